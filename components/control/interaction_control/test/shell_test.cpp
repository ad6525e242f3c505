#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "control/interaction_control/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::interaction_control {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::FaceTarget_Constants;

struct Bench {
  runtime::TestHost host{
      runtime::component_factory<InteractionControlComponent>("interaction_control")};
  bool enabled = true;
  bool odometry = true;

  void run(int ms, int mode, double bearing) {
    for (int i = 0; i < ms; i += 50) {
      for (int j = 0; j < 2; ++j) {
        usher_msgs::msg::MovementEnable enable;
        enable.header(wire::header(host.now(), ""));
        enable.interaction_control(enabled);
        host.publish(topics::kMovementEnable, enable);
        nav_msgs::msg::Odometry odom;
        odom.header(wire::header(host.now(), "odom"));
        if (odometry) host.publish(topics::kOdom, odom);
        host.run_for(milliseconds(5));
        if (j == 0 && mode >= 0) {
          usher_msgs::msg::FaceTarget target;
          target.header(wire::header(host.now(), "base_footprint"));
          target.mode(static_cast<std::uint8_t>(mode));
          target.bearing(bearing);
          host.publish(topics::kInteractionTarget, target);
        }
        host.run_for(milliseconds(20));
      }
    }
  }
  double w() const { return host.last(topics::kCmdVelInteraction)->twist().angular().z(); }
};

TEST(InteractionControlShell, TurnsTowardTheTargetAndNeverDrives) {
  Bench bench;
  bench.run(500, MODE_FACE, 1.0);
  EXPECT_EQ(bench.w(), 0.5);
  bench.run(500, MODE_FACE, -1.0);
  EXPECT_EQ(bench.w(), -0.5);
  bench.run(500, MODE_SEARCH, 0.0);
  EXPECT_EQ(bench.w(), 0.25);
  bench.run(500, MODE_STAND, 1.0);
  EXPECT_EQ(bench.w(), 0.0);
  for (const auto& command : bench.host.written(topics::kCmdVelInteraction))
    EXPECT_EQ(command.twist().linear().x(), 0.0);
}

TEST(InteractionControlShell, StandsWithoutTargetOdometryOrEnable) {
  Bench bench;
  bench.run(500, MODE_SEARCH, 0.0);
  EXPECT_NE(bench.w(), 0.0);
  bench.run(700, -1, 0.0);
  EXPECT_EQ(bench.w(), 0.0) << "target lost";
  bench.run(500, MODE_SEARCH, 0.0);
  bench.odometry = false;
  bench.run(500, MODE_SEARCH, 0.0);
  EXPECT_EQ(bench.w(), 0.0) << "odometry lost";
  bench.odometry = true;
  bench.enabled = false;
  bench.run(500, MODE_SEARCH, 0.0);
  EXPECT_EQ(bench.w(), 0.0) << "not enabled";
}

TEST(InteractionControlShell, TakesNoZoneThatEndsBeforeItBegins) {
  try {
    const runtime::TestHost host(
        runtime::component_factory<InteractionControlComponent>("interaction_control"),
        "dead_zone: 0.3 rad\nresume_zone: 0.2 rad");
    FAIL() << "it runs";
  } catch (const std::runtime_error& refused) {
    EXPECT_STREQ(refused.what(), "resume_zone must be above dead_zone, got 0.2 rad and 0.3 rad");
  }
}

TEST(InteractionControlShell, RejectsNonsense) {
  Bench bench;
  bench.run(500, MODE_FACE, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(bench.w(), 0.0);
  bench.run(200, 77, 1.0);
  EXPECT_EQ(bench.w(), 0.0);
  bench.run(200, -1, 1.0);
  EXPECT_GT(bench.host.counter("targets: rejected"), 0U);
}

TEST(InteractionControlShell, AlwaysCommands) {
  Bench bench;
  bench.host.clear();
  bench.run(1000, -1, 0.0);
  EXPECT_GE(bench.host.written(topics::kCmdVelInteraction).size(), 19U);
}

}  // namespace
}  // namespace usher::interaction_control
