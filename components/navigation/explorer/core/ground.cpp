#include "navigation/explorer/core/ground.hpp"

#include <algorithm>

namespace usher::explorer {

namespace {

constexpr std::int8_t kOccupiedFrom = 65;  // percent, as map_server's default

}  // namespace

Status Ground::set_map(const grid::OccupancyGrid& map, std::span<const Rectangle> leave_out,
                       double passing_room, double standing_room) {
  if (Status taken = ways_.set_map(map, passing_room); !taken) return taken;
  const grid::GridGeometry& g = map.geometry();
  standing_map_ = map;
  for (auto& value : standing_map_) value = value >= kOccupiedFrom ? grid::kOccupied : value;
  // What is left out is as good as never seen: blocked, without being an obstacle to keep from.
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (standing_map_[i] == grid::kOccupied) continue;
    const Point2 center = g.center(g.cell(i));
    if (std::any_of(leave_out.begin(), leave_out.end(),
                    [&](const Rectangle& r) { return r.contains(center); }))
      standing_map_[i] = grid::kUnknown;
  }
  standing_.build(standing_map_, standing_room);
  return {};
}

}  // namespace usher::explorer
