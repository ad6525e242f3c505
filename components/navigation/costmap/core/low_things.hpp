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

/// Splits a scan, `ranges` [m], one per direction, between two layers: `elsewhere(bearing, place in
/// the sensor's frame)` says what is for the other one. What is for the other one is -r in each:
/// nothing of its own is up to there (negative_clears).
template <class Elsewhere>
void split_ranges(std::span<const float> ranges, std::span<const geometry::Point2> directions,
                  const Elsewhere& elsewhere, std::vector<float>& own, std::vector<float>& other) {
  own.assign(ranges.begin(), ranges.end());
  other.assign(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float range = ranges[i];
    if (!std::isfinite(range) || range <= 0.0F) continue;
    const geometry::Point2 place(static_cast<double>(range) * directions[i]);
    (elsewhere(i, place) ? own : other)[i] = -range;
  }
}

}  // namespace usher::costmap
