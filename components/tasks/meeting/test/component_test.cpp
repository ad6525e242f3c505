#include "tasks/meeting/shell/component.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::meeting {
namespace {

using namespace usher_msgs::msg;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace state = MeetingStatus_Constants;

const std::string kParameters =
    "robot.footprint: [0.2, 0.2, -0.2, 0.2, -0.2, -0.2, 0.2, -0.2]\n"
    "texts: " USHER_SOURCE_DIR
    "/config/dialogue/en.yaml\n"
    "site.meeting_rooms:\n"
    "  - {name: west, west: 0.0, south: 0.0, east: 4.0, north: 4.0}\n";

/// The component in a robot that is told by hand what it does, from a thread of time of its own.
class Stage {
 public:
  explicit Stage() : host(runtime::component_factory<MeetingComponent>("meeting"), kParameters) {
    nav_msgs::msg::OccupancyGrid map;
    map =
        wire::to_message(host.now(), frames::kMap,
                         grid::OccupancyGrid(grid::GridGeometry{100, 100, 0.1, 0, 0}, grid::kFree));
    host.publish(topics::kMap, map);
    Locations locations;
    auto& west = locations.locations().emplace_back();
    west.name("west");
    west.title("West room");
    west.pose(wire::to_message(geometry::Pose2{2.0, 2.0, 0.0}));
    host.publish(topics::kLocations, locations);
    run(500);
  }

  runtime::TestHost host;
  std::uint8_t supervisor = SupervisorStatus_Constants::STATE_INTERACTION;
  std::vector<std::string> stopped_by;
  bool navigator = true, explorer = true, detector = true, localized = true;
  geometry::Pose2 pose{6.0, 6.0, 0.0};
  NavigateStatus navigation;
  ExploreStatus exploration;
  std::vector<usher_msgs::msg::Face> faces;

  void run(int ms) {
    for (int i = 0; i < ms; i += 50) {
      SupervisorStatus status;
      status.header(wire::header(host.now(), ""));
      status.state(supervisor);
      status.stopped_by(stopped_by);
      if (supervisor != 255) host.publish(topics::kSupervisorStatus, status);
      navigation.header(wire::header(host.now(), frames::kMap));
      if (navigator) host.publish(topics::kNavigateStatus, navigation);
      exploration.header(navigation.header());
      if (explorer) host.publish(topics::kExploreStatus, exploration);
      LocalizationStatus localization;
      localization.header(navigation.header());
      localization.state(localized ? LocalizationStatus_Constants::STATE_GOOD
                                   : LocalizationStatus_Constants::STATE_LOST);
      host.publish(topics::kLocalizationStatus, localization);
      tf2_msgs::msg::TFMessage tf;
      auto& transform = tf.transforms().emplace_back();
      transform.header(wire::header(host.now(), frames::kMap));
      transform.child_frame_id(frames::kBaseFootprint);
      transform.transform().translation().x(pose.x);
      transform.transform().translation().y(pose.y);
      transform.transform().rotation().z(std::sin(0.5 * pose.yaw));
      transform.transform().rotation().w(std::cos(0.5 * pose.yaw));
      host.publish(topics::kTf, tf);
      usher_msgs::msg::Faces message;
      message.header(wire::header(host.now(), frames::kBaseFootprint));
      message.image_width(640);
      message.image_height(480);
      message.faces(faces);
      if (detector && i % 100 == 0) host.publish(topics::kFaces, message);
      host.run_for(milliseconds(50));
    }
  }
  void call(std::uint32_t persons, std::uint64_t id = 7) {
    MeetingRequest request;
    request.id(id);
    request.client("operator");
    request.persons(persons);
    host.publish(topics::kMeetingRequest, request);
    run(100);
  }
  MeetingStatus status() const { return host.last(topics::kMeetingStatus).value(); }
};

TEST(MeetingComponent, TakesARequestAndDrivesToTheRoom) {
  Stage stage;
  EXPECT_EQ(stage.status().state(), state::STATE_IDLE);
  stage.call(2);
  EXPECT_EQ(stage.status().state(), state::STATE_TO_ROOM);
  EXPECT_EQ(stage.status().last_request(), 7U);
  EXPECT_EQ(stage.status().mission().wanted(), 2U);
  EXPECT_NEAR(stage.status().time_left(), 900.0, 1.0);
  const auto request = stage.host.last(topics::kSupervisorRequest);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->command(), SupervisorRequest_Constants::COMMAND_NAVIGATION_START);
  EXPECT_EQ(request->client(), "meeting");
  stage.supervisor = SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
  stage.run(200);
  const auto goal = stage.host.last(topics::kNavigateGoal);
  ASSERT_TRUE(goal);
  EXPECT_EQ(goal->location(), "west");
  const auto target = stage.host.last(topics::kInteractionTarget);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->mode(), FaceTarget_Constants::MODE_STAND);
}

TEST(MeetingComponent, TurnsRoundAndFacesWhomItSees) {
  Stage stage;
  stage.call(1);
  stage.supervisor = SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
  stage.run(200);
  stage.navigation.id(stage.host.last(topics::kNavigateGoal)->id());
  stage.navigation.client("meeting");
  stage.navigation.state(GoalStatus_Constants::STATE_SUCCEEDED);
  stage.pose = {2.0, 2.0, 0.0};
  stage.run(100);
  stage.supervisor = SupervisorStatus_Constants::STATE_INTERACTION;
  stage.run(300);
  EXPECT_EQ(stage.status().state(), state::STATE_SCAN_ROOM);
  EXPECT_EQ(stage.host.last(topics::kInteractionTarget)->mode(), FaceTarget_Constants::MODE_SEARCH);
  usher_msgs::msg::Face face;
  face.left(250.0F), face.top(100.0F), face.width(60.0F), face.height(60.0F);
  face.depth(1.4F), face.range(1.5F), face.bearing(0.2F);
  stage.faces = {face};
  stage.run(200);
  EXPECT_EQ(stage.host.last(topics::kInteractionTarget)->mode(), FaceTarget_Constants::MODE_FACE);
  EXPECT_NEAR(stage.host.last(topics::kInteractionTarget)->bearing(), 0.2, 0.02);
  stage.run(600);
  EXPECT_EQ(stage.status().mission().rooms_occupied(), 1U);
}

TEST(MeetingComponent, TellsOfAStop) {
  Stage stage;
  stage.call(1);
  const auto told = [&] { return stage.host.last(topics::kDialogueScreen)->status(); };
  const std::string before = told();
  stage.stopped_by = {"tablet"};
  stage.run(300);
  EXPECT_NE(told(), before);
  stage.stopped_by.clear();
  stage.run(300);
  EXPECT_EQ(told(), before);
}

TEST(MeetingComponent, RepeatsItsExplorationWhileItGoesOn) {
  Stage stage;
  stage.call(1);
  stage.supervisor = SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
  stage.run(200);
  stage.navigation.id(stage.host.last(topics::kNavigateGoal)->id());
  stage.navigation.client("meeting");
  stage.navigation.state(GoalStatus_Constants::STATE_SUCCEEDED);
  stage.pose = {2.0, 2.0, 0.0};
  stage.run(100);
  stage.supervisor = SupervisorStatus_Constants::STATE_INTERACTION;
  for (int i = 0; i < 100 && stage.status().state() != state::STATE_EXPLORE; ++i) {
    stage.pose.yaw = geometry::normalized(stage.pose.yaw + 0.1);
    stage.run(100);
  }
  ASSERT_EQ(stage.status().state(), state::STATE_EXPLORE);
  stage.supervisor = SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE;
  stage.run(500);
  ASSERT_TRUE(stage.host.last(topics::kExploreGoal));
  stage.exploration.id(stage.host.last(topics::kExploreGoal)->id());
  stage.exploration.client("meeting");
  stage.exploration.state(GoalStatus_Constants::STATE_ACTIVE);
  stage.run(500);
  stage.host.clear();
  stage.run(5000);
  const auto asked = stage.host.written(topics::kExploreGoal);
  EXPECT_GE(asked.size(), 4U) << "the explorer ends after 3 s without";
  for (const auto& goal : asked) EXPECT_EQ(goal.id(), stage.exploration.id());
  GoalCancel cancel;
  cancel.id(7);
  cancel.client("operator");
  stage.host.publish(topics::kMeetingCancel, cancel);
  stage.run(500);
  stage.host.clear();
  stage.run(3000);
  EXPECT_TRUE(stage.host.written(topics::kExploreGoal).empty());
}

TEST(MeetingComponent, SaysWhatIsMissing) {
  const auto reason = [](void (*act)(Stage&)) {
    Stage stage;
    act(stage);
    stage.run(2500);
    EXPECT_EQ(stage.host.heartbeat().state(), 2U);
    EXPECT_EQ(stage.status().reason(), stage.host.heartbeat().reason());
    return stage.host.heartbeat().reason();
  };
  EXPECT_EQ(reason([](Stage& s) { s.supervisor = 255; }), "no supervisor");
  EXPECT_EQ(reason([](Stage& s) { s.navigator = false; }), "no navigator");
  EXPECT_EQ(reason([](Stage& s) { s.explorer = false; }), "no explorer");
  EXPECT_EQ(reason([](Stage& s) { s.detector = false; }), "no face detector");
  EXPECT_EQ(reason([](Stage& s) { s.localized = false; }), "not localized");
}

TEST(MeetingComponent, CountsFacesAndRequestsThatAreNone) {
  Stage stage;
  usher_msgs::msg::Face face;
  face.width(std::numeric_limits<float>::quiet_NaN());
  stage.faces = {face};
  stage.run(1200);
  EXPECT_GT(stage.host.counter("faces: rejected"), 5U);
  stage.call(0);
  EXPECT_EQ(stage.status().last_request(), 7U);
  EXPECT_NE(stage.status().reason().find("persons"), std::string::npos);
  stage.run(1100);
  EXPECT_EQ(stage.host.counter("inputs: rejected"), 1U);
  stage.host.publish(topics::kMap, {});
  stage.run(1100);
  EXPECT_EQ(stage.host.counter("inputs: rejected"), 2U);
  EXPECT_EQ(stage.status().state(), state::STATE_IDLE) << "keeps the map it has";
}

TEST(MeetingComponent, ReportsAMissionThatItsRestartEnded) {
  Stage stage;
  stage.call(3);
  ASSERT_EQ(stage.status().state(), state::STATE_TO_ROOM);
  stage.host.world().kill("meeting");
  stage.host.clear();
  stage.host.world().start("meeting");
  stage.run(1500);
  const auto report = stage.host.last(topics::kMeetingReport);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->id(), 7U);
  EXPECT_EQ(report->wanted(), 3U);
  EXPECT_EQ(report->outcome(), state::OUTCOME_FAILED);
  EXPECT_EQ(report->reason(), "the assistant was restarted");
  EXPECT_FALSE(stage.host.last(topics::kNavigateCancel)) << "nobody drives for it";
  EXPECT_EQ(stage.status().state(), state::STATE_IDLE);
}

TEST(MeetingComponent, EndsWhatItsRestartLeftUntilItHasEnded) {
  Stage stage;
  stage.call(1);
  stage.host.world().kill("meeting");
  stage.host.clear();
  stage.exploration.id(99);
  stage.exploration.client("meeting");
  stage.exploration.state(GoalStatus_Constants::STATE_ACTIVE);
  stage.navigation.id(5);
  stage.navigation.client("operator");
  stage.navigation.state(GoalStatus_Constants::STATE_ACTIVE);
  stage.host.world().start("meeting");
  stage.run(1500);
  ASSERT_TRUE(stage.host.last(topics::kExploreCancel));
  EXPECT_EQ(stage.host.last(topics::kExploreCancel)->id(), 99U);
  EXPECT_FALSE(stage.host.last(topics::kMeetingReport)) << "it explores yet";
  stage.host.clear();  // that one was lost
  stage.run(1500);
  EXPECT_TRUE(stage.host.last(topics::kExploreCancel));
  stage.exploration.state(GoalStatus_Constants::STATE_CANCELLED);
  stage.run(1500);
  EXPECT_TRUE(stage.host.last(topics::kMeetingReport));
  EXPECT_FALSE(stage.host.last(topics::kNavigateCancel)) << "another one's drive is not touched";
  EXPECT_FALSE(stage.host.last(topics::kSupervisorRequest)) << "nor its navigation";
  stage.host.clear();
  stage.run(3000);
  EXPECT_FALSE(stage.host.last(topics::kExploreCancel));
}

TEST(MeetingComponent, EndsTheDriveThatItsRestartLeft) {
  Stage stage;
  stage.call(1);
  stage.host.world().kill("meeting");
  stage.host.clear();
  stage.navigation.id(5);
  stage.navigation.client("meeting");
  stage.navigation.state(GoalStatus_Constants::STATE_WAITING);
  stage.host.world().start("meeting");
  stage.run(2500);
  ASSERT_TRUE(stage.host.last(topics::kNavigateCancel));
  EXPECT_EQ(stage.host.last(topics::kNavigateCancel)->id(), 5U);
  EXPECT_FALSE(stage.host.last(topics::kMeetingReport));
  stage.navigation.state(GoalStatus_Constants::STATE_CANCELLED);
  stage.run(1500);
  EXPECT_TRUE(stage.host.last(topics::kMeetingReport));
  ASSERT_TRUE(stage.host.last(topics::kSupervisorRequest));
  EXPECT_EQ(stage.host.last(topics::kSupervisorRequest)->command(),
            SupervisorRequest_Constants::COMMAND_NAVIGATION_END);
}

TEST(MeetingComponent, WaitsForNobodyWhoIsSilentAfterItsRestart) {
  Stage stage;
  stage.call(1);
  stage.host.world().kill("meeting");
  stage.host.clear();
  stage.explorer = false;
  stage.run(3000);
  stage.host.world().start("meeting");
  stage.run(4000);
  EXPECT_FALSE(stage.host.last(topics::kMeetingReport));
  stage.run(2000);
  EXPECT_TRUE(stage.host.last(topics::kMeetingReport));
}

TEST(MeetingComponent, RefusesTextsThatAreNone) {
  EXPECT_FALSE(
      runtime::TestHost::try_make(runtime::component_factory<MeetingComponent>("meeting"),
                                  "robot.footprint: [0.2, 0.2, -0.2, 0.2, -0.2, -0.2, 0.2, -0.2]\n"
                                  "texts: /nowhere/en.yaml\n")
          .ok());
}

}  // namespace
}  // namespace usher::meeting
