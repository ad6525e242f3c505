#pragma once

#include <bit>
#include <cstdint>

#include "foundation/grid/grid.hpp"

namespace usher::grid {

/// A number that tells one map from another: geometry and every cell (FNV-1a, 64 bits). Maps that
/// differ in a single cell differ in it, but for one pair in 2^64.
inline std::uint64_t fingerprint(const OccupancyGrid& map) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&hash](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      hash = (hash ^ ((value >> (8 * i)) & 0xFF)) * std::uint64_t{0x100000001b3ULL};
  };
  const GridGeometry& geometry = map.geometry();
  add(static_cast<std::uint64_t>(geometry.width), 8);
  add(static_cast<std::uint64_t>(geometry.height), 8);
  for (const double value : {geometry.resolution, geometry.origin_x, geometry.origin_y})
    add(std::bit_cast<std::uint64_t>(value + 0.0), 8);  // minus zero is zero
  for (std::size_t i = 0; i < map.size(); ++i) add(static_cast<std::uint8_t>(map[i]), 1);
  return hash;
}

}  // namespace usher::grid
