#include "navigation/navigator/core/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "foundation/result/bounds.hpp"

namespace usher::navigator {
namespace {

constexpr double kRepeat = 0.2 - 1e-6;  // [s] between repetitions of what was not answered
constexpr double kProgress = 0.1;       // [m] nearer to the goal than ever restarts the stall clock
constexpr double kTurned = 0.35;        // [rad] a slow turn is progress too,
constexpr int kMostTurns = 12;          // but not to turn and turn again
constexpr double kAsLately = 5.0;       // [m] ahead are driven as fast as the last ones,
constexpr double kSlowestKept = 0.1;    // [m/s] and no slower than this
constexpr double kStarted = 0.5;        // [m] of the way
constexpr double kApproach = 1.0;       // [m] before its end
constexpr double kStands = 0.1;         // [m/s]
constexpr double kTurns = 0.1;          // [rad/s]
constexpr double kMoved = 2.0;          // [m] a newer goal so near to the one that runs moves it
constexpr double kOldPath = 1.0;        // [s] its path is driven on until there is a new one
constexpr double kBarred = 1.5;         // [s] a recovery that cannot begin ends
constexpr int kRecoveryKinds = 3;
constexpr double kPersonAhead = 3.0;   // [m] along the path,
constexpr double kPersonBeside = 0.8;  // [m] beside it: half a robot, half a person and some room

std::string text(const char* format, double value) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string no_word_from(const std::string& whom) { return "no word from " + whom; }

bool finite(const std::vector<geometry::Pose2>& path) {
  return std::ranges::all_of(path, &geometry::Pose2::finite);
}

/// Bounds of every field: what is outside makes no sense, and nothing may wait forever.
Status check(const NavigatorConfig& c) {
  return within({{"position_tolerance", c.position_tolerance, 0.01, 2.0},
                 {"yaw_tolerance", c.yaw_tolerance, 0.01, 3.2},
                 {"settle_time", c.settle_time, 0.0, 10.0},
                 {"settle_speed", c.settle_speed, 0.001, 0.5},
                 {"replan_period", c.replan_period, 0.0, 600.0},
                 {"replan_interval", c.replan_interval, 0.1, 60.0},
                 {"off_path", c.off_path, 0.1, 10.0},
                 {"obstacle_ahead", c.obstacle_ahead, 0.0, 20.0},
                 {"keep_path", c.keep_path, 0.0, 1.0},
                 {"wait_object", c.wait_object, 0.0, 120.0},
                 {"wait_person", c.wait_person, c.wait_object, 120.0},
                 {"recovery_patience", c.recovery_patience, 0.1, 120.0},
                 {"stall_time", c.stall_time, 1.0, 120.0},
                 {"most_recoveries", static_cast<double>(c.most_recoveries), 0.0, 100.0},
                 {"near_enough", c.near_enough, 0.0, 2.0},
                 {"recovery_progress", c.recovery_progress, 0.1, 100.0},
                 {"back_off_distance", c.back_off_distance, 0.0, 2.0},
                 {"rear_margin", c.rear_margin, 0.0, 2.0},
                 {"look_angle", c.look_angle, 0.1, 6.3},
                 {"clear_time", c.clear_time, 0.0, 30.0},
                 {"recovery_timeout", c.recovery_timeout, 0.5, 120.0},
                 {"plan_attempts", static_cast<double>(c.plan_attempts), 1.0, 100.0},
                 {"plan_retry", c.plan_retry, 0.1, 60.0},
                 {"plan_timeout", c.plan_timeout, 0.5, 60.0},
                 {"ready_timeout", c.ready_timeout, 0.0, 600.0},
                 {"pause_timeout", c.pause_timeout, 0.0, 600.0},
                 {"hold_timeout", c.hold_timeout, 0.0, 3600.0},
                 {"time_base", c.time_base, 1.0, 36000.0},
                 {"time_factor", c.time_factor, 1.0, 1000.0},
                 {"usual_speed", c.usual_speed, 0.05, 5.0},
                 {"turn_time", c.turn_time, 0.0, 60.0},
                 {"start_time", c.start_time, 0.0, 60.0},
                 {"approach_time", c.approach_time, 0.0, 60.0},
                 {"speed_memory", c.speed_memory, 0.1, 600.0},
                 {"degraded_speed", c.degraded_speed, 0.05, 5.0}});
}

}  // namespace

const char* name(State state) {
  switch (state) {
    case State::kInitialise:
      return "initialise";
    case State::kInactive:
      return "inactive";
    case State::kNewRequest:
      return "new request";
    case State::kActive:
      return "active";
    case State::kSuccess:
      return "success";
    case State::kFailure:
      return "failure";
  }
  return "unknown";
}

const char* name(Phase phase) {
  switch (phase) {
    case Phase::kPlanning:
      return "planning";
    case Phase::kFollowing:
      return "following";
    case Phase::kBlocked:
      return "blocked";
    case Phase::kPaused:
      return "paused";
    case Phase::kClearing:
      return "clearing";
    case Phase::kBackingOff:
      return "backing off";
    case Phase::kLooking:
      return "looking";
  }
  return "unknown";
}

const char* name(Failure failure) {
  switch (failure) {
    case Failure::kNone:
      return "none";
    case Failure::kBadGoal:
      return "bad goal";
    case Failure::kUnknownLocation:
      return "unknown location";
    case Failure::kNotReady:
      return "not ready";
    case Failure::kNoPath:
      return "no path";
    case Failure::kPlannerSilent:
      return "planner silent";
    case Failure::kBlocked:
      return "blocked";
    case Failure::kLocalizationLost:
      return "localization lost";
    case Failure::kInputsStale:
      return "inputs stale";
    case Failure::kHeld:
      return "held";
    case Failure::kTooSlow:
      return "too slow";
  }
  return "unknown";
}

Result<Navigator> Navigator::create(const NavigatorConfig& config, Locations locations,
                                    std::uint64_t first_id) {
  if (const Status status = check(config); !status) return Error{status.error()};
  return Navigator(config, std::move(locations), first_id);
}

Navigator::Navigator(const NavigatorConfig& config, Locations locations, std::uint64_t first_id)
    : config_(config), locations_(std::move(locations)), last_plan_id_(first_id - 1) {
  motion_.id = first_id;
}

// --- Requests

void Navigator::request(const GoalRequest& goal) {
  if (goal.id == status_.id && goal.id != 0 && goal.client == status_.client) return;
  NavigationStatus status;
  status.id = goal.id;
  status.client = goal.client;
  status.location = goal.location;
  status.goal = goal.pose;
  status.state = GoalState::kActive;
  const auto refuse = [&](Failure failure, const std::string& reason) {
    status.state = GoalState::kFailed;
    status.failure = failure;
    status.reason = reason;
    if (open()) {
      decision_.asides.push_back(status);
    } else {
      status_ = status;
      state_ = state_ == State::kInitialise ? State::kInitialise : State::kFailure;
    }
  };
  if (goal.id == 0) return refuse(Failure::kBadGoal, "a goal needs an id other than 0");
  if (!std::isfinite(goal.max_speed) || goal.max_speed < 0.0)
    return refuse(Failure::kBadGoal,
                  text("max_speed must be 0 or more, got %g m/s", goal.max_speed));
  if (!goal.location.empty()) {
    const auto location = locations_.find(goal.location);
    if (!location) return refuse(Failure::kUnknownLocation, location.error());
    status.goal = location->pose;
  } else if (!goal.pose.finite()) {
    return refuse(Failure::kBadGoal, "the goal pose must be finite");
  }
  if (open()) {
    NavigationStatus old = status_;
    old.state = GoalState::kReplaced;
    old.reason = "replaced by a newer goal";
    decision_.asides.push_back(old);
  }
  moved_ = open() && status_.client == status.client &&
           geometry::distance(status_.goal, status.goal) <= kMoved;
  status_ = status;
  goal_max_speed_ = goal.max_speed;
  pace_.reset();
  fresh_ = true;
}

bool Navigator::pace(std::uint64_t id, const std::string& client, double max_speed) {
  if (!open() || id != status_.id || client != status_.client) return false;
  if (!std::isfinite(max_speed) || max_speed < 0.0) return false;
  pace_ = max_speed;
  return true;
}

bool Navigator::cancel(std::uint64_t id, const std::string& reason) {
  if (!open() || (id != 0 && id != status_.id)) return false;
  finish(GoalState::kCancelled, Failure::kNone, reason);
  return true;
}

void Navigator::plan_reply(PlanReply reply) { reply_ = std::move(reply); }

// --- The state machine

bool Navigator::on_the_way(const geometry::Point2& point) const {
  return !route_.empty() && point.allFinite() &&
         route_.distance_ahead(point, kPersonAhead) <= kPersonBeside;
}

Decision Navigator::step(const Situation& s) {
  if (fresh_) start(s);
  if (s.person_ahead) somebody_at_ = s.time;
  step_state(s);
  limit_speed(s);
  send_plan(s);
  send_motion(s);
  update_status(s);
  last_step_ = s.time;
  return std::exchange(decision_, {});
}

void Navigator::start(const Situation& s) {
  fresh_ = false;
  started_at_ = s.time;
  longest_ = 0.0;
  pending_.reset();
  if (!old_path_) old_path_since_ = s.time;  // however often the goal moves meanwhile
  old_path_ = moved_ && phase_ == Phase::kFollowing && motion_.mode == MotionMode::kFollow;
  reply_ = {};
  waiting_for_.clear();
  next_attempt_ = s.time;
  failed_plans_ = 0;
  advanced_ = recovered_at_ = 0.0;
  recoveries_in_a_row_ = 0;
  if (!s.pose || !s.pose->finite() ||
      geometry::distance(*s.pose, stuck_at_) >= config_.recovery_progress)
    tried_here_ = 0;
  if (old_path_ && s.pose && s.pose->finite()) return ask_plan(s, PlanCause::kNeeded);
  usual_ =
      goal_max_speed_ > 0.0 ? std::min(goal_max_speed_, config_.usual_speed) : config_.usual_speed;
  speed_kept_ = usual_;
  if (state_ != State::kInitialise) state_ = State::kNewRequest;
  stop_and_plan(s);
}

void Navigator::stop_and_plan(const Situation& s) {
  route_.clear();
  set_motion(MotionMode::kStop);
  enter(Phase::kPlanning, s.time);
}

void Navigator::step_state(const Situation& s) {
  switch (state_) {
    case State::kInitialise:
      if (s.missing.empty()) {
        state_ = open() ? State::kNewRequest : State::kInactive;
        enter(Phase::kPlanning, s.time);
        if (open()) pursue(s);
      } else if (open() && s.time - started_at_ > config_.ready_timeout) {
        finish(GoalState::kFailed, Failure::kNotReady,
               no_word_from(s.missing) + text(" for %g s", config_.ready_timeout));
      }
      break;
    case State::kSuccess:
    case State::kFailure:
      state_ = State::kInactive;
      [[fallthrough]];
    case State::kInactive:
      if (!s.missing.empty()) state_ = State::kInitialise;
      break;
    case State::kNewRequest:
    case State::kActive:
      pursue(s);
      break;
  }
}

void Navigator::pursue(const Situation& s) {
  const double limit = config_.time_base + config_.time_factor * longest_ / config_.usual_speed;
  if (s.time - started_at_ > limit)
    return finish(GoalState::kFailed, Failure::kTooSlow, text("not there after %.0f s", limit));
  if (pause_if_unfit(s)) return;
  if (old_path_ && s.time - old_path_since_ > kOldPath) stop_and_plan(s);
  track(s);
  handle_reply(s);
  if (!open() || arrived(s)) return;
  switch (phase_) {
    case Phase::kPlanning:
      return plan(s);
    case Phase::kFollowing:
      return follow(s);
    case Phase::kBlocked:
      return wait_blocked(s);
    case Phase::kClearing:
    case Phase::kBackingOff:
    case Phase::kLooking:
      return continue_recovery(s);
    case Phase::kPaused:
      break;  // left by pause_if_unfit
  }
}

bool Navigator::pause_if_unfit(const Situation& s) {
  Failure cause = Failure::kNone;
  std::string reason;
  // A path in hand is good without the planner that made it.
  const bool has_path = phase_ == Phase::kFollowing || phase_ == Phase::kBlocked;
  if (!s.stale.empty() || (!s.missing.empty() && !has_path)) {
    cause = Failure::kInputsStale;
    reason = no_word_from(s.stale.empty() ? s.missing : s.stale);
  } else if (s.localization == Localization::kLost || !s.pose || !s.pose->finite()) {
    cause = Failure::kLocalizationLost;
    reason = "robot not localized";
  } else if (!s.not_allowed_because.empty()) {
    cause = Failure::kHeld;
    reason = s.not_allowed_because;
  } else if (phase_ == Phase::kPaused) {
    failed_plans_ = 0;
    next_attempt_ = s.time;
    waiting_for_.clear();
    enter(Phase::kPlanning, s.time);  // the world has moved on: from here, a new path
  }
  if (cause == Failure::kNone) return false;
  if (phase_ != Phase::kPaused) {
    pending_.reset();
    set_motion(MotionMode::kStop);
    enter(Phase::kPaused, s.time);
  } else if (cause != pause_cause_) {
    phase_since_ = s.time;  // each cause has its own patience
  }
  pause_cause_ = cause;
  waiting_for_ = reason;
  if (cause == Failure::kHeld) started_at_ += std::clamp(s.time - last_step_, 0.0, 1.0);
  const double patience = cause == Failure::kHeld ? config_.hold_timeout : config_.pause_timeout;
  if (s.time - phase_since_ > patience)
    finish(GoalState::kFailed, cause, reason + text(" for %g s", patience));
  return true;
}

void Navigator::restart_stall_clock(const Situation& s) {
  nearest_since_ = s.time;
  stall_yaw_ = s.pose->yaw;
}

void Navigator::track(const Situation& s) {
  if (route_.empty()) return;
  const double elapsed = std::clamp(s.time - last_step_, 0.0, 1.0);
  const double advance = route_.track(*s.pose);
  advanced_ = std::max(0.0, advanced_ + advance);
  // What turns take is counted apart.
  const bool turns = std::abs(s.velocity.v) < kStands && std::abs(s.velocity.w) > kTurns;
  if (elapsed > 0.0 && !turns) {
    const double speed = std::clamp(advance / elapsed, 0.0, 5.0);
    speed_kept_ += (speed - speed_kept_) * (1.0 - std::exp(-elapsed / config_.speed_memory));
  }
  if (route_.remaining() < nearest_ - kProgress) {
    nearest_ = route_.remaining();
    restart_stall_clock(s);
    turns_counted_ = 0;
  } else if (turns_counted_ < kMostTurns &&
             std::abs(geometry::shortest_turn(stall_yaw_, s.pose->yaw)) > kTurned) {
    restart_stall_clock(s);
    ++turns_counted_;
  }
  recovered_at_ = std::min(recovered_at_, advanced_);
  if (advanced_ - recovered_at_ >= config_.recovery_progress)
    recoveries_in_a_row_ = tried_here_ = 0;
}

bool Navigator::arrived(const Situation& s) {
  if (motion_.mode != MotionMode::kFollow || old_path_) return false;
  const geometry::Pose2& end = route_.end();
  const bool there =
      geometry::distance(*s.pose, end) <= config_.position_tolerance &&
      std::abs(geometry::shortest_turn(s.pose->yaw, end.yaw)) <= config_.yaw_tolerance &&
      std::abs(s.velocity.v) <= config_.settle_speed &&
      std::abs(s.velocity.w) <= config_.settle_speed;
  if (!there) {
    standing_since_.reset();
    return false;
  }
  if (!standing_since_) standing_since_ = s.time;
  if (s.time - *standing_since_ < config_.settle_time) return false;
  const double shift = geometry::distance(end, status_.goal);
  status_.progress = 1.0;
  finish(GoalState::kSucceeded, Failure::kNone,
         shift > config_.position_tolerance
             ? text("%.2f m beside the goal, which is blocked", shift)
             : "");
  return true;
}

// --- Planning

void Navigator::ask_plan(const Situation& s, PlanCause cause) {
  pending_ = PendingPlan{{++last_plan_id_, *s.pose, status_.goal},
                         cause,
                         s.time,
                         -std::numeric_limits<double>::infinity()};
  last_planned_ = s.time;
}

void Navigator::send_plan(const Situation& s) {
  if (!pending_ || s.time - pending_->sent < kRepeat) return;
  decision_.plan = pending_->request;
  pending_->sent = s.time;
}

void Navigator::handle_reply(const Situation& s) {
  const PlanReply reply = std::exchange(reply_, {});
  if (!pending_) return;
  if (reply.id == pending_->request.id) {
    const PlanCause cause = std::exchange(pending_, std::nullopt)->cause;
    if (reply.path.empty() || !finite(reply.path))
      return handle_failed_plan(s, Failure::kNoPath,
                                reply.reason.empty() ? "no path" : reply.reason);
    adopt(s, cause, reply.path);
  } else if (s.time - pending_->asked > config_.plan_timeout) {
    pending_.reset();
    handle_failed_plan(s, Failure::kPlannerSilent,
                       text("the global planner did not answer for %g s", config_.plan_timeout));
  }
}

void Navigator::handle_failed_plan(const Situation& s, Failure failure, const std::string& reason) {
  if (old_path_) stop_and_plan(s);
  if (phase_ != Phase::kPlanning) return;  // the path still leads there
  waiting_for_ = reason;
  next_attempt_ = s.time + config_.plan_retry;
  if (++failed_plans_ < config_.plan_attempts) {
    decision_.clear_costmap = true;  // what bars the way may be gone
  } else if (state_ == State::kActive) {
    recover(s, failure, reason);
  } else {
    finish(GoalState::kFailed, failure, reason);
  }
}

/// A path that leads back the way that the robot has come, unlike the one that it is on.
bool Navigator::turns_back(const Situation& s, const Route& route) const {
  constexpr double kBack = 2.0, kOn = 1.0;  // [rad] from where the robot looks
  const auto turn = [&](const Route& one) {
    return std::abs(geometry::shortest_turn(s.pose->yaw, one.heading()));
  };
  return !route_.empty() && turn(route) > kBack && turn(route_) < kOn;
}

/// Somebody is, or was a moment ago, on the way, and has not been waited for long enough: whoever
/// follows the robot would stand in its way back.
bool Navigator::waits_for_somebody(const Situation& s) const {
  if (!somebody_at_ || s.time - *somebody_at_ >= config_.wait_person) return false;
  return phase_ != Phase::kBlocked || s.time - blocked_since_ < config_.wait_person;
}

void Navigator::adopt(const Situation& s, PlanCause cause, std::vector<geometry::Pose2> path) {
  Route route;
  route.set(std::move(path));
  ++status_.replans;
  failed_plans_ = 0;
  const double change = std::abs(route.length() - route_.remaining());
  if (cause == PlanCause::kPeriodic && change <= config_.keep_path * route_.remaining()) return;
  const bool needed = cause == PlanCause::kNeeded || cause == PlanCause::kOffPath;
  if (!needed && waits_for_somebody(s) && turns_back(s, route)) {
    if (cause == PlanCause::kBlocked) replanned_at_.reset(), blocked_by_person_ = true;
    return;
  }
  old_path_ = false;
  route_ = std::move(route);
  route_.track(*s.pose);
  longest_ = std::max(longest_, advanced_ + route_.length());
  nearest_ = route_.remaining();
  // A path that is new only because the robot is elsewhere by now is no progress.
  if (cause != PlanCause::kPeriodic && cause != PlanCause::kOffPath) {
    restart_stall_clock(s);
    turns_counted_ = 0;
  }
  standing_since_.reset();
  obstacle_since_.reset();
  state_ = State::kActive;
  if (motion_.mode == MotionMode::kFollow) {
    motion_changed_ = true;
  } else {
    set_motion(MotionMode::kFollow);
  }
  if (phase_ == Phase::kBlocked) {
    if (replanned_at_) replanned_at_ = s.time;
  } else {
    enter(Phase::kFollowing, s.time);
  }
}

void Navigator::plan(const Situation& s) {
  if (!pending_ && s.time >= next_attempt_) ask_plan(s, PlanCause::kNeeded);
}

// --- On the way

bool Navigator::blocked(const Situation& s) const {
  return follower_speaks(s) && s.follow.state == GoalState::kWaiting;
}

void Navigator::follow(const Situation& s) {
  if (blocked(s)) {
    enter(Phase::kBlocked, s.time);
    blocked_since_ = s.time;
    blocked_by_person_ = false;
    replanned_at_.reset();
    return wait_blocked(s);
  }
  if (follower_speaks(s) && s.follow.state == GoalState::kFailed)
    return recover(s, Failure::kBlocked,
                   s.follow.reason.empty() ? "the path cannot be followed" : s.follow.reason);
  if (s.time - nearest_since_ > config_.stall_time)
    return recover(s, Failure::kBlocked, text("no progress for %g s", config_.stall_time));
  replan_if_due(s);
}

void Navigator::replan_if_due(const Situation& s) {
  if (!(s.follow.obstacle_distance < config_.obstacle_ahead) || !follower_speaks(s)) {
    obstacle_since_.reset();
  } else if (!obstacle_since_) {
    obstacle_since_ = s.time;
  }
  if (pending_ || s.time - last_planned_ < config_.replan_interval) return;
  const double wait = s.person_ahead ? config_.wait_person : config_.wait_object;
  // The follower believes to be there, we do not: localization corrected itself after the path was
  // made.
  const bool astray =
      follower_speaks(s) && s.follow.state == GoalState::kSucceeded && !standing_since_;
  if (route_.offset() > config_.off_path || astray) {
    ask_plan(s, PlanCause::kOffPath);
  } else if (obstacle_since_ && s.time - *obstacle_since_ >= wait) {
    obstacle_since_ = s.time;
    ask_plan(s, PlanCause::kObstacleAhead);
  } else if (config_.replan_period > 0.0 && s.time - last_planned_ >= config_.replan_period) {
    ask_plan(s, PlanCause::kPeriodic);
  }
}

void Navigator::wait_blocked(const Situation& s) {
  if (!blocked(s)) {
    restart_stall_clock(s);
    return enter(Phase::kFollowing, s.time);
  }
  blocked_by_person_ |= s.person_ahead;
  waiting_for_ = s.follow.reason.empty() ? "the way is blocked" : s.follow.reason;
  if (pending_) return;
  if (!replanned_at_) {
    const double wait = blocked_by_person_ ? config_.wait_person : config_.wait_object;
    if (s.time - blocked_since_ < wait) return;
    replanned_at_ = s.time;
    ask_plan(s, PlanCause::kBlocked);
  } else if (s.time - *replanned_at_ >= config_.recovery_patience) {
    recover(s, Failure::kBlocked, waiting_for_);
  }
}

// --- Recovering

void Navigator::recover(const Situation& s, Failure failure, const std::string& reason) {
  const double off = s.pose ? geometry::distance(*s.pose, status_.goal) : HUGE_VAL;
  if (recoveries_in_a_row_ >= kRecoveryKinds && off <= config_.near_enough) {
    status_.progress = 1.0;
    return finish(GoalState::kSucceeded, Failure::kNone,
                  text("%.2f m from the goal, which is blocked", off));
  }
  if (recoveries_in_a_row_ >= config_.most_recoveries)
    return finish(GoalState::kFailed, failure, reason);
  const int kind = recoveries_in_a_row_++ % kRecoveryKinds;
  const int round = ++tried_here_ / kRecoveryKinds;
  if (s.pose) stuck_at_ = *s.pose;
  const bool left = round % 2 == 1;
  ++status_.recoveries;
  recovered_at_ = advanced_;
  waiting_for_ = reason;
  pending_.reset();
  // What did not help is tried over a longer way.
  const double back =
      std::min(config_.back_off_distance * (1 + round), s.rear_clearance - config_.rear_margin);
  const bool room_behind = back >= config_.back_off_distance;
  if (kind == 0) {
    decision_.clear_costmap = true;
    set_motion(MotionMode::kStop);
    enter(Phase::kClearing, s.time);
  } else if (kind == 1 && room_behind) {
    set_motion(MotionMode::kBackOff, back);
    enter(Phase::kBackingOff, s.time);
  } else {
    set_motion(MotionMode::kRotate, left ? config_.look_angle : -config_.look_angle);
    enter(Phase::kLooking, s.time);
  }
}

void Navigator::continue_recovery(const Situation& s) {
  const double elapsed = s.time - phase_since_;
  const bool barred = blocked(s) && elapsed >= kBarred;
  const bool moved = barred || (follower_speaks(s) && (s.follow.state == GoalState::kSucceeded ||
                                                       s.follow.state == GoalState::kFailed));
  const bool done = phase_ == Phase::kClearing ? elapsed >= config_.clear_time
                                               : moved || elapsed >= config_.recovery_timeout ||
                                                     (phase_ == Phase::kBackingOff &&
                                                      s.rear_clearance < config_.rear_margin);
  if (!done) return;
  set_motion(MotionMode::kStop);
  failed_plans_ = 0;
  next_attempt_ = s.time;
  enter(Phase::kPlanning, s.time);
  plan(s);
}

// --- Outputs

void Navigator::enter(Phase phase, double time) {
  phase_ = phase;
  phase_since_ = time;
  if (phase == Phase::kFollowing) waiting_for_.clear();
}

void Navigator::set_motion(MotionMode mode, double amount) {
  if (mode != MotionMode::kFollow) old_path_ = false;
  if (mode == MotionMode::kStop && motion_.mode == MotionMode::kStop) return;
  motion_ = {motion_.id + 1, mode, 0.0, amount};
  motion_changed_ = true;
  standing_since_.reset();
  obstacle_since_.reset();
}

void Navigator::limit_speed(const Situation& s) {
  if (motion_.mode != MotionMode::kFollow) return;
  double limit = pace_.value_or(goal_max_speed_);
  if (s.localization == Localization::kDegraded)
    limit = limit > 0.0 ? std::min(limit, config_.degraded_speed) : config_.degraded_speed;
  if (limit == motion_.max_speed) return;
  motion_.max_speed = limit;
  motion_changed_ = true;
}

void Navigator::send_motion(const Situation& s) {
  const bool unheard = !follower_speaks(s) && s.time - motion_sent_ >= kRepeat;
  if (!motion_changed_ && !unheard) return;
  decision_.motion = motion_;
  motion_changed_ = false;
  motion_sent_ = s.time;
}

void Navigator::finish(GoalState outcome, Failure failure, const std::string& reason) {
  status_.state = outcome;
  status_.failure = failure;
  status_.reason = reason;
  status_.eta = outcome == GoalState::kSucceeded ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  if (outcome == GoalState::kSucceeded) status_.remaining = 0.0;
  pending_.reset();
  fresh_ = false;
  waiting_for_.clear();
  set_motion(MotionMode::kStop);
  if (state_ == State::kInitialise) return;
  state_ = outcome == GoalState::kSucceeded ? State::kSuccess
           : outcome == GoalState::kFailed  ? State::kFailure
                                            : State::kInactive;
}

/// The next metres at the speed kept lately, for a jam ends somewhere, the way beyond them as
/// usual, and what turns, start and approach take besides.
double Navigator::time_left(const Situation& s) const {
  const double remaining = route_.remaining();
  const double near = std::min(remaining, kAsLately);
  const double driving = near / std::max(speed_kept_, kSlowestKept) + (remaining - near) / usual_;
  const double turning = s.pose && s.pose->finite() ? route_.turning_left(s.pose->yaw) : 0.0;
  const double start = advanced_ < kStarted ? config_.start_time : 0.0;
  const double approach = config_.approach_time * std::min(1.0, remaining / kApproach);
  return driving + config_.turn_time * turning + start + approach;
}

void Navigator::update_status(const Situation& s) {
  if (!open()) return;
  if (state_ == State::kInitialise) waiting_for_ = no_word_from(s.missing) + " yet";
  const bool stands =
      state_ == State::kInitialise || (phase_ != Phase::kFollowing && !waiting_for_.empty());
  status_.state = stands ? GoalState::kWaiting : GoalState::kActive;
  status_.reason = stands ? waiting_for_ : "";
  if (route_.empty() || old_path_) return;
  status_.remaining = route_.remaining();
  const double way = advanced_ + status_.remaining;
  if (way > 0.0) status_.progress = std::max(status_.progress, advanced_ / way);
  status_.eta = time_left(s);
}

}  // namespace usher::navigator
