#include "tasks/guide/shell/component.hpp"

#include <gmock/gmock.h>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::guide {
namespace {

using namespace usher_msgs::msg;
using std::chrono::milliseconds;

TEST(GuideParameters, ThatCannotBeMeantAreRefused) {
  const auto error = [](const std::string& parameters) -> std::string {
    try {
      const runtime::TestHost host(runtime::component_factory<GuideComponent>("guide"), parameters);
      return "";
    } catch (const std::runtime_error& refused) {
      return refused.what();
    }
  };
  EXPECT_EQ(error("answer_timeout: 40 s\nwarning_time: 30 s"), "");
  EXPECT_EQ(
      error("answer_timeout: 40 s\nwarning_time: 40 s"),
      "warning_time must be below answer_timeout and pause_timeout, got 40 s, 40 s and 120 s");
  EXPECT_THAT(error("pause_timeout: 50 s\nwarning_time: 55 s"), testing::HasSubstr("55 s"));
  for (const char* nonsense : {"answer_timeout: 0.1 s", "warning_time: 10 s", "tone_time: 1 h",
                               "tone_time: 0.1 s", "arrived_time: 1 h", "follow_unseen: 1 h"}) {
    EXPECT_THAT(error(nonsense), testing::HasSubstr("must be in")) << nonsense;
  }
}

/// The component in a robot that is told by hand what it does. Its texts are their keys.
class Stage : public testing::Test {
 protected:
  Stage() : host(runtime::component_factory<GuideComponent>("guide"), "introduction_time: 3") {
    Locations locations;
    locations.locations().emplace_back().name("lab");
    host.publish(topics::kLocations, locations);
    supervisor.state(SupervisorStatus_Constants::STATE_INTERACTION);
    supervisor.granted(true);
    run(500);
  }

  void run(int ms) {
    for (int at = 0; at < ms; at += 100) {
      const auto asked = host.last(topics::kSupervisorRequest);
      if (asked && answers_requests) obey(*asked);
      supervisor.header(wire::header(host.now(), ""));
      host.publish(topics::kSupervisorStatus, supervisor);
      navigation.header(wire::header(host.now(), frames::kMap));
      host.publish(topics::kNavigateStatus, navigation);
      if (speech) {
        speech->header(wire::header(host.now(), ""));
        host.publish(topics::kSpeechStatus, *speech);
      }
      if (visitor) {
        visitor->header(wire::header(host.now(), frames::kBaseFootprint));
        host.publish(topics::kVisitor, *visitor);
      }
      host.run_for(milliseconds(100));
    }
  }
  /// What the supervisor does with a request.
  void obey(const SupervisorRequest& request) {
    if (supervisor.last_request() == request.id()) return;
    supervisor.last_request(request.id());
    supervisor.last_request_client(answered_client);
    supervisor.last_request_done(true);
    const bool stops = request.command() == SupervisorRequest_Constants::COMMAND_STOP;
    if (stops || request.command() == SupervisorRequest_Constants::COMMAND_MOVEMENT_ON)
      std::erase(supervisor.stopped_by(), host.name());
    if (stops) supervisor.stopped_by().push_back(host.name());
    if (request.command() == SupervisorRequest_Constants::COMMAND_NAVIGATION_END)
      supervisor.state(SupervisorStatus_Constants::STATE_INTERACTION);
  }
  DialogueScreen screen() const { return host.last(topics::kDialogueScreen).value(); }
  void press(const std::string& option) {
    DialogueAnswer answer;
    answer.screen_id(screen().id());
    answer.option_id(option);
    answer.client("tablet");
    answer.id(++answers);
    host.publish(topics::kDialogueAnswer, answer, "tablet");
    run(100);
  }
  void drive() {
    press("language:en"), run(3000), press("guide_me"), press("lab"), press("start");
    supervisor.state(SupervisorStatus_Constants::STATE_NAVIGATION_ACTIVE);
    run(1200);
    navigation.id(host.last(topics::kNavigateGoal).value().id());
    navigation.client("guide");
    navigation.state(GoalStatus_Constants::STATE_ACTIVE);
    run(1000);
    ASSERT_EQ(screen().state(), "guide_active");
    ASSERT_EQ(screen().status(), "driving");
  }
  void meet(std::uint64_t person) {
    visitor.emplace();
    visitor->presence(Visitor_Constants::PRESENCE_SEEN);
    visitor->person(person);
    visitor->x(1.5);
    run(1300);
  }

  runtime::TestHost host;
  SupervisorStatus supervisor;
  NavigateStatus navigation;
  std::optional<SpeechStatus> speech;
  std::optional<usher_msgs::msg::Visitor> visitor;
  std::uint64_t answers = 0;
  bool answers_requests = true;
  std::string answered_client = "guide";
};

TEST_F(Stage, ShowsThatSomebodyElseHoldsTheRobot) {
  drive();
  supervisor.stopped_by({"guide"});
  run(1500);
  EXPECT_EQ(screen().status(), "driving") << "its own stop is on its screen by itself";
  supervisor.stopped_by({"guide", "operator"});
  run(1500);
  EXPECT_EQ(screen().status(), "standing");
  EXPECT_EQ(screen().text(), "stopped_me");
  supervisor.stopped_by({});
  run(1300);
  EXPECT_EQ(screen().status(), "driving");
  supervisor.granted(false);
  run(1500);
  EXPECT_EQ(screen().status(), "standing");
  EXPECT_EQ(screen().text(), "one_moment");
}

TEST_F(Stage, DrivesNowhereAfterALostMemory) {
  drive();
  press("stop"), run(500);
  ASSERT_EQ(supervisor.stopped_by().size(), 1U);
  host.world().kill("guide");
  host.world().kept("guide")["session.dialogue"] = {'?'};
  host.run_for(milliseconds(100));
  host.world().start("guide");
  host.clear();
  run(500);
  Locations locations;
  locations.locations().emplace_back().name("lab");
  host.publish(topics::kLocations, locations);
  run(1500);
  EXPECT_EQ(host.counter("memory: unreadable"), 1U);
  const auto requests = host.written(topics::kSupervisorRequest);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests.front().command(), SupervisorRequest_Constants::COMMAND_NAVIGATION_END)
      << "before its stop is lifted";
  const auto cancel = host.last(topics::kNavigateCancel);
  ASSERT_TRUE(cancel);
  EXPECT_EQ(cancel->id(), navigation.id());
  EXPECT_TRUE(supervisor.stopped_by().empty()) << "no dead end";
  EXPECT_EQ(supervisor.state(), SupervisorStatus_Constants::STATE_INTERACTION);
}

TEST_F(Stage, AStopWaitsForNoOtherRequest) {
  drive();
  press("stop"), run(500), press("continue");
  answers_requests = false;
  run(1200);
  ASSERT_EQ(host.last(topics::kSupervisorRequest)->command(),
            SupervisorRequest_Constants::COMMAND_MOVEMENT_ON);
  press("stop");
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(),
            SupervisorRequest_Constants::COMMAND_STOP);
  answers_requests = true;
  host.clear();
  run(1000);
  EXPECT_EQ(supervisor.stopped_by().size(), 1U);
  for (const auto& request : host.written(topics::kSupervisorRequest))
    EXPECT_NE(request.command(), SupervisorRequest_Constants::COMMAND_MOVEMENT_ON);
}

TEST_F(Stage, TakesNobodyElsesAnswerForItsOwn) {
  answered_client = "tablet";
  press("language:en"), run(3000), press("guide_me"), press("lab"), press("start"), run(500);
  for (const auto& request : host.written(topics::kSupervisorRequest))
    EXPECT_EQ(request.command(), SupervisorRequest_Constants::COMMAND_NAVIGATION_START)
        << "not answered yet";
}

TEST_F(Stage, LetsItsVoiceFinishWhereOneIsHeard) {
  speech.emplace();
  speech->audible(true);
  press("language:en");
  run(4000);
  EXPECT_EQ(screen().state(), "introduction");
  speech->spoken_id(screen().spoken_id());
  speech->finished(true);
  run(300);
  EXPECT_EQ(screen().state(), "location_ask");
}

TEST_F(Stage, WaitsForNoVoiceThatCannotBeHeard) {
  speech.emplace();
  press("language:en"), run(3100);
  EXPECT_EQ(screen().state(), "location_ask") << "no loudspeaker";
}

TEST_F(Stage, WaitsForNoVoiceThatHasGone) {
  speech.emplace();
  speech->audible(true);
  press("language:en"), run(500);
  speech.reset();
  run(2700);
  EXPECT_EQ(screen().state(), "location_ask");
}

TEST_F(Stage, AsksNobodyToMakeWayOnOldWordOfAnObstacle) {
  drive();
  const auto blocked_for = [&](int ms) {
    for (int at = 0; at < ms; at += 100) {
      FollowStatus follow;
      follow.header(wire::header(host.now(), ""));
      follow.state(GoalStatus_Constants::STATE_WAITING);
      follow.blocked_for(1.0F);
      host.publish(topics::kFollowStatus, follow);
      run(100);
    }
  };
  const auto pleas = [&] {
    return std::ranges::count_if(host.written(topics::kDialogueScreen), [](const auto& screen) {
      return screen.tone() == DialogueScreen_Constants::TONE_PLEASE;
    });
  };
  blocked_for(1500), run(5000);
  EXPECT_EQ(pleas(), 0);
  blocked_for(4000);
  EXPECT_GT(pleas(), 0);
}

TEST_F(Stage, GreetsWhoIsAnotherOne) {
  meet(5);
  EXPECT_EQ(screen().state(), "introduction");
  run(3000), press("no"), press("no"), press("no");
  ASSERT_EQ(screen().state(), "end");
  meet(5), run(4000);
  EXPECT_EQ(screen().state(), "end");
  meet(6), run(4000);
  EXPECT_EQ(screen().state(), "location_ask");
  EXPECT_EQ(host.last(topics::kGuideStatus)->greeted(), 2U);
}

}  // namespace
}  // namespace usher::guide
