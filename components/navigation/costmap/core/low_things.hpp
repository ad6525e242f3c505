#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::costmap {

/// Sets to NaN the positive `ranges` of a depth camera's low scan, one per direction, whose line of
/// sight one of the `people` [m, in the frame of window_T_camera] bars: floor that is hidden by
/// somebody who is too near to be measured looks like a hole. O(ranges x people).
void drop_what_people_hide(std::span<const geometry::Point2> directions,
                           const geometry::Pose2& window_T_camera,
                           std::span<const geometry::Point2> people, std::span<float> ranges);

/// A layer's own part of a scan, `ranges` [m], one per direction, that it shares with another:
/// `is_own(bearing, place in the sensor's frame)`. What is the other's is -r: nothing of its own is
/// up to there (negative_clears).
template <class IsOwn>
void keep_own(std::span<const float> ranges, std::span<const geometry::Point2> directions,
              const IsOwn& is_own, std::vector<float>& own) {
  own.assign(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float range = ranges[i];
    if (!std::isfinite(range) || range <= 0.0F) continue;
    const geometry::Point2 place(static_cast<double>(range) * directions[i]);
    if (!is_own(i, place)) own[i] = -range;
  }
}

}  // namespace usher::costmap
