#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tasks/guide/core/guide.hpp"

namespace usher::guide {

using std::chrono::milliseconds;

inline std::vector<Location> rooms() {
  return {{"am218", "AM218", {1, 0}}, {"co239", "CO239", {5, 0}}, {"foyer", "Foyer", {9, 0}}};
}

inline phrases::PhraseBook book(const std::vector<std::string>& tags = {"en", "mi", "de", "fr"}) {
  auto book =
      phrases::PhraseBook::load(USHER_SOURCE_DIR "/config/dialogue", tags, "guide", kTextKeys);
  EXPECT_TRUE(book.ok()) << (book.ok() ? "" : book.error());
  return std::move(book).value();
}

/// With a greeting that is soon over.
inline Parameters quick() {
  Parameters parameters;
  parameters.introduction = std::chrono::seconds(3);
  return parameters;
}

/// The guide in a robot that is well, with every action written down.
class Rig {
 public:
  explicit Rig(const Parameters& parameters = quick(), const Memory& memory = {},
               std::uint64_t first_id = 100)
      : guide(parameters, book(), first_id, memory, {}) {
    EXPECT_TRUE(guide.set_locations(rooms(), {}).ok());
    around.supervisor = Supervisor::kAvailable;
    around.navigation = Navigation{};
    around.pose = geometry::Pose2{4.8, 0.5, 0.0};
    wait(100);
  }

  Guide guide;
  Surroundings around;
  int now_ms = 0;
  std::string done;  ///< actions since the last taken()
  std::uint64_t goal = 0;
  std::optional<geometry::Pose2> goal_pose;
  std::vector<std::string> said;
  int toned_ms = -1;  ///< when the last tone before a motion sounded
  std::vector<guide::Visit> visits;
  double pace = -1.0;

  Time now() const { return milliseconds(now_ms); }
  void wait(int ms) {
    const int end = now_ms + ms;
    do {
      now_ms = std::min(now_ms + 100, end);
      note(guide.step(around, now()));
    } while (now_ms < end);
  }
  void press(const std::string& option) {
    note(guide.answer({guide.screen().id, option, "", Input::kTouch}, now()));
  }
  void type(const std::string& text) {
    note(guide.answer({guide.screen().id, "query", text, Input::kTouch}, now()));
  }
  /// The navigator says this of the guide's goal.
  void navigate(GoalState state) {
    if (!around.navigation) around.navigation = Navigation{};
    around.navigation->goal_id = goal;
    around.navigation->state = state;
    wait(100);
  }
  /// Time passes, and the navigator reaches every goal at once.
  void drive(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      wait(100);
      if (around.navigation->goal_id != goal) navigate(GoalState::kSucceeded);
    }
  }
  void see(double x, double speed = 0.0) { see_at(x, 0.0, speed); }
  void see_at(double x, double y, double speed) {
    around.visitor = VisitorSighting{true, x, y, speed};
    if (around.pose) around.visitor->in_map = *around.pose * geometry::Point2{x, y};
  }
  /// Somebody stands before the robot.
  void meet(std::uint64_t person) {
    see(1.5);
    around.visitor->person = person;
  }
  void see_nobody() { around.visitor = VisitorSighting{}; }

  // Shortcuts into the dialogue; each asserts nothing.
  void begin() { press("language:en"); }
  void to_location_ask() { begin(), wait(3000); }
  void to_options() { to_location_ask(), press("guide_me"); }
  void to_start() { to_options(), press("am218"); }
  void to_active() {
    to_start(), press("start");
    around.supervisor = Supervisor::kNavigation;
    wait(1000);
    navigate(GoalState::kActive);
    done.clear();
  }

  void to_following() {
    see(1.2), to_location_ask(), press("no"), press("follow_me");
    around.supervisor = Supervisor::kNavigation;
    wait(100);
    done.clear();
  }
  void speak_and_move() { around.speech = Speech{~0ULL, true, true}, around.torso = true; }
  void to_end_ask() { to_active(), navigate(GoalState::kSucceeded), wait(4000); }
  void to_feedback() { to_end_ask(), speak_and_move(), wait(100), press("no"); }

  void note(const Actions& actions) {
    for (const Request& request : actions.requests) {
      const char* const names[] = {"start", "go", "end", "stop", "on"};
      add(names[static_cast<int>(request.kind)] +
          (request.goal.empty() ? std::string() : ":" + request.goal));
    }
    if (actions.goal) {
      goal = actions.goal->id;
      goal_pose = actions.goal->pose;
      add("goal:" + (goal_pose ? "pose" : actions.goal->location));
    }
    if (actions.cancel) {
      EXPECT_EQ(*actions.cancel, goal);
      add("cancel");
    }
    if (actions.pace) pace = *actions.pace;
    if (actions.visit) visits.push_back(*actions.visit);
    const Screen& screen = guide.screen();
    if (screen.spoken_id != spoken_id_) {
      spoken_id_ = screen.spoken_id;
      if (screen.tone == Tone::kMoving) toned_ms = now_ms;
      if (!screen.spoken.empty()) said.push_back(screen.spoken);
    }
  }
  std::string taken() { return std::exchange(done, {}); }
  std::string state() const { return std::string(text(guide.state())); }
  bool offers(const std::string& id) const {
    const auto& options = guide.screen().options;
    return std::any_of(options.begin(), options.end(),
                       [&](const Option& option) { return option.id == id; });
  }

 private:
  void add(const std::string& action) {
    if (!done.empty()) done += ' ';
    done += action;
  }
  std::uint64_t spoken_id_ = 0;
};

}  // namespace usher::guide
