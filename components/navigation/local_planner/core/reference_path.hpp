#pragma once

#include <array>
#include <span>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"

namespace usher::local_planner {

/// The path to follow: a polyline in the odometry frame, how far along it the robot is, and
/// distances to it.
class ReferencePath {
 public:
  /// 1 to 100000 finite poses; the last is the goal with its yaw, the yaws of the others are not
  /// used. Starts at the beginning. An error leaves the path as it was.
  Status set(std::span<const geometry::Pose2> poses);
  void clear();

  bool empty() const { return x_.empty(); }
  const geometry::Pose2& goal() const { return goal_; }
  double length() const { return arc_.empty() ? 0.0 : arc_.back(); }  ///< [m]

  /// Moves the progress to the point nearest to `position` on the stretch around the last progress
  /// (0.5 m back, 1.5 m ahead), or on the whole path when that stretch is more than 1 m away: where
  /// a path passes twice, the robot stays on its leg.
  void advance(const geometry::Point2& position);

  double progress() const { return progress_; }              ///< [m] along the path
  double remaining() const { return length() - progress_; }  ///< [m] to the goal
  /// The point at `arc` metres along the path with the direction of travel there. Beyond the end it
  /// goes straight on.
  geometry::Pose2 at(double arc) const;
  geometry::Point2 point(double arc) const;  ///< the position alone

 private:
  void project(const geometry::Point2& position, double from, double to, double& best_arc,
               double& best_squared) const;
  std::size_t segment_at(double arc) const;

  std::vector<double> x_, y_, arc_;  // corners and their way from the start
  geometry::Pose2 goal_;
  double progress_ = 0.0;
};

/// Distances of many points to one polyline: sides outside, points inside the loops, eight at a
/// time.
class PolylineDistance {
 public:
  explicit PolylineDistance(cpu::Simd simd = cpu::best_simd()) : avx2_(simd == cpu::Simd::kAvx2) {}

  void clear() { sides_.clear(); }
  void add(float ax, float ay, float bx, float by);
  /// distances[i] = distance of (x[i], y[i]) to the nearest point of the polyline; infinite without
  /// sides.
  void measure(std::span<const float> x, std::span<const float> y,
               std::span<float> distances) const;

 private:
  bool avx2_ = false;
  using Side = std::array<float, 5>;  // start, way to the end, 1 / squared length
  std::vector<Side> sides_;
};

}  // namespace usher::local_planner
