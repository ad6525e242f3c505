// A local planner that has gone wrong, in lock-step: whatever it should do, it tells the robot to
// drive full speed ahead.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "foundation/grid/costs.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

struct Way {
  const char* name;
  const char* manifest;
  const char* place;
  const char* goal;
  double v;           ///< [m/s] that the planner wants
  const char* thing;  ///< in a hall of its own instead of the site, where not null
  double ahead;       ///< [m] from the place to the obstacle
  bool glass;         ///< not even a beam at a right angle sees it; whiskers feel this one only
};

constexpr double kLaserX = 0.28;  // [m] of MARVIN's laser ahead of the axle
constexpr double kPaneX = 4.5;    // [m] of the pane across the glass corridor, up to y = 1.2 m
constexpr const char* kHall = R"(name: hall
ceiling: 2.7
rooms:
  - {name: hall, title: Hall, area: [0.0, 0.0, 12.0, 6.0]}
walls:
  - {name: around, thickness: 0.2, points: [[-0.1, -0.1], [12.1, -0.1], [12.1, 6.1], [-0.1, 6.1], [-0.1, -0.1]]}
obstacles:
  - )";
constexpr const char* kLowBox = "{name: box, box: [6.0, 3.0, 0.0, 0.4, 0.8], height: [0.0, 0.2]}";
constexpr const char* kBench =
    "{name: bench, box: [6.0, 3.0, 0.0, 0.4, 1.6], height: [0.46, 0.56]}";
constexpr const char* kBelt = "{name: belt, box: [6.0, 3.0, 0.0, 0.1, 1.6], height: [0.8, 0.9]}";

// What the laser sees; what only the ultrasonic sensors hear; what only the depth camera sees, low,
// over the laser, of a barrier, all of which leave its image while the robot rolls up to them.
const Way kWays[] = {
    {"Wall", "marvin-sim.yaml", "[4.5, 7.0, 1.5708]", "library", 1.4, nullptr, 3.7, false},
    {"Glass", "glass-corridor.yaml", "[1.0, 0.6, 0.0]", "goal", 1.0, nullptr, 3.49, true},
    {"LowBox", "obstacle-course.yaml", "[1.0, 3.0, 0.0]", "goal", 1.0, kLowBox, 4.8, false},
    {"Belt", "obstacle-course.yaml", "[1.0, 3.0, 0.0]", "goal", 1.0, kBelt, 4.95, false},
    {"Bench", "obstacle-course.yaml", "[1.0, 3.0, 0.0]", "goal", 1.0, kBench, 4.8, false},
    {"SlowlyABelt", "obstacle-course.yaml", "[3.0, 3.0, 0.0]", "goal", 0.3, kBelt, 2.95, false},
};

// 0.07 m before the ultrasonic sensors, which tell of 0.15 m then; the planner stands.
const Way kNearGlass = {
    "NearGlass", "glass-corridor.yaml", "[4.14, 0.6, 0.0]", "goal", 0.0, nullptr, 0.1, true};

struct Outcome {
  RunRecord::Summary summary;
  double way = 0.0, fastest = 0.0, speed = 0.0;  ///< [m], [m/s], the latter at the end
  bool held = false;                             ///< by the guard, while it was fast
  double stood = 0.0;                            ///< [s] at the end
  bool barred = false;                           ///< by the local costs, at the end
};

/// Something lethal is before the middle of the robot's front, within 0.4 m.
bool barred(const usher_msgs::msg::Costmap& message, const geometry::Pose2& odom_T_base) {
  const auto costs = wire::from_message(message);
  if (!costs) return false;
  constexpr double kStep = 0.025;  // [m]
  for (int i = 0; i < 16; ++i) {
    for (int k = -4; k <= 4; ++k) {
      const geometry::Point2 place(0.3 + i * kStep, k * kStep);
      const grid::Cell cell = costs->geometry().cell_at(odom_T_base * place);
      if (costs->value_or(cell, 0) == grid::kLethalCost) return true;
    }
  }
  return false;
}

Outcome drive_blindly(const Way& way, bool guard) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  auto deployment = load_deployment(share + "/deploy/" + way.manifest, installation,
                                    {{"movement_control", "guard", guard ? "true" : "false"}});
  EXPECT_TRUE(deployment.ok()) << deployment.error();
  set_site_value(*deployment, "site.initial_pose", way.place);
  const test::Folder folder;
  if (way.thing != nullptr)
    set_site_value(*deployment, "site.world",
                   folder.file("world.yaml", std::string(kHall) + way.thing + "\n"));
  Outcome outcome;
  geometry::Pose2 odom_T_base;
  const auto robot = lockstep_robot(*deployment, 1, [&](LockstepRun& run) {
    auto& world = run.world();
    world.tamper(topics::kCmdVelNavigation, [&](const auto&, auto& wanted) {
      wanted.twist().linear().x(way.v);
      wanted.twist().angular().z(0.0);
      return true;
    });
    world.tamper(topics::kWhiskers, [&](const auto&, auto& whiskers) {
      if (!way.glass) whiskers.front_left(false), whiskers.front_right(false);
      return true;
    });
    world.tamper(topics::kScanFiltered, [&, judge = &run](const auto&, auto& scan) {
      const auto truth = judge->record().truth();
      if (!way.glass || !truth) return true;
      for (std::size_t i = 0; i < scan.ranges().size(); ++i) {
        const double angle = scan.angle_min() + scan.angle_increment() * static_cast<double>(i);
        const double range = scan.ranges()[i];
        const geometry::Point2 end =
            *truth * geometry::Point2(kLaserX + range * std::cos(angle), range * std::sin(angle));
        if (std::abs(end.x() - kPaneX) < 0.15 && end.y() > 0.1 && end.y() < 1.3)
          scan.ranges()[i] = std::numeric_limits<float>::infinity();
      }
      return true;
    });
    world.observe(topics::kMovementStatus, [&](const auto& status, const auto&) {
      outcome.held =
          outcome.held || (status.limit_reason() == "something is in the way" &&
                           static_cast<double>(status.velocity_measured_linear()) > 0.5 * way.v);
    });
    world.observe(topics::kOdom, [&](const auto& odom, const auto&) {
      if (const auto pose = wire::to_planar(odom.pose().pose())) odom_T_base = *pose;
    });
    world.observe(topics::kLocalCosts, [&](const auto& costs, const auto&) {
      outcome.barred = barred(costs, odom_T_base);
    });
  });
  EXPECT_TRUE(robot.ok()) << robot.error();
  const auto arrival = (*robot)->send(way.goal, 30.0);
  EXPECT_TRUE(arrival.ok()) << arrival.error();
  const RunRecord record = (*robot)->take_record();
  const auto& samples = record.samples();
  auto rolled = samples.front().stamp;
  for (const auto& sample : samples) {
    outcome.fastest = std::max(outcome.fastest, sample.v);
    if (std::abs(sample.v) >= 0.1) rolled = sample.stamp;
  }
  outcome.stood = runtime::seconds(samples.back().stamp - rolled);
  outcome.speed = samples.back().v;
  outcome.way = geometry::distance(samples.front().truth, samples.back().truth);
  outcome.summary = record.summary();
  return outcome;
}

class BlindPlanner : public testing::TestWithParam<Way> {};

TEST_P(BlindPlanner, IsStoppedBeforeIt) {
  const Outcome outcome = drive_blindly(GetParam(), true);
  EXPECT_GT(outcome.fastest, 0.7 * GetParam().v) << "it went there at speed";
  EXPECT_GT(outcome.way, GetParam().ahead - 0.8) << "and got near";
  EXPECT_LT(std::abs(outcome.speed), 0.1);
  EXPECT_TRUE(outcome.held);
  EXPECT_EQ(outcome.summary.contacts + outcome.summary.touches, 0U) << outcome.summary.contact_with;
  EXPECT_GT(outcome.stood, 10.0);
  EXPECT_TRUE(outcome.barred) << "the costs still know of it";
}

TEST_P(BlindPlanner, HitsItWithoutTheGuard) {
  EXPECT_GT(drive_blindly(GetParam(), false).summary.contacts, 0U);
}

TEST(NearGlass, StaysInTheCosts) {
  const Outcome outcome = drive_blindly(kNearGlass, true);
  EXPECT_GT(outcome.stood, 10.0);
  EXPECT_TRUE(outcome.barred);
}

INSTANTIATE_TEST_SUITE_P(Into, BlindPlanner, testing::ValuesIn(kWays),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace usher::operations
