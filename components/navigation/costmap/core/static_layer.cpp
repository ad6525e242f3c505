#include "navigation/costmap/core/static_layer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <string>

#include "navigation/costmap/core/static_layer_kernels.hpp"

namespace usher::costmap {

namespace static_layer_kernels {

void sample_portable(const std::uint8_t* map, int map_width, const StaticLayer::Run& run,
                     std::uint8_t* states) {
  std::int64_t x = run.x;
  std::int64_t y = run.y;
  for (int i = 0; i < run.count; ++i) {
    states[i] = map[(y >> 32) * map_width + (x >> 32)];
    x += run.step_x;
    y += run.step_y;
  }
}

}  // namespace static_layer_kernels

namespace {

constexpr std::size_t kReadAhead = 4;

std::int64_t fixed_point(double cells) { return std::llround(cells * 0x1p32); }

std::int64_t floor_divided(std::int64_t value, std::int64_t by) {  // by > 0
  const std::int64_t quotient = value / by;
  return value % by < 0 ? quotient - 1 : quotient;
}

/// Narrows first <= i < end to the i with 0 <= start + i step < limit.
void keep_within(std::int64_t start, std::int64_t step, std::int64_t limit, std::int64_t& first,
                 std::int64_t& end) {
  if (step == 0) {
    if (start < 0 || start >= limit) end = first;
  } else if (step > 0) {
    first = std::max(first, -floor_divided(start, step));
    end = std::min(end, -floor_divided(start - limit, step));
  } else {
    first = std::max(first, floor_divided(start - limit, -step) + 1);
    end = std::min(end, floor_divided(start, -step) + 1);
  }
}

/// The maximum over 2 radius + 1 cells along both axes.
void widen(std::vector<std::uint8_t>& states, int width, int height, int radius) {
  const auto pass = [&](int lines, int count, std::size_t line_stride, std::size_t stride) {
    std::vector<std::uint8_t> line(static_cast<std::size_t>(count));
    for (int l = 0; l < lines; ++l) {
      std::uint8_t* cells = states.data() + static_cast<std::size_t>(l) * line_stride;
      for (int i = 0; i < count; ++i)
        line[static_cast<std::size_t>(i)] = cells[static_cast<std::size_t>(i) * stride];
      for (int i = 0; i < count; ++i) {
        const auto begin = line.begin() + std::max(0, i - radius);
        const auto end = line.begin() + std::min(count, i + radius + 1);
        cells[static_cast<std::size_t>(i) * stride] = *std::max_element(begin, end);
      }
    }
  };
  pass(height, width, static_cast<std::size_t>(width), 1);
  pass(width, height, 1, static_cast<std::size_t>(width));
}

}  // namespace

StaticLayer::StaticLayer(cpu::Simd simd) : sample_(static_layer_kernels::sample_portable) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) sample_ = static_layer_kernels::sample_avx2;
#else
  static_cast<void>(simd);
#endif
}

Status StaticLayer::set_map(const grid::OccupancyGrid& map, int occupied_from, double resolution) {
  constexpr std::size_t kMaxCells = std::size_t{1} << 29;
  const grid::GridGeometry& geometry = map.geometry();
  if (map.empty() || geometry.width <= 0 || geometry.height <= 0 || map.size() > kMaxCells) {
    return Error{"static map must have 1 to 2^29 cells, got " + std::to_string(geometry.width) +
                 " x " + std::to_string(geometry.height)};
  }
  if (!(geometry.resolution >= kFinestResolution) || !std::isfinite(geometry.resolution)) {
    return Error{"static map resolution must be at least 0.001 m, got " +
                 std::to_string(geometry.resolution) + " m"};
  }
  if (!reachable(geometry.origin_x, geometry.origin_y)) {
    return Error{"static map origin must be within 1e5 m, got (" +
                 std::to_string(geometry.origin_x) + ", " + std::to_string(geometry.origin_y) +
                 ") m"};
  }
  geometry_ = geometry;
  states_.assign(map.size() + kReadAhead, kUnseen);
  std::transform(map.begin(), map.end(), states_.begin(), [&](std::int8_t occupancy) {
    return occupancy < 0 ? kUnseen : occupancy >= occupied_from ? kSeenOccupied : kSeenFree;
  });
  const int radius =
      static_cast<int>(std::ceil(0.5 * (resolution / geometry.resolution - 1.0) - 1e-6));
  if (radius > 0) widen(states_, geometry.width, geometry.height, radius);
  return {};
}

void StaticLayer::sample(const geometry::Pose2& map_T_window, const Raster& raster,
                         const CellRect& cells, grid::Grid<std::uint8_t>& window) const {
  const CellRect rect = cells.within(raster.all());
  if (rect.empty() || !has_map()) return;
  assert(map_T_window.finite());
  const double per_cell = 1.0 / geometry_.resolution;
  const double c = std::cos(map_T_window.yaw);
  const double s = std::sin(map_T_window.yaw);
  const double x = raster.anchor_x + 0.5 * raster.resolution;
  const double y = raster.anchor_y + 0.5 * raster.resolution;
  const std::int64_t step_c = fixed_point(c * raster.resolution * per_cell);
  const std::int64_t step_s = fixed_point(s * raster.resolution * per_cell);
  const std::int64_t anchor_x =
      fixed_point((map_T_window.x + c * x - s * y - geometry_.origin_x) * per_cell);
  const std::int64_t anchor_y =
      fixed_point((map_T_window.y + s * x + c * y - geometry_.origin_y) * per_cell);
  for (int row = rect.y0; row < rect.y1; ++row) {
    const std::int64_t column = raster.first_x + rect.x0;
    const std::int64_t line = raster.first_y + row;
    const std::int64_t start_x = anchor_x + column * step_c - line * step_s;
    const std::int64_t start_y = anchor_y + column * step_s + line * step_c;
    const std::int64_t count = rect.x1 - rect.x0;
    std::int64_t first = 0;
    std::int64_t end = count;
    keep_within(start_x, step_c, std::int64_t{geometry_.width} << 32, first, end);
    keep_within(start_y, step_s, std::int64_t{geometry_.height} << 32, first, end);
    std::uint8_t* states = window.row(row) + rect.x0;
    if (first >= end) {
      std::memset(states, kUnseen, static_cast<std::size_t>(count));
      continue;
    }
    std::memset(states, kUnseen, static_cast<std::size_t>(first));
    const Run run{start_x + first * step_c, start_y + first * step_s, step_c, step_s,
                  static_cast<int>(end - first)};
    sample_(states_.data(), geometry_.width, run, states + first);
    std::memset(states + end, kUnseen, static_cast<std::size_t>(count - end));
  }
}

}  // namespace usher::costmap
