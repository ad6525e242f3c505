// A local planner that has gone wrong, in lock-step: whatever it should do, it tells the robot to
// drive full speed ahead.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using std::chrono::milliseconds;

struct Way {
  const char* name;
  const char* manifest;
  const char* place;
  const char* goal;
  double v;           ///< [m/s] that the planner wants
  const char* world;  ///< instead of the site's, where not null
  double ahead;       ///< [m] from the place to the obstacle
};

constexpr const char* kLowBox = R"(name: hall
ceiling: 2.7
rooms:
  - {name: hall, title: Hall, area: [0.0, 0.0, 12.0, 6.0]}
walls:
  - {name: around, thickness: 0.2, points: [[-0.1, -0.1], [12.1, -0.1], [12.1, 6.1], [-0.1, 6.1], [-0.1, -0.1]]}
obstacles:
  - {name: box, box: [6.0, 3.0, 0.0, 0.4, 0.8], height: [0.0, 0.2]}
)";

// What the laser sees; what only the ultrasonic sensors hear; what only the depth camera sees.
const Way kWays[] = {
    {"Wall", "marvin-sim.yaml", "[4.5, 7.0, 1.5708]", "library", 1.4, nullptr, 3.7},
    {"Glass", "glass-corridor.yaml", "[1.0, 0.6, 0.0]", "goal", 1.0, nullptr, 3.49},
    {"LowBox", "obstacle-course.yaml", "[1.0, 3.0, 0.0]", "goal", 1.0, kLowBox, 4.8},
};

struct Outcome {
  RunRecord::Summary summary;
  double way = 0.0, fastest = 0.0, speed = 0.0;  ///< [m], [m/s], the latter at the end
  std::string reason;
};

Outcome drive_blindly(const Way& way, bool guard) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  auto deployment = load_deployment(share + "/deploy/" + way.manifest, installation,
                                    {{"movement_control", "guard", guard ? "true" : "false"}});
  EXPECT_TRUE(deployment.ok()) << deployment.error();
  set_site_value(*deployment, "site.initial_pose", way.place);
  const test::Folder folder;
  if (way.world != nullptr)
    set_site_value(*deployment, "site.world", folder.file("world.yaml", way.world));
  auto run = LockstepRun::create(*deployment, 1);
  EXPECT_TRUE(run.ok()) << run.error();
  auto& world = (*run)->world();
  Outcome outcome;
  Errand errand(
      way.goal, 1000,
      {[&](const auto& request) {
         world.publish(topics::kSupervisorRequest, request, Errand::kClient);
       },
       [&](const auto& goal) { world.publish(topics::kNavigateGoal, goal, Errand::kClient); }});
  world.tamper(topics::kCmdVelNavigation, [&](const auto&, auto& wanted) {
    wanted.twist().linear().x(way.v);
    wanted.twist().angular().z(0.0);
    return true;
  });
  world.observe(topics::kSupervisorStatus,
                [&](const auto& status, const auto&) { errand.take(status); });
  world.observe(topics::kNavigateStatus,
                [&](const auto& status, const auto&) { errand.take(status); });
  world.observe(topics::kMovementStatus, [&](const auto& status, const auto&) {
    if (status.source() == usher_msgs::msg::MovementStatus_Constants::SOURCE_NAVIGATION)
      outcome.reason = status.limit_reason();
  });
  while (world.elapsed() < std::chrono::seconds(20) && !errand.over()) {
    errand.step();
    world.run_for(milliseconds(200));
  }
  const auto& samples = (*run)->record().samples();
  for (const auto& sample : samples) outcome.fastest = std::max(outcome.fastest, sample.v);
  outcome.speed = samples.back().v;
  outcome.way = geometry::distance(samples.front().truth, samples.back().truth);
  outcome.summary = (*run)->record().summary();
  return outcome;
}

class BlindPlanner : public testing::TestWithParam<Way> {};

TEST_P(BlindPlanner, IsStoppedBeforeIt) {
  const Outcome outcome = drive_blindly(GetParam(), true);
  EXPECT_GT(outcome.fastest, 0.7 * GetParam().v) << "it went there at speed";
  EXPECT_GT(outcome.way, GetParam().ahead - 0.8) << "and got near";
  EXPECT_LT(std::abs(outcome.speed), 0.1);
  EXPECT_EQ(outcome.reason, "something is in the way");
  EXPECT_EQ(outcome.summary.contacts + outcome.summary.touches, 0U) << outcome.summary.contact_with;
}

TEST_P(BlindPlanner, HitsItWithoutTheGuard) {
  EXPECT_GT(drive_blindly(GetParam(), false).summary.contacts, 0U);
}

INSTANTIATE_TEST_SUITE_P(Into, BlindPlanner, testing::ValuesIn(kWays),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace usher::operations
