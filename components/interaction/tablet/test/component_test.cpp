#include "interaction/tablet/shell/component.hpp"

#include <gtest/gtest.h>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::tablet {
namespace {

using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;

class Component : public testing::Test {
 protected:
  void hear(bool guide = true) {
    usher_msgs::msg::SupervisorStatus supervisor;
    supervisor.header(wire::header(host_.now(), ""));
    supervisor.last_request(request_seen_);
    supervisor.last_request_client(client_seen_);
    supervisor.current_goal(goal_);
    supervisor.stopped_by(stopped_by_);
    host_.publish(topics::kSupervisorStatus, supervisor, "supervisor");
    usher_msgs::msg::GuideStatus status;
    status.header(wire::header(host_.now(), ""));
    status.serves(serves_);
    if (guide) host_.publish(topics::kGuideStatus, status, "guide");
    host_.run_for(milliseconds(110));
  }
  usher_msgs::msg::DialogueScreen screen(std::uint64_t id, const std::string& state,
                                         const std::vector<std::string>& options) {
    usher_msgs::msg::DialogueScreen message;
    message.id(id);
    message.state(state);
    message.language("en");
    message.title("Title");
    for (const auto& option : options) {
      auto& entry = message.options().emplace_back();
      entry.id(option);
      entry.label(option);
    }
    return message;
  }
  void show(const usher_msgs::msg::DialogueScreen& message) {
    host_.publish(topics::kDialogueScreen, message, "guide");
    host_.run_for(milliseconds(110));
  }

  NullWindow window_;
  runtime::TestHost host_{{"tablet",
                           [this](runtime::Host& host) {
                             return std::unique_ptr<runtime::Component>(
                                 std::make_unique<TabletComponent>(host, window_));
                           }},
                          "texts: " USHER_SOURCE_DIR
                          "/config/dialogue/en.yaml\n"
                          "site.locations: [{name: kitchen, title: Kitchen, x: 0, y: 0, yaw: 0}]\n"
                          "site.titles: [{place: kitchen, language: de, title: Küche}]"};
  std::uint64_t request_seen_ = 0;
  std::string client_seen_ = "tablet", goal_;
  std::vector<std::string> stopped_by_;
  bool serves_ = false;
};

TEST(ComponentWithTitles, RefusesOneOfAPlaceThatTheSiteDoesNotHave) {
  NullWindow window;
  const runtime::ComponentFactory factory{
      "tablet", [&](runtime::Host& host) {
        return std::unique_ptr<runtime::Component>(std::make_unique<TabletComponent>(host, window));
      }};
  const auto made = runtime::TestHost::try_make(
      factory,
      "site.locations: [{name: kitchen, title: Kitchen, x: 0, y: 0, yaw: 0}]\n"
      "site.titles: [{place: kichen, language: de, title: Küche}]");
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.error().find("site.titles must be of places among site.locations (kitchen), "
                              "got 'kichen'"),
            std::string::npos)
      << made.error();
}

TEST_F(Component, NamesThePlacesOnTheMapInTheLanguageOfTheDialogue) {
  usher_msgs::msg::Locations locations;
  locations.locations().emplace_back().name("kitchen");
  locations.locations().back().title("Kitchen");
  host_.publish(topics::kLocations, locations, "navigator");
  auto message = screen(5, "guide_options", {"kitchen"});
  show(message);
  ASSERT_EQ(window_.places.size(), 1U);
  EXPECT_EQ(window_.places[0].title, "Kitchen");
  message.id(6), message.language("de");
  show(message);
  EXPECT_EQ(window_.places[0].title, "Küche");
  message.id(7), message.language("fr");
  show(message);
  EXPECT_EQ(window_.places[0].title, "Kitchen");
}

TEST_F(Component, ShowsWhatTheEarAsks) {
  hear();
  show(screen(5, "guide_options", {"library"}));
  usher_msgs::msg::SpeechStatus speech;
  speech.header(wire::header(host_.now(), ""));
  speech.state(usher_msgs::msg::SpeechStatus_Constants::STATE_ASKING);
  speech.hint("Did you say library?");
  host_.publish(topics::kSpeechStatus, speech, "speech");
  hear();
  EXPECT_EQ(window_.view.text, "Did you say library?");
  speech.state(usher_msgs::msg::SpeechStatus_Constants::STATE_SILENT);
  speech.hint("Please touch");
  host_.publish(topics::kSpeechStatus, speech, "speech");
  hear();
  EXPECT_EQ(window_.view.text, "");
  EXPECT_EQ(window_.view.status, "Please touch");
  for (int i = 0; i < 40; ++i) hear();
  EXPECT_EQ(window_.view.status, "") << "the ear is silent";
}

TEST_F(Component, ShowsTheDialogueAndSaysWhenTheRobotIsAway) {
  host_.run_for(milliseconds(200));
  EXPECT_EQ(window_.view.page, Page::kAway);
  hear();
  show(screen(5, "guide_ask", {"yes", "no"}));
  EXPECT_EQ(window_.view.page, Page::kButtons);
  EXPECT_EQ(window_.view.primary.size(), 2U);
  host_.run_for(milliseconds(1600));
  EXPECT_EQ(window_.view.page, Page::kAway);
  EXPECT_EQ(host_.heartbeat().reason(), "the robot is out of reach");
  hear();
  EXPECT_EQ(window_.view.page, Page::kButtons) << "comes back by itself";
}

TEST(ComponentWithoutADisplay, IsDegraded) {
  struct HiddenWindow final : NullWindow {
    std::string hidden() const override { return "no display"; }
  } window;
  runtime::TestHost host(
      {"tablet",
       [&](runtime::Host& h) {
         return std::unique_ptr<runtime::Component>(std::make_unique<TabletComponent>(h, window));
       }},
      "");
  for (int i = 0; i < 3; ++i) {
    usher_msgs::msg::SupervisorStatus supervisor;
    supervisor.header(wire::header(host.now(), ""));
    host.publish(topics::kSupervisorStatus, supervisor, "supervisor");
    usher_msgs::msg::GuideStatus status;
    status.header(wire::header(host.now(), ""));
    host.publish(topics::kGuideStatus, status, "guide");
    host.run_for(milliseconds(110));
  }
  EXPECT_EQ(host.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_DEGRADED);
  EXPECT_EQ(host.heartbeat().reason(), "no display");
}

TEST_F(Component, RepeatsAnAnswerUntilTheScreenNamesIt) {
  hear();
  show(screen(5, "guide_ask", {"yes", "no"}));
  window_.touches.push_back({false, "yes"});
  host_.run_for(milliseconds(100));
  EXPECT_TRUE(host_.written(topics::kDialogueAnswer).empty())
      << "touched for what was there before";
  host_.run_for(milliseconds(250));
  window_.touches.push_back({false, "yes"});
  host_.run_for(milliseconds(450));
  const auto answers = host_.written(topics::kDialogueAnswer);
  ASSERT_GE(answers.size(), 2U);
  EXPECT_EQ(answers[0].option_id(), "yes");
  EXPECT_EQ(answers[0].screen_id(), 5U);
  EXPECT_EQ(answers[0].input(), usher_msgs::msg::DialogueAnswer_Constants::INPUT_TOUCH);
  EXPECT_EQ(answers[0].id(), answers[1].id());
  EXPECT_TRUE(window_.view.pending);
  auto reply = screen(6, "guide_options", {"lab"});
  reply.answer_client("tablet");
  reply.answer_id(answers[0].id());
  show(reply);
  host_.clear();
  host_.run_for(milliseconds(600));
  EXPECT_TRUE(host_.written(topics::kDialogueAnswer).empty());
  EXPECT_FALSE(window_.view.pending);
}

TEST_F(Component, StopsAtTheSupervisorWithin25MillisecondsAndLiftsItWhenTheDialogueGoesOn) {
  hear();
  show(screen(5, "guide_active", {"stop", "cancel"}));
  window_.touches.push_back({false, "stop"});
  host_.run_for(milliseconds(25));
  ASSERT_TRUE(host_.last(topics::kSupervisorRequest));
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_STOP);
  EXPECT_EQ(host_.last(topics::kDialogueAnswer)->option_id(), "stop");
  request_seen_ = host_.last(topics::kSupervisorRequest)->id();
  stopped_by_ = {"tablet", "guide"};
  hear();
  show(screen(6, "guide_paused", {"continue"}));
  show(screen(7, "guide_active", {"stop"}));
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_MOVEMENT_ON);
}

TEST_F(Component, StopsEvenWithoutDialogue) {
  hear(false);
  EXPECT_EQ(window_.view.page, Page::kStarting);
  window_.touches.push_back({false, Tablet::kStop});
  host_.run_for(milliseconds(25));
  ASSERT_TRUE(host_.last(topics::kSupervisorRequest));
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_STOP);
  EXPECT_TRUE(window_.view.start_offered);
}

TEST_F(Component, LiftsItsStopAtTheEndOfTheVisit) {
  serves_ = true;
  hear();
  show(screen(5, "guide_ask", {"yes", "no"}));
  window_.touches.push_back({false, Tablet::kStop});
  hear();
  EXPECT_TRUE(window_.view.start_offered);
  request_seen_ = host_.last(topics::kSupervisorRequest)->id();
  stopped_by_ = {"tablet"};
  serves_ = false;
  hear();
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_MOVEMENT_ON);
  EXPECT_FALSE(window_.view.start_offered);
}

TEST_F(Component, HoldsARobotWhoseDialogueHasForgottenTheJourney) {
  serves_ = true, goal_ = "lab";
  hear();
  show(screen(5, "guide_active", {"stop"}));
  window_.touches.push_back({false, "stop"});
  hear();
  request_seen_ = host_.last(topics::kSupervisorRequest)->id();
  stopped_by_ = {"tablet"};
  serves_ = false;
  hear(), hear();
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_STOP)
      << "the navigation would drive on";
  goal_.clear();
  hear();
  hear();
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_MOVEMENT_ON);
}

TEST_F(Component, TakesNobodyElsesAnswerForItsOwn) {
  hear();
  show(screen(5, "inactive", {"language:en"}));
  window_.touches.push_back({false, Tablet::kStop});
  host_.run_for(milliseconds(25));
  request_seen_ = host_.last(topics::kSupervisorRequest)->id();
  client_seen_ = "speech";
  hear();
  EXPECT_TRUE(window_.view.start_offered) << "its stop is not answered yet";
  host_.clear();
  hear(), hear();
  EXPECT_FALSE(host_.written(topics::kSupervisorRequest).empty());
}

TEST_F(Component, OffersStopAgainWhenAnOperatorHasLiftedItsStop) {
  hear();
  show(screen(5, "inactive", {"language:en"}));
  window_.touches.push_back({false, Tablet::kStop});
  host_.run_for(milliseconds(25));
  stopped_by_ = {"tablet"};
  hear();
  EXPECT_TRUE(window_.view.start_offered) << "not answered yet";
  request_seen_ = host_.last(topics::kSupervisorRequest)->id();
  hear();
  EXPECT_TRUE(window_.view.start_offered);
  EXPECT_FALSE(window_.view.stop_offered);
  stopped_by_.clear();
  hear();
  EXPECT_TRUE(window_.view.stop_offered);
  EXPECT_FALSE(window_.view.start_offered);
}

TEST_F(Component, OffersToLiftAStopThatItHasForgotten) {
  stopped_by_ = {"tablet"};
  hear();
  show(screen(5, "inactive", {"language:en"}));
  EXPECT_TRUE(window_.view.start_offered);
  host_.run_for(milliseconds(2000));
  window_.touches.push_back({false, Tablet::kStart});
  host_.run_for(milliseconds(25));
  ASSERT_TRUE(host_.last(topics::kSupervisorRequest));
  EXPECT_EQ(host_.last(topics::kSupervisorRequest)->command(), command::COMMAND_MOVEMENT_ON);
}

/// A finger at the end of a line.
class Finger final : public runtime::LockstepDevice {
 public:
  runtime::Bytes answer(std::span<const std::uint8_t>) override { return {}; }
  runtime::Bytes speak(runtime::Time) override { return std::exchange(says, {}); }
  runtime::Bytes says;
};

TEST(ComponentWithAFinger, TouchesWhatIsDrawn) {
  NullWindow window;
  const auto finger = std::make_shared<Finger>();
  const std::string lines = "nonsense\n" + finger::to_line({5, false, "yes"});
  finger->says.assign(lines.begin(), lines.end());
  runtime::TestHost host{{"tablet",
                          [&](runtime::Host& made) {
                            return std::unique_ptr<runtime::Component>(
                                std::make_unique<TabletComponent>(made, window));
                          }},
                         "texts: " USHER_SOURCE_DIR
                         "/config/dialogue/en.yaml\nfinger: listen://127.0.0.1:7431",
                         finger};
  host.run_for(milliseconds(1100));
  EXPECT_EQ(window.taps, (std::vector<finger::Tap>{{5, false, "yes"}}));
  EXPECT_EQ(host.counter("inputs: rejected"), 1U);
}

TEST_F(Component, ShowsBuildingRouteAndPlaces) {
  nav_msgs::msg::OccupancyGrid map;
  map.header().frame_id("map");
  map.info().resolution(0.05F);
  map.info().width(4);
  map.info().height(4);
  map.info().origin().orientation().w(1.0);
  map.data().assign(16, 0);
  host_.publish(topics::kMap, map, "map_server");
  usher_msgs::msg::Locations locations;
  locations.locations().resize(1);
  locations.locations()[0].name("lab");
  host_.publish(topics::kLocations, locations, "navigator");
  host_.run_for(milliseconds(110));
  EXPECT_EQ(window_.plan.width, 4);
  EXPECT_EQ(window_.places.size(), 1U);
  map.data().resize(3);
  host_.publish(topics::kMap, map, "map_server");
  host_.run_for(milliseconds(1100));
  EXPECT_EQ(host_.counter("inputs: rejected"), 1U);
  EXPECT_EQ(window_.plan.width, 4) << "the one before";
}

TEST_F(Component, ShowsTheRobotOnlyWhereItIsLocalizedNow) {
  hear();
  show(screen(5, "location_show", {"done"}));
  usher_msgs::msg::LocalizationStatus localization;
  const auto localize = [&](std::uint8_t state) {
    localization.header(wire::header(host_.now(), "map"));
    localization.state(state);
    host_.publish(topics::kLocalizationStatus, localization, "amcl");
    host_.run_for(milliseconds(210));
    return window_.view.located;
  };
  namespace state = usher_msgs::msg::LocalizationStatus_Constants;
  EXPECT_FALSE(localize(state::STATE_GOOD)) << "nobody told where";
  geometry_msgs::msg::PoseWithCovarianceStamped pose;
  pose.header(wire::header(host_.now(), "map"));
  pose.pose().pose(wire::to_message(geometry::Pose2{4.0, 3.0, 0.0}));
  host_.publish(topics::kAmclPose, pose, "amcl");
  EXPECT_TRUE(localize(state::STATE_GOOD));
  EXPECT_EQ(window_.view.robot.x, 4.0);
  EXPECT_FALSE(localize(state::STATE_LOST));
  EXPECT_TRUE(localize(state::STATE_GOOD)) << "the pose of a robot that stands stays";
  for (int i = 0; i < 22; ++i) hear();
  EXPECT_FALSE(window_.view.located) << "nobody localizes it any more";
}

TEST_F(Component, DrawsTheNewestPlanUntilThereIsAnother) {
  nav_msgs::msg::Path path;
  path.header(wire::header(host_.now(), "map"));
  for (const double x : {1.0, 2.0}) {
    auto& pose = path.poses().emplace_back();
    pose.pose(wire::to_message(geometry::Pose2{x, 0.0, 0.0}));
  }
  host_.publish(topics::kPlan, path, "navigator");
  host_.run_for(milliseconds(5000));
  EXPECT_EQ(window_.route.size(), 2U) << "the map shows it on the way only";
  path.poses().clear();
  host_.publish(topics::kPlan, path, "navigator");
  host_.run_for(milliseconds(110));
  EXPECT_TRUE(window_.route.empty());
}

}  // namespace
}  // namespace usher::tablet
