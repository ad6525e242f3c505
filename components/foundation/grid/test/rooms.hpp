#pragma once

#include "foundation/grid/grid.hpp"
#include "foundation/random/random.hpp"

namespace usher::grid {

/// 20 x 10 m of free floor in cells of 0.05 m with walls around.
inline OccupancyGrid hall() {
  OccupancyGrid map({.width = 400, .height = 200, .resolution = 0.05}, kFree);
  for (int x = 0; x < 400; ++x) map.at({x, 0}) = map.at({x, 199}) = kOccupied;
  for (int y = 0; y < 200; ++y) map.at({0, y}) = map.at({399, y}) = kOccupied;
  return map;
}

inline void block(OccupancyGrid& map, double x0, double y0, double x1, double y1) {
  for (int y = static_cast<int>(y0 / 0.05); y < static_cast<int>(y1 / 0.05); ++y) {
    for (int x = static_cast<int>(x0 / 0.05); x < static_cast<int>(x1 / 0.05); ++x)
      map.at({x, y}) = kOccupied;
  }
}

/// Two rooms and a wall between them with a door of 0.8 m; a narrow corridor of 0.7 m in the east.
inline OccupancyGrid two_rooms() {
  auto map = hall();
  block(map, 9.9, 0.0, 10.1, 4.6);
  block(map, 9.9, 5.4, 10.1, 10.0);
  block(map, 15.0, 2.0, 19.9, 4.0);
  block(map, 15.0, 4.7, 19.9, 6.7);
  return map;
}

/// Random blocks in the hall.
inline OccupancyGrid clutter(std::uint64_t seed) {
  auto map = hall();
  Random random(seed);
  for (int i = 0; i < 40; ++i) {
    const double x = random.uniform(0.5, 18.5), y = random.uniform(0.5, 8.5);
    block(map, x, y, x + random.uniform(0.1, 1.0), y + random.uniform(0.1, 1.0));
  }
  return map;
}

}  // namespace usher::grid
