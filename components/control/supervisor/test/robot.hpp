#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "control/supervisor/core/supervisor.hpp"

namespace usher::supervisor {

using geometry::Twist2;
using std::chrono::milliseconds;

inline constexpr std::uint64_t kDigest = 5;
inline constexpr WriterId kMovement{1};
inline constexpr WriterId kMovementHeartbeat{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9};
inline constexpr WriterId kReplacement{2};
inline constexpr WriterId kRogue{66};
inline constexpr const char* kDrive = "drive/command";

inline Parameters parameters() {
  Parameters parameters;
  parameters.components = {
      {"movement_control", Criticality::kStop, milliseconds(100)},
      {"segway_rmp", Criticality::kStop, milliseconds(100)},
      {"amcl", Criticality::kStop, milliseconds(100)},
      {"people_detector", Criticality::kDegrade, milliseconds(300)},
      {"interaction_control", Criticality::kNotify, milliseconds(300)},
      {"tablet", Criticality::kNotify, milliseconds(300)},
  };
  parameters.idl_digest = kDigest;
  return parameters;
}

/// A supervisor whose robot is well unless a test says otherwise.
class Robot {
 public:
  explicit Robot(const Parameters& given = parameters(), Memory memory = {})
      : supervisor(given, std::move(memory)) {}

  Supervisor supervisor;
  std::set<std::string> silent;
  std::set<std::string> starting;
  std::set<std::string> other_idl;
  bool base_unheard = false;  ///< though its driver lives
  BaseReport base;
  Twist2 command;
  int now_ms = 0;

  Time now() const { return milliseconds(now_ms); }
  void appear(const WriterId& writer = kMovement, const char* name = "movement_control") {
    supervisor.writer_appeared(kDrive, {writer, name, "nuc"}, now());
  }
  /// Runs for a while at 50 Hz.
  const Decision& run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 20;
      for (const WatchedComponent& component : parameters().components) {
        if (silent.contains(component.name)) continue;
        const WriterId writer =
            component.name == "movement_control" ? kMovementHeartbeat : WriterId{99};
        const Reported state =
            starting.contains(component.name) ? Reported::kStarting : Reported::kOk;
        supervisor.heartbeat({component.name, writer,
                              kDigest + (other_idl.contains(component.name) ? 1U : 0U), state, ""},
                             now());
      }
      if (!silent.contains("movement_control")) {
        supervisor.drive_command(kMovement, command, now());
      }
      if (!silent.contains("segway_rmp") && !base_unheard) supervisor.base(base, now());
      supervisor.step(now());
    }
    return supervisor.decision();
  }
  Answer ask(Command what, const char* goal = "") {
    Answer answer = supervisor.request({++request_id, "operator", what, goal}, now());
    supervisor.step(now());
    return answer;
  }
  bool granted() const { return supervisor.decision().grant.writer != drive::kNobody; }
  State state() const { return supervisor.decision().state; }
  std::string reason() const { return std::string(supervisor.decision().reason); }

  std::uint64_t request_id = 0;
};

inline Robot ready() {
  Robot robot;
  robot.appear();
  robot.run(400);
  return robot;
}

inline Robot guiding() {
  Robot robot = ready();
  EXPECT_TRUE(robot.ask(Command::kNavigationStart, "am218").done);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kNavigationStart);
  EXPECT_TRUE(robot.ask(Command::kNavigationGo).done);
  robot.supervisor.navigation(41, GoalState::kActive);
  robot.run(100);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  return robot;
}

}  // namespace usher::supervisor
