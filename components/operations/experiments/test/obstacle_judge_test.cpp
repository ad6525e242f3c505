#include "operations/experiments/obstacle_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace usher::operations {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr float kFree = std::numeric_limits<float>::infinity();

runtime::Time at(double seconds) { return runtime::Time(runtime::from_seconds(100.0 + seconds)); }

/// A robot of 0.6 x 0.6 m that drives along x toward a box at x = 3 m; odom is turned and shifted.
class ObstacleJudgeTest : public testing::Test {
 protected:
  static constexpr Pose2 kOdom{2.0, -1.0, 0.5};  // odom_T_world

  ObstacleJudge make() const {
    const std::vector<world::Thing> box{world::box("box", {3.1, 0.0, 0.0}, 0.2, 0.4, 0.0, 0.3)};
    return ObstacleJudge({.footprint = {{0.3, 0.3}, {-0.3, 0.3}, {-0.3, -0.3}, {0.3, -0.3}}},
                         objects_of(box), box, 2.7);
  }
  /// Drives at `v` to x with costs in which the marks [in world] are lethal.
  void step(ObstacleJudge& judge, double x, double v, const std::vector<Point2>& marks) {
    time_ += 0.1;
    const Pose2 base{x, 0.0, 0.0};
    judge.take_truth(at(time_), base, v, 0.05);
    judge.take_odometry(at(time_), kOdom * base);
    grid::Grid<std::uint8_t> costs({.width = 240,
                                    .height = 240,
                                    .resolution = 0.05,
                                    .origin_x = kOdom.x - 6.0,
                                    .origin_y = kOdom.y - 6.0});
    for (const Point2& mark : marks) costs.at(costs.geometry().cell_at(kOdom * mark)) = 254;
    judge.take_costs(at(time_), costs);
  }
  const std::vector<Point2> front_{{3.02, -0.2}, {3.02, -0.1}, {3.02, 0}, {3.02, 0.1}, {3.02, 0.2}};
  double time_ = 0.0;
};

TEST_F(ObstacleJudgeTest, IsContentWithWhatIsKnownInTime) {
  ObstacleJudge judge = make();
  step(judge, 0.5, 0.6, {});
  step(judge, 1.0, 0.6, front_);
  step(judge, 2.4, 0.6, front_);
  const auto& verdict = judge.verdicts().front();
  EXPECT_NEAR(verdict.first_seen, 1.7, 1e-6);
  EXPECT_NEAR(verdict.closest, 0.3, 1e-6);
  EXPECT_EQ(verdict.first_pitch, 0.05);
  EXPECT_EQ(verdict.too_late, 0.0);
  EXPECT_EQ(verdict.forgotten, 0.0);
  EXPECT_TRUE(verdict.in_time());
  EXPECT_EQ(judge.false_costmaps(), 0U);
}

TEST_F(ObstacleJudgeTest, CountsWhatIsKnownTooLateOrForgottenWithinTheStoppingDistance) {
  ObstacleJudge judge = make();
  step(judge, 1.7, 0.6, {});            // 1.0 m away: it still stops
  step(judge, 2.0, 0.6, {});            // 0.7 m away
  step(judge, 2.1, 0.3, {});            // 0.6 m away, slower: it still stops
  step(judge, 2.2, 0.6, {{3.3, 0.0}});  // behind it is not its near side
  step(judge, 2.3, 0.6, front_);
  step(judge, 2.4, 0.6, {});
  const auto& verdict = judge.verdicts().front();
  EXPECT_NEAR(verdict.too_late, 0.2, 1e-6);
  EXPECT_NEAR(verdict.forgotten, 0.1, 1e-6);
  EXPECT_NEAR(verdict.first_seen, 0.4, 1e-6);
  EXPECT_FALSE(verdict.in_time());
}

TEST_F(ObstacleJudgeTest, WhatWasNeverSeenIsInTimeOnlyWhereTheRobotNeverGotNear) {
  ObstacleJudge judge = make();
  EXPECT_FALSE(judge.verdicts().front().in_time()) << "nobody looked";
  step(judge, 0.5, 0.6, {});
  EXPECT_TRUE(judge.verdicts().front().in_time());
  step(judge, 2.4, 0.0, {});
  EXPECT_TRUE(judge.verdicts().front().in_time()) << "it stands before it";
  step(judge, 2.68, 0.04, {});
  const auto& verdict = judge.verdicts().front();
  EXPECT_FALSE(verdict.seen());
  EXPECT_EQ(verdict.too_late, 0.0);
  EXPECT_FALSE(verdict.in_time()) << "it creeps up to it";
}

TEST_F(ObstacleJudgeTest, ForgivesWhatLiesBehindAndWhoStands) {
  ObstacleJudge judge = make();
  step(judge, 2.4, 0.0, {});
  step(judge, 4.0, 0.6, {});
  EXPECT_EQ(judge.verdicts().front().too_late, 0.0);
}

TEST_F(ObstacleJudgeTest, FindsCellsAndBearingsWhereNothingIs) {
  ObstacleJudge judge = make();
  step(judge, 0.5, 0.6, {{3.02, 0.0}, {3.6, 0.0}, {1.5, 1.0}});  // what it hides is no ghost
  step(judge, 0.6, 0.6, front_);
  EXPECT_EQ(judge.costmaps(), 2U);
  EXPECT_EQ(judge.false_costmaps(), 1U);
  EXPECT_EQ(judge.false_cells(), 1U);
  // Seen from x = 1.1 m: the box, the floor in the middle, something too far to count, nothing.
  judge.take_scan({at(time_ + 0.1), 0.2, -0.05, 0.05, {1.0F, 1.9F, 4.5F, kFree}});
  EXPECT_EQ(judge.scans(), 0U) << "its truth has not come";
  step(judge, 0.9, 0.6, {});
  EXPECT_EQ(judge.scans(), 1U);
  EXPECT_EQ(judge.false_scans(), 1U);
  EXPECT_NEAR(judge.false_share(), 0.25, 1e-9);
}

TEST(ObjectsOf, PutsThePartsOfAThingTogether) {
  const auto objects = objects_of({world::disc("chair", {0, 0}, 0.2, 0.4, 0.5),
                                   world::disc("chair foot", {0, 0}, 0.3, 0.0, 0.1),
                                   world::disc("bin", {1, 0}, 0.2, 0.0, 0.7)});
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].name, "chair");
  EXPECT_EQ(objects[0].parts.size(), 2U);
  EXPECT_EQ(objects[1].name, "bin");
}

}  // namespace
}  // namespace usher::operations
