#include "control/supervisor/core/behavior.hpp"

namespace usher::supervisor {

std::string_view text(State state) {
  switch (state) {
    case State::kInitialise:
      return "initialise";
    case State::kInactive:
      return "inactive";
    case State::kInteraction:
      return "interaction";
    case State::kNavigationStart:
      return "navigation start";
    case State::kNavigationActive:
      return "navigation active";
    case State::kNavigationEnd:
      return "navigation end";
    case State::kManual:
      return "manual";
    case State::kFault:
      return "fault";
  }
  return "unknown";
}

void Behavior::manual(bool on) {
  manual_ = on;
  if (on) navigation_ = Navigation::kNone;
}

void Behavior::navigation_start() {
  new_goal_ = new_goal_ || navigation_ == Navigation::kGoing;
  navigation_ = Navigation::kStarting;
}

void Behavior::navigation_go() {
  if (navigation_ == Navigation::kStarting) navigation_ = Navigation::kGoing;
}

void Behavior::navigation_end() { navigation_ = Navigation::kNone; }

State Behavior::wanted() const {
  if (manual_) return State::kManual;
  switch (navigation_) {
    case Navigation::kStarting:
      return State::kNavigationStart;
    case Navigation::kGoing:
      return State::kNavigationActive;
    case Navigation::kNone:
      break;
  }
  return State::kInteraction;
}

State Behavior::next(bool able, bool fault, Time now) {
  if (fault) {
    manual_ = false;
    navigation_ = Navigation::kNone;
    return State::kFault;
  }
  if (!able) return state_ == State::kInitialise ? state_ : State::kInactive;
  const bool settled = settled_since_ && now - *settled_since_ >= dwell_;
  switch (state_) {
    case State::kInitialise:
    case State::kFault:
      return State::kInactive;
    case State::kInactive:
      return settled ? wanted() : state_;
    case State::kInteraction:
      return wanted() == state_ ? state_ : State::kInactive;
    case State::kManual:
      return manual_ ? state_ : State::kInactive;
    case State::kNavigationStart:
      if (manual_) return State::kInactive;
      return navigation_ == Navigation::kNone ? State::kNavigationEnd : wanted();
    case State::kNavigationActive:
      if (manual_ || new_goal_) return State::kInactive;
      return navigation_ == Navigation::kNone ? State::kNavigationEnd : state_;
    case State::kNavigationEnd:
      return manual_ || settled ? State::kInactive : state_;
  }
  return State::kInactive;
}

State Behavior::step(bool able, bool fault, Time now) {
  const State next_state = next(able, fault, now);
  if (next_state != state_) {
    state_ = next_state;
    settled_since_.reset();
  }
  if (state_ == State::kInactive) new_goal_ = false;
  if (!able || fault) {
    settled_since_.reset();
  } else if (!settled_since_) {
    settled_since_ = now;
  }
  return state_;
}

}  // namespace usher::supervisor
