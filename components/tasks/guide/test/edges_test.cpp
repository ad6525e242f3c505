// Every edge of the dialogue, one visit each or more; the coverage is counted and printed.
#include <gtest/gtest.h>

#include <cstdio>

#include "visit_rig.hpp"

namespace usher::guide {
namespace {

struct Step {
  void (*act)(Rig&);
  State state;
  const char* actions;
};
struct Case {
  const char* name;
  std::vector<Step> steps;
};

const Step kActive{[](Rig& r) { r.to_active(); }, State::kGuideActive, ""};
const Step kStart{[](Rig& r) { r.to_start(); }, State::kGuideStart, "start:am218"};
const Step kArrive{[](Rig& r) { r.navigate(GoalState::kSucceeded); }, State::kGuideSuccess, "end"};
const Step kAnythingElse{[](Rig& r) { r.wait(4000); }, State::kEndAsk, ""};
const Step kBye{[](Rig& r) { r.press("no"); }, State::kEnd, ""};
const Step kIdle{[](Rig& r) { r.wait(4000); }, State::kInactive, ""};
const Step kComes{[](Rig& r) { r.see(1.5), r.wait(1100); }, State::kIntroduction, ""};

Step press(const char* /*what*/, void (*act)(Rig&), State state, const char* actions = "") {
  return {act, state, actions};
}

#define PRESS(id, state, ...) \
  press(                      \
      id, [](Rig& r) { r.press(id); }, State::state __VA_OPT__(, ) __VA_ARGS__)
#define WAIT(ms, state, ...) \
  press(                     \
      "", [](Rig& r) { r.wait(ms); }, State::state __VA_OPT__(, ) __VA_ARGS__)

const Step kToLocationAsk{[](Rig& r) { r.to_location_ask(); }, State::kLocationAsk, ""};
const Step kToOptions{[](Rig& r) { r.to_options(); }, State::kGuideOptions, ""};
const Step kGone{[](Rig& r) { r.see_nobody(), r.wait(15100); }, State::kEnd, ""};
const Step kGoneFromStart{[](Rig& r) { r.see_nobody(), r.wait(15100); }, State::kEnd, "end"};

const Step kFollowing{[](Rig& r) { r.to_following(); }, State::kFollowMe, ""};
const Step kFeedback{[](Rig& r) {
                       Parameters asks = quick();
                       asks.questionnaire = true;
                       r.guide = Guide(asks, book(), 1, {}, {});
                       EXPECT_TRUE(r.guide.set_locations(rooms(), r.now()).ok());
                       r.wait(100), r.to_feedback(), r.taken();
                     },
                     State::kFeedback, ""};

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"the questionnaire's seven tasks",
       {kComes,
        WAIT(3000, kLocationAsk),
        PRESS("yes", kLocationShow),
        PRESS("done", kGuideAsk),
        PRESS("yes", kGuideOptions),
        PRESS("am218", kGuideStart, "start:am218"),
        PRESS("start", kGuideActive, "go"),
        WAIT(900, kGuideActive, ""),
        WAIT(100, kGuideActive, "goal:am218"),
        {[](Rig& r) {
           r.around.visitor.reset();
           r.around.supervisor = Supervisor::kNavigation;
           r.navigate(GoalState::kActive);
         },
         State::kGuideActive, ""},
        kArrive,
        {[](Rig& r) { r.around.supervisor = Supervisor::kAvailable, r.wait(4000); }, State::kEndAsk,
         ""},
        PRESS("yes", kLocationAsk),
        PRESS("no", kGuideAsk),
        PRESS("yes", kGuideOptions),
        PRESS("foyer", kGuideStart, "start:foyer"),
        PRESS("start", kGuideActive, "go"),
        {[](Rig& r) { r.around.supervisor = Supervisor::kNavigation, r.wait(1000); },
         State::kGuideActive, "goal:foyer"},
        kArrive,
        kAnythingElse,
        kBye,
        kIdle}},
      {"a touch begins, another language on the way",
       {PRESS("language:de", kIntroduction), PRESS("language:fr", kIntroduction),
        WAIT(3000, kLocationAsk), PRESS("languages", kIntroduction), WAIT(3000, kLocationAsk),
        PRESS("no", kGuideAsk), PRESS("languages", kIntroduction)}},
      {"is not ready, then is",
       {{[](Rig& r) { r.around.supervisor = Supervisor::kUnknown, r.wait(100); },
         State::kInitialise, ""},
        {[](Rig& r) { r.around.supervisor = Supervisor::kAvailable, r.wait(100); },
         State::kInactive, ""}}},
      {"looks for places on the map, then goes there",
       {kToLocationAsk, PRESS("yes", kLocationShow), PRESS("where_is", kLocationOptions),
        PRESS("search", kLocationOptions), PRESS("back", kLocationOptions),
        PRESS("co239", kLocationShow), PRESS("guide_me", kGuideStart, "start:co239"),
        PRESS("cancel", kEndAsk, "end")}},
      {"looks for a place from the guide's question, cancels",
       {kToLocationAsk, PRESS("no", kGuideAsk), PRESS("where_is", kLocationOptions),
        PRESS("cancel", kGuideAsk), PRESS("no", kEndAsk), kBye, PRESS("again", kLocationAsk)}},
      {"searches among the options, cancels",
       {kToOptions, PRESS("search", kGuideOptions), PRESS("cancel", kEndAsk)}},
      {"cancels on the way", {kActive, PRESS("cancel", kEndAsk, "end cancel")}},
      {"stops and goes on",
       {kActive, PRESS("stop", kGuidePaused, "stop"), WAIT(30000, kGuidePaused),
        PRESS("continue", kGuideActive), WAIT(1000, kGuideActive, "on"), kArrive}},
      {"stops and cancels",
       {kActive, PRESS("stop", kGuidePaused, "stop"), PRESS("cancel", kEndAsk, "end cancel"),
        PRESS("no", kEnd, "on")}},
      {"stops and is forgotten",
       {kActive, PRESS("stop", kGuidePaused, "stop"), WAIT(120000, kEnd, "end on cancel")}},
      {"stops where the place is",
       {kActive,
        PRESS("stop", kGuidePaused, "stop"),
        {[](Rig& r) { r.navigate(GoalState::kSucceeded); }, State::kGuideSuccess, "end"},
        kAnythingElse,
        PRESS("no", kEnd, "on")}},
      {"stops, then the robot fails",
       {kActive,
        PRESS("stop", kGuidePaused, "stop"),
        {[](Rig& r) { r.around.supervisor = Supervisor::kFault, r.wait(100); }, State::kGuideError,
         "end cancel"}}},
      {"fails, tries again, fails, gives up",
       {kActive,
        {[](Rig& r) { r.navigate(GoalState::kFailed); }, State::kGuideError, "end cancel"},
        PRESS("yes", kGuideOptions),
        PRESS("foyer", kGuideStart, "start:foyer"),
        {[](Rig& r) { r.around.supervisor = Supervisor::kManual, r.wait(100); }, State::kGuideError,
         "end"},
        PRESS("no", kEndAsk)}},
      {"loses the visitor",
       {{[](Rig& r) { r.see(1.0), r.to_active(); }, State::kGuideActive, ""},
        {[](Rig& r) { r.see_nobody(), r.wait(9000); }, State::kGuideActive, "stop"},
        {[](Rig& r) { r.wait(61000); }, State::kEnd, "end on cancel"},
        {[](Rig& r) { r.around.supervisor = Supervisor::kAvailable, r.wait(4000); },
         State::kInactive, ""}}},
      {"walks ahead, is there",
       {kFollowing,
        {[](Rig& r) { r.see(2.5), r.wait(1000); }, State::kFollowMe, "goal:pose"},
        {[](Rig& r) { r.navigate(GoalState::kActive); }, State::kFollowMe, ""},
        PRESS("done", kEndAsk, "end cancel")}},
      {"walks nowhere", {kFollowing, WAIT(120000, kEndAsk, "end")}},
      {"walks ahead, stops the robot", {kFollowing, PRESS("stop", kEndAsk, "stop end")}},
      {"walks ahead, the robot fails",
       {kFollowing,
        {[](Rig& r) { r.around.supervisor = Supervisor::kFault, r.wait(100); }, State::kGuideError,
         "end"}}},
      {"walks ahead, there is no way, tries again",
       {kFollowing,
        {[](Rig& r) { r.see(3.0), r.wait(1100), r.navigate(GoalState::kReplaced); },
         State::kGuideError, "goal:pose end cancel"},
        PRESS("yes", kGuideAsk)}},
      {"walks ahead, is lost",
       {kFollowing,
        {[](Rig& r) { r.see_nobody(), r.wait(1500); }, State::kFollowMe, "goal:pose"},
        {[](Rig& r) {
           // It looks round, and tries the way again.
           r.navigate(GoalState::kSucceeded), r.drive(58000);
           r.taken(), r.drive(2000);
         },
         State::kEnd, "goal:pose end"}}},
      {"says what it was like",
       {kFeedback,
        PRESS("rating:5", kFeedback),
        PRESS("skip", kFeedback),
        {[](Rig& r) {
           for (int i = 0; i < 11; ++i) r.press("rating:2");
         },
         State::kEnd, ""}}},
      {"has no time for questions",
       {kFeedback, PRESS("rating:1", kFeedback), PRESS("cancel", kEnd)}},
      {"no answer: what it was like", {kFeedback, WAIT(60000, kEnd)}},
      {"leaves: what it was like", {kFeedback, kGone}},
      {"no answer: location", {kToLocationAsk, WAIT(60000, kEnd)}},
      {"no answer: map", {kToLocationAsk, PRESS("yes", kLocationShow), WAIT(60000, kEnd)}},
      {"no answer: which place",
       {kToLocationAsk, PRESS("no", kGuideAsk), PRESS("where_is", kLocationOptions),
        WAIT(60000, kEnd)}},
      {"no answer: guide", {kToLocationAsk, PRESS("no", kGuideAsk), WAIT(60000, kEnd)}},
      {"no answer: where to", {kToOptions, WAIT(60000, kEnd)}},
      {"no answer: ready", {kStart, WAIT(60000, kEnd, "end")}},
      {"no answer: try again",
       {kActive,
        {[](Rig& r) { r.navigate(GoalState::kFailed); }, State::kGuideError, "end cancel"},
        WAIT(60000, kEnd)}},
      {"no answer: anything else", {kToOptions, PRESS("cancel", kEndAsk), WAIT(60000, kEnd)}},
      {"leaves: greeting",
       {{[](Rig& r) {
           Parameters slow;
           slow.introduction = std::chrono::seconds(30);
           r.guide = Guide(slow, book(), 1, {}, {});
           EXPECT_TRUE(r.guide.set_locations(rooms(), r.now()).ok());
           r.wait(100), r.see(1.5), r.wait(1100);
         },
         State::kIntroduction, ""},
        kGone}},
      {"leaves: location", {kToLocationAsk, kGone}},
      {"leaves: map", {kToLocationAsk, PRESS("yes", kLocationShow), kGone}},
      {"leaves: which place",
       {kToLocationAsk, PRESS("no", kGuideAsk), PRESS("where_is", kLocationOptions), kGone}},
      {"leaves: guide", {kToLocationAsk, PRESS("no", kGuideAsk), kGone}},
      {"leaves: where to", {kToOptions, kGone}},
      {"leaves: ready", {kStart, kGoneFromStart}},
      {"leaves: try again",
       {kActive,
        {[](Rig& r) { r.navigate(GoalState::kFailed); }, State::kGuideError, "end cancel"},
        kGone}},
      {"leaves: anything else", {kToOptions, PRESS("cancel", kEndAsk), kGone}},
  };
  return kCases;
}

TEST(Edges, AreAllTakenAndLeadWhereTheTableSays) {
  std::array<std::uint64_t, kEdges.size()> taken{};
  for (const Case& test : cases()) {
    Rig rig;
    int number = 0;
    for (const Step& step : test.steps) {
      SCOPED_TRACE(std::string(test.name) + ", step " + std::to_string(number++));
      step.act(rig);
      ASSERT_EQ(rig.state(), text(step.state));
      ASSERT_EQ(rig.taken(), step.actions);
    }
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] += rig.guide.edges_taken()[i];
  }
  std::size_t covered = 0;
  for (std::size_t i = 0; i < kEdges.size(); ++i) {
    const Edge& edge = kEdges[i];
    std::printf("%4llu  %-16s -> %-16s %s\n", static_cast<unsigned long long>(taken[i]),
                std::string(text(edge.from)).c_str(), std::string(text(edge.to)).c_str(),
                std::string(text(edge.cause)).c_str());
    covered += taken[i] > 0 ? 1 : 0;
  }
  std::printf("edges covered: %zu of %zu\n", covered, kEdges.size());
  EXPECT_EQ(covered, kEdges.size());
}

TEST(Edges, LeaveNoStateWithoutAWayOut) {
  for (std::size_t i = 0; i <= static_cast<std::size_t>(State::kEnd); ++i) {
    const auto state = static_cast<State>(i);
    EXPECT_EQ(state_of(text(state)), state);
    EXPECT_TRUE(std::any_of(kEdges.begin(), kEdges.end(), [&](const Edge& edge) {
      return edge.from == state && edge.to != state;
    })) << text(state);
  }
  EXPECT_FALSE(state_of("nowhere"));
}

}  // namespace
}  // namespace usher::guide
