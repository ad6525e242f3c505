#include "control/supervisor/core/behavior.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace usher::supervisor {
namespace {

using std::chrono::milliseconds;

TEST(Behavior, EnablesWhatTable61Enables) {
  using enum State;
  for (const State state : {kInitialise, kInactive, kNavigationStart, kNavigationEnd, kFault}) {
    EXPECT_EQ(enables_of(state), Enables{}) << text(state);
  }
  EXPECT_EQ(enables_of(kInteraction), (Enables{true, false, true, false, true}));
  EXPECT_EQ(enables_of(kNavigationActive), (Enables{true, false, false, true, false}));
  EXPECT_EQ(enables_of(kManual), (Enables{true, true, false, false, false}));
}

enum class Do {
  kNothing,
  kManualOn,
  kManualOff,
  kStart,
  kGo,
  kEnd,
  kLose,
  kRegain,
  kLatch,
  kClear,
};

struct Step {
  int ms;
  Do event;
  State expected;
};
struct Case {
  const char* name;
  std::vector<Step> steps;
};

const std::vector<Case>& cases() {
  using enum Do;
  using enum State;
  // Each run starts able and without a fault in Initialise; the dwell is 250 ms.
  static const std::vector<Case> kCases{
      {"starts into interaction",
       {{0, kNothing, kInactive}, {249, kNothing, kInactive}, {250, kNothing, kInteraction}}},
      {"initialises until all is there",
       {{0, kLose, kInitialise},
        {5000, kNothing, kInitialise},
        {5001, kRegain, kInactive},
        {5251, kNothing, kInteraction}}},
      {"a fault while initialising",
       {{0, kLatch, kFault}, {10, kClear, kInactive}, {260, kNothing, kInteraction}}},
      {"guides from start to end",
       {{0, kNothing, kInactive},
        {250, kNothing, kInteraction},
        {1000, kStart, kInactive},
        {1249, kNothing, kInactive},
        {1250, kNothing, kNavigationStart},
        {9000, kNothing, kNavigationStart},
        {9001, kGo, kNavigationActive},
        {60000, kNothing, kNavigationActive},
        {60001, kEnd, kNavigationEnd},
        {60250, kNothing, kNavigationEnd},
        {60251, kNothing, kInactive},
        {60501, kNothing, kInteraction}}},
      {"a visitor who gives up before the start",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {300, kEnd, kNavigationEnd},
        {550, kNothing, kInactive},
        {800, kNothing, kInteraction}}},
      {"an end in Inactive needs no Navigation end",
       {{0, kNothing, kInactive},
        {250, kNothing, kInteraction},
        {300, kStart, kInactive},
        {310, kEnd, kInactive},
        {550, kNothing, kInteraction}}},
      {"go before its state waits for it",
       {{0, kNothing, kInactive},
        {250, kNothing, kInteraction},
        {300, kStart, kInactive},
        {310, kGo, kInactive},
        {550, kNothing, kNavigationActive}}},
      {"go without a goal does nothing",
       {{0, kNothing, kInactive}, {250, kNothing, kInteraction}, {300, kGo, kInteraction}}},
      {"a new goal while driving begins anew",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {260, kGo, kNavigationActive},
        {500, kStart, kInactive},
        {750, kNothing, kNavigationStart},
        {760, kGo, kNavigationActive}}},
      {"an operator takes over and gives back",
       {{0, kNothing, kInactive},
        {250, kNothing, kInteraction},
        {300, kManualOn, kInactive},
        {550, kNothing, kManual},
        {9000, kNothing, kManual},
        {9001, kManualOff, kInactive},
        {9251, kNothing, kInteraction}}},
      {"an operator ends the guidance",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {260, kGo, kNavigationActive},
        {500, kManualOn, kInactive},
        {750, kNothing, kManual},
        {800, kManualOff, kInactive},
        {1050, kNothing, kInteraction}}},
      {"an operator interrupts Navigation start",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {300, kManualOn, kInactive},
        {550, kNothing, kManual}}},
      {"an operator interrupts Navigation end",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {260, kGo, kNavigationActive},
        {300, kEnd, kNavigationEnd},
        {310, kManualOn, kInactive},
        {560, kNothing, kManual}}},
      {"a loss while guiding resumes through Inactive",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {260, kGo, kNavigationActive},
        {500, kLose, kInactive},
        {5000, kNothing, kInactive},
        {5001, kRegain, kInactive},
        {5250, kNothing, kInactive},
        {5251, kNothing, kNavigationActive}}},
      {"a loss in Interaction, Manual, Navigation start and end",
       {{0, kNothing, kInactive},
        {250, kNothing, kInteraction},
        {300, kLose, kInactive},
        {310, kRegain, kInactive},
        {560, kManualOn, kManual},
        {600, kLose, kInactive},
        {610, kRegain, kInactive},
        {860, kNothing, kManual},
        {900, kManualOff, kInactive},
        {910, kStart, kInactive},
        {1150, kNothing, kNavigationStart},
        {1160, kLose, kInactive},
        {1170, kRegain, kInactive},
        {1420, kNothing, kNavigationStart},
        {1430, kEnd, kNavigationEnd},
        {1440, kLose, kInactive},
        {1450, kRegain, kInactive},
        {1700, kNothing, kInteraction}}},
      {"a loss that flickers restarts the dwell",
       {{0, kNothing, kInactive},
        {200, kLose, kInactive},
        {210, kRegain, kInactive},
        {250, kNothing, kInactive},
        {459, kNothing, kInactive},
        {460, kNothing, kInteraction}}},
      {"a fault forgets the guidance",
       {{0, kNothing, kInactive},
        {250, kStart, kNavigationStart},
        {260, kGo, kNavigationActive},
        {500, kLatch, kFault},
        {5000, kNothing, kFault},
        {5001, kClear, kInactive},
        {5251, kNothing, kInteraction}}},
      {"a fault forgets the operator",
       {{0, kNothing, kInactive},
        {250, kManualOn, kManual},
        {300, kLatch, kFault},
        {310, kClear, kInactive},
        {560, kNothing, kInteraction}}},
      {"a fault in every other state",
       {{0, kLatch, kFault},
        {10, kClear, kInactive},
        {20, kLatch, kFault},
        {30, kClear, kInactive},
        {280, kNothing, kInteraction},
        {290, kLatch, kFault},
        {300, kClear, kInactive},
        {550, kStart, kNavigationStart},
        {560, kLatch, kFault},
        {570, kClear, kInactive},
        {820, kStart, kNavigationStart},
        {830, kEnd, kNavigationEnd},
        {840, kLatch, kFault}}},
      {"a fault is stronger than a loss",
       {{0, kNothing, kInactive},
        {10, kLose, kInactive},
        {20, kLatch, kFault},
        {30, kClear, kInactive},
        {1000, kNothing, kInactive},
        {1001, kRegain, kInactive},
        {1251, kNothing, kInteraction}}},
  };
  return kCases;
}

TEST(Behavior, FollowsFigure69) {
  std::set<std::pair<State, State>> seen;
  for (const Case& test : cases()) {
    Behavior behavior(milliseconds(250));
    bool able = true;
    bool fault = false;
    for (const Step& step : test.steps) {
      SCOPED_TRACE(std::string(test.name) + " at " + std::to_string(step.ms));
      switch (step.event) {
        case Do::kNothing:
          break;
        case Do::kManualOn:
          behavior.manual(true);
          break;
        case Do::kManualOff:
          behavior.manual(false);
          break;
        case Do::kStart:
          behavior.navigation_start();
          break;
        case Do::kGo:
          behavior.navigation_go();
          break;
        case Do::kEnd:
          behavior.navigation_end();
          break;
        case Do::kLose:
          able = false;
          break;
        case Do::kRegain:
          able = true;
          break;
        case Do::kLatch:
          fault = true;
          break;
        case Do::kClear:
          fault = false;
          break;
      }
      const State before = behavior.state();
      const State state = behavior.step(able, fault, milliseconds(step.ms));
      EXPECT_EQ(text(state), text(step.expected));
      EXPECT_EQ(behavior.step(able, fault, milliseconds(step.ms)), state) << "settles at once";
      if (before != state) seen.insert({before, state});
    }
  }
  // Every edge of the machine was driven, and no other.
  using enum State;
  const std::set<std::pair<State, State>> edges{
      {kInitialise, kInactive},
      {kInitialise, kFault},
      {kInactive, kInteraction},
      {kInactive, kNavigationStart},
      {kInactive, kNavigationActive},
      {kInactive, kManual},
      {kInactive, kFault},
      {kInteraction, kInactive},
      {kInteraction, kFault},
      {kNavigationStart, kNavigationActive},
      {kNavigationStart, kNavigationEnd},
      {kNavigationStart, kInactive},
      {kNavigationStart, kFault},
      {kNavigationActive, kNavigationEnd},
      {kNavigationActive, kInactive},
      {kNavigationActive, kFault},
      {kNavigationEnd, kInactive},
      {kNavigationEnd, kFault},
      {kManual, kInactive},
      {kManual, kFault},
      {kFault, kInactive},
  };
  EXPECT_EQ(seen, edges);
}

TEST(Behavior, TwoNewGoalsBetweenTwoStepsEndTheJourneyAsOneDoes) {
  Behavior behavior(milliseconds(250));
  auto run = [&, now = milliseconds(0)](int ms) mutable {
    for (const auto end = now + milliseconds(ms); now < end;)
      behavior.step(true, false, now += milliseconds(10));
    return behavior.state();
  };
  run(300);
  behavior.navigation_start();
  run(300);
  behavior.navigation_go();
  ASSERT_EQ(run(300), State::kNavigationActive);
  behavior.navigation_start();
  behavior.navigation_start();
  EXPECT_EQ(run(10), State::kInactive);
  EXPECT_EQ(run(300), State::kNavigationStart);
}

}  // namespace
}  // namespace usher::supervisor
