#include "foundation/grid/distance_field.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::grid {
namespace {

constexpr int kLanes = 32;  // cells per block of the row pass

/// down[x] = occupied ? 0 : min(above[x] + 1, radius), a whole row at a time.
[[gnu::always_inline]] inline void sweep_row(const std::int8_t* map, const std::uint8_t* before,
                                             std::uint8_t* row, int width,
                                             std::int8_t occupied_from, std::uint8_t radius) {
  for (int x = 0; x < width; ++x) {
    const auto next = static_cast<std::uint8_t>(before[x] + 1);
    const std::uint8_t distance = next < radius ? next : radius;
    row[x] = map[x] >= occupied_from ? std::uint8_t{0} : distance;
  }
}

[[gnu::always_inline]] inline void merge_row(const std::uint8_t* before, std::uint8_t* row,
                                             int width) {
  for (int x = 0; x < width; ++x) {
    const auto next = static_cast<std::uint8_t>(before[x] + 1);
    row[x] = next < row[x] ? next : row[x];
  }
}

/// out[x] = min over dx of squared[x + dx] + dx^2 for one block; `squared` may be read `radius`
/// cells to both sides.
[[gnu::always_inline]] inline void minimum_block(const std::uint16_t* squared, std::uint16_t* out,
                                                 int radius) {
  std::uint16_t best[kLanes];
  for (int i = 0; i < kLanes; ++i) best[i] = squared[i];
  for (int dx = 1; dx < radius; ++dx) {
    const auto square = static_cast<std::uint16_t>(dx * dx);
    std::uint16_t open = 0;  // whether a farther column could still win somewhere
    for (int i = 0; i < kLanes; ++i)
      open = static_cast<std::uint16_t>(open | (best[i] > square ? 0xffff : 0));
    if (open == 0) break;
    const std::uint16_t* left = squared - dx;
    const std::uint16_t* right = squared + dx;
    for (int i = 0; i < kLanes; ++i) {
      const std::uint16_t nearer = left[i] < right[i] ? left[i] : right[i];
      const auto sum = static_cast<std::uint16_t>(nearer + square);
      best[i] = sum < best[i] ? sum : best[i];
    }
  }
  for (int i = 0; i < kLanes; ++i) out[i] = best[i];
}

struct Work {
  const std::int8_t* map;
  std::uint8_t* columns;
  std::uint16_t* row;  // first cell; radius + kLanes cells of padding on both sides
  std::uint16_t* squared;
  int width, height, radius;
  std::int8_t occupied_from;
};

[[gnu::always_inline]] inline void column_pass(const Work& work) {
  const auto width = static_cast<std::size_t>(work.width);
  const auto height = static_cast<std::size_t>(work.height);
  const auto radius = static_cast<std::uint8_t>(work.radius);
  std::uint8_t* columns = work.columns;
  std::fill_n(columns, width, radius);  // the row "before" the first: nothing occupied
  sweep_row(work.map, columns, columns, work.width, work.occupied_from, radius);
  for (std::size_t y = 1; y < height; ++y) {
    sweep_row(work.map + y * width, columns + (y - 1) * width, columns + y * width, work.width,
              work.occupied_from, radius);
  }
  for (std::size_t y = height - 1; y-- > 0;)
    merge_row(columns + (y + 1) * width, columns + y * width, work.width);
}

[[gnu::always_inline]] inline void row_pass(const Work& work) {
  const auto width = static_cast<std::size_t>(work.width);
  const int whole = work.width / kLanes * kLanes;
  for (std::size_t y = 0; y < static_cast<std::size_t>(work.height); ++y) {
    const std::uint8_t* column = work.columns + y * width;
    std::uint16_t* out = work.squared + y * width;
    for (int x = 0; x < work.width; ++x)
      work.row[x] = static_cast<std::uint16_t>(column[x] * column[x]);
    for (int x = 0; x < whole; x += kLanes) minimum_block(work.row + x, out + x, work.radius);
    if (whole < work.width) {
      std::uint16_t rest[kLanes];
      minimum_block(work.row + whole, rest, work.radius);
      std::copy_n(rest, work.width - whole, out + whole);
    }
  }
}

void measure_portable(const Work& work) {
  column_pass(work);
  row_pass(work);
}

#if defined(__x86_64__)
__attribute__((target("sse4.1"))) void measure_sse41(const Work& work) {
  column_pass(work);
  row_pass(work);
}
__attribute__((target("avx2"))) void measure_avx2(const Work& work) {
  column_pass(work);
  row_pass(work);
}
#endif

void measure(const Work& work, [[maybe_unused]] cpu::Simd simd) {
#if defined(__x86_64__)
  if (simd == cpu::Simd::kAvx2) return measure_avx2(work);
  if (simd == cpu::Simd::kSse41) return measure_sse41(work);
#endif
  measure_portable(work);
}

}  // namespace

void DistanceField::build(const OccupancyGrid& map, double radius, std::int8_t occupied_from,
                          cpu::Simd simd) {
  if (!(squared_.geometry() == map.geometry())) squared_ = Grid<std::uint16_t>(map.geometry());
  if (map.empty()) return;
  assert(radius > 0 && map.resolution() > 0);
  const int cells = static_cast<int>(
      std::clamp(std::floor(radius / map.resolution() + 1e-6), 1.0, double{kMaxRadius}));
  if (cells != radius_) {
    radius_ = cells;
    root_.resize(static_cast<std::size_t>(radius_ * radius_) + 1);
    for (std::size_t i = 0; i < root_.size(); ++i)
      root_[i] = static_cast<float>(std::sqrt(static_cast<double>(i)));
  }
  columns_.resize(map.size());
  const auto padding = static_cast<std::size_t>(radius_ + kLanes);
  row_.assign(static_cast<std::size_t>(map.width()) + 2 * padding,
              static_cast<std::uint16_t>(radius_ * radius_));
  measure({map.data(), columns_.data(), row_.data() + padding, squared_.data(), map.width(),
           map.height(), radius_, occupied_from},
          simd);
}

DistanceField::Sample DistanceField::interpolated(const geometry::Point2& point) const {
  const GridGeometry& g = geometry();
  const double x = (point.x() - g.origin_x) / g.resolution - 0.5;
  const double y = (point.y() - g.origin_y) / g.resolution - 0.5;
  if (!(x >= 0 && y >= 0 && x < g.width - 1 && y < g.height - 1))
    return {radius(), geometry::Point2::Zero()};
  const Cell cell{static_cast<int>(x), static_cast<int>(y)};
  const double fx = x - cell.x;
  const double fy = y - cell.y;
  const std::uint16_t* low = squared_.row(cell.y) + cell.x;
  const std::uint16_t* high = low + g.width;
  const double a = root_[low[0]], b = root_[low[1]], c = root_[high[0]], d = root_[high[1]];
  const double bottom = a + fx * (b - a);
  const double top = c + fx * (d - c);
  return {(bottom + fy * (top - bottom)) * g.resolution,
          {(b - a) + fy * ((d - c) - (b - a)), top - bottom}};
}

std::optional<RayHit> DistanceField::cast_ray(const geometry::Point2& start, double direction,
                                              double max_range) const {
  if (empty()) return std::nullopt;
  return grid::cast_ray(
      geometry(), start, direction, max_range, [this](Cell cell) { return squared_.at(cell) == 0; },
      // Half a diagonal from the point to its cell's centre, another from the occupied centre to
      // its corner.
      [this](Cell cell) { return root_[squared_.at(cell)] - 1.4143; });
}

}  // namespace usher::grid
