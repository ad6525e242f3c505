#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "localization/amcl/core/amcl.hpp"
#include "localization/amcl/test/sim_robot.hpp"

namespace usher::amcl {
namespace {

using geometry::Pose2;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix3d spread(double position, double yaw) {
  return Eigen::Vector3d(position * position, position * position, yaw * yaw).asDiagonal();
}

double error(const Amcl& amcl, const SimRobot& robot) {
  return distance(amcl.estimate()->map_T_odom() * robot.odometry(), robot.pose());
}

/// A robot in the small building with its filter.
struct World {
  explicit World(std::uint64_t seed, const AmclConfig& config = {},
                 const SimRobot::Errors& errors = {})
      : World(small_building(), seed, config, errors) {}
  World(const grid::OccupancyGrid& building, std::uint64_t seed, const AmclConfig& config,
        const SimRobot::Errors& errors = {})
      : random(seed),
        robot(building, SimRobot::free_place(building, random), seed, errors),
        amcl(config, seed),
        map(building) {
    EXPECT_TRUE(amcl.set_map(map).ok());
  }
  void start_near() { EXPECT_TRUE(amcl.set_initial_pose(robot.pose(), spread(0.5, 0.25)).ok()); }
  UpdateResult step() {
    robot.step();
    return amcl.update(robot.odometry(), robot.scan());
  }

  Random random;
  SimRobot robot;
  Amcl amcl;
  grid::OccupancyGrid map;
};

TEST(Amcl, TracksWithinTwoCentimetres) {
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    World world(seed);
    world.start_near();
    for (int i = 0; i < 300; ++i) {
      world.step();
      if (i < 20) continue;
      sum += error(world.amcl, world.robot);
      ++count;
      ASSERT_LT(error(world.amcl, world.robot), 0.1) << "seed " << seed << " step " << i;
      ASSERT_EQ(world.amcl.estimate()->quality.confidence, Confidence::kGood);
    }
  }
  EXPECT_LT(sum / count, 0.012);
}

TEST(Amcl, TracksWithTheBeamModel) {
  AmclConfig config;
  config.sensor_model = SensorModel::kBeam;
  config.max_particles = 500;
  World world(3, config);
  world.start_near();
  for (int i = 0; i < 60; ++i) world.step();
  EXPECT_LT(error(world.amcl, world.robot), 0.05);
}

TEST(Amcl, TracksThroughACrowd) {
  World world(4);
  world.start_near();
  for (int i = 0; i < 40; ++i) world.step();
  for (int i = 0; i < 80; ++i) {  // people stand in a third of the view and walk along
    world.robot.step();
    auto scan = world.robot.scan();
    for (std::size_t k = 0; k < 60; ++k) {
      float& range = world.robot.ranges()[(k + static_cast<std::size_t>(i)) % 181];
      range = std::min(range, 0.8F + 0.01F * static_cast<float>(k % 17));
    }
    world.amcl.update(world.robot.odometry(), scan);
    ASSERT_LT(error(world.amcl, world.robot), 0.1) << i;
    ASSERT_NE(world.amcl.estimate()->quality.confidence, Confidence::kLost) << i;
  }
}

TEST(Amcl, TurnsBeforeSomebodyWhoFillsItsView) {
  AmclConfig config;
  config.sensor.max_range = 3.95;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    World world(seed, config);
    world.robot.kidnap({6.5, 1.0, 0.6 * static_cast<double>(seed)});  // in the middle of a room
    ASSERT_TRUE(world.amcl.set_initial_pose(world.robot.pose(), spread(0.05, 0.05)).ok());
    for (int i = 0; i < 20; ++i) {
      world.robot.move({0.0, 0.0, 0.11});
      world.amcl.update(world.robot.odometry(), world.robot.scan());
    }
    for (int i = 0; i < 24; ++i) {  // to and fro; somebody stays where the robot looks
      world.robot.move({0.0, 0.0, i % 12 < 6 ? 0.11 : -0.11});
      const auto scan = world.robot.scan();
      std::fill_n(world.robot.ranges().begin() + 30, 121, 0.4F);
      world.amcl.update(world.robot.odometry(), scan);
      ASSERT_LT(error(world.amcl, world.robot), 0.25) << "seed " << seed << " step " << i;
      ASSERT_NE(world.amcl.estimate()->quality.confidence, Confidence::kLost);
    }
  }
}

TEST(Amcl, SurvivesOdometryThatCountsBackwardsAsForwards) {
  World world(5);
  const Pose2 start{-1.5, 2.9, 0.0};
  world.robot.kidnap(start);
  ASSERT_TRUE(world.amcl.set_initial_pose(start, spread(0.1, 0.05)).ok());
  Pose2 odometry;
  for (int i = 0; i < 60; ++i) {
    const bool backwards = i >= 30 && i < 50;
    world.robot.move({backwards ? -0.1 : 0.1, 0.0, 0.0});
    odometry = odometry * Pose2{0.1, 0.0, 0.0};
    world.amcl.update(odometry, world.robot.scan());
  }
  EXPECT_LT(distance(world.amcl.estimate()->map_T_odom() * odometry, world.robot.pose()), 0.1);
}

TEST(Amcl, FindsItselfAnywhere) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World world(seed);
    world.amcl.start_globally();
    EXPECT_FALSE(world.amcl.estimate());
    for (int i = 0; i < 250; ++i) {
      world.step();
      if (i < 8) {
        EXPECT_NE(world.amcl.estimate()->quality.confidence, Confidence::kGood)
            << "too early to be sure";
      }
    }
    found += error(world.amcl, world.robot) < 0.1;
  }
  EXPECT_GE(found, 5);
}

TEST(Amcl, RecoversFromBeingCarriedAway) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 18; ++seed) {
    World world(seed);
    world.start_near();
    for (int i = 0; i < 50; ++i) world.step();
    world.robot.kidnap(SimRobot::free_place(world.map, world.random));
    for (int i = 0; i < 300; ++i) world.step();
    found += error(world.amcl, world.robot) < 0.1;
  }
  EXPECT_GE(found, 16);
}

TEST(Amcl, LooksOnWhileItIsLostAndStands) {
  int lost = 0;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    World world(seed);
    world.start_near();
    for (int i = 0; i < 50; ++i) world.step();
    world.robot.kidnap(world.robot.pose() * geometry::Pose2{0.3, 0.2, 0.8});
    world.robot.move({0.0, 0.0, 0.2});
    world.amcl.update(world.robot.odometry(), world.robot.scan());
    if (world.amcl.estimate()->quality.confidence != Confidence::kLost) continue;
    ++lost;
    for (int i = 0; i < 1000; ++i) world.amcl.update(world.robot.odometry(), world.robot.scan());
    found += error(world.amcl, world.robot) < 0.1;
  }
  EXPECT_GE(lost, 5);
  EXPECT_GE(found, lost * 3 / 4);
}

TEST(Amcl, LearnsThatItsRangeFinderReadsShort) {
  for (const double offset : {-0.03, 0.03}) {
    World world(1, {}, {.range_offset = offset});
    world.start_near();
    double sum = 0.0;
    for (int i = 0; i < 300; ++i) {
      world.step();
      if (i >= 100) sum += error(world.amcl, world.robot) / 200.0;
    }
    EXPECT_LT(sum, 0.012) << offset;
  }
}

TEST(Amcl, StaysUnsureAlongAFeaturelessCorridor) {
  grid::OccupancyGrid map({2400, 60, 0.05, -60.0, -1.5}, grid::kUnknown);
  for (int x = 0; x < 2400; ++x) {
    for (int y = 11; y < 50; ++y) map.at({x, y}) = grid::kFree;
    map.at({x, 10}) = map.at({x, 50}) = grid::kOccupied;
  }
  AmclConfig config;
  config.sensor.max_range = 10.0;
  Amcl amcl(config, 1);
  ASSERT_TRUE(amcl.set_map(map).ok());
  SimRobot robot(map, {-10.0, 0.0, 0.0}, 1);
  ASSERT_TRUE(
      amcl.set_initial_pose(robot.pose(), Eigen::Vector3d(4.0, 0.04, 0.01).asDiagonal()).ok());
  for (int i = 0; i < 100; ++i) {
    robot.move({0.1, 0.0, 0.0});
    amcl.update(robot.odometry(), robot.scan());
  }
  const Estimate& estimate = *amcl.estimate();
  EXPECT_GT(std::sqrt(estimate.covariance(0, 0)), 1.0) << "the initial 2 m are still open";
  EXPECT_LT(std::sqrt(estimate.covariance(1, 1)), 0.1);
  EXPECT_EQ(estimate.quality.confidence, Confidence::kDegraded);
}

TEST(Amcl, KnowsThatTwoEqualRoomsCannotBeToldApart) {
  grid::OccupancyGrid map({400, 120, 0.05, 0.0, 0.0}, grid::kUnknown);
  for (const int left : {20, 220}) {  // two closed rooms of 7 m x 4 m, the same furniture in both
    for (int y = 20; y <= 100; ++y) {
      for (int x = left; x <= left + 140; ++x) {
        const bool edge = x == left || x == left + 140 || y == 20 || y == 100;
        const bool shelf = x > left + 30 && x < left + 60 && y < 40;
        map.at({x, y}) = edge || shelf ? grid::kOccupied : grid::kFree;
      }
    }
  }
  AmclConfig config;
  Amcl amcl(config, 2);
  ASSERT_TRUE(amcl.set_map(map).ok());
  SimRobot robot(map, {4.0, 3.5, 0.3}, 2);
  amcl.start_globally();
  for (int i = 0; i < 6; ++i) {
    robot.step();
    amcl.update(robot.odometry(), robot.scan());
  }
  EXPECT_LT(amcl.estimate()->quality.cluster_weight, 0.95);
  EXPECT_EQ(amcl.estimate()->quality.confidence, Confidence::kDegraded);
}

TEST(Amcl, RepeatsItselfOnEveryInstructionSet) {
  std::vector<Pose2> first;
  for (const auto simd : {cpu::Simd::kPortable, cpu::best_simd(), cpu::best_simd()}) {
    Random random(7);
    const grid::OccupancyGrid map = small_building();
    SimRobot robot(map, SimRobot::free_place(map, random), 7);
    Amcl amcl({}, 7, simd);
    ASSERT_TRUE(amcl.set_map(map).ok());
    amcl.start_globally();
    std::vector<Pose2> poses;
    for (int i = 0; i < 40; ++i) {
      robot.step();
      amcl.update(robot.odometry(), robot.scan());
      poses.push_back(amcl.estimate()->map_T_base);
    }
    if (first.empty()) first = poses;
    EXPECT_EQ(first, poses);
  }
}

TEST(Amcl, WeightsAddUpToOneAndTheirNumberFollowsTheSpread) {
  World world(8);
  world.amcl.start_globally();
  world.step();
  const std::size_t spread_out = world.amcl.particles().size();
  for (int i = 0; i < 250; ++i) {
    world.step();
    double sum = 0.0;
    for (const double weight : world.amcl.particles().weight) sum += weight;
    ASSERT_NEAR(sum, 1.0, 1e-9);
  }
  EXPECT_GT(spread_out, 2000U);
  EXPECT_LT(world.amcl.particles().size(), 500U);
}

TEST(Amcl, UpdatesOnlyAfterATenthOfAMetreOrRadian) {
  World world(9);
  world.start_near();
  const auto update = [&] {
    return world.amcl.update(world.robot.odometry(), world.robot.scan()).outcome;
  };
  EXPECT_EQ(update(), Outcome::kUpdated);  // the first after a start
  EXPECT_EQ(update(), Outcome::kNotMoved);
  world.robot.move({0.05, 0.0, 0.0});
  EXPECT_EQ(update(), Outcome::kNotMoved);
  world.robot.move({0.06, 0.0, 0.0});
  EXPECT_EQ(update(), Outcome::kUpdated);
  world.robot.move({0.0, 0.0, 0.12});
  EXPECT_EQ(update(), Outcome::kUpdated);
}

TEST(Amcl, ResamplesAtItsInterval) {
  AmclConfig config;
  config.resample_interval = 3;
  config.recovery_slow = 0.0;
  World world(10, config);
  world.start_near();
  std::vector<bool> resampled;
  for (int i = 0; i < 6; ++i) {
    world.robot.move({0.0, 0.0, 0.12});
    resampled.push_back(world.amcl.update(world.robot.odometry(), world.robot.scan()).resampled);
  }
  EXPECT_THAT(resampled, testing::ElementsAre(false, false, true, false, false, true));
}

TEST(Amcl, SaysWhatItMisses) {
  Amcl amcl({}, 1);
  const std::vector<float> ranges(10, 1.0F);
  const LaserBeams scan{{}, 0.0, 0.1, 0.0, 20.0, ranges};
  EXPECT_EQ(amcl.update({}, scan).outcome, Outcome::kNoMap);
  ASSERT_TRUE(amcl.set_map(small_building()).ok());
  EXPECT_EQ(amcl.update({}, scan).outcome, Outcome::kNoPose);
  EXPECT_FALSE(amcl.estimate());
  EXPECT_THAT(amcl.set_initial_pose({kNan, 0, 0}, spread(1, 1)).error(), HasSubstr("finite"));
  EXPECT_THAT(amcl.set_initial_pose({}, -spread(1, 1)).error(), HasSubstr("negative"));
  EXPECT_EQ(amcl.update({}, scan).outcome, Outcome::kNoPose);
}

TEST(Amcl, RefusesMapsThatTellNothing) {
  Amcl amcl({}, 1);
  EXPECT_THAT(amcl.set_map({}).error(), HasSubstr("free cells"));
  EXPECT_THAT(amcl.set_map(grid::OccupancyGrid({9, 9, 0.05, 0, 0}, grid::kFree)).error(),
              HasSubstr("occupied"));
  EXPECT_THAT(amcl.set_map(grid::OccupancyGrid({9, 9, 0.05, 0, 0}, grid::kOccupied)).error(),
              HasSubstr("free"));
}

TEST(Amcl, SurvivesBadScansAndOdometry) {
  World world(11);
  world.start_near();
  for (int i = 0; i < 20; ++i) world.step();
  const Pose2 before = world.amcl.estimate()->map_T_odom();
  const auto with = [&](const LaserBeams& scan) {
    world.robot.move({0.0, 0.0, 0.11});
    return world.amcl.update(world.robot.odometry(), scan);
  };
  const std::vector<float> none(181, std::numeric_limits<float>::quiet_NaN());
  auto result = with({{}, -1.5, 0.017, 0.05, 20.0, none});
  EXPECT_EQ(result.outcome, Outcome::kScanRejected);
  EXPECT_EQ(result.beams.not_finite, 181U);
  EXPECT_EQ(with({{}, -1.5, 0.017, 0.05, 20.0, {}}).outcome, Outcome::kScanRejected);
  const std::vector<float> good(181, 2.0F);
  EXPECT_EQ(with({{kNan, 0, 0}, -1.5, 0.017, 0.05, 20.0, good}).outcome, Outcome::kScanRejected);
  EXPECT_EQ(with({{}, kNan, 0.017, 0.05, 20.0, good}).outcome, Outcome::kScanRejected);
  EXPECT_EQ(with({{}, 0.0, 0.017, 0.05, kNan, good}).outcome, Outcome::kScanRejected);
  EXPECT_EQ(world.amcl.update({kNan, 0, 0}, world.robot.scan()).outcome,
            Outcome::kOdometryRejected);
  EXPECT_EQ(world.amcl.estimate()->map_T_odom(), before);
  for (int i = 0; i < 20; ++i) world.step();
  EXPECT_LT(error(world.amcl, world.robot), 0.1);
}

TEST(Amcl, TakesAJumpOfTheOdometryForItsRestart) {
  World world(12);
  world.start_near();
  for (int i = 0; i < 20; ++i) world.step();
  const Pose2 place = world.robot.pose();
  const auto result = world.amcl.update({100.0, 50.0, 2.0}, world.robot.scan());
  EXPECT_TRUE(result.odometry_restarted);
  EXPECT_EQ(result.outcome, Outcome::kUpdated);
  EXPECT_LT(distance(world.amcl.estimate()->map_T_base, place), 0.1);
}

/// A driver whose odometry begins anew at less than max_step looks as if the robot had moved. In
/// two of these places the scan fits another one as well.
TEST(Amcl, FindsBackStandingWhenTheOdometryBeganAnewNearby) {
  constexpr int kScans = 100, kWorlds = 10, kUnlike = 8;
  int right = 0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    World world(seed);
    world.start_near();
    for (int i = 0; i < 20; ++i) world.step();
    const Pose2 anew = world.robot.odometry() * Pose2{-1.2, 0.8, 0.5};
    for (int i = 0; i < kScans; ++i) world.amcl.update(anew, world.robot.scan());
    const Estimate& estimate = *world.amcl.estimate();
    EXPECT_EQ(estimate.quality.confidence, Confidence::kGood) << "seed " << seed;
    if (distance(estimate.map_T_base, world.robot.pose()) < 0.1) ++right;
  }
  EXPECT_GE(right, kUnlike);
}

TEST(Amcl, KnowsThatItIsLost) {
  World world(13);
  ASSERT_TRUE(world.amcl.set_initial_pose({1.0, 11.0, 1.0}, spread(0.1, 0.1)).ok());
  world.robot.kidnap({-2.0, 5.0, 0.0});
  world.robot.move({0.0, 0.0, 0.2});
  world.amcl.update(world.robot.odometry(), world.robot.scan());
  EXPECT_NE(world.amcl.estimate()->quality.confidence, Confidence::kGood);
  EXPECT_LT(world.amcl.estimate()->quality.explained, 0.75);
}

TEST(AmclConfig, NamesTheFirstValueOutOfRange) {
  EXPECT_TRUE(AmclConfig{}.validate().ok());
  AmclConfig config;
  config.sensor.sigma_hit = 5.0;
  EXPECT_THAT(config.validate().error(), HasSubstr("sigma_hit must be in [0.005, 1] m, got 5"));
  config = {};
  config.update_distance = kNan;
  EXPECT_THAT(config.validate().error(), HasSubstr("update_distance"));
  config = {};
  config.min_particles = 6000;
  EXPECT_THAT(config.validate().error(), HasSubstr("min_particles must be in [10, 5000]"));
}

}  // namespace
}  // namespace usher::amcl
