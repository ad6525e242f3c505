#include "navigation/costmap/core/polygon_raster.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace usher::costmap {

using geometry::Point2;

namespace {

int clamped_floor(double value, int low, int high) {
  return static_cast<int>(
      std::floor(std::clamp(value, static_cast<double>(low), static_cast<double>(high))));
}

}  // namespace

PolygonRaster::PolygonRaster(std::span<const Point2> polygon, const geometry::Pose2& pose,
                             const grid::GridGeometry& geometry)
    : corners_(polygon.size()), width_(geometry.width) {
  assert(corners_ >= 3 && corners_ <= kMaxCorners);
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x, high_x = -low_x,
         high_y = -low_x;
  for (std::size_t i = 0; i < corners_; ++i) {
    const Point2& corner = polygon[i];
    x_[i] = (pose.x + c * corner.x() - s * corner.y() - geometry.origin_x) / geometry.resolution;
    y_[i] = (pose.y + s * corner.x() + c * corner.y() - geometry.origin_y) / geometry.resolution;
    low_x = std::min(low_x, x_[i]), high_x = std::max(high_x, x_[i]);
    low_y = std::min(low_y, y_[i]), high_y = std::max(high_y, y_[i]);
  }
  x_[corners_] = x_[0];
  y_[corners_] = y_[0];
  leaves_grid_ =
      !(low_x >= 0.0 && low_y >= 0.0 && high_x < geometry.width && high_y < geometry.height);
  const bool meets_grid =
      high_x >= 0.0 && high_y >= 0.0 && low_x < geometry.width && low_y < geometry.height;
  if (meets_grid) {
    first_row_ = clamped_floor(low_y, 0, geometry.height - 1);
    end_row_ = clamped_floor(high_y, 0, geometry.height - 1) + 1;
  }
}

// A cell that no edge touches lies wholly inside or wholly outside, so its centre decides: the runs
// are what the edges cover within the row and what lies between crossings of the row's middle line.
std::size_t PolygonRaster::row_spans(int y, std::array<CellSpan, kMaxSpans>& spans) const {
  const double bottom = y;
  const double top = bottom + 1.0;
  const double middle = bottom + 0.5;
  std::array<double, kMaxCorners> crossings;
  std::size_t crossing_count = 0;
  std::size_t count = 0;
  const auto add = [&](int first, int last) {
    first = std::max(first, 0);
    last = std::min(last, width_ - 1);
    if (first > last) return;
    std::size_t at = count++;
    for (; at > 0 && spans[at - 1].x0 > first; --at) spans[at] = spans[at - 1];
    spans[at] = {y, first, last + 1};
  };
  for (std::size_t i = 0; i < corners_; ++i) {
    const bool rises = y_[i] <= y_[i + 1];
    const std::size_t low = rises ? i : i + 1;
    const std::size_t high = rises ? i + 1 : i;
    if (y_[high] < bottom || y_[low] >= top) continue;
    const double height = y_[high] - y_[low];
    const double slope = height > 0.0 ? (x_[high] - x_[low]) / height : 0.0;
    const double enter = y_[low] < bottom ? x_[low] + (bottom - y_[low]) * slope : x_[low];
    const double leave = y_[high] > top ? x_[low] + (top - y_[low]) * slope : x_[high];
    add(clamped_floor(std::min(enter, leave), -1, width_),
        clamped_floor(std::max(enter, leave), -1, width_));
    if (y_[low] <= middle && y_[high] > middle) {
      const double crossing = x_[low] + (middle - y_[low]) * slope;
      std::size_t at = crossing_count++;
      for (; at > 0 && crossings[at - 1] > crossing; --at) crossings[at] = crossings[at - 1];
      crossings[at] = crossing;
    }
  }
  for (std::size_t i = 0; i + 1 < crossing_count; i += 2) {
    add(clamped_floor(crossings[i] + 0.5, 0, width_),
        clamped_floor(crossings[i + 1] - 0.5, -1, width_));
  }
  std::size_t merged = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (merged > 0 && spans[i].x0 <= spans[merged - 1].x1) {
      spans[merged - 1].x1 = std::max(spans[merged - 1].x1, spans[i].x1);
    } else {
      spans[merged++] = spans[i];
    }
  }
  return merged;
}

// A convex polygon holds a square that lies between its sides on the lower and on the upper line.
CellSpan PolygonRaster::inner_span(int y) const {
  double left = 0.0, right = static_cast<double>(width_);
  for (const double line : {static_cast<double>(y), y + 1.0}) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < corners_; ++i) {
      const double from = y_[i] - line, to = y_[i + 1] - line;
      if ((from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0)) continue;
      const double share = from == to ? 0.0 : from / (from - to);
      const double crossing = x_[i] + share * (x_[i + 1] - x_[i]);
      low = std::min(low, crossing), high = std::max(high, crossing);
    }
    left = std::max(left, low), right = std::min(right, high);
  }
  if (!(left < right)) return {y, 0, 0};
  return {y, static_cast<int>(std::ceil(left)), static_cast<int>(std::floor(right))};
}

}  // namespace usher::costmap
