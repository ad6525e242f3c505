#include "tasks/meeting/core/cleared_space.hpp"

#include <algorithm>
#include <cmath>

namespace usher::meeting {

namespace {
constexpr double kSide = 0.05;        // [m] of a cell
constexpr double kBefore = 0.2;       // [m] of a point: what it stands for begins there
constexpr double kLongest = 6.0;      // [m]
constexpr std::uint32_t kOften = 3;   // scans
constexpr std::uint32_t kSeldom = 3;  // times more looked through than met something
constexpr int kAround = 3;            // [cells]
constexpr int kBody = 5;              // [cells]

bool near(const Point2& point) { return point.allFinite() && point.cwiseAbs().maxCoeff() < 1e6; }
}  // namespace

void ClearedSpace::set_extent(const grid::GridGeometry& map) {
  const double scale = map.resolution / kSide;
  cells_ = grid::Grid<Looked>(grid::GridGeometry{static_cast<int>(std::ceil(map.width * scale)),
                                                 static_cast<int>(std::ceil(map.height * scale)),
                                                 kSide, map.origin_x, map.origin_y});
}

void ClearedSpace::forget() { std::fill(cells_.begin(), cells_.end(), Looked{}); }

void ClearedSpace::add(const Point2& from, std::span<const Point2> points) {
  if (!near(from)) return;
  ++scan_;
  for (const Point2& point : points) {
    if (!near(point)) continue;
    const Point2 way = point - from;
    if (const grid::Cell met = cells_.geometry().cell_at(point); cells_.geometry().contains(met))
      ++cells_.at(met).met;
    const double length = std::min(way.norm(), kLongest) - kBefore;
    if (length <= 0.0) continue;
    const Point2 step = way.normalized() * kSide;
    const int steps = static_cast<int>(length / kSide);
    Point2 here = from;
    for (int i = 0; i <= steps; ++i, here += step) {
      const grid::Cell cell = cells_.geometry().cell_at(here);
      if (!cells_.geometry().contains(cell)) continue;
      Looked& looked = cells_.at(cell);
      looked.scans += looked.last != scan_ ? 1 : 0;
      looked.last = scan_;
    }
  }
}

bool ClearedSpace::was_clear(const Point2& point) const {
  if (cells_.empty() || !near(point)) return false;
  const grid::Cell middle = cells_.geometry().cell_at(point);
  for (int y = -kAround; y <= kAround; ++y) {
    for (int x = -kAround; x <= kAround; ++x) {
      if (x * x + y * y > kAround * kAround) continue;
      const Looked looked = cells_.value_or({middle.x + x, middle.y + y}, {});
      if (looked.scans < kOften || kSeldom * looked.met > looked.scans) return false;
    }
  }
  return true;
}

bool ClearedSpace::was_taken(const Point2& point) const {
  if (cells_.empty() || !near(point)) return false;
  const grid::Cell middle = cells_.geometry().cell_at(point);
  std::uint32_t met = 0;
  for (int y = -kBody; y <= kBody; ++y) {
    for (int x = -kBody; x <= kBody; ++x) {
      if (x * x + y * y <= kBody * kBody)
        met += cells_.value_or({middle.x + x, middle.y + y}, {}).met;
    }
  }
  return met >= kOften;
}

}  // namespace usher::meeting
