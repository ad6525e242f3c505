// Zones, torso and eyes; shell_test.cpp has the turning toward a given target.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "control/interaction_control/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::interaction_control {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
namespace speech = usher_msgs::msg::SpeechStatus_Constants;

constexpr const char* kJoints =
    "robot.torso.torso_tilt: [-12 deg, 12 deg]\nrobot.torso.head_rise: [0, 0.08]\n"
    "robot.torso.turn_rate: 0.5\nrobot.torso.rise_rate: 0.04\n";
constexpr std::size_t kTilt = 2;

std::string zone(const std::string& name, const std::string& place, const std::string& tilt,
                 bool tracking, const std::string& eye = "\"#00ff00\"") {
  return "  - {name: " + name + ", enabled: true, " + place +
         ", tracking: " + (tracking ? "true" : "false") + ", voice: true, left_eye: " + eye +
         ", right_eye: \"#0000ff\", left_shoulder: 0, right_shoulder: 0, torso_tilt: " + tilt +
         ", head_rise: 0, head_tilt: 0, head_nod: 0, head_shake: 0}\n";
}

const std::string kNominal =
    "range_min: 0, range_max: 1.5, bearing_min: -40 deg, bearing_max: 40 deg";
const std::string kLeft = "range_min: 0, range_max: 1.5, bearing_min: 40 deg, bearing_max: 90 deg";

std::string parameters() {
  return kJoints + std::string("rest: nominal\nzones:\n") + zone("nominal", kNominal, "0", true) +
         zone("left", kLeft, "10 deg", false);
}

struct Bench {
  runtime::TestHost host{
      runtime::component_factory<InteractionControlComponent>("interaction_control"), parameters()};
  bool interacts = true, drives = false, torso_speaks = true, people_known = true, listens = false,
       hears = false;
  double x = 1.0, y = 0.0, yaw = 0.0;  // of the person, of the robot; in odom
  double level = 0.0;
  bool guide_speaks = false, seeks = false;

  void run(int ms) {
    for (int i = 0; i < ms; i += 50) {
      usher_msgs::msg::GuideStatus guide;
      guide.header(wire::header(host.now(), ""));
      guide.seeks(seeks);
      if (guide_speaks) host.publish(topics::kGuideStatus, guide);
      usher_msgs::msg::MovementEnable enable;
      enable.header(wire::header(host.now(), ""));
      enable.movement(interacts || drives);
      enable.interaction_control(interacts);
      enable.navigation(drives);
      host.publish(topics::kMovementEnable, enable);
      nav_msgs::msg::Odometry odom;
      odom.header(wire::header(host.now(), "odom"));
      odom.pose().pose(wire::to_message(geometry::Pose2{0, 0, yaw}));
      host.publish(topics::kOdom, odom);
      usher_msgs::msg::People people;
      people.header(wire::header(host.now(), "odom"));
      auto& person = people.people().emplace_back();
      person.id(5);
      person.x(x);
      person.y(y);
      if (people_known) host.publish(topics::kPeople, people);
      usher_msgs::msg::TorsoStatus torso;
      torso.header(wire::header(host.now(), ""));
      torso.moves(true);
      if (const auto frame = host.last(topics::kTorsoFrame)) torso.joints(frame->joints());
      if (torso_speaks) host.publish(topics::kTorsoStatus, torso);
      usher_msgs::msg::SpeechStatus said;
      said.header(wire::header(host.now(), ""));
      said.state(listens ? speech::STATE_LISTENING : speech::STATE_SPEAKING);
      said.hears(hears);
      host.publish(topics::kSpeechStatus, said);
      usher_msgs::msg::SpeechLevel loud;
      loud.header(wire::header(host.now(), ""));
      loud.level(static_cast<float>(level));
      if (level > 0.0) host.publish(topics::kSpeechLevel, loud);
      host.run_for(milliseconds(50));
    }
  }
  double tilt() const { return host.last(topics::kTorsoFrame)->joints()[kTilt]; }
  double w() const { return host.last(topics::kCmdVelInteraction)->twist().angular().z(); }
  usher_msgs::msg::InteractionStatus status() const {
    return host.last(topics::kInteractionStatus).value();
  }
};

TEST(PosingShell, PosesByWhereThePersonStandsInTheRobotsFrame) {
  Bench bench;
  bench.run(2000);
  EXPECT_EQ(bench.status().zone(), "nominal");
  EXPECT_TRUE(bench.status().posed());
  EXPECT_EQ(bench.tilt(), 0.0);
  bench.yaw = -1.0;  // the same person is now to its left
  bench.run(3000);
  const auto status = bench.status();
  EXPECT_EQ(status.zone(), "left");
  EXPECT_EQ(status.pose(), "left");
  EXPECT_NEAR(status.human_range(), 1.0, 1e-6);
  EXPECT_NEAR(status.human_bearing(), 1.0, 1e-6);
  EXPECT_NEAR(bench.tilt(), 0.1745, 1e-3);
}

TEST(PosingShell, TurnsSlowlyWhileTheGuideSeeksAndStopsAtOnceForWhoeverIsThere) {
  Bench bench;
  bench.people_known = false;
  bench.guide_speaks = true;
  bench.run(1000);
  EXPECT_EQ(bench.w(), 0.0) << "it does not seek";
  bench.seeks = true;
  bench.run(200);
  EXPECT_EQ(bench.w(), 0.25);
  bench.people_known = true;
  bench.y = 1.0;  // in the zone where the base stands
  bench.x = 0.5;
  bench.run(200);
  EXPECT_EQ(bench.w(), 0.0) << "somebody is in a zone, though the guide has not noticed yet";
  bench.people_known = false;
  bench.run(1500);
  EXPECT_EQ(bench.w(), 0.25) << "and has gone";
  bench.seeks = false;
  bench.run(100);
  EXPECT_EQ(bench.w(), 0.0) << "somebody is served";
}

TEST(PosingShell, SeeksNobodyWithoutTheGuideOrLeave) {
  Bench bench;
  bench.people_known = false;
  bench.guide_speaks = bench.seeks = true;
  bench.run(500);
  ASSERT_EQ(bench.w(), 0.25);
  bench.interacts = false;
  bench.run(100);
  EXPECT_EQ(bench.w(), 0.0) << "it may not";
  bench.interacts = true;
  bench.run(200);
  ASSERT_EQ(bench.w(), 0.25);
  bench.guide_speaks = false;
  bench.run(1700);
  EXPECT_EQ(bench.w(), 0.0) << "the guide is silent";
}

TEST(PosingShell, StatusHasTheFieldsOfTheThesis) {
  Bench bench;
  bench.run(1000);
  const auto status = bench.status();
  EXPECT_FLOAT_EQ(status.zone_change_range_threshold(), 0.15F);
  EXPECT_FLOAT_EQ(status.zone_change_bearing_threshold(), 0.12F);
  EXPECT_FLOAT_EQ(status.segway_tracking_deadzone(), 0.14F);
  EXPECT_TRUE(status.enable_interaction());
  EXPECT_TRUE(status.human_detected());
  EXPECT_TRUE(status.segway_tracking());
  EXPECT_TRUE(status.ok());
  bench.people_known = false;
  bench.run(1500);
  EXPECT_FALSE(bench.status().human_detected());
  EXPECT_FALSE(bench.status().segway_tracking());
  EXPECT_TRUE(std::isnan(bench.status().human_range()));
  EXPECT_TRUE(std::isnan(bench.status().human_bearing()));
  EXPECT_EQ(bench.status().zone(), "");
}

TEST(PosingShell, TurnsToFaceInATrackingZoneUnlessSomebodyElseDecides) {
  Bench bench;
  bench.x = std::cos(0.5);
  bench.y = std::sin(0.5);
  bench.run(500);
  EXPECT_EQ(bench.w(), 0.5);
  bench.yaw = 0.45;
  bench.run(200);
  EXPECT_EQ(bench.w(), 0.0) << "within the dead zone";
  bench.yaw = -0.6;
  bench.run(500);
  EXPECT_EQ(bench.status().zone(), "left");
  EXPECT_EQ(bench.w(), 0.0) << "the torso leans, the base stands";
  bench.yaw = 0.1;
  bench.run(500);
  EXPECT_GT(bench.w(), 0.0);
  usher_msgs::msg::FaceTarget target;
  target.header(wire::header(bench.host.now(), "base_footprint"));
  target.mode(usher_msgs::msg::FaceTarget_Constants::MODE_STAND);
  bench.host.publish(topics::kInteractionTarget, target);
  bench.run(200);
  EXPECT_EQ(bench.w(), 0.0) << "who tells it whom to face knows better";
  bench.run(1000);
  EXPECT_GT(bench.w(), 0.0);
  bench.people_known = false;
  bench.run(1000);
  EXPECT_EQ(bench.w(), 0.0);
}

TEST(PosingShell, HoldsStillWhileItListensOrMayNotPoseAndRestsOnTheWay) {
  Bench bench;
  bench.run(1000);
  bench.yaw = -1.0;
  bench.run(400);
  bench.listens = true;
  bench.run(300);
  const double held = bench.tilt();
  EXPECT_GT(held, 0.0);
  EXPECT_LT(held, 0.17);
  EXPECT_TRUE(bench.status().listens());
  bench.run(2000);
  EXPECT_EQ(bench.tilt(), held);
  bench.listens = bench.interacts = false;
  bench.run(2000);
  EXPECT_EQ(bench.tilt(), held);
  EXPECT_FALSE(bench.status().enable_interaction());
  bench.interacts = true;
  bench.run(2000);
  EXPECT_NEAR(bench.tilt(), 0.1745, 1e-3);
  bench.interacts = false;
  bench.drives = true;
  bench.run(3000);
  EXPECT_EQ(bench.status().pose(), "nominal");
  EXPECT_EQ(bench.tilt(), 0.0);
}

TEST(PosingShell, HoldsTorsoAndBaseWhileSomebodySpeaksThoughTheRobotDoes) {
  Bench bench;
  bench.run(1000);
  bench.yaw = -1.0;
  bench.run(400);
  bench.hears = true;
  bench.run(300);
  const double held = bench.tilt();
  EXPECT_GT(held, 0.0);
  EXPECT_LT(held, 0.17);
  EXPECT_TRUE(bench.status().listens());
  bench.run(2000);
  EXPECT_EQ(bench.tilt(), held);
  bench.hears = false;
  bench.run(2000);
  EXPECT_NEAR(bench.tilt(), 0.1745, 1e-3);

  bench.yaw = 0.0;
  bench.x = std::cos(0.5);
  bench.y = std::sin(0.5);
  bench.run(500);
  EXPECT_GT(bench.w(), 0.0);
  bench.hears = true;
  bench.run(100);
  EXPECT_EQ(bench.w(), 0.0);
  bench.hears = false;
  bench.run(100);
  EXPECT_GT(bench.w(), 0.0);

  bench.people_known = false;
  bench.guide_speaks = bench.seeks = true;
  bench.run(1500);
  bench.hears = true;
  bench.run(100);
  EXPECT_EQ(bench.w(), 0.25) << "whoever talks somewhere in the room does not end the search";
}

TEST(PosingShell, TheEyesFollowTheVoice) {
  Bench bench;
  bench.run(2000);
  EXPECT_FLOAT_EQ(bench.host.last(topics::kTorsoFrame)->left_eye()[1], 0.4F);
  EXPECT_FLOAT_EQ(bench.host.last(topics::kTorsoFrame)->right_eye()[2], 0.4F);
  bench.level = 1.0;
  bench.run(500);
  EXPECT_FLOAT_EQ(bench.host.last(topics::kTorsoFrame)->left_eye()[1], 1.0F);
  bench.level = 0.0;
  bench.run(1000);
  EXPECT_FLOAT_EQ(bench.host.last(topics::kTorsoFrame)->left_eye()[1], 0.4F);
}

TEST(PosingShell, TellsATorsoThatDoesNotAnswerNothing) {
  Bench bench;
  bench.run(1000);
  bench.torso_speaks = false;
  bench.run(500);
  bench.host.clear();
  bench.run(1000);
  EXPECT_TRUE(bench.host.written(topics::kTorsoFrame).empty());
  EXPECT_FALSE(bench.status().ok());
  EXPECT_EQ(bench.host.heartbeat().reason(), "the torso does not obey");
  bench.torso_speaks = true;
  bench.run(1000);
  EXPECT_TRUE(bench.status().ok());
}

TEST(PosingShell, CountsAPersonWhoIsNowhere) {
  Bench bench;
  bench.x = std::numeric_limits<double>::quiet_NaN();
  bench.run(2000);
  EXPECT_FALSE(bench.status().human_detected());
  EXPECT_GT(bench.host.counter("people: rejected"), 0U);
}

TEST(PosingShell, RefusesZonesThatMakeNoSense) {
  const auto error_of = [](const std::string& text) {
    const Status made = runtime::TestHost::try_make(
        runtime::component_factory<InteractionControlComponent>("interaction_control"),
        kJoints + text);
    return made ? "" : made.error();
  };
  EXPECT_EQ(error_of("zones:\n" + zone("a", kLeft, "0", true) + "rest: a"), "");
  EXPECT_THAT(error_of("zones:\n" + zone("a", kLeft, "0", true) + "rest: b"),
              HasSubstr("rest must be the name of a zone, got \"b\""));
  EXPECT_THAT(error_of("zones:\n" + zone("a", kLeft, "13 deg", true)),
              HasSubstr("zone 'a': torso_tilt must be in"));
  EXPECT_THAT(error_of("zones:\n" + zone("a", kLeft, "0", true, "green")),
              HasSubstr("left_eye must be a color like \"#20c040\", got \"green\""));
  EXPECT_THAT(error_of("zones:\n" + zone("a", kLeft + ", mood: 3", "0", true)),
              HasSubstr("unknown field \"mood\" in zones[0] (interaction_control:"));
  EXPECT_THAT(error_of("zones:\n  - {name: a, enabled: true}"), HasSubstr("must be set"));
}

}  // namespace
}  // namespace usher::interaction_control
