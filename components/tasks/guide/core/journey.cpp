// The way: what the guide does from "Start" until the place is reached or given up.
#include <algorithm>
#include <cmath>

#include "tasks/guide/core/guide.hpp"

namespace usher::guide {

namespace {

constexpr int kMostGivenAgain = 3;  ///< times that a goal is repeated to a navigator that forgot it
constexpr Time kAskAgainAfter = std::chrono::seconds(2);
constexpr Time kAskAgainEvery = std::chrono::seconds(5);
constexpr Time kSentence = std::chrono::seconds(4);  ///< a sentence stays at least so long
constexpr Time kEtaSettles = std::chrono::seconds(3);
constexpr double kAlmost = 10.0;      ///< [m]
constexpr double kStuckWithin = 3.0;  ///< [m] no farther, and asking to be let through ...
constexpr Time kStuckFor = std::chrono::minutes(5);  ///< ... for so long, there is no way
constexpr std::size_t kMostRemembered = 8;
constexpr double kAhead = 0.5;        ///< [m] who walks before the robot does not fall behind ...
constexpr double kAheadWithin = 6.0;  ///< [m] ... unless he is gone

}  // namespace

void Guide::say_on_the_way(Text text, Tone tone, Time now) {
  sentence_ = say(text);
  sentence_at_ = now;
  speak(sentence_, tone);
}

void Guide::depart(Time now) {
  goal_id_ = 0;
  acknowledged_ = false;
  given_again_ = 0;
  unheard_since_.reset();
  blocked_since_.reset();
  stuck_at_.reset();
  pleads_ = told_eta_ = told_almost_ = false;
  pleaded_ = refreshed_ = {};
  first_eta_ = first_way_ = kNothing;
  departed_ = asked_again_ = now;
  move_at_ = now + parameters_.tone;
  follow_.depart(now);
  calls_heard_ = follow_.calls();
  stands_told_.reset();
  sentence_ = say(Text::kLetsGo);
  sentence_at_ = now;
  screen_.progress = 0.0;
  if (visit_.started++ == 0) ++funnel_.started;
  enter(State::kGuideActive, Cause::kYes, now);
  screen_.tone = Tone::kMoving;
}

void Guide::move_when_due(Time now) {
  if (!move_at_ || now < *move_at_) return;
  move_at_.reset();
  lift_stop();
  if (goal_id_ == 0) {
    goal_id_ = next_id_++;
    actions_.goal = Goal{goal_id_, place_.name};
  }
  actions_.remember = true;
}

void Guide::stop_robot() {
  move_at_.reset();
  if (!stopped_) actions_.requests.push_back({RequestKind::kStop, {}});
  stopped_ = true;
  actions_.remember = true;
}

/// An operator ends every stop, but not what this one waits for. A boot, or a memory that cannot be
/// read, forgets that it waited: then the stop is lifted when no navigation can drive off, and who
/// stopped the robot may still lie before it.
void Guide::keep_own_stop() {
  const auto& holds = surroundings_.stop_holds;
  if (!holds || *holds == stopped_) return;
  if (stopped_) {
    actions_.requests.push_back({RequestKind::kStop, {}});
  } else if (on_the_way() || surroundings_.supervisor == Supervisor::kAvailable) {
    if (!on_the_way()) stays_ = actions_.remember = true;
    actions_.requests.push_back({RequestKind::kMovementOn, {}});
  }
}

/// Nothing drives on, or off with the end of a stop, for a visit that this guide has forgotten.
void Guide::end_forgotten_journey() {
  if (state_ != State::kInitialise) return;
  const auto& navigation = surroundings_.navigation;
  const bool drives = navigator_drives() && navigation->ours;
  if (drives) actions_.cancel = navigation->goal_id;
  const auto& holds = surroundings_.stop_holds;
  const bool stands = holds && *holds && !stopped_;
  // Once: while a request waits it is not known what holds.
  if (surroundings_.supervisor == Supervisor::kNavigation && holds && (drives || stands))
    actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
}

/// After a stop, with the time of a departure for the visitor to step behind.
void Guide::go_on(Time now) {
  say_on_the_way(Text::kHereWeGo, Tone::kMoving, now);
  move_at_ = now + parameters_.tone;
  follow_.depart(now);
  stands_told_.reset();
  stuck_at_.reset();
}

void Guide::lift_stop() {
  if (stopped_) actions_.requests.push_back({RequestKind::kMovementOn, {}});
  stopped_ = false;
}

/// Gives up the goal, if there is one. A stop of the visitor (`stopped`, or a pause) holds the
/// robot until he goes on or his visit ends.
void Guide::leave_journey(bool stopped) {
  const auto stray = follows() ? own_goal() : std::nullopt;
  if (goal_id_ != 0 || stray) actions_.cancel = goal_id_ != 0 ? goal_id_ : *stray;
  goal_id_ = first_goal_ = 0;
  move_at_.reset();
  actions_.requests.push_back({RequestKind::kNavigationEnd, {}});
  if (!stopped && state_ != State::kGuidePaused) lift_stop();
}

void Guide::fail(Text reason, Cause cause, Time now) {
  if (state_ != State::kGuideStart) visit_.travel_time += now - departed_;
  leave_journey();
  failure_ = reason;
  enter(State::kGuideError, cause, now);
}

void Guide::watch_robot(Time now) {
  const Supervisor supervisor = surroundings_.supervisor;
  if (supervisor == Supervisor::kFault) return fail(Text::kFault, Cause::kFailure, now);
  if (supervisor == Supervisor::kManual) {
    return fail(Text::kOperatorTookOver, Cause::kFailure, now);
  }
  // On the way, a supervisor that does not navigate holds the robot just as one that is missing.
  // A visitor who stopped it himself has his own time.
  const bool refused = surroundings_.permission != Permission::kGiven &&
                       (state_ == State::kGuideActive || follows());
  // Between two goals of a following it navigates nowhere.
  const bool between = follows() && goal_id_ == 0;
  const bool held =
      refused || (supervisor != Supervisor::kNavigation &&
                  (supervisor != Supervisor::kAvailable || (on_the_way() && !between)));
  if (!held) {
    not_allowed_since_.reset();
    return;
  }
  if (!not_allowed_since_) not_allowed_since_ = now;
  const Time lasted = now - *not_allowed_since_;
  const bool stopped = surroundings_.permission == Permission::kStopped;
  if (lasted >= (stopped ? parameters_.pause : parameters_.recovery)) {
    return fail(stopped ? Text::kStoppedMe : Text::kPartSilent, Cause::kFailure, now);
  }
  // One that was restarted knows nothing of this journey.
  if (on_the_way() && supervisor == Supervisor::kAvailable && lasted >= kAskAgainAfter &&
      now - asked_again_ >= kAskAgainEvery) {
    asked_again_ = now;
    start_navigation();
  }
}

/// Why a robot stands that wants to drive; nothing: it drives, or waits for the visitor or the way.
std::optional<Text> Guide::stands_for(Time now) const {
  if (not_allowed_since_ && now - *not_allowed_since_ >= parameters_.refresh) {
    return surroundings_.permission == Permission::kStopped ? Text::kStoppedMe : Text::kOneMoment;
  }
  const bool lost = waits_since_ && now - *waits_since_ >= parameters_.refresh;
  const bool waits = stopped_ && !stands_told_;  // for the visitor
  return lost && !waits ? std::optional(Text::kNotLocated) : std::nullopt;
}

void Guide::tell_why_it_stands(Time now) {
  // The navigator waits for the way, too; that the visitor sees, and hears otherwise.
  const auto& navigation = surroundings_.navigation;
  const bool lost = navigation && navigation->state == GoalState::kWaiting && !surroundings_.pose;
  if (!lost) waits_since_.reset();
  if (lost && !waits_since_) waits_since_ = now;
  const auto why = stands_for(now);
  if (why == stands_told_) return;
  stands_told_ = why;
  if (why) {
    // So that it does not drive off by itself, but after a tone. Between two goals of a following
    // the supervisor navigates nowhere.
    const bool between = follows() && surroundings_.supervisor == Supervisor::kAvailable;
    if (!between && (!stopped_ || move_at_)) stop_robot();
    return say_on_the_way(*why, Tone::kNone, now);
  }
  if (journey() && follow_.waits()) return;
  say_on_the_way(follows() ? Text::kWalkAhead : Text::kHereWeGo, Tone::kMoving, now);
  if (stopped_) move_at_ = now + parameters_.tone;
}

/// The navigator pursues a goal, whoever gave it. One that it refused is in its status for a moment
/// only.
bool Guide::navigator_drives() const {
  const auto& navigation = surroundings_.navigation;
  return navigation &&
         (navigation->state == GoalState::kActive || navigation->state == GoalState::kWaiting);
}

/// The navigator does not speak of our goal.
void Guide::await_navigator(Time now) {
  if (!unheard_since_) unheard_since_ = now;
  if (now - *unheard_since_ >= parameters_.acknowledge)
    fail(Text::kPartSilent, Cause::kFailure, now);
}

/// What became of our newest goal, of which the navigator speaks: whether it was reached; nothing
/// while it runs. Who cancelled or replaced it has ended the journey: it was not this guide, which
/// forgets what it cancels.
std::optional<bool> Guide::goal_reached(Time now) {
  acknowledged_ = true;
  unheard_since_.reset();
  switch (surroundings_.navigation->state) {
    case GoalState::kSucceeded:
      return true;
    case GoalState::kFailed:
      return false;
    case GoalState::kCancelled:
    case GoalState::kReplaced:
      fail(Text::kOtherGoal, Cause::kFailure, now);
      break;
    case GoalState::kIdle:
    case GoalState::kActive:
    case GoalState::kWaiting:
      break;
  }
  return std::nullopt;
}

void Guide::watch_navigation(Time now) {
  const auto& navigation = surroundings_.navigation;
  if (navigation && navigation->goal_id == goal_id_) {
    const auto reached = goal_reached(now);
    if (reached && *reached) arrive(now);
    if (!reached || *reached) return;
    if (state_ != State::kGuidePaused)
      return fail(surroundings_.pose ? Text::kNoWay : Text::kNotLocated, Cause::kFailure, now);
    goal_id_ = 0;  // its patience is shorter than the visitor's pause; going on gives it anew
    acknowledged_ = false;
    actions_.remember = true;
    return;
  }
  const bool forgot = acknowledged_ && navigation && navigation->goal_id == 0;
  if (!forgot) {
    if (acknowledged_ && navigator_drives()) return fail(Text::kOtherGoal, Cause::kFailure, now);
    return await_navigator(now);
  }
  if (given_again_++ >= kMostGivenAgain) return fail(Text::kPartSilent, Cause::kFailure, now);
  acknowledged_ = false;
  unheard_since_.reset();
  actions_.goal = Goal{goal_id_, place_.name};
}

void Guide::arrive(Time now) {
  goal_id_ = 0;
  leave_journey();
  visit_.travel_time += now - departed_;
  if (visit_.arrived++ == 0) ++funnel_.arrived;
  if (first_eta_ > 0.0) {
    const double took = std::chrono::duration<double>(now - first_eta_at_).count();
    visit_.eta_error = took / first_eta_ - 1.0;
  }
  std::erase(recent_, place_.name);
  recent_.insert(recent_.begin(), place_.name);
  if (recent_.size() > kMostRemembered) recent_.resize(kMostRemembered);
  enter(State::kGuideSuccess, Cause::kArrived, now);
}

void Guide::watch_follower(Time now) {
  std::optional<FollowerSighting> sighting;
  if (const auto& visitor = surroundings_.visitor) {
    const double range = std::hypot(visitor->x, visitor->y);
    // Who has been missed and walks about before it may as well walk away.
    const bool ahead = visitor->x > kAhead && range < kAheadWithin && !follow_.waits();
    sighting = FollowerSighting{visitor->seen, ahead ? 0.0 : range, visitor->x < 0.0};
  }
  const auto& pose = surroundings_.pose;
  const Follower before = follow_.state();
  follow_.update(sighting, pose ? std::optional(pose->position()) : std::nullopt, now);
  if (follow_.lost()) {
    lost_visitor_ = true;
    visit_.travel_time += now - departed_;
    leave_journey();
    enter(State::kEnd, Cause::kLeft, now);
    return;
  }
  if (follow_.state() != Follower::kUnknown) actions_.pace = follow_.pace(parameters_.speed);
  if (follow_.waits()) {
    if (!stopped_ || move_at_) {
      stop_robot();
      ++visit_.waits;
      say_on_the_way(Text::kWaitingForYou, Tone::kCall, now);
    } else if (follow_.calls() != calls_heard_) {
      say_on_the_way(Text::kWhereAreYou, Tone::kCall, now);
    }
    calls_heard_ = follow_.calls();
    return;
  }
  if (sighting && sighting->seen && !(follow_.gap() <= visit_.largest_gap)) {
    visit_.largest_gap = follow_.gap();
  }
  if (stopped_ && !move_at_ && !stands_told_) {
    say_on_the_way(Text::kHereWeGo, Tone::kMoving, now);
    move_at_ = now + parameters_.tone;
  } else if (follow_.state() == Follower::kLagging && before == Follower::kFollowing &&
             now - sentence_at_ >= kSentence) {
    sentence_ = say(Text::kSlower);
    sentence_at_ = now;
  }
}

/// Somebody or something stands in the way: asks to be let through. The navigator looks for another
/// way by itself.
void Guide::watch_obstacle(Time now) {
  const auto& navigation = surroundings_.navigation;
  const bool blocked =
      navigation && navigation->goal_id == goal_id_ && navigation->blocked && !stopped_;
  if (pleads_ && journey() && navigation && navigation->replans != replans_at_plea_) {
    pleads_ = false;
    say_on_the_way(Text::kAnotherWay, Tone::kNone, now);
    pleaded_ = now;
  }
  if (!blocked) {
    blocked_since_.reset();
    if (pleads_ && follows() && !unseen_since_) say_on_the_way(Text::kWalkAhead, Tone::kNone, now);
    pleads_ = false;
    return;
  }
  if (!blocked_since_) blocked_since_ = now;
  if (now - *blocked_since_ < parameters_.please) return;
  if (pleaded_ != Time{} && now - pleaded_ < parameters_.please_again) return;
  pleaded_ = now;
  pleads_ = true;
  replans_at_plea_ = navigation->replans;
  say_on_the_way(Text::kExcuseMe, Tone::kPlease, now);
}

/// A jam that lasts is no way: the visitor is asked.
void Guide::watch_progress(Time now) {
  const auto& pose = surroundings_.pose;
  if (!pose) return;
  if (stopped_ || follow_.waits() || surroundings_.permission != Permission::kGiven) {
    stuck_at_.reset();  // that is no jam
    return;
  }
  if (!stuck_at_ || (pose->position() - *stuck_at_).norm() > kStuckWithin) {
    stuck_at_ = pose->position();
    stuck_since_ = now;
  }
  if (now - stuck_since_ >= kStuckFor && pleaded_ > stuck_since_)
    fail(Text::kNoWay, Cause::kFailure, now);
}

void Guide::refresh_journey(Time now) {
  const auto& navigation = surroundings_.navigation;
  if (!navigation || goal_id_ == 0 || navigation->goal_id != goal_id_) return;
  if (now - refreshed_ < parameters_.refresh) return;
  refreshed_ = now;
  screen_.progress =
      std::isfinite(navigation->progress) ? std::clamp(navigation->progress, 0.0, 1.0) : 0.0;
  const auto known = [](double value) { return std::isfinite(value) && value >= 0.0; };
  screen_.eta = known(navigation->eta) ? navigation->eta : kNothing;
  // Before there is a plan neither is.
  const bool planned = known(navigation->eta) && known(navigation->remaining);
  screen_.remaining = planned ? navigation->remaining : kNothing;
  if (!planned) return;
  if (std::isnan(first_eta_) && screen_.remaining > 0.0) {
    first_eta_ = screen_.eta;
    first_way_ = screen_.remaining;
    first_eta_at_ = now;
  }
  const bool busy =
      stands_told_ || follow_.waits() || pleads_ || move_at_ || now - sentence_at_ < kSentence;
  if (busy) return;
  const bool tells_eta = !told_eta_ && now - departed_ >= kEtaSettles;
  const bool tells_almost =
      !told_almost_ && screen_.remaining < kAlmost && first_way_ > 2.0 * kAlmost;
  if (tells_almost) {
    told_eta_ = told_almost_ = true;
    say_on_the_way(Text::kAlmostThere, Tone::kNone, now);
    return;
  }
  sentence_ = phrases::filled(say(Text::kWayLeft), {{"way", way_words(screen_.remaining)},
                                                    {"time", time_words(screen_.eta)}});
  if (told_almost_) sentence_ = say(Text::kAlmostThere);
  if (tells_eta) {
    told_eta_ = true;
    sentence_at_ = now;
    speak(sentence_);
  }
}

}  // namespace usher::guide
