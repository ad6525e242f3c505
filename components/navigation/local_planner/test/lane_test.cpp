#include "navigation/local_planner/core/lane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::local_planner {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr double kHalf = 0.305, kGap = 0.1;  // [m]

/// A corridor along x, `width` [m] wide, with y = 0 in its middle.
grid::Grid<std::uint8_t> corridor(double width) {
  grid::Grid<std::uint8_t> costs({200, 60, 0.05, -2.0, -1.5}, 0);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (std::abs(costs.geometry().center(costs.geometry().cell(i)).y()) > 0.5 * width)
      costs[i] = grid::kLethalCost;
  }
  return costs;
}
ReferencePath middle() {
  ReferencePath path;
  const std::vector<Pose2> poses{{0, 0, 0}, {4, 0, 0}, {8, 0, 0}};
  EXPECT_TRUE(path.set(poses));
  path.advance({1.0, 0.0});
  return path;
}
MovingDisc walker(double x, double y, double vx) { return {{x, y}, {vx, 0.0}, 0.25}; }

TEST(Lane, KeepsAsideWhileSomebodyComesAsFarAsTheWallAllows) {
  const ReferencePath path = middle();
  for (const double width : {1.2, 1.4, 1.6, 2.5}) {
    Lane lane(kHalf, kGap);
    const std::vector discs{walker(4.0, 0.2, -0.8)};
    lane.choose(path, corridor(width), discs, 0.05);
    ASSERT_TRUE(lane.keeps_aside());
    const double room = 0.5 * width - kHalf - kGap;
    EXPECT_NEAR(lane.shift(2.0), std::min(room, 0.3), 0.03) << width;
    EXPECT_LT(lane.point(path, 2.0).y(), -0.1);
    EXPECT_EQ(lane.point(path, 2.0).x(), 2.0);
  }
}

TEST(Lane, KeepsLeftWhereThatIsTheCustom) {
  const ReferencePath path = middle();
  Lane lane(kHalf, kGap, -1.0);
  lane.choose(path, corridor(1.4), std::vector{walker(4.0, 0.2, -0.8)}, 0.05);
  EXPECT_NEAR(lane.point(path, 2.0).y(), 0.295, 0.03);
}

TEST(Lane, StaysInTheMiddleForNobodyAndForWhoWalksAheadOrElsewhere) {
  const ReferencePath path = middle();
  for (const MovingDisc& disc :
       {walker(4.0, 0.0, 0.8), walker(4.0, 0.0, 0.0), walker(-0.2, 0.0, -0.8),
        walker(7.5, 0.0, -0.8), walker(4.0, 1.4, -0.8)}) {
    Lane lane(kHalf, kGap);
    lane.choose(path, corridor(1.4), std::vector{disc}, 0.05);
    EXPECT_FALSE(lane.keeps_aside()) << disc.position.x() << " " << disc.velocity.x();
    EXPECT_EQ(lane.point(path, 2.0), Point2(2.0, 0.0));
  }
}

TEST(Lane, GoesBackToTheMiddleAWhileAfter) {
  const ReferencePath path = middle();
  Lane lane(kHalf, kGap);
  lane.choose(path, corridor(1.4), std::vector{walker(4.0, 0.0, -0.8)}, 0.05);
  lane.choose(path, corridor(1.4), {}, 1.0);
  EXPECT_TRUE(lane.keeps_aside());
  lane.choose(path, corridor(1.4), {}, 1.0);
  EXPECT_FALSE(lane.keeps_aside());
}

TEST(Lane, IsInTheMiddleOfDoorsAndAtTheGoal) {
  const ReferencePath path = middle();
  auto costs = corridor(1.6);
  for (const double y : {-0.45, 0.45})
    costs.at(costs.geometry().cell_at({4.0, y})) = grid::kLethalCost;
  Lane lane(kHalf, kGap);
  lane.choose(path, costs, std::vector{walker(5.0, 0.0, -0.8)}, 0.05);
  EXPECT_LT(lane.shift(4.0), 0.06);
  EXPECT_LT(lane.shift(3.5), 0.06);
  EXPECT_GT(lane.shift(2.0), 0.25);
  ReferencePath end = middle();
  end.advance({7.9, 0.0});
  lane.choose(end, corridor(1.6), std::vector{walker(9.0, 0.0, -0.8)}, 0.05);
  EXPECT_EQ(lane.shift(8.0), 0.0);
}

}  // namespace
}  // namespace usher::local_planner
