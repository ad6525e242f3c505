#include "interaction/tablet/core/floor_plan.hpp"

#include <algorithm>
#include <cmath>

#include "interaction/tablet/core/theme.hpp"

namespace usher::tablet {

namespace {

constexpr int kOccupied = 65;  ///< [%]

std::uint32_t pixel(const Color& color) {
  return 0xff000000U | (static_cast<std::uint32_t>(color.red) << 16U) |
         (static_cast<std::uint32_t>(color.green) << 8U) | color.blue;
}

double distance_to(const geometry::Point2& p, const geometry::Point2& a,
                   const geometry::Point2& b) {
  const geometry::Point2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

}  // namespace

Ground FloorPlan::ground(int x, int y) const {
  const std::uint32_t shown = pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                     static_cast<std::size_t>(x)];
  if (shown == pixel(kPalette.floor)) return Ground::kFloor;
  return shown == pixel(kPalette.wall) ? Ground::kWall : Ground::kUnknown;
}

FloorPlan draw_floor_plan(const grid::OccupancyGrid& map, int margin) {
  int left = map.width(), right = -1, bottom = map.height(), top = -1;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (map.at({x, y}) < 0) continue;
      left = std::min(left, x), right = std::max(right, x);
      bottom = std::min(bottom, y), top = std::max(top, y);
    }
  }
  FloorPlan plan;
  if (right < 0) return plan;
  left = std::max(0, left - margin), bottom = std::max(0, bottom - margin);
  right = std::min(map.width() - 1, right + margin), top = std::min(map.height() - 1, top + margin);
  plan.width = right - left + 1;
  plan.height = top - bottom + 1;
  plan.resolution = map.resolution();
  const auto& geometry = map.geometry();
  plan.upper_left = {geometry.origin_x + left * plan.resolution,
                     geometry.origin_y + (top + 1) * plan.resolution};
  plan.pixels.reserve(static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.height));
  for (int y = top; y >= bottom; --y) {
    for (int x = left; x <= right; ++x) {
      const int value = map.at({x, y});
      plan.pixels.push_back(pixel(value < 0            ? kPalette.unknown
                                  : value >= kOccupied ? kPalette.wall
                                                       : kPalette.floor));
    }
  }
  return plan;
}

std::vector<geometry::Point2> simplified(const std::vector<geometry::Point2>& path,
                                         double tolerance) {
  if (path.size() < 3) return path;
  std::vector<bool> keep(path.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, path.size() - 1}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double farthest = tolerance;
    std::size_t split = from;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double distance = distance_to(path[i], path[from], path[to]);
      if (distance > farthest) farthest = distance, split = i;
    }
    if (split == from) continue;
    keep[split] = true;
    open.emplace_back(from, split);
    open.emplace_back(split, to);
  }
  std::vector<geometry::Point2> out;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (keep[i]) out.push_back(path[i]);
  }
  return out;
}

}  // namespace usher::tablet
