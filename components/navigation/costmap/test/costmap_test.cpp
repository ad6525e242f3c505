#include "navigation/costmap/core/costmap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/costmap/test/footprint_reading.hpp"
#include "navigation/costmap/test/reference_costmap.hpp"

namespace usher::costmap {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<Point2> polygon(int corners, double radius) {
  std::vector<Point2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * geometry::kPi * i / corners;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

CostmapConfig rolling_config() {
  CostmapConfig config;
  config.window = {100, 100, 0.05, 0.0, 0.0};
  config.rolling = true;
  config.footprint = polygon(8, 0.25);
  return config;
}

CostmapConfig fixed_config() {
  CostmapConfig config = rolling_config();
  config.rolling = false;
  config.window.origin_x = -2.013;  // not on any raster
  config.window.origin_y = -1.377;
  return config;
}

ObstacleLayerConfig layer_config(const std::string& name) {
  ObstacleLayerConfig config;
  config.name = name;
  return config;
}

/// One beam from a sensor at `sensor` ahead to `range`.
void see(Costmap& costmap, Costmap::LayerId layer, const Pose2& sensor, float range) {
  static const std::vector<Point2> kAhead = {{1.0, 0.0}};
  const std::vector<float> ranges = {range};
  ASSERT_TRUE(costmap.observe(layer, {sensor, kAhead, ranges, 0.0}).ok());
}

class CostmapLaws : public testing::TestWithParam<int> {};

// A random robot in a random building with three scanners and whiskers: after every cycle the
// incremental costmap equals one that computes everything anew, and both equal the definition.
TEST_P(CostmapLaws, EveryCycleEqualsTheOneFromScratchAndTheDefinition) {
  const int variant = GetParam();
  Random random(static_cast<std::uint64_t>(variant) + 100);
  CostmapConfig config;
  config.rolling = variant % 2 == 0;
  config.window = {61 + 7 * variant, 52, 0.1, config.rolling ? 0.0 : -2.91,
                   config.rolling ? 0.0 : -2.63};
  config.footprint = polygon(variant % 3 == 0 ? 4 : 7, 0.35);
  config.inflation_radius = 0.7;
  config.cost_scaling = 4.0;
  config.unseen = static_cast<Inflation::Unseen>(variant % 3);
  config.social = {.radius = variant % 3 == 1 ? 0.0 : 1.0, .cost = 120};
  CostmapConfig portable = config;
  portable.simd = cpu::Simd::kPortable;
  Costmap incremental = Costmap::make(config).value();
  Costmap fresh = Costmap::make(portable).value();
  ReferenceCostmap reference(config);
  for (int i = 0; i < 4; ++i) {
    ObstacleLayerConfig layer = layer_config("layer " + std::to_string(i));
    layer.max_obstacle_range = 2.5 + i;
    layer.max_raytrace_range = 3.0 + i;
    layer.min_raytrace_range = i == 1 ? 0.4 : 0.0;
    layer.persistence = i == 2 ? 0.5 : 0.0;
    layer.overrules_static_map = i != 2;
    layer.footprint_clearing = i != 3;
    layer.clears_only_what_all_beams_pass = i == 0;
    ASSERT_TRUE(incremental.add_obstacle_layer(layer).ok());
    ASSERT_TRUE(fresh.add_obstacle_layer(layer).ok());
    reference.add_obstacle_layer(layer);
  }
  const auto directions = beam_directions(-2.3, 4.6 / 90, 91);
  Pose2 base{0.3, -0.2, 0.0};
  Pose2 map_T_window;
  for (int cycle = 0; cycle < 1000; ++cycle) {
    if (cycle == 3 || random.below(200) == 0) {
      grid::OccupancyGrid map({110, 90, random.below(2) == 0 ? 0.05 : 0.1, random.uniform(-4, -2),
                               random.uniform(-4, -2)});
      for (std::int8_t& cell : map) {
        const auto draw = random.below(30);
        cell = draw == 0 ? grid::kOccupied : draw < 8 ? grid::kUnknown : grid::kFree;
      }
      ASSERT_TRUE(incremental.set_static_map(map).ok());
      ASSERT_TRUE(fresh.set_static_map(map).ok());
      reference.set_static_map(map);
    }
    if (random.below(10) == 0) {
      map_T_window = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5),
                      random.uniform(-0.3, 0.3)};
      ASSERT_TRUE(incremental.set_static_transform(map_T_window).ok());
      ASSERT_TRUE(fresh.set_static_transform(map_T_window).ok());
      reference.set_static_transform(map_T_window);
    }
    if (random.below(3) > 0) {
      base.x += 0.2 * random.gaussian();
      base.y += 0.2 * random.gaussian();
      base.yaw = random.uniform(-4, 4);
      if (random.below(150) == 0) base = {random.uniform(-9, 9), random.uniform(-9, 9), 0.0};
      ASSERT_TRUE(incremental.move_to(base).ok());
      ASSERT_TRUE(fresh.move_to(base).ok());
      reference.move_to(base);
    }
    const double now = 0.05 * cycle;
    for (std::size_t id = 0; id < 3; ++id) {
      if (random.below(2) == 0) continue;
      std::vector<float> ranges(directions.size());
      for (float& range : ranges) {
        const auto draw = random.below(20);
        range = draw == 0   ? kInfinity
                : draw == 1 ? std::numeric_limits<float>::quiet_NaN()
                            : static_cast<float>(random.uniform(0.05, 7.0));
      }
      const Pose2 sensor = base * Pose2{random.uniform(-0.3, 0.3), 0.0, random.uniform(-3, 3)};
      const RangeObservation scan{sensor, directions, ranges, now};
      ASSERT_TRUE(incremental.observe(id, scan).ok());
      ASSERT_TRUE(fresh.observe(id, scan).ok());
      reference.observe(id, scan);
    }
    if (random.below(4) == 0) {
      std::vector<Point2> corners;
      for (std::size_t i = random.below(5); i > 0; --i)
        corners.push_back(base * Point2{0.4, 0.2 * static_cast<double>(i)});
      ASSERT_TRUE(incremental.replace(3, corners, now).ok());
      ASSERT_TRUE(fresh.replace(3, corners, now).ok());
      reference.replace(3, corners, now);
    }
    if (variant % 3 != 1 && random.below(3) == 0) {
      std::vector<Point2> people;
      for (std::size_t i = random.below(4); i > 0; --i)
        people.push_back(base * Point2{random.uniform(-4, 4), random.uniform(-4, 4)});
      incremental.set_people(people);
      fresh.set_people(people);
      reference.set_people(people);
    }
    fresh.invalidate();
    const auto& master = incremental.update(now);
    ASSERT_EQ(master, fresh.update(now)) << "cycle " << cycle;
    const auto expected = reference.update(now);
    ASSERT_EQ(master.geometry(), expected.geometry());
    ASSERT_EQ(master.values(), expected.values()) << "cycle " << cycle;
  }
}

INSTANTIATE_TEST_SUITE_P(Windows, CostmapLaws, testing::Range(0, 6));

TEST(Costmap, WritesOnlyWhatItReportsAsChanged) {
  Costmap costmap = Costmap::make(fixed_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  costmap.update(0.0);
  EXPECT_EQ(costmap.changed(), (CellRect{0, 0, 100, 100}));
  costmap.update(0.0);
  EXPECT_TRUE(costmap.changed().empty());
  const auto before = costmap.costs();
  see(costmap, laser, {0.0, 0.0, 0.5}, 1.0F);
  const auto& after = costmap.update(0.1);
  const CellRect changed = costmap.changed();
  EXPECT_LT((changed.x1 - changed.x0) * (changed.y1 - changed.y0), 100 * 100);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const grid::Cell c = after.geometry().cell(i);
    const bool reported =
        c.x >= changed.x0 && c.x < changed.x1 && c.y >= changed.y0 && c.y < changed.y1;
    EXPECT_TRUE(reported || after[i] == before[i]) << i;
  }
  EXPECT_EQ(costmap.cost_at({std::cos(0.5), std::sin(0.5)}), kLethalCost);
}

TEST(Costmap, GivesPeopleRoomThatBarsNobody) {
  CostmapConfig config = fixed_config();
  config.social = {.radius = 1.2, .cost = 100};
  Costmap costmap = Costmap::make(config).value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point2> people{{0.025, 0.025}, {nan, 0.0}, {1e9, 0.0}};
  costmap.set_people(people);
  costmap.update(0.0);
  const auto cost = [&](double x) { return int{costmap.cost_at({x, 0.025}).value()}; };
  EXPECT_NEAR(cost(0.025), 100, 4);
  EXPECT_NEAR(cost(0.625), 50, 2);
  EXPECT_EQ(cost(1.275), kFreeCost);
  costmap.forget();
  costmap.update(0.1);
  EXPECT_NEAR(cost(0.025), 100, 4) << "a recovery forgets things, not people";
  costmap.set_people({});
  costmap.update(0.2);
  EXPECT_EQ(cost(0.025), kFreeCost);
  config.social.radius = 5.0;
  EXPECT_NE(Costmap::make(config).error().find("social radius must be in"), std::string::npos);
}

TEST(Costmap, MovesTheWindowWithTheRobot) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  ASSERT_TRUE(costmap.move_to({10.02, -3.97, 0.0}).ok());
  costmap.update(0.0);
  EXPECT_NEAR(costmap.costs().geometry().origin_x, 10.0 - 2.5, 1e-9);
  EXPECT_NEAR(costmap.costs().geometry().origin_y, -4.0 - 2.5, 1e-9);
  ASSERT_TRUE(costmap.move_to({10.04, -3.99, 0.0}).ok());
  costmap.update(0.1);
  EXPECT_TRUE(costmap.changed().empty()) << "the same cell";
}

// The thesis' table (5.2.2): the depth camera sees the top, the laser sees between the legs.
TEST(Costmap, KeepsTheTableThatTheLaserSeesThrough) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  const auto depth = costmap.add_obstacle_layer(layer_config("depth")).value();
  see(costmap, depth, {0.02, 0.02, 0.0}, 1.0F);
  for (int i = 0; i < 5; ++i) see(costmap, laser, {0.02, 0.02, 0.0}, 2.0F);
  costmap.update(0.0);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kLethalCost);
  EXPECT_EQ(costmap.cost_at({2.02, 0.02}), kLethalCost);
  see(costmap, depth, {0.02, 0.02, 0.0}, kInfinity);
  costmap.update(0.1);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kFreeCost) << "its own sensor clears it";
  EXPECT_EQ(costmap.cost_at({2.02, 0.02}), kLethalCost);
}

grid::OccupancyGrid map_with_wall_at(double x) {
  grid::OccupancyGrid map({200, 200, 0.05, -5.0, -5.0}, grid::kFree);
  for (int y = 0; y < 200; ++y) map.at({map.geometry().cell_at(x, 0.0).x, y}) = grid::kOccupied;
  return map;
}

TEST(Costmap, UsesTheStaticMapOnlyWhereNothingWasObserved) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  ASSERT_TRUE(costmap.set_static_map(map_with_wall_at(1.02)).ok());
  costmap.update(0.0);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kLethalCost);
  see(costmap, laser, {0.02, 0.02, 0.0}, 2.0F);
  costmap.update(0.1);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kInscribedCost)
      << "seen free; the wall beside it still counts";
  EXPECT_EQ(costmap.cost_at({1.02, 0.07}), kLethalCost);
  costmap.forget();
  costmap.update(0.2);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kLethalCost);
}

TEST(Costmap, ForgetsNothingThatNoSensorWouldSeeAgain) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  ObstacleLayerConfig config = layer_config("low");
  config.min_raytrace_range = 1.8;
  config.kept_range = std::numeric_limits<double>::infinity();
  const auto low = costmap.add_obstacle_layer(config).value();
  see(costmap, laser, {0.02, 0.02, 0.0}, 1.0F);
  see(costmap, low, {0.02, 0.02, 0.0}, 1.5F);
  costmap.forget();
  costmap.update(0.2);
  EXPECT_NE(costmap.cost_at({1.02, 0.02}), kLethalCost) << "the laser would see it again";
  EXPECT_EQ(costmap.cost_at({1.52, 0.02}), kLethalCost) << "the camera looks over it";
}

TEST(Costmap, ForgetsNothingThatIsTooNearToBeSeenAgain) {
  ObstacleLayerConfig config = layer_config("laser");
  config.kept_range = 0.6;
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(config).value();
  see(costmap, laser, {0.02, 0.02, 0.0}, 1.0F);
  ASSERT_TRUE(costmap.move_to({0.5, 0.02, 0.0}).ok());
  costmap.forget();
  costmap.update(0.2);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kLethalCost);
  ASSERT_TRUE(costmap.move_to({0.3, 0.02, 0.0}).ok());
  costmap.forget();
  costmap.update(0.3);
  EXPECT_NE(costmap.cost_at({1.02, 0.02}), kLethalCost) << "far enough away again";
}

TEST(Costmap, KeepsWhatIsBesideAThingThatTheMapHasNot) {
  for (const double wall :
       {1.02, 1.32, 4.02}) {  // what the laser sees is it, or is 0.3 m before it
    Costmap costmap = Costmap::make(rolling_config()).value();
    const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
    ObstacleLayerConfig config = layer_config("feet");
    config.persistence = wall > 4.0 ? 0.0 : 300.0;  // 0: for ever
    const auto feet = costmap.add_obstacle_layer(config).value();
    ASSERT_TRUE(costmap.set_static_map(map_with_wall_at(wall)).ok());
    costmap.update(0.0);
    see(costmap, laser, {0.02, 0.02, 0.0}, 1.0F);
    EXPECT_FALSE(costmap.unmapped_beside(laser, {0.62, 0.02}, 0.5)) << "one cell may be a rest";
    see(costmap, laser, {0.02, 0.07, 0.0}, 1.0F);
    const bool unmapped = wall != 1.02;
    EXPECT_EQ(costmap.unmapped_beside(laser, {0.62, 0.02}, 0.5), unmapped) << wall;
    EXPECT_FALSE(costmap.unmapped_beside(laser, {0.42, 0.02}, 0.5)) << "too far";
    EXPECT_FALSE(costmap.unmapped_beside(laser, {1e9, 0.0}, 0.5));
    see(costmap, feet, {0.02, 0.02, 0.0}, 0.6F);
    costmap.keep_beside(feet, laser, 0.5);
    costmap.update(0.1);
    EXPECT_EQ(costmap.cost_at({0.62, 0.02}) == kLethalCost, unmapped) << wall;
    see(costmap, feet, {0.02, 0.02, 0.0}, 0.6F);
    see(costmap, laser, {0.02, 0.02, 0.0}, 2.0F);  // it has gone
    costmap.keep_beside(feet, laser, 0.5);
    costmap.update(0.2);
    EXPECT_NE(costmap.cost_at({0.62, 0.02}), kLethalCost) << wall;
  }
}

TEST(Costmap, KeepsMappedGlassForALayerThatMayNotOverruleTheMap) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  ObstacleLayerConfig config = layer_config("laser");
  config.overrules_static_map = false;
  const auto laser = costmap.add_obstacle_layer(config).value();
  ASSERT_TRUE(costmap.set_static_map(map_with_wall_at(1.02)).ok());
  see(costmap, laser, {0.02, 0.02, 0.0}, 2.0F);
  costmap.update(0.1);
  EXPECT_EQ(costmap.cost_at({1.02, 0.02}), kLethalCost);
  EXPECT_EQ(costmap.cost_at({2.02, 0.02}), kLethalCost) << "what it sees still counts";
}

TEST(Costmap, WipesTheWhiskersWithEachMessage) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  ObstacleLayerConfig config = layer_config("whiskers");
  config.footprint_clearing = false;
  const auto whiskers = costmap.add_obstacle_layer(config).value();
  const Pose2 base{0.02, 0.02, 0.3};
  ASSERT_TRUE(costmap.move_to(base).ok());
  const std::vector<Point2> corner = {base * costmap.footprint().corners()[1]};
  ASSERT_TRUE(costmap.replace(whiskers, corner, 0.0).ok());
  costmap.update(0.0);
  EXPECT_EQ(costmap.cost_at(corner[0]), kLethalCost) << "although it lies on the footprint";
  ASSERT_TRUE(costmap.replace(whiskers, {}, 0.1).ok());
  costmap.update(0.1);
  EXPECT_EQ(costmap.cost_at(corner[0]), kFreeCost);
}

FootprintReading under_the_robot(const Costmap& costmap, const Pose2& base) {
  return footprint_reading(costmap.costs(), costmap.footprint().corners(), base);
}

TEST(Costmap, HasNoObstacleWhereTheRobotStands) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  see(costmap, laser, {0.02, 0.02, 0.0}, 1.0F);
  ASSERT_TRUE(costmap.move_to({1.02, 0.02, 0.0}).ok());
  costmap.update(0.0);
  EXPECT_EQ(under_the_robot(costmap, {1.02, 0.02, 0.0}),
            (FootprintReading{kFreeCost, false, false}));
}

// A post beside the robot does not vanish since the robot's outline is in a part of its cell.
TEST(Costmap, KeepsWhatTheRobotCoversAPartOf) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  see(costmap, laser, {0.02, 0.02, 0.0}, 1.0F);
  const double front = costmap.footprint().corners()[0].x();
  const Pose2 before{1.02 - front - 0.005, 0.02, 0.0};
  ASSERT_TRUE(costmap.move_to(before).ok());
  costmap.update(0.0);
  EXPECT_EQ(under_the_robot(costmap, before).highest_cost, kLethalCost);
}

TEST(Costmap, TakesTheUnknownForFreeOrNot) {
  for (const Inflation::Unseen unseen : {Inflation::Unseen::kFree, Inflation::Unseen::kUnknown}) {
    CostmapConfig config = rolling_config();
    config.unseen = unseen;
    Costmap costmap = Costmap::make(config).value();
    costmap.update(0.0);
    EXPECT_EQ(costmap.cost_at({0.0, 0.0}),
              unseen == Inflation::Unseen::kFree ? kFreeCost : kUnknownCost);
  }
}

TEST(Costmap, GoesOnWhenTheRobotLeavesTheMap) {
  Costmap costmap = Costmap::make(fixed_config()).value();
  const auto laser = costmap.add_obstacle_layer(layer_config("laser")).value();
  ASSERT_TRUE(costmap.move_to({50.0, 50.0, 1.0}).ok());
  see(costmap, laser, {50.0, 50.0, 1.0}, 2.0F);
  costmap.update(0.0);
  EXPECT_EQ(costmap.layer(laser).sensors_outside(), 1U);
  EXPECT_EQ(costmap.cost_at({50.0, 50.0}), std::nullopt);
  EXPECT_TRUE(under_the_robot(costmap, {50.0, 50.0, 1.0}).leaves_grid);
}

TEST(Costmap, RefusesAPoseThatIsNone) {
  Costmap costmap = Costmap::make(rolling_config()).value();
  ASSERT_TRUE(costmap.move_to({1.0, 2.0, 0.0}).ok());
  costmap.update(0.0);
  const auto before = costmap.costs();
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Pose2& pose :
       {Pose2{nan, 0, 0}, Pose2{0, infinity, 0}, Pose2{0, 0, nan}, Pose2{2e5, 0, 0}}) {
    EXPECT_FALSE(costmap.move_to(pose).ok());
    EXPECT_FALSE(costmap.set_static_transform(pose).ok());
  }
  EXPECT_EQ(costmap.update(0.1), before);
  EXPECT_EQ(costmap.cost_at({nan, 0.0}), std::nullopt);
  EXPECT_EQ(costmap.cost_at({1e300, 0.0}), std::nullopt);
}

TEST(Costmap, RefusesAConfigThatCannotBe) {
  const auto error_of = [](auto change) {
    CostmapConfig config = fixed_config();
    change(config);
    const Result<Costmap> made = Costmap::make(config);
    return made.ok() ? std::string() : made.error();
  };
  EXPECT_EQ(error_of([](auto&) {}), "");
  EXPECT_EQ(error_of([](auto& c) { c.window.resolution = 0.0; }),
            "costmap resolution must be in [0.001, 10] m, got 0.000000 m");
  EXPECT_NE(error_of([](auto& c) { c.window.width = 0; }), "");
  EXPECT_NE(error_of([](auto& c) { c.window.width = c.window.height = 1 << 20; }), "");
  EXPECT_NE(error_of([](auto& c) { c.window.origin_x = std::nan(""); }), "");
  EXPECT_NE(error_of([](auto& c) { c.inflation_radius = 0.1; }), "")
      << "less than the inscribed radius";
  EXPECT_NE(error_of([](auto& c) { c.inflation_radius = 100.0; }), "");
  EXPECT_NE(error_of([](auto& c) { c.cost_scaling = -1.0; }), "");
  EXPECT_NE(error_of([](auto& c) { c.occupied_from = 0; }), "");
  EXPECT_NE(error_of([](auto& c) { c.footprint.clear(); }), "");
}

}  // namespace
}  // namespace usher::costmap
