#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "navigation/explorer/core/ground.hpp"
#include "navigation/explorer/core/seen_area.hpp"

namespace usher::explorer {

/// How robots that look for people together divide the map: a place for each robot, the same list
/// on all of them.
struct Share {
  static constexpr std::size_t kMost = 16;  ///< places
  std::vector<Point2> places;               ///< [m] in map; fewer than two: nothing is divided
  std::size_t own = 0;                      ///< which of them is this robot's
  bool operator==(const Share&) const = default;
};

/// Which place each cell that is to be looked at belongs to: the one that is nearest by the length
/// of the way, with a head start for each place such that all parts are about equally large, as far
/// as that can be had: places side by side have the same way to whole rooms. A pure function of map
/// and places, so that robots need not agree on more than these. At most kMost places; a place
/// without any way has no part. Cells that are not to be looked at have any value.
/// The ways of `ground` start anywhere after it. About 10 ms and a place on a floor of 16 x 12 m.
std::vector<std::uint8_t> divide(Ground& ground, const SeenArea& area,
                                 std::span<const Point2> places);

}  // namespace usher::explorer
