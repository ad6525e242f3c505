#include "navigation/costmap/core/low_things.hpp"

#include <algorithm>
#include <limits>

namespace usher::costmap {

namespace {
constexpr double kBeside = 0.35;  // [m] so near to where somebody is a line of sight ends
}  // namespace

void drop_what_people_hide(std::span<const geometry::Point2> directions,
                           const geometry::Pose2& window_T_camera,
                           std::span<const geometry::Point2> people, std::span<float> ranges) {
  const geometry::Pose2 camera_T_window = geometry::inverse(window_T_camera);
  for (const geometry::Point2& person : people) {
    const geometry::Point2 place = camera_T_window * person;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double range = ranges[i];
      if (!std::isfinite(range) || range <= 0.0) continue;
      const double along = std::clamp(directions[i].dot(place), 0.0, range);
      if ((place - along * directions[i]).norm() < kBeside)
        ranges[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

}  // namespace usher::costmap
