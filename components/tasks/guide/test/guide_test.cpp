#include "tasks/guide/core/guide.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::guide {
namespace {

using std::chrono::milliseconds;

std::vector<Location> rooms() {
  return {{"am218", "AM218"}, {"co239", "CO239"}, {"foyer", "Foyer"}};
}

/// The guide in a robot that is well, with every action written down.
class Visit {
 public:
  Visit() : guide(Parameters{}, 100) {
    EXPECT_TRUE(guide.set_locations(rooms(), {}).ok());
    around.supervisor = Supervisor::kAvailable;
    around.navigation = Navigation{};
    wait(0);
  }

  Guide guide;
  Surroundings around;
  int now_ms = 0;
  std::string done;  ///< actions since the last taken()

  Time now() const { return milliseconds(now_ms); }
  void wait(int ms) {
    const int end = now_ms + ms;
    do {
      now_ms = std::min(now_ms + 100, end);
      note(guide.step(around, now()));
    } while (now_ms < end);
  }
  void press(const std::string& option) { note(guide.answer({guide.screen().id, option}, now())); }
  void navigate(std::uint64_t id, NavigationState state, const char* reason = "") {
    around.navigation = Navigation{id, state, 0.5, 20.0, reason};
    wait(100);
  }
  void note(const Actions& actions) {
    for (const Request& request : actions.requests) {
      const char* const names[] = {"start", "go", "end", "stop", "on"};
      add(names[static_cast<int>(request.kind)] +
          (request.goal.empty() ? std::string() : ":" + request.goal));
    }
    if (actions.goal) {
      add("goal:" + std::to_string(actions.goal->id) + ":" + actions.goal->location);
    }
    if (actions.cancel) add("cancel:" + std::to_string(*actions.cancel));
  }
  void add(const std::string& action) {
    if (!done.empty()) done += ' ';
    done += action;
  }
  std::string taken() { return std::exchange(done, {}); }
  std::string state() const { return std::string(text(guide.state())); }
};

struct Step {
  void (*act)(Visit&);
  State state;
  const char* actions;
};
struct Case {
  const char* name;
  std::vector<Step> steps;
};

const Step kBegin{[](Visit& v) { v.press("start"); }, State::kOptions, ""};
const Step kChoose{[](Visit& v) { v.press("am218"); }, State::kConfirm, "start:am218"};
const Step kGo{[](Visit& v) { v.press("start"); }, State::kGuiding, "go goal:100:am218"};
const Step kMoving{[](Visit& v) {
                     v.around.supervisor = Supervisor::kNavigation;
                     v.navigate(100, NavigationState::kActive);
                   },
                   State::kGuiding, ""};

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"guides, arrives, says goodbye",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kSucceeded); }, State::kArrived, "end"},
        {[](Visit& v) { v.wait(3800); }, State::kArrived, ""},
        {[](Visit& v) { v.wait(200); }, State::kAskMore, ""},
        {[](Visit& v) { v.press("no"); }, State::kEnd, ""},
        {[](Visit& v) { v.wait(4000); }, State::kIdle, ""}}},
      {"guides on to the next place",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kSucceeded); }, State::kArrived, "end"},
        {[](Visit& v) { v.wait(4000); }, State::kAskMore, ""},
        {[](Visit& v) { v.press("yes"); }, State::kOptions, ""},
        {[](Visit& v) { v.press("foyer"); }, State::kConfirm, "start:foyer"},
        {[](Visit& v) { v.press("start"); }, State::kGuiding, "go goal:101:foyer"},
        {[](Visit& v) { v.wait(300); }, State::kGuiding, ""}}},
      {"cancels among the options",
       {kBegin, {[](Visit& v) { v.press("cancel"); }, State::kAskMore, ""}}},
      {"cancels before the start",
       {kBegin, kChoose, {[](Visit& v) { v.press("cancel"); }, State::kAskMore, "end"}}},
      {"cancels on the way",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("cancel"); }, State::kAskMore, "end cancel:100"}}},
      {"stops and goes on",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("stop"); }, State::kPaused, "stop"},
        {[](Visit& v) { v.wait(30000); }, State::kPaused, ""},
        {[](Visit& v) { v.press("continue"); }, State::kGuiding, "on"},
        {[](Visit& v) { v.navigate(100, NavigationState::kSucceeded); }, State::kArrived, "end"}}},
      {"stops and cancels",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("stop"); }, State::kPaused, "stop"},
        {[](Visit& v) { v.press("cancel"); }, State::kAskMore, "end on cancel:100"}}},
      {"stops and is forgotten",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("stop"); }, State::kPaused, "stop"},
        {[](Visit& v) { v.wait(120000); }, State::kEnd, "end on cancel:100"}}},
      {"stops at the goal",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("stop"); }, State::kPaused, "stop"},
        {[](Visit& v) { v.navigate(100, NavigationState::kSucceeded); }, State::kArrived,
         "on end"}}},
      {"no way: another try",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kFailed, "No path"); }, State::kFailed,
         "end cancel:100"},
        {[](Visit& v) { v.around.supervisor = Supervisor::kAvailable; }, State::kFailed, ""},
        {[](Visit& v) { v.press("yes"); }, State::kOptions, ""},
        {[](Visit& v) { v.press("co239"); }, State::kConfirm, "start:co239"},
        {[](Visit& v) { v.press("start"); }, State::kGuiding, "go goal:101:co239"}}},
      {"no way: no more",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kFailed); }, State::kFailed,
         "end cancel:100"},
        {[](Visit& v) { v.press("no"); }, State::kAskMore, ""}}},
      {"the navigator never answers",
       {kBegin,
        kChoose,
        kGo,
        {[](Visit& v) { v.wait(4900); }, State::kGuiding, ""},
        {[](Visit& v) { v.wait(100); }, State::kFailed, "end cancel:100"}}},
      {"the navigator falls silent",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.around.navigation.reset(), v.wait(5000); }, State::kGuiding, ""},
        {[](Visit& v) { v.wait(100); }, State::kFailed, "end cancel:100"}}},
      {"the navigator falls silent for a moment",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.around.navigation.reset(), v.wait(4000); }, State::kGuiding, ""},
        {[](Visit& v) { v.navigate(100, NavigationState::kActive), v.wait(8000); }, State::kGuiding,
         ""}}},
      {"somebody gives another goal",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(7, NavigationState::kActive); }, State::kFailed,
         "end cancel:100"}}},
      {"the old goal's status is not ours",
       {kBegin,
        kChoose,
        kGo,
        {[](Visit& v) { v.navigate(99, NavigationState::kSucceeded), v.wait(3000); },
         State::kGuiding, ""}}},
      {"replaced",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kReplaced); }, State::kFailed,
         "end cancel:100"}}},
      {"cancelled by somebody",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kCancelled); }, State::kFailed,
         "end cancel:100"}}},
      {"an operator takes over",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.around.supervisor = Supervisor::kManual, v.wait(100); }, State::kFailed,
         "end cancel:100"}}},
      {"a fault before the start",
       {kBegin,
        kChoose,
        {[](Visit& v) { v.around.supervisor = Supervisor::kFault, v.wait(100); }, State::kFailed,
         "end"}}},
      {"a fault while stopped",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.press("stop"); }, State::kPaused, "stop"},
        {[](Visit& v) { v.around.supervisor = Supervisor::kFault, v.wait(100); }, State::kFailed,
         "end on cancel:100"}}},
      {"a loss that passes",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.around.supervisor = Supervisor::kInactive, v.wait(50000); },
         State::kGuiding, ""},
        {[](Visit& v) { v.around.supervisor = Supervisor::kNavigation, v.wait(50000); },
         State::kGuiding, ""},
        {[](Visit& v) { v.navigate(100, NavigationState::kSucceeded); }, State::kArrived, "end"}}},
      {"a loss that stays",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.around.supervisor = Supervisor::kUnknown, v.wait(60000); },
         State::kGuiding, ""},
        {[](Visit& v) { v.wait(100); }, State::kFailed, "end cancel:100"}}},
      {"the supervisor never navigates",
       {kBegin,
        kChoose,
        kGo,
        {[](Visit& v) { v.navigate(100, NavigationState::kActive), v.wait(59900); },
         State::kGuiding, ""},
        {[](Visit& v) { v.wait(100); }, State::kFailed, "end cancel:100"}}},
      {"the supervisor refuses",
       {kBegin,
        kChoose,
        {[](Visit& v) { v.note(v.guide.refused("a fault must be cleared first", v.now())); },
         State::kFailed, "end"}}},
      {"a refusal while nothing is asked",
       {kBegin, {[](Visit& v) { v.note(v.guide.refused("late", v.now())); }, State::kOptions, ""}}},
      {"no answer to: which place",
       {kBegin,
        {[](Visit& v) { v.wait(59900); }, State::kOptions, ""},
        {[](Visit& v) { v.wait(100); }, State::kEnd, ""}}},
      {"no answer to: ready",
       {kBegin, kChoose, {[](Visit& v) { v.wait(60000); }, State::kEnd, "end"}}},
      {"no answer to: another try",
       {kBegin,
        kChoose,
        kGo,
        kMoving,
        {[](Visit& v) { v.navigate(100, NavigationState::kFailed); }, State::kFailed,
         "end cancel:100"},
        {[](Visit& v) { v.wait(60000); }, State::kEnd, ""}}},
      {"no answer to: anything else",
       {kBegin,
        {[](Visit& v) { v.press("cancel"); }, State::kAskMore, ""},
        {[](Visit& v) { v.wait(60000); }, State::kEnd, ""}}},
      {"greets a visitor who comes near, once",
       {{[](Visit& v) { v.around.visitor_near = true, v.wait(100); }, State::kGreeting, ""},
        {[](Visit& v) { v.wait(2000); }, State::kOptions, ""},
        {[](Visit& v) { v.press("cancel"); }, State::kAskMore, ""},
        {[](Visit& v) { v.press("no"); }, State::kEnd, ""},
        {[](Visit& v) { v.wait(20000); }, State::kIdle, ""},
        {[](Visit& v) { v.around.visitor_near = false, v.wait(100); }, State::kIdle, ""},
        {[](Visit& v) { v.around.visitor_near = true, v.wait(100); }, State::kGreeting, ""}}},
  };
  return kCases;
}

TEST(Guide, FollowsTheTable) {
  for (const Case& test : cases()) {
    Visit visit;
    int number = 0;
    for (const Step& step : test.steps) {
      SCOPED_TRACE(std::string(test.name) + ", step " + std::to_string(number++));
      step.act(visit);
      EXPECT_EQ(visit.state(), text(step.state));
      EXPECT_EQ(visit.taken(), step.actions);
    }
  }
}

TEST(Guide, SpeaksTheSentencesOfTheThesis) {
  Visit visit;
  EXPECT_EQ(visit.guide.screen().title, "Hello, I am MARVIN.");
  EXPECT_EQ(visit.guide.screen().state, "inactive");
  visit.press("start");
  EXPECT_EQ(visit.guide.screen().title, "Where would you like to go?");
  ASSERT_EQ(visit.guide.screen().options.size(), 4U);
  EXPECT_EQ(visit.guide.screen().options[0], (Option{"am218", "AM218", OptionKind::kOption}));
  EXPECT_EQ(visit.guide.screen().options[3], (Option{"cancel", "Cancel", OptionKind::kNo}));
  visit.press("am218");
  EXPECT_EQ(visit.guide.screen().title, "I will take you to AM218.");
  EXPECT_EQ(visit.guide.screen().text, "Tell me when you are ready to go.");
  visit.press("start");
  EXPECT_EQ(visit.guide.screen().text, "All right, let's go. Tell me if we need to stop.");
  visit.navigate(100, NavigationState::kFailed, "No path to AM218");
  EXPECT_EQ(visit.guide.screen().title, "Sorry, I was unable to guide you.");
  EXPECT_EQ(visit.guide.screen().text, "No path to AM218. Would you like to try again?");
}

TEST(Guide, IgnoresStaleRepeatedAndForeignAnswers) {
  Visit visit;
  const std::uint64_t idle = visit.guide.screen().id;
  visit.press("start");
  const std::uint64_t options = visit.guide.screen().id;
  EXPECT_GT(options, idle);
  visit.note(visit.guide.answer({idle, "start"}, visit.now()));     // a touch that comes late
  visit.note(visit.guide.answer({options, "start"}, visit.now()));  // not on this screen
  visit.note(visit.guide.answer({options + 1, "am218"}, visit.now()));
  visit.note(visit.guide.answer({0, ""}, visit.now()));
  EXPECT_EQ(visit.state(), "guide_options");
  EXPECT_EQ(visit.guide.ignored_answers(), 4U);
  visit.note(visit.guide.answer({options, "am218"}, visit.now()));
  visit.note(visit.guide.answer({options, "am218"}, visit.now()));  // repeated
  visit.note(visit.guide.answer({options, "co239"}, visit.now()));  // the second of two voices
  EXPECT_EQ(visit.state(), "guide_start");
  EXPECT_EQ(visit.taken(), "start:am218");
}

TEST(Guide, ShowsProgressUnderTheSameScreenAndNotTooOften) {
  Visit visit;
  visit.press("start");
  visit.press("am218");
  visit.press("start");
  visit.around.supervisor = Supervisor::kNavigation;
  const std::uint64_t id = visit.guide.screen().id;
  int updates = 0;
  for (int i = 0; i < 100; ++i) {
    visit.now_ms += 100;
    visit.around.navigation =
        Navigation{100, NavigationState::kActive, 0.01 * i, 30.0 - 0.1 * i, ""};
    updates += visit.guide.step(visit.around, visit.now()).screen_changed ? 1 : 0;
  }
  EXPECT_EQ(visit.guide.screen().id, id);
  EXPECT_GT(visit.guide.screen().progress, 0.85);
  EXPECT_LT(visit.guide.screen().eta, 22.0);
  EXPECT_GE(updates, 9);
  EXPECT_LE(updates, 11);
  visit.navigate(100, NavigationState::kWaiting);
  EXPECT_EQ(visit.guide.screen().text, "Something is in the way. I am waiting until we can go on.");
  visit.press("stop");
  EXPECT_EQ(visit.state(), "guide_paused") << "the button is still the button";
}

TEST(Guide, ProgressThatIsNotANumberIsNone) {
  Visit visit;
  visit.press("start");
  visit.press("am218");
  visit.press("start");
  visit.around.navigation = Navigation{100, NavigationState::kActive, std::nan(""), 1.0, ""};
  visit.wait(2000);
  EXPECT_EQ(visit.guide.screen().progress, 0.0);
}

TEST(Guide, OffersNothingWhileTheRobotIsNotReady) {
  Visit visit;
  for (const Supervisor supervisor :
       {Supervisor::kUnknown, Supervisor::kNotReady, Supervisor::kInactive, Supervisor::kManual,
        Supervisor::kFault}) {
    visit.around.supervisor = supervisor;
    visit.around.visitor_near = true;
    visit.wait(5000);
    EXPECT_EQ(visit.guide.state(), State::kIdle);
    EXPECT_TRUE(visit.guide.screen().options.empty());
    EXPECT_FALSE(visit.guide.screen().text.empty());
  }
  visit.around.visitor_near.reset();
  visit.around.supervisor = Supervisor::kAvailable;
  visit.wait(100);
  EXPECT_EQ(visit.guide.screen().options.size(), 1U);
}

TEST(Guide, KnowsNoPlacesUntilItIsTold) {
  Guide guide({}, 1);
  Surroundings around;
  around.supervisor = Supervisor::kAvailable;
  guide.step(around, Time(0));
  EXPECT_EQ(guide.screen().text, "I do not know any places yet.");
  ASSERT_TRUE(guide.set_locations(rooms(), Time(0)).ok());
  EXPECT_EQ(guide.screen().options.size(), 1U);
}

TEST(Guide, PutsManyPlacesOnPages) {
  Visit visit;
  std::vector<Location> many;
  for (int i = 0; i < 20; ++i) many.push_back({"room" + std::to_string(i), ""});
  ASSERT_TRUE(visit.guide.set_locations(many, visit.now()).ok());
  visit.press("start");
  std::set<std::string> seen;
  for (int page = 0; page < 4; ++page) {
    EXPECT_LE(visit.guide.screen().options.size(), 8U);
    for (const Option& option : visit.guide.screen().options) seen.insert(option.id);
    visit.press("more");
  }
  EXPECT_EQ(seen.size(), 22U) << "all rooms, more, cancel";
  EXPECT_EQ(visit.guide.screen().options[0].id, "room0") << "round again";
  EXPECT_EQ(visit.guide.screen().options[0].label, "room0") << "a name where there is no title";
}

TEST(Guide, RefusesPlacesThatNoButtonCanName) {
  Guide guide({}, 1);
  const Status cancel = guide.set_locations({{"cancel", "Cancel"}}, Time(0));
  ASSERT_FALSE(cancel.ok());
  EXPECT_NE(cancel.error().find("'cancel'"), std::string::npos);
  EXPECT_FALSE(guide.set_locations({{"", "?"}}, Time(0)).ok());
  EXPECT_FALSE(guide.set_locations({{"a", "A"}, {"a", "B"}}, Time(0)).ok());
}

// Whatever visitor, navigator and supervisor do: option ids are unique, questions can be answered,
// the screen's id never goes back, and a robot left alone comes to idle.
TEST(Guide, HasNoDeadEnd) {
  Random random(11);
  for (int run = 0; run < 300; ++run) {
    Visit visit;
    std::uint64_t last_id = 0;
    for (int i = 0; i < 300; ++i) {
      const auto& options = visit.guide.screen().options;
      if (random.below(2) == 0 && !options.empty()) {
        visit.press(options[random.below(options.size())].id);
      }
      visit.around.supervisor =
          static_cast<Supervisor>(random.below(20) == 0 ? random.below(7) : 3);
      visit.around.visitor_near = random.below(3) == 0;
      if (random.below(4) == 0) {
        visit.around.navigation = Navigation{
            100 + random.below(4), static_cast<NavigationState>(random.below(7)), 0.3, 4.0, "why"};
      }
      if (random.below(30) == 0) visit.around.navigation.reset();
      visit.wait(static_cast<int>(random.below(3000)));
      const Screen& screen = visit.guide.screen();
      ASSERT_GE(screen.id, last_id);
      ASSERT_FALSE(screen.title.empty());
      std::set<std::string> ids;
      for (const Option& option : screen.options) {
        ASSERT_TRUE(ids.insert(option.id).second);
        ASSERT_FALSE(option.label.empty());
      }
      last_id = screen.id;
    }
    visit.around.supervisor = Supervisor::kAvailable;
    visit.around.navigation = Navigation{1, NavigationState::kIdle, 0.0, 0.0, ""};
    visit.around.visitor_near = false;
    visit.wait(400000);
    ASSERT_EQ(visit.guide.state(), State::kIdle) << "run " << run;
  }
}

}  // namespace
}  // namespace usher::guide
