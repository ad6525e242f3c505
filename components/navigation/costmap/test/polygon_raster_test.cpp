#include "navigation/costmap/core/polygon_raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "foundation/geometry/footprint.hpp"
#include "foundation/random/random.hpp"
#include "navigation/costmap/core/costs.hpp"
#include "navigation/costmap/test/footprint_reading.hpp"

namespace usher::costmap {
namespace {

using geometry::Point2;
using geometry::Pose2;

std::vector<Point2> square(double half) {
  return {{half, half}, {-half, half}, {-half, -half}, {half, -half}};
}

/// A polygon star-shaped around the origin: corners at rising angles, so it never crosses itself.
std::vector<Point2> star(Random& random, std::size_t corners, double smallest) {
  std::vector<Point2> points;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * geometry::kPi * (static_cast<double>(i) + 0.8 * random.uniform()) /
                         static_cast<double>(corners);
    const double radius = random.uniform(smallest, 0.6);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

std::set<std::pair<int, int>> raster(std::span<const Point2> polygon, const Pose2& pose,
                                     const grid::GridGeometry& geometry) {
  std::set<std::pair<int, int>> cells;
  CellSpan last{-1, 0, 0};
  PolygonRaster(polygon, pose, geometry).for_each_span([&](const CellSpan& span) {
    EXPECT_TRUE(span.x0 >= 0 && span.x0 < span.x1 && span.x1 <= geometry.width);
    EXPECT_TRUE(span.y > last.y || (span.y == last.y && span.x0 > last.x1))
        << "runs rise and never touch";
    last = span;
    for (int x = span.x0; x < span.x1; ++x) EXPECT_TRUE(cells.emplace(x, span.y).second);
  });
  return cells;
}

/// Does the segment from a to b meet the square [low, high]? Each axis leaves an interval of the
/// segment's parameter.
bool meets_square(const Point2& a, const Point2& b, const Point2& low, const Point2& high) {
  double enter = 0.0;
  double leave = 1.0;
  for (const int axis : {0, 1}) {
    const double along = b[axis] - a[axis];
    if (along == 0.0 && (a[axis] < low[axis] || a[axis] > high[axis])) return false;
    if (along == 0.0) continue;
    const double at_low = (low[axis] - a[axis]) / along;
    const double at_high = (high[axis] - a[axis]) / along;
    enter = std::max(enter, std::min(at_low, at_high));
    leave = std::min(leave, std::max(at_low, at_high));
  }
  return enter <= leave;
}

/// The angle that the polygon turns around a point inside of it is a full circle, else nothing.
bool winds_around(const std::vector<Point2>& polygon, const Point2& point) {
  double turned = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 a = polygon[i] - point;
    const Point2 b = polygon[(i + 1) % polygon.size()] - point;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turned) > geometry::kPi;
}

bool touches(std::span<const Point2> polygon, const Pose2& pose, const grid::GridGeometry& geometry,
             grid::Cell cell) {
  std::vector<Point2> placed;
  for (const Point2& corner : polygon) placed.push_back(pose * corner);
  const Point2 center = geometry.center(cell);
  const Point2 low = center.array() - 0.5 * geometry.resolution;
  const Point2 high = center.array() + 0.5 * geometry.resolution;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (meets_square(placed[i], placed[(i + 1) % placed.size()], low, high)) return true;
  }
  return winds_around(placed, center);
}

TEST(PolygonRaster, GivesExactlyTheCellsThatThePolygonTouches) {
  Random random(7);
  for (int round = 0; round < 1500; ++round) {
    const grid::GridGeometry geometry{40, 36, 0.05, random.uniform(-2.0, 2.0),
                                      random.uniform(-2.0, 2.0)};
    const std::size_t corners = 3 + random.below(14);
    const auto polygon = star(random, corners, round % 2 == 0 ? 0.05 : 0.5);
    const Pose2 pose{geometry.origin_x + random.uniform(-0.5, 2.5),
                     geometry.origin_y + random.uniform(-0.5, 2.3), random.uniform(-4.0, 4.0)};
    const auto cells = raster(polygon, pose, geometry);
    for (int y = 0; y < geometry.height; ++y) {
      for (int x = 0; x < geometry.width; ++x) {
        ASSERT_EQ(cells.contains({x, y}), touches(polygon, pose, geometry, {x, y}))
            << "round " << round << " cell " << x << ", " << y;
      }
    }
  }
}

TEST(PolygonRaster, TakesCornersEitherWayRound) {
  Random random(8);
  std::vector<Point2> corners = star(random, 9, 0.1);
  const std::vector<Point2> one = corners;
  std::reverse(corners.begin(), corners.end());
  const grid::GridGeometry geometry{40, 40, 0.05, -1.0, -1.0};
  EXPECT_EQ(raster(one, {0.1, 0.2, 0.3}, geometry), raster(corners, {0.1, 0.2, 0.3}, geometry));
}

TEST(PolygonRaster, LeavesOutTheInsideOfAConcavity) {
  // A horseshoe open to +x around the origin.
  const std::vector<Point2> horseshoe{{0.5, 0.5},  {-0.5, 0.5},  {-0.5, -0.5}, {0.5, -0.5},
                                      {0.5, -0.3}, {-0.3, -0.3}, {-0.3, 0.3},  {0.5, 0.3}};
  grid::Grid<std::uint8_t> costs({40, 40, 0.05, -1.0, -1.0}, kFreeCost);
  costs.at(costs.geometry().cell_at(0.1, 0.0)) = kLethalCost;
  EXPECT_EQ(footprint_reading(costs, horseshoe, {0.01, 0.01, 0.0}).highest_cost, kFreeCost);
  EXPECT_EQ(footprint_reading(costs, horseshoe, {0.41, 0.01, 0.0}).highest_cost, kLethalCost);
}

TEST(FootprintReading, ReportsCostUnknownAndOutside) {
  grid::Grid<std::uint8_t> costs({40, 40, 0.05, 0.0, 0.0}, kFreeCost);
  const auto footprint = square(0.2);
  EXPECT_EQ(footprint_reading(costs, footprint, {1.0, 1.0, 0.3}),
            (FootprintReading{0, false, false}));
  costs.at(costs.geometry().cell_at(1.01, 1.01)) = 77;
  costs.at(costs.geometry().cell_at(1.07, 1.01)) = kUnknownCost;
  EXPECT_EQ(footprint_reading(costs, footprint, {1.0, 1.0, 0.3}),
            (FootprintReading{77, true, false}));
  EXPECT_EQ(footprint_reading(costs, footprint, {0.1, 1.0, 0.0}),
            (FootprintReading{0, false, true}));
  EXPECT_EQ(footprint_reading(costs, footprint, {1e9, -1e300, 0.0}),
            (FootprintReading{0, false, true}));
  EXPECT_EQ(footprint_reading(costs, footprint, {std::nan(""), 1.0, 0.0}),
            (FootprintReading{0, false, true}));
}

TEST(PolygonRaster, TheInnerCellsAreThoseWhoseCornersAreAllInside) {
  Random random(5);
  const grid::GridGeometry geometry{24, 20, 0.05, -0.6, -0.5};
  std::size_t inner = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto footprint =
        geometry::Footprint::rectangle(random.uniform(0.05, 0.9), random.uniform(0.05, 0.9));
    const Pose2 pose{random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), random.uniform(-4, 4)};
    grid::Grid<std::uint8_t> cells(geometry, 0);
    PolygonRaster(footprint.corners(), pose, geometry).for_each_inner_span([&](const CellSpan& s) {
      for (int x = s.x0; x < s.x1; ++x) ++cells.at({x, s.y});
    });
    for (int y = 0; y < geometry.height; ++y) {
      for (int x = 0; x < geometry.width; ++x) {
        int inside = 0;
        for (const int dx : {0, 1}) {
          for (const int dy : {0, 1}) {
            const Point2 corner(geometry.origin_x + (x + dx) * geometry.resolution,
                                geometry.origin_y + (y + dy) * geometry.resolution);
            inside += footprint.distance(geometry::inverse(pose) * corner) <= 0.0 ? 1 : 0;
          }
        }
        ASSERT_EQ(cells.at({x, y}), inside == 4 ? 1 : 0) << x << ' ' << y << " of polygon " << i;
        inner += inside == 4 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(inner, 10000U);
}

}  // namespace
}  // namespace usher::costmap
