#pragma once

#include <cstddef>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::navigator {

/// A path with the robot's place on it.
class Route {
 public:
  /// At least one pose, all finite. The robot is taken to be at its beginning.
  void set(std::vector<geometry::Pose2> path);
  void clear() { path_.clear(); }

  bool empty() const { return path_.empty(); }
  const std::vector<geometry::Pose2>& path() const { return path_; }
  const geometry::Pose2& end() const { return path_.back(); }

  /// Moves the place to the point of the path nearest to the robot, looked for between half a metre
  /// behind the old place and three metres before it (a path that crosses itself is not cut short),
  /// on the whole path when nothing there is within one metre. Returns the way made along the path
  /// [m], negative backwards.
  double track(const geometry::Pose2& robot);

  double length() const {
    return length_.empty() ? 0.0 : length_.back();
  }                                                       ///< [m] of the whole path
  double remaining() const { return length() - place_; }  ///< [m] from the place to the end
  /// [m] of a point from the path between the place and `reach` farther on. Not for an empty path.
  double distance_ahead(const geometry::Point2& point, double reach) const {
    return project(point, place_, place_ + reach).distance;
  }
  /// [rad] that the robot at `yaw` has still to turn, in both senses together: to the path, along
  /// it (in chords of 0.4 m: corners of a grid's path are none) and at its end. Not for an empty
  /// path.
  double turning_left(double yaw) const;
  /// [rad] Where the path leads from the place. Not for an empty path.
  double heading() const;
  double offset() const { return offset_; }  ///< [m] of the robot from the path, when last tracked

 private:
  struct Projection {
    double place;
    double distance;
  };
  void measure_chords();
  Projection project(const geometry::Point2& point, double from, double to) const;

  std::vector<geometry::Pose2> path_;
  std::vector<double> length_;  // [m] from the beginning to each pose
  std::vector<double> chords_;  // [rad] heading of each chord of the path
  double place_ = 0.0;          // [m] from the beginning
  double offset_ = 0.0;
};

}  // namespace usher::navigator
