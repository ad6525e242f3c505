#include "navigation/local_planner/core/waypoint_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/random/random.hpp"

namespace usher::local_planner {
namespace {

using geometry::Point2;
using geometry::Pose2;
using geometry::Twist2;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kCycle = 0.05;  // [s]

kinematics::StoppingDistance pioneer_stopping() {
  const kinematics::StoppingPoint points[] = {{0.4, 0.24}, {0.7, 0.59}, {1.0, 1.09}};
  return *kinematics::StoppingDistance::make(points);
}

/// The Pioneer of the meeting report.
WaypointFollowerConfig pioneer() {
  WaypointFollowerConfig c;
  c.motion.footprint = Footprint::rectangle(0.456, 0.382);
  c.motion.stopping = pioneer_stopping();
  c.motion.pace = 0.7;
  c.motion.limits = {.acceleration = 0.5, .deceleration = 0.6, .angular_acceleration = 1.5};
  c.motion.response = {.latency = 0.05, .time_constant = 0.12, .turn_time_constant = 0.12};
  return c;
}

/// A base that follows its command as a first-order lag, on a floor with round posts.
class Drive : public testing::Test {
 protected:
  void SetUp() override { make(pioneer()); }
  void make(const WaypointFollowerConfig& config) {
    follower.emplace(std::move(WaypointFollower::make(config)).value());
  }
  double range(double bearing) const {
    double nearest = kInf;
    for (const Point2& post : posts) {
      const Point2 in_robot = geometry::inverse(pose) * post;
      const double along = in_robot.x() * std::cos(bearing) + in_robot.y() * std::sin(bearing);
      const double beside = in_robot.y() * std::cos(bearing) - in_robot.x() * std::sin(bearing);
      if (along > 0.0 && std::abs(beside) < 0.25)
        nearest = std::min(nearest, along - std::sqrt(0.0625 - beside * beside));
    }
    return nearest;
  }
  void scan() {
    std::vector<float> ranges;
    for (int i = 0; i <= 240; ++i) ranges.push_back(static_cast<float>(range(-2.1 + 0.0175 * i)));
    follower->sectors().take(ranges, -2.1, 0.0175, {});
  }
  Decision decide() {
    costs.set_origin(pose.x - 2.0, pose.y - 2.0);
    scan();
    return follower->decide(costs, pose, measured, command, kCycle);
  }
  /// Until the goal is reached, or so many seconds; the greatest distance from the polyline.
  Decision drive(double seconds) {
    Decision decision;
    for (double t = 0.0; t < seconds; t += kCycle) {
      decision = decide();
      EXPECT_TRUE(decision.command.finite());
      command = decision.command;
      const double share = kCycle / 0.12;
      measured = {measured.v + share * (command.v - measured.v),
                  measured.w + share * (command.w - measured.w)};
      pose = geometry::integrate(pose, measured, kCycle);
      trace.push_back(pose);
      if (decision.reached) break;
    }
    return decision;
  }

  std::optional<WaypointFollower> follower;
  grid::Grid<std::uint8_t> costs{{80, 80, 0.05, -2.0, -2.0}, 0};
  Pose2 pose;
  Twist2 measured, command;
  std::vector<Point2> posts;
  std::vector<Pose2> trace;
};

std::vector<Pose2> straight(double length) {
  std::vector<Pose2> path;
  for (double x = 0.0; x <= length; x += 0.05) path.push_back({x, 0.0, 0.0});
  return path;
}

TEST_F(Drive, ArrivesStraightAhead) {
  ASSERT_TRUE(follower->set_path(straight(5.0)));
  const Decision last = drive(30.0);
  EXPECT_TRUE(last.reached);
  EXPECT_NEAR(pose.x, 5.0, 0.2);
  for (const Pose2& p : trace) EXPECT_NEAR(p.y, 0.0, 0.01);
}

TEST_F(Drive, TurnsToTheWaypointBeforeItDrives) {
  pose.yaw = 2.0;
  ASSERT_TRUE(follower->set_path(straight(3.0)));
  while (std::abs(pose.yaw) > 0.16) {
    drive(kCycle);
    ASSERT_LT((pose.position() - Point2(0, 0)).norm(), 0.01);
    ASSERT_LT(trace.size(), 400U);
    EXPECT_LE(command.w, 0.0);
  }
  drive(2.0);
  EXPECT_GT(pose.x, 0.4);
}

TEST_F(Drive, DrivesStraightWithinTheToleranceAndInACurveBeyond) {
  ASSERT_TRUE(follower->set_path(straight(10.0)));
  pose.yaw = 0.14;
  EXPECT_EQ(decide().target.w, 0.0);
  ASSERT_GT(decide().target.v, 0.0);
  pose = {3.0, 0.0, 0.3};
  const Decision curve = decide();
  EXPECT_LT(curve.target.w, -0.1);
  EXPECT_GT(curve.target.v, 0.3) << "it does not stop to adjust";
  pose = {3.0, 0.0, 1.2};
  EXPECT_EQ(decide().target.v, 0.0) << "but so far off it does";
}

TEST_F(Drive, PassesItsWaypointsInOrder) {
  const std::vector<Pose2> path{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 4, 3.0}};
  ASSERT_TRUE(follower->set_path(path));
  const Decision last = drive(90.0);
  ASSERT_TRUE(last.reached);
  EXPECT_NEAR(pose.x, 0.0, 0.2);
  EXPECT_NEAR(pose.y, 4.0, 0.2);
  EXPECT_NEAR(geometry::shortest_turn(pose.yaw, 3.0), 0.0, 0.15) << "and has the goal's yaw";
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const bool passed = std::any_of(trace.begin(), trace.end(), [&](const Pose2& p) {
      return geometry::distance(p, path[i]) < 0.25;
    });
    EXPECT_TRUE(passed) << i;
  }
  for (const Pose2& p : trace) {
    double beside = kInf;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Point2 a = path[i - 1].position(), way = path[i].position() - a;
      const double share = std::clamp((p.position() - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      beside = std::min(beside, (a + share * way - p.position()).norm());
    }
    EXPECT_LT(beside, 0.25);
  }
}

TEST_F(Drive, StandsBeforeAnObstacleAndGoesOnWhenItIsGone) {
  ASSERT_TRUE(follower->set_path(straight(6.0)));
  posts.push_back({3.0, 0.05});
  const Decision last = drive(20.0);
  EXPECT_EQ(last.reason, Reason::kBlocked);
  EXPECT_TRUE(last.blocked);
  EXPECT_EQ(command.v, 0.0);
  EXPECT_LT(pose.x, 3.0 - 0.25 - 0.228);
  EXPECT_GT(pose.x, 1.6);
  posts.clear();
  EXPECT_TRUE(drive(30.0).reached);
}

TEST_F(Drive, NeitherSingleEchoesNorPostsBesideItsSectorsStopIt) {
  ASSERT_TRUE(follower->set_path(straight(6.0)));
  posts = {{3.0, 1.2}, {3.0, -1.2}};
  EXPECT_TRUE(drive(30.0).reached);
  std::vector<float> noisy(241, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < noisy.size(); i += 3) noisy[i] = 0.1F;
  follower->sectors().take(noisy, -2.1, 0.0175, {});
  EXPECT_GT(follower->sectors().nearest(), 10.0);
}

TEST_F(Drive, DoesNotTurnWhereItsOutlineHasNoRoom) {
  pose.yaw = 1.5;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const Point2 at = costs.geometry().center({x, y});
      if (std::abs(at.x()) > 0.22) costs.at({x, y}) = grid::kLethalCost;
    }
  }
  ASSERT_TRUE(follower->set_path(straight(3.0)));
  const Decision decision = decide();
  EXPECT_EQ(decision.reason, Reason::kBlocked);
  EXPECT_EQ(decision.command.w, 0.0);
}

TEST_F(Drive, StandsWithoutAPathAndOnWhatIsNoNumber) {
  EXPECT_EQ(decide().reason, Reason::kNoPath);
  ASSERT_TRUE(follower->set_path(straight(3.0)));
  EXPECT_EQ(decide().reason, Reason::kFollowing);
  for (const Pose2& none : {Pose2{kNan, 0, 0}, Pose2{1e9, 0, 0}, Pose2{5, 0, 0}}) {
    const Decision decision = follower->decide(costs, none, {}, {0.5, 0.0}, kCycle);
    EXPECT_EQ(decision.reason, Reason::kInvalidInput);
    EXPECT_EQ(decision.command, Twist2{});
  }
  EXPECT_EQ(follower->decide(costs, {}, {kNan, 0}, {}, kCycle).reason, Reason::kInvalidInput);
  EXPECT_FALSE(follower->set_path({}));
  EXPECT_FALSE(follower->set_pace(kNan));
}

TEST(SectorMedians, SplitTheAngleAheadFromRightToLeft) {
  SectorMedians sectors(geometry::kPi / 2.0, 10);
  EXPECT_EQ(sectors.nearest(), 0.0) << "nothing is known yet";
  std::vector<float> ranges(901);
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = i < 450 ? 2.0F : 3.0F;
  sectors.take(ranges, -1.5708, 3.1416 / 900, {});
  ASSERT_EQ(sectors.medians().size(), 10U);
  EXPECT_NEAR(sectors.bearing(0), -0.7069, 1e-3);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(sectors.medians()[i], i < 5 ? 2.0 : 3.0, 1e-6);
}

TEST(SectorMedians, MeasureFromTheRobotsMiddle) {
  SectorMedians sectors(geometry::kPi / 2.0, 3);
  const std::vector<float> ranges(301, 1.0F);
  sectors.take(ranges, -1.5, 0.01, {0.15, 0.0, 0.0});
  EXPECT_NEAR(sectors.medians()[1], 1.15, 0.01);
}

TEST(SectorMedians, AreBlindWithoutReadings) {
  SectorMedians sectors(geometry::kPi / 2.0, 10);
  const std::vector<float> none(301, std::numeric_limits<float>::quiet_NaN());
  sectors.take(none, -1.5, 0.01, {});
  EXPECT_EQ(sectors.nearest(), 0.0);
  const std::vector<float> free(301, std::numeric_limits<float>::infinity());
  sectors.take(free, -1.5, 0.01, {});
  EXPECT_EQ(sectors.nearest(), kInf);
  sectors.take({}, -1.5, 0.01, {});
  EXPECT_EQ(sectors.nearest(), 0.0);
}

TEST(Corners, AreTheFewestWithinTheTolerance) {
  std::vector<Pose2> path = straight(2.0);
  const double end = path.back().x;
  for (double y = 0.05; y <= 1.0; y += 0.05) path.push_back({end, y, 0.0});
  const auto found = corners(path, 0.05);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR((found[1] - Point2(end, 0.0)).norm(), 0.0, 0.06);
  EXPECT_TRUE(corners({}, 0.05).empty());
  EXPECT_EQ(corners(std::vector<Pose2>{{1, 2, 0}}, 0.05).size(), 1U);
  // A circle: no point farther from the corners' polyline than the tolerance.
  path.clear();
  for (int i = 0; i < 200; ++i) path.push_back({std::cos(0.02 * i), std::sin(0.02 * i), 0.0});
  const auto around = corners(path, 0.05);
  EXPECT_GT(around.size(), 5U);
  EXPECT_LT(around.size(), 12U);
}

TEST(WaypointFollowers, NameWhatIsOutOfRange) {
  auto config = pioneer();
  config.waypoint_radius = 0.0;
  auto made = WaypointFollower::make(config);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), "waypoint_radius must be in [0.05, 1] m, got 0");
  config = pioneer();
  config.sectors = 0;
  EXPECT_FALSE(WaypointFollower::make(config));
  config = pioneer();
  config.motion.pace = kNan;
  EXPECT_FALSE(WaypointFollower::make(config));
}

}  // namespace
}  // namespace usher::local_planner
