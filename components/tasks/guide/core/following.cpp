// "Follow me": the robot goes behind the visitor, along his way.
#include <algorithm>

#include "tasks/guide/core/buttons.hpp"
#include "tasks/guide/core/guide.hpp"

namespace usher::guide {

namespace {

constexpr Time kGoalEvery = std::chrono::milliseconds(700);
constexpr double kGoalStep = 0.3;  ///< [m] a goal nearer to the last one, or to the robot, is none
constexpr double kLookFrom = 0.3;  ///< [m] before the place where an unseen visitor was last
constexpr double kJump = 2.0;      ///< [m] nobody walks so far unseen: the way begins anew
constexpr int kMostGoalsFailed = 5;               ///< in a row
constexpr Time kRests = std::chrono::seconds(5);  ///< then a tone sounds before it drives again
constexpr Time kLooks = std::chrono::seconds(2);  ///< in each direction, for a lost visitor
constexpr Time kStuck = std::chrono::seconds(4);  ///< on the way to where he was last
constexpr double kLooksOn = 1.2;                  ///< [rad] to the next one, a camera's view
constexpr int kLooksInATurn = 6;                  ///< then the way to him may be free again

}  // namespace

bool Guide::choose_following(const std::string& option, Time now) {
  if (follows()) {
    const bool there = option == button::kDone;
    visit_.travel_time += now - departed_;
    if (there && visit_.arrived++ == 0) ++funnel_.arrived;
    if (!there) stop_robot();
    leave_journey(!there);
    enter(State::kEndAsk, there ? Cause::kYes : Cause::kNo, now);
    return true;
  }
  place_ = {};
  goal_id_ = first_goal_ = 0;
  acknowledged_ = false;
  goals_failed_ = 0;
  trail_ = {};
  going_to_.reset();
  looks_round_ = false;
  looks_ = 0;
  blocked_since_.reset();
  pleads_ = false;
  pleaded_ = {};
  unseen_since_.reset();
  not_allowed_since_.reset();
  stands_told_.reset();
  unheard_since_.reset();
  departed_ = asked_again_ = moved_at_ = drove_at_ = now;
  move_at_ = now + parameters_.tone;
  sentence_ = say(Text::kWalkAhead);
  sentence_at_ = now;
  if (visit_.started++ == 0) ++funnel_.started;
  enter(State::kFollowMe, Cause::kChoice, now);
  screen_.tone = Tone::kMoving;
  start_navigation();
  return true;
}

void Guide::start_navigation() {
  actions_.requests.push_back({RequestKind::kNavigationStart, goal_name()});
  actions_.requests.push_back({RequestKind::kNavigationGo, {}});
}

/// The goal of this guide that the navigator pursues, if it does.
std::optional<std::uint64_t> Guide::own_goal() const {
  const auto& navigation = surroundings_.navigation;
  const bool ours = navigator_drives() && first_goal_ != 0 && navigation->goal_id >= first_goal_ &&
                    navigation->goal_id < next_id_;
  return ours ? std::optional(navigation->goal_id) : std::nullopt;
}

/// What became of the newest goal. One after the other replaces the one before it, so all from
/// the first on are ours.
void Guide::watch_following(Time now) {
  const auto& navigation = surroundings_.navigation;
  if (goal_id_ == 0) {
    if (const auto stray = own_goal()) actions_.cancel = *stray;  // one cancel was lost
    unheard_since_.reset();
    return;
  }
  if (!navigation || navigation->goal_id != goal_id_) {
    const bool other = navigator_drives() && !own_goal();
    if (other && acknowledged_) return fail(Text::kOtherGoal, Cause::kFailure, now);
    return await_navigator(now);  // not anew with each goal
  }
  const auto reached = goal_reached(now);
  if (!reached) return;
  goal_id_ = 0;
  actions_.remember = true;
  if (*reached) {
    goals_failed_ = 0;
    return;
  }
  if (looks_round_) return;
  going_to_.reset();
  if (++goals_failed_ >= kMostGoalsFailed) fail(Text::kNoWay, Cause::kFailure, now);
}

void Guide::follow_visitor(Time now) {
  const auto& visitor = surroundings_.visitor;
  const auto& pose = surroundings_.pose;
  if (pose && trail_.empty()) trail_.begin(pose->position());
  if (visitor && visitor->seen && pose) {
    if (unseen_since_ && sentence_ != say(Text::kWalkAhead)) {
      say_on_the_way(Text::kWalkAhead, Tone::kNone, now);
    }
    unseen_since_.reset();
    if (visitor->in_map) {
      if ((*visitor->in_map - trail_.newest()).norm() > kJump) trail_.begin(pose->position());
      trail_.see(*visitor->in_map);
    }
  } else if (!unseen_since_) {
    unseen_since_ = now;
  }
  const bool lost = unseen_since_ && now - *unseen_since_ >= parameters_.follow.unseen;
  if (lost && now - *unseen_since_ >= parameters_.follow.give_up) {
    lost_visitor_ = true;
    visit_.travel_time += now - departed_;
    leave_journey();
    return enter(State::kEnd, Cause::kLeft, now);
  }
  if (lost &&
      (sentence_ != say(Text::kComeBack) || now - sentence_at_ >= parameters_.follow.call)) {
    say_on_the_way(Text::kComeBack, Tone::kCall, now);
  }
  if (move_at_ && now >= *move_at_) {
    move_at_.reset();
    lift_stop();
    actions_.remember = true;
  }
  if (goal_id_ != 0) drove_at_ = now;
  if (!move_at_ && !stopped_ && pose) go_behind(now);
}

void Guide::go_behind(Time now) {
  const geometry::Point2 robot = surroundings_.pose->position();
  const auto& visitor = surroundings_.visitor;
  const bool seen = visitor && visitor->seen;
  const bool near = seen && std::hypot(visitor->x, visitor->y) < parameters_.behind;
  if (near || (seen && looks_round_)) {  // he has stopped or come back, or is found
    if (goal_id_ != 0) {
      actions_.cancel = goal_id_;
      actions_.remember = true;
    }
    goal_id_ = 0;
    blocked_since_.reset();
    looks_round_ = false;
    looks_ = 0;
    going_to_.reset();
    return;
  }
  // One who went round a corner is looked for where he was last.
  const bool unseen = unseen_since_ && now - *unseen_since_ >= parameters_.follow.unseen;
  const auto place = trail_.behind(unseen ? kLookFrom : parameters_.behind);
  if (!place || (place->position() - robot).norm() < kGoalStep) {
    if (unseen) look_round(now);
    return;
  }
  // Never past him.
  if (seen && (place->position() - robot).norm() > std::hypot(visitor->x, visitor->y)) return;
  if (going_to_ && (place->position() - *going_to_).norm() < kGoalStep) {
    if (unseen) look_round(now);  // from as near as it comes
    return;
  }
  if (going_to_ && now - goal_given_at_ < kGoalEvery) return;
  if (go_to(*place, now)) going_to_ = place->position(), looks_round_ = false;
}

/// A lost visitor is not where he was last seen: a camera's view farther round after the other. The
/// way there is tried again after each turn.
void Guide::look_round(Time now) {
  const bool stuck = blocked_since_ && now - *blocked_since_ >= kStuck && !looks_round_;
  if (!stuck && (goal_id_ != 0 || now - drove_at_ < kLooks)) return;
  if (looks_ == kLooksInATurn) {
    looks_ = 0;
    going_to_.reset();
    return;
  }
  geometry::Pose2 turned = *surroundings_.pose;
  turned.yaw = geometry::normalized(turned.yaw + kLooksOn);
  if (!go_to(turned, now)) return;
  looks_round_ = true;
  ++looks_;
}

/// False: it has rested, and a tone sounds first.
bool Guide::go_to(const geometry::Pose2& place, Time now) {
  if (now - drove_at_ >= kRests) {
    drove_at_ = now;
    move_at_ = now + parameters_.tone;
    sound(Tone::kMoving);
    return false;
  }
  goal_id_ = next_id_++;
  if (first_goal_ == 0) first_goal_ = goal_id_;
  goal_given_at_ = now;
  actions_.goal = Goal{goal_id_, {}, place};
  moved_at_ = now;
  // For the supervisor a navigation ends with each goal that is reached.
  if (surroundings_.supervisor == Supervisor::kAvailable) start_navigation();
  actions_.remember = true;
  return true;
}

}  // namespace usher::guide
