#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/goal/goal_state.hpp"
#include "foundation/result/result.hpp"
#include "navigation/navigator/core/locations.hpp"
#include "navigation/navigator/core/route.hpp"

namespace usher::navigator {

/// Times are seconds on any clock that does not go back.
struct NavigatorConfig {
  double position_tolerance = 0.25;  ///< [m] of the end of the path; at least the local planner's
  double yaw_tolerance = 0.2;        ///< [rad]
  double settle_time = 0.5;          ///< [s] to stand within the tolerances before it counts
  double settle_speed = 0.05;        ///< [m/s] and [rad/s]: slower counts as standing

  double replan_period = 5.0;    ///< [s] a better path may have appeared; 0 = never
  double replan_interval = 1.0;  ///< [s] least time between plans
  double off_path = 0.6;         ///< [m] farther from the path than this: a new one
  double obstacle_ahead =
      3.0;  ///< [m] an obstacle on the path nearer than this for longer than its wait: a new one
  double keep_path =
      0.05;  ///< a periodic plan whose length differs by a smaller share changes nothing

  double wait_object = 2.0;        ///< [s] blocked by a thing: wait before planning round it
  double wait_person = 8.0;        ///< [s] blocked by somebody, who probably moves
  double recovery_patience = 6.0;  ///< [s] still blocked after the new path: recover
  double stall_time = 15.0;        ///< [s] without getting nearer counts as blocked

  int most_recoveries = 6;         ///< in a row without progress; clear, back off, look, clear, ...
  double near_enough = 0.35;       ///< [m] of the goal: each recovery tried once, it has arrived
  double recovery_progress = 1.0;  ///< [m] on the way that forgives earlier recoveries
  double back_off_distance = 0.3;  ///< [m]
  double rear_margin = 0.2;        ///< [m] room that must stay behind the robot
  double look_angle = 1.57;        ///< [rad] left, next time right
  double clear_time = 1.0;         ///< [s] for sensors to fill the cleared costmap
  double recovery_timeout = 10.0;  ///< [s] for one recovery motion

  int plan_attempts = 3;        ///< failed plans in a row before giving up
  double plan_retry = 1.0;      ///< [s] between them
  double plan_timeout = 5.0;    ///< [s] without an answer is a failed plan
  double ready_timeout = 30.0;  ///< [s] a goal waits for planners that are not there yet
  double pause_timeout = 60.0;  ///< [s] without localization or inputs before giving up
  double hold_timeout = 300.0;  ///< [s] not allowed to drive before giving up; whoever stops the
                                ///< robot has a shorter patience
  double time_base = 180.0;     ///< [s] a goal may take this long, and ...
  double time_factor = 8.0;     ///< ... this many times its longest path at the usual speed

  double usual_speed = 0.5;     ///< [m/s] kept on average along the way, stops for people included
  double turn_time = 2.5;       ///< [s/rad] that a turn takes besides
  double start_time = 3.0;      ///< [s] from standing to driving
  double approach_time = 5.0;   ///< [s] that the last metre takes besides
  double speed_memory = 15.0;   ///< [s] time constant of the measured one
  double degraded_speed = 0.5;  ///< [m/s] limit while localization is degraded
};

/// States of the thesis' navigation thread (6.4.3).
enum class State : std::uint8_t {
  kInitialise,  ///< waits for the planners
  kInactive,    ///< waits for a goal
  kNewRequest,  ///< the goal is known and valid, its first path is being planned
  kActive,      ///< on the way
  kSuccess,     ///< for one step, then inactive
  kFailure,     ///< for one step, then inactive
};

/// What an active navigation does.
enum class Phase : std::uint8_t {
  kPlanning,    ///< stands and waits for a path
  kFollowing,   ///< drives
  kBlocked,     ///< the follower stands before an obstacle and drives on as soon as it can
  kPaused,      ///< stands: localization or an input is missing
  kClearing,    ///< recovery: forgets observed obstacles
  kBackingOff,  ///< recovery
  kLooking,     ///< recovery: turns in place
};

enum class Failure : std::uint8_t {
  kNone,
  kBadGoal,           ///< no id, or a pose that is not finite
  kUnknownLocation,   ///< not in the list of locations
  kNotReady,          ///< the planners did not come up
  kNoPath,            ///< the global planner finds none
  kPlannerSilent,     ///< the global planner does not answer
  kBlocked,           ///< all recoveries used up
  kLocalizationLost,  ///< for longer than the pause may last
  kInputsStale,       ///< for longer than the pause may last
  kHeld,              ///< not allowed to drive for longer than the pause may last
  kTooSlow,           ///< the time for this goal is over
};

struct GoalRequest {
  std::uint64_t id = 0;  ///< unique per client; a repeated one changes nothing
  std::string client;
  std::string location;    ///< empty = use the pose
  geometry::Pose2 pose;    ///< in map
  double max_speed = 0.0;  ///< [m/s] 0 = the planner's own limit
};

struct PlanReply {
  std::uint64_t id = 0;               ///< of the request
  std::string reason;                 ///< why there is no path
  std::vector<geometry::Pose2> path;  ///< in map; empty when it failed
};

struct FollowReport {
  std::uint64_t id = 0;                ///< of the motion that it speaks of
  GoalState state = GoalState::kIdle;  ///< kWaiting = blocked
  std::string reason;
  double obstacle_distance = std::numeric_limits<double>::infinity();  ///< [m] along the path
};

enum class Localization : std::uint8_t { kLost, kDegraded, kGood };

/// What the robot knows now.
struct Situation {
  double time = 0.0;    ///< [s]
  std::string missing;  ///< a planner that is not there ("the global planner"); empty = all are
                        ///< there (Initialise ends)
  std::string stale;    ///< an input that is too old to drive on ("the odometry"); empty = none
  /// Why the robot may not drive now, for people ("movement is switched off"); empty = it may.
  std::string not_allowed_because;
  Localization localization = Localization::kLost;
  std::optional<geometry::Pose2> pose;  ///< in map; absent or not finite counts as lost
  geometry::Twist2 velocity;            ///< measured
  FollowReport follow;
  bool person_ahead = false;  ///< somebody is on_the_way(): what blocks is probably a person
  double rear_clearance =
      0.0;  ///< [m] known to be free behind the robot; 0 when nobody sees behind
};

struct PlanRequest {
  std::uint64_t id = 0;
  geometry::Pose2 start, goal;  ///< in map
};

enum class MotionMode : std::uint8_t { kStop, kFollow, kRotate, kBackOff };

/// What the local planner shall do. A new task has a new id; a new path for the same task keeps it.
struct Motion {
  std::uint64_t id = 0;
  MotionMode mode = MotionMode::kStop;
  double max_speed = 0.0;  ///< [m/s] 0 = the planner's own limit
  double amount = 0.0;     ///< [m] to back off or [rad] to turn, left positive
};

struct NavigationStatus {
  std::uint64_t id = 0;  ///< 0 = no goal yet
  std::string client;
  GoalState state = GoalState::kIdle;
  Failure failure = Failure::kNone;
  std::string reason;  ///< why it waits, failed, or stopped beside the goal; else empty
  std::string location;
  geometry::Pose2 goal;
  double progress = 0.0;                                  ///< 0..1, never falls for one goal
  double remaining = 0.0;                                 ///< [m]
  double eta = std::numeric_limits<double>::quiet_NaN();  ///< [s] from now at the speed kept
                                                          ///< lately; NaN = unknown
  std::uint32_t recoveries = 0;
  std::uint32_t replans = 0;  ///< paths planned for this goal
};

/// What to do after a step. Everything optional is to be sent now and once.
struct Decision {
  std::optional<PlanRequest> plan;  ///< repeated five times a second until answered
  std::optional<Motion>
      motion;  ///< on change, and repeated until the follower names its id; path: Navigator::path()
  bool clear_costmap = false;  ///< forget what was observed around the robot
  std::vector<NavigationStatus>
      asides;  ///< last words about other goals: replaced, or refused while one runs
};

/// Takes goals and leads the robot there with a global planner, a local planner that follows, and
/// patience.
///
/// Pure: time and everything else come as arguments. Call request(), cancel() and plan_reply() as
/// they arrive and step() after each of them and at 5 Hz or faster; carry out its decision. Every
/// goal ends: each wait, retry and recovery has a bound in the configuration.
class Navigator {  // NOLINT(clang-analyzer-optin.performance.Padding): there is one
 public:
  /// The error names the field, its range and what was found. Ids of plans and motions count up
  /// from `first_id`; after a restart it should be larger than any used before.
  static Result<Navigator> create(const NavigatorConfig& config, Locations locations,
                                  std::uint64_t first_id = 1);

  /// The newest goal wins; the same id of the same client changes nothing. A goal that is refused
  /// (kBadGoal, kUnknownLocation) is answered in the status, or aside while another one runs, which
  /// then goes on. A newer goal of the same client within 2 m of the one that the robot drives to
  /// moves that goal: it drives on along its path until there is one to the new place, for a second
  /// at most.
  void request(const GoalRequest& goal);
  /// Another pace for the goal of this id and client while it runs [m/s]; 0 = the planner's own
  /// limit. Returns whether there was one; a pace that is negative or not finite is none.
  bool pace(std::uint64_t id, const std::string& client, double max_speed);
  /// Nobody says a pace any more: the goal's own counts again.
  void forget_pace() { pace_.reset(); }
  /// Ends the goal of this id, or whatever runs for 0. Returns whether there was one.
  bool cancel(std::uint64_t id, const std::string& reason = "cancelled");
  /// Answers other than to the newest plan request are ignored.
  void plan_reply(PlanReply reply);
  Decision step(const Situation& situation);

  /// Whether a point in map lies on the next metres of the path or close beside them.
  bool on_the_way(const geometry::Point2& point) const;

  State state() const { return state_; }
  Phase phase() const { return phase_; }  ///< meaningful in kNewRequest and kActive
  const NavigationStatus& status() const { return status_; }
  /// Whether its goal has no outcome yet.
  bool pursues() const { return open(); }
  const Motion& motion() const { return motion_; }
  /// The path of a motion in mode kFollow.
  const std::vector<geometry::Pose2>& path() const { return route_.path(); }
  const Locations& locations() const { return locations_; }

 private:
  enum class PlanCause : std::uint8_t { kNeeded, kPeriodic, kOffPath, kObstacleAhead, kBlocked };
  struct PendingPlan {
    PlanRequest request;
    PlanCause cause;
    double asked;  // [s] first sent
    double sent;   // [s] last sent
  };

  Navigator(const NavigatorConfig& config, Locations locations, std::uint64_t first_id);
  /// Whether there is a goal without an outcome.
  bool open() const {
    return status_.state == GoalState::kActive || status_.state == GoalState::kWaiting;
  }
  void start(const Situation& s);
  void stop_and_plan(const Situation& s);
  void step_state(const Situation& s);
  void pursue(const Situation& s);
  bool pause_if_unfit(const Situation& s);
  void restart_stall_clock(const Situation& s);
  void track(const Situation& s);
  bool arrived(const Situation& s);
  void handle_reply(const Situation& s);
  void handle_failed_plan(const Situation& s, Failure failure, const std::string& reason);
  bool turns_back(const Situation& s, const Route& route) const;
  bool waits_for_somebody(const Situation& s) const;
  void adopt(const Situation& s, PlanCause cause, std::vector<geometry::Pose2> path);
  void ask_plan(const Situation& s, PlanCause cause);
  void send_plan(const Situation& s);
  void plan(const Situation& s);
  void follow(const Situation& s);
  void wait_blocked(const Situation& s);
  void recover(const Situation& s, Failure failure, const std::string& reason);
  void continue_recovery(const Situation& s);
  void replan_if_due(const Situation& s);
  bool blocked(const Situation& s) const;
  bool follower_speaks(const Situation& s) const { return s.follow.id == motion_.id; }
  void enter(Phase phase, double time);
  void set_motion(MotionMode mode, double amount = 0.0);
  void limit_speed(const Situation& s);
  void send_motion(const Situation& s);
  void finish(GoalState outcome, Failure failure, const std::string& reason);
  double time_left(const Situation& s) const;
  void update_status(const Situation& s);

  NavigatorConfig config_;
  Locations locations_;
  Decision decision_;
  NavigationStatus status_;
  State state_ = State::kInitialise;
  Phase phase_ = Phase::kPlanning;
  Failure pause_cause_ = Failure::kNone;
  bool fresh_ = false;           // a goal was requested, but there was no step yet
  bool moved_ = false;           // the goal that runs was replaced by its own client
  double old_path_since_ = 0.0;  // [s]
  bool old_path_ = false;        // the path leads to the goal before this one
  double phase_since_ = 0.0;

  // The goal.
  double goal_max_speed_ = 0.0;
  std::optional<double> pace_;  // [m/s] instead, while it is said
  double started_at_ = 0.0;
  double longest_ = 0.0;     // [m] way of this goal by the longest of its plans
  std::string waiting_for_;  // for the status while it stands

  // Planning.
  std::uint64_t last_plan_id_ = 0;
  std::optional<PendingPlan> pending_;
  PlanReply reply_;            // id 0 = none
  double next_attempt_ = 0.0;  // [s] no plan is asked for earlier
  int failed_plans_ = 0;

  // On the way.
  Route route_;
  double last_step_ = -std::numeric_limits<double>::infinity();
  double advanced_ = 0.0;    // [m] along all paths of this goal
  double usual_ = 0.5;       // [m/s] of this goal
  double speed_kept_ = 0.0;  // [m/s] lately
  double last_planned_ = 0.0;
  double nearest_ = 0.0;  // [m] least remaining way on this path, for the stall clock
  double nearest_since_ = 0.0;
  double stall_yaw_ = 0.0;  // [rad] when the stall clock was restarted
  int turns_counted_ = 0;   // as progress, since it came nearer
  std::optional<double> standing_since_, obstacle_since_;

  // Blocked and recovering.
  std::optional<double> somebody_at_;  // [s] when somebody was on the way last
  double blocked_since_ = 0.0;
  std::optional<double> replanned_at_;
  int recoveries_in_a_row_ = 0;  // of this goal
  int tried_here_ = 0;           // whatever the goal: what did not help is done over a longer way
  geometry::Pose2 stuck_at_;     // when it last recovered
  bool blocked_by_person_ = false;
  double recovered_at_ = 0.0;  // [m] of advanced_

  Motion motion_;
  bool motion_changed_ = true;
  double motion_sent_ = 0.0;
};

const char* name(State state);
const char* name(Phase phase);
const char* name(Failure failure);

}  // namespace usher::navigator
