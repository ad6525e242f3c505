#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foundation/goal/goal_state.hpp"
#include "tasks/meeting/core/faces.hpp"
#include "tasks/service/core/robot.hpp"

namespace usher::meeting {

/// What navigator or explorer say of a goal.
struct GoalReport {
  std::uint64_t id = 0;  ///< 0: none
  GoalState state = GoalState::kIdle;
  std::string reason;
};

/// What is known of the rest of the robot.
struct Surroundings {
  service::Supervisor supervisor = service::Supervisor::kUnknown;
  bool stopped = false;                     ///< somebody's stop holds
  std::optional<Pose2> pose;                ///< in map; nothing: not localized
  std::optional<GoalReport> navigation;     ///< nothing: the navigator is silent
  std::optional<GoalReport> exploration;    ///< nothing: the explorer is silent
  bool sees = false;                        ///< the face detector is heard
  std::vector<std::string> team{};          ///< robots of the fleet that are heard
  std::map<std::string, Point2> team_at{};  ///< [m] in map, where they are, as far as they say
};

/// Where the navigator shall go.
struct Goal {
  std::uint64_t id = 0;
  std::string location;  ///< empty: the pose
  Pose2 pose;            ///< in map
};

struct Exploration {
  std::uint64_t id = 0;
  bool anew = false;
};

/// What the robot shall turn to while it stands.
enum class Turn : std::uint8_t { kStand, kFace, kSearch };

/// What a step asks of the others. Goals and requests are to be repeated until they are answered.
struct MotionActions {
  std::vector<service::Request> requests;  ///< in this order
  std::optional<Goal> goal;
  std::optional<std::uint64_t> cancel;  ///< of the navigator
  std::optional<Exploration> explore;
  std::optional<std::uint64_t> stop_exploring;
};

struct MotionLimits {
  Time acknowledge = std::chrono::seconds(5);  ///< a goal must be taken by then
  Time silence = std::chrono::seconds(5);      ///< so long nothing is heard of it
  Time depart = std::chrono::seconds(90);      ///< the supervisor must let it go by then
  Time again = std::chrono::seconds(2);        ///< it is asked anew
};

/// One journey after the other: asks the supervisor for the navigation, then navigator or explorer,
/// and gives all of it back.
///
///   resting -> asking -> waiting -> driving -> resting;  a supervisor that forgot is asked anew
class Motion {
 public:
  enum class Outcome : std::uint8_t { kBusy, kArrived, kFailed };

  /// Goals count up from `first_id`.
  Motion(const MotionLimits& limits, std::uint64_t first_id)
      : limits_(limits), last_id_(first_id) {}

  /// Begin; what runs is given up.
  void drive(Goal goal, Time now);
  void explore(bool anew, Time now);
  /// Gives up what runs.
  void rest();
  bool resting() const { return phase_ == Phase::kResting; }
  /// The robot stands and interaction_control may turn it.
  bool may_turn(const Surroundings& robot) const {
    return resting() && robot.supervisor == service::Supervisor::kAvailable && !robot.stopped;
  }

  /// At 5 Hz or faster. kBusy while resting, too.
  Outcome step(const Surroundings& robot, Time now);
  /// Why the last journey failed.
  const std::string& reason() const { return reason_; }
  /// Hands over what is to be asked of the others.
  MotionActions take_actions();
  /// Of the goal that runs, or ran last.
  std::uint64_t goal_id() const { return last_id_; }

 private:
  enum class Phase : std::uint8_t { kResting, kAsking, kWaiting, kDriving };
  void begin(Time now);
  Outcome fail(const std::string& reason);
  Outcome follow(const Surroundings& robot, Time now);
  void go(Time now);
  std::string name() const;

  MotionLimits limits_;
  std::uint64_t last_id_;
  Phase phase_ = Phase::kResting;
  bool exploring_ = false;
  bool anew_ = false;
  Goal goal_;
  bool asked_ = false;  ///< the supervisor, for this journey
  bool acknowledged_ = false;
  Time began_{}, phase_since_{}, heard_{}, held_since_{};
  bool given_back_ = true;  // the supervisor was told that the journey is over
  Time given_back_at_{};
  std::string reason_;
  MotionActions actions_;
};

}  // namespace usher::meeting
