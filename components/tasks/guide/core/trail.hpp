#pragma once

#include <deque>
#include <optional>

#include "foundation/geometry/pose2.hpp"

namespace usher::guide {

/// The way that somebody took, in map, from the robot that follows on: so the robot goes through
/// the same doors. Its last 20 m are kept.
class Trail {
 public:
  bool empty() const { return points_.empty(); }
  const geometry::Point2& newest() const { return points_.back(); }
  void begin(const geometry::Point2& robot) { points_.assign(1, robot); }
  /// He is here now. Steps of less than 0.15 m are none; where he comes back to his own way, what
  /// lies between is forgotten.
  void see(const geometry::Point2& visitor);
  /// The place so far behind the newest one [m], along the way, facing along it; nothing where the
  /// way is not so long.
  std::optional<geometry::Pose2> behind(double distance) const;

 private:
  std::deque<geometry::Point2> points_;  ///< oldest first
};

}  // namespace usher::guide
