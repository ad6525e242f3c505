#include "tasks/meeting/core/motion.hpp"

#include <utility>

namespace usher::meeting {

using service::RequestKind;
using service::Supervisor;

void Motion::begin(Time now) {
  rest();
  phase_ = Phase::kAsking;
  began_ = now;
  asked_ = false;
  acknowledged_ = false;
  reason_.clear();
}

void Motion::drive(Goal goal, Time now) {
  begin(now);
  exploring_ = false;
  goal_ = std::move(goal);
}

void Motion::explore(bool anew, Time now) {
  begin(now);
  exploring_ = true;
  anew_ = anew_ || anew;
}

void Motion::rest() {
  if (phase_ == Phase::kResting) return;
  if (phase_ == Phase::kDriving) {
    if (exploring_)
      actions_.stop_exploring = last_id_;
    else
      actions_.cancel = last_id_;
  }
  if (asked_) {
    actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
    given_back_ = false;
    given_back_at_ = {};
  }
  phase_ = Phase::kResting;
}

Motion::Outcome Motion::fail(const std::string& reason) {
  rest();
  reason_ = reason;
  return Outcome::kFailed;
}

/// Of the journey; the supervisor starts none without.
std::string Motion::name() const {
  if (exploring_) return "exploration";
  return goal_.location.empty() ? "person" : goal_.location;
}

void Motion::go(Time now) {
  phase_ = Phase::kDriving;
  phase_since_ = heard_ = now;
  acknowledged_ = false;
  ++last_id_;
  if (exploring_) {
    actions_.explore = Exploration{last_id_, anew_};
    anew_ = false;
  } else {
    goal_.id = last_id_;
    actions_.goal = goal_;
  }
}

Motion::Outcome Motion::step(const Surroundings& robot, Time now) {
  const bool navigates = robot.supervisor == Supervisor::kNavigation;
  switch (phase_) {
    case Phase::kResting:
      // The end of the navigation may have been lost with a supervisor that was restarted.
      if (!navigates) given_back_ = true;
      if (given_back_at_ == Time{}) given_back_at_ = now;
      if (!given_back_ && now - given_back_at_ >= limits_.again) {
        given_back_at_ = now;
        actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
      }
      return Outcome::kBusy;
    case Phase::kAsking:
      if (now - began_ >= limits_.depart) return fail("the supervisor does not let me drive");
      if (asked_ && navigates) {  // it let go late
        go(now);
        return Outcome::kBusy;
      }
      if (robot.supervisor != Supervisor::kAvailable) return Outcome::kBusy;
      asked_ = true;
      actions_.requests.push_back({RequestKind::kNavigationStart, name()});
      actions_.requests.push_back({RequestKind::kNavigationGo, {}});
      phase_ = Phase::kWaiting;
      phase_since_ = now;
      return Outcome::kBusy;
    case Phase::kWaiting:
      if (navigates) {
        go(now);
      } else if (now - phase_since_ >= limits_.again) {
        phase_ = Phase::kAsking;
      }
      return Outcome::kBusy;
    case Phase::kDriving:
      return follow(robot, now);
  }
  return Outcome::kBusy;
}

Motion::Outcome Motion::follow(const Surroundings& robot, Time now) {
  const auto& report = exploring_ ? robot.exploration : robot.navigation;
  const std::string who = exploring_ ? "the explorer" : "the navigator";
  if (report) heard_ = now;
  if (now - heard_ >= limits_.silence) return fail(who + " is silent");
  if (report && report->id == last_id_) {
    acknowledged_ = true;
    switch (report->state) {
      case GoalState::kSucceeded:
        rest();
        return Outcome::kArrived;
      case GoalState::kFailed:
        return fail(report->reason);
      case GoalState::kCancelled:
      case GoalState::kReplaced:
        return fail("somebody else ended the drive");
      default:
        break;
    }
  } else if (report && acknowledged_) {
    return fail(who + " follows another goal");
  }
  if (!acknowledged_ && now - phase_since_ >= limits_.acknowledge)
    return fail(who + " does not take the goal");
  // Back in Interaction without an outcome: a supervisor that forgot the journey is asked anew.
  if (robot.supervisor != Supervisor::kAvailable) held_since_ = now;
  if (held_since_ < phase_since_) held_since_ = phase_since_;
  if (now - held_since_ >= limits_.again) {
    actions_.requests.push_back({RequestKind::kNavigationStart, name()});
    actions_.requests.push_back({RequestKind::kNavigationGo, {}});
    held_since_ = now;
  }
  return Outcome::kBusy;
}

MotionActions Motion::take_actions() { return std::exchange(actions_, {}); }

}  // namespace usher::meeting
