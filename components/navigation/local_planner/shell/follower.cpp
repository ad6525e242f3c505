#include "navigation/local_planner/shell/follower.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/stopping.hpp"
#include "wire/whiskers.hpp"

namespace usher::local_planner {

namespace {

using namespace usher_msgs::msg::GoalStatus_Constants;
using namespace usher_msgs::msg::FollowGoal_Constants;
using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kCostsAge = milliseconds(250);
constexpr auto kOdomAge = milliseconds(150);
constexpr auto kWhiskerAge = milliseconds(300);
constexpr auto kPeopleAge = milliseconds(400);
constexpr auto kNavigatorAge = milliseconds(600);  // it speaks five times a second
constexpr double kFarthestBack = 3.0;              // [m] of its own way that the planner knows
constexpr double kFarthestTurn = 6.4;              // [rad] once around
constexpr double kBody = 0.25;                     // [m] radius of a person
constexpr double kSeenLately = 0.5;                // [s]
constexpr double kBlind = 1.0;                     // [m] from the middle of the robot
constexpr double kLongestPrediction = 0.1;         // [s] from the odometry's stamp to now
constexpr double kPathShift = 0.005;               // [m] less is not worth placing the path anew
constexpr double kPathTurn = 0.002;                // [rad]

}  // namespace

DynamicWindowConfig read_motion(runtime::Host& host) {
  auto& p = host.parameters();
  DynamicWindowConfig c;
  c.footprint = wire::read_footprint(host);
  c.whiskers = wire::read_whiskers(host);
  c.stopping = wire::read_stopping(host);
  c.pace = p.number("pace", "m/s", {0.1, 1.4}, c.pace, "Speed to keep where it can be stopped.");
  c.careful_speed = p.number(
      "careful_speed", "m/s", {0, 1.5}, c.careful_speed,
      "Up to here half of the clearance is enough; beside people, and where nobody tells of them.");
  c.slowest = p.number("slowest", "m/s", {0.01, 0.5}, c.slowest,
                       "The base does not follow slower commands well.");
  c.clearance = p.number("clearance", "m", {0, 0.5}, c.clearance,
                         "Kept around the outline above the careful speed.");
  c.fastest_turn =
      p.number("fastest_turn", "rad/s", {0.1, 2}, c.fastest_turn, "Greatest turn rate.");
  c.spot_turn = p.number("spot_turn", "rad/s", {0.1, 2}, c.spot_turn, "Turn rate in place.");
  c.limits.acceleration =
      p.number("acceleration", "m/s2", {0.1, 3}, 0.7, "Of the command, away from standstill.");
  c.limits.deceleration =
      p.number("deceleration", "m/s2", {0.1, 5}, 1.0, "Of the command, toward standstill.");
  c.limits.angular_acceleration =
      p.number("angular_acceleration", "rad/s2", {0.1, 10}, 1.5, "Of the turn command.");
  c.tight_turn =
      p.number("tight_turn", "rad/s", {0.05, 2}, c.tight_turn,
               "Turn rate in place without half of the clearance; 1.5 times that without the "
               "whole.");
  c.braking =
      p.number("braking", "m/s2", {0.1, 10}, c.braking, "Slope of the command when it must stop.");
  c.response.latency = p.number("robot.response.latency", "s", {0, 1}, c.response.latency,
                                "From a command to the base's first change.");
  c.response.time_constant = p.number("robot.response.time_constant", "s", {0.05, 3},
                                      c.response.time_constant, "Lag of the base's speed.");
  c.response.turn_time_constant =
      p.number("robot.response.turn_time_constant", "s", {0.05, 3}, c.response.turn_time_constant,
               "Lag of the base's turn rate.");
  c.response.acceleration =
      p.number("robot.response.acceleration", "m/s2", {0.1, 5}, c.response.acceleration,
               "Acceleration that the base reaches.");
  c.margin = p.number("margin", "m", {0, 1}, c.margin, "Room left after stopping.");
  c.position_tolerance = p.number("position_tolerance", "m", {0.02, 1}, c.position_tolerance,
                                  "The goal is reached within this.");
  c.yaw_tolerance = p.number("yaw_tolerance", "rad", {0.01, 3.2}, c.yaw_tolerance,
                             "The goal's yaw is reached within this.");
  return c;
}

FollowerComponent::FollowerComponent(runtime::Host& host, std::shared_ptr<PathFollower> follower,
                                     const DynamicWindowConfig& motion)
    : host_(host),
      follower_(std::move(follower)),
      default_pace_(motion.pace),
      slowest_(motion.slowest),
      careful_pace_(std::clamp(motion.careful_speed, motion.slowest, motion.pace)),
      pace_(motion.pace),
      back_off_speed_(host.parameters().number("back_off_speed", "m/s", {0.05, 0.5}, 0.15,
                                               "Speed of the recovery that backs off.")),
      turn_rate_(host.parameters().number("recovery_turn_rate", "rad/s", {0.1, 1.5}, 0.5,
                                          "Rate of the recovery that turns.")),
      people_needed_(host.parameters().flag(
          "people_needed", false,
          "Somebody tells of people on this robot: until then it drives at the careful speed.")),
      rejected_(host.health().counter("inputs: rejected")),
      transforms_(host) {
  goal_ = host.input(topics::kFollowGoal, {.optional = true},
                     [this](const auto& goal, const auto&) { take_goal(goal); });
  navigator_ = host.input(
      topics::kNavigateStatus,
      {.max_age = kNavigatorAge, .on_loss = "stands and forgets its goal until it is given again"});
  cancel_ = host.input(topics::kFollowCancel, {.optional = true},
                       [this](const auto& message, const auto&) { cancel(message); });
  costs_ = host.input(
      topics::kLocalCosts, {.max_age = kCostsAge, .on_loss = "commands zero and waits"},
      [this](const auto& message, const auto& info) { take_costs(message, info.effective); },
      [this] { stand(STATE_WAITING, "no local costs"); });
  odom_ = host.input(topics::kOdom, {.max_age = kOdomAge, .on_loss = "commands zero and waits"}, {},
                     [this] { stand(STATE_WAITING, "no odometry"); });
  whiskers_ = host.input(
      topics::kWhiskers,
      {.max_age = kWhiskerAge, .on_loss = "takes nothing for touched", .optional = true});
  people_ = host.input(topics::kPeople,
                       {.max_age = kPeopleAge,
                        .on_loss = "drives at the careful speed if it needs them or had heard of "
                                   "any; the costs hold who is there",
                        .optional = true},
                       [this](const auto& people, const auto&) {
                         if (people.header().frame_id() != frames::kOdom) ++rejected_;
                       });
  command_ = host.output(topics::kCmdVelNavigation);
  status_ = host.output(topics::kFollowStatus);
  view_ = host.output(topics::kLocalPlan);
}

void FollowerComponent::take_goal(const usher_msgs::msg::FollowGoal& goal) {
  auto path = wire::from_message(goal.path());
  const bool wants_path = goal.mode() == MODE_PATH;
  const double farthest = goal.mode() == MODE_BACK_OFF ? kFarthestBack : kFarthestTurn;
  if (!path || !(std::abs(goal.amount()) <= farthest) || !std::isfinite(goal.max_speed()) ||
      goal.mode() > MODE_BACK_OFF ||
      (wants_path && (path->empty() || goal.path().header().frame_id() != frames::kMap))) {
    ++rejected_;
    return;
  }
  const double pace =
      goal.max_speed() > 0.0F ? static_cast<double>(goal.max_speed()) : default_pace_;
  // Slower than the base can follow is as slow as it can. The pace may change along the same path.
  pace_ = std::clamp(pace, slowest_, default_pace_);
  const bool recovering = goal.mode() == MODE_ROTATE || goal.mode() == MODE_BACK_OFF;
  const bool repeated = goal.id() == goal_id_ && goal.client() == client_ && goal.mode() == mode_;
  if (repeated && (recovering || *path == path_in_map_))
    return;  // the client did not hear the answer yet
  goal_id_ = goal.id();
  client_ = goal.client();
  mode_ = goal.mode();
  amount_ = goal.amount();
  recovery_start_.reset();
  path_in_map_ = std::move(path).value();
  path_placed_by_.reset();
  blocked_since_.reset();
  if (!wants_path) follower_->clear_path();
  state_ = mode_ == MODE_STOP ? STATE_IDLE : STATE_ACTIVE;
}

void FollowerComponent::cancel(const usher_msgs::msg::GoalCancel& cancel) {
  if (cancel.id() != 0 && cancel.id() != goal_id_) return;
  mode_ = MODE_STOP;
  follower_->clear_path();
  stand(STATE_CANCELLED, "cancelled");
}

/// As after a restart: a navigator that lives hears that its goal is not known here and gives it
/// again, one that was restarted knows better than to go on as before.
void FollowerComponent::forget_goal(const std::string& reason) {
  mode_ = MODE_STOP;
  goal_id_ = 0;
  client_.clear();
  follower_->clear_path();
  blocked_since_.reset();
  stand(STATE_IDLE, reason);
}

void FollowerComponent::take_costs(const usher_msgs::msg::Costmap& message,
                                   runtime::Time effective) {
  const auto costs = wire::from_message(message);
  if (!costs || message.header().frame_id() != frames::kOdom) {
    ++rejected_;
    stand(STATE_WAITING, "local costs refused");
    return;
  }
  decide(*costs, effective);
}

void FollowerComponent::decide(const grid::Grid<std::uint8_t>& costs, runtime::Time effective) {
  if (mode_ == MODE_STOP || state_ == STATE_SUCCEEDED || state_ == STATE_FAILED ||
      state_ == STATE_CANCELLED) {
    stand(state_, "");
    host_.health().set(HealthState::kOk);
    return;
  }
  if (navigator_.fresh() == nullptr) return forget_goal("no navigator");
  const auto* odom = odom_.fresh();
  const auto pose_then =
      odom ? wire::to_planar(odom->pose().pose()) : Result<geometry::Pose2>(Error{"no odometry"});
  const auto measured = odom ? wire::from_message(odom->twist().twist())
                             : Result<geometry::Twist2>(Error{"no odometry"});
  if (!pose_then || !measured) {
    if (odom != nullptr) ++rejected_;
    stand(STATE_WAITING, pose_then ? measured.error() : pose_then.error());
    return;
  }
  const double age = runtime::seconds(host_.now() - odom_.info()->effective);
  const auto pose =
      geometry::integrate(*pose_then, *measured, std::clamp(age, 0.0, kLongestPrediction));
  if (mode_ == MODE_PATH && !place_path()) {
    stand(STATE_WAITING, "robot not localized");
    return;
  }
  if (const std::string missing = not_ready(); mode_ == MODE_PATH && !missing.empty()) {
    stand(STATE_WAITING, missing);
    return;
  }
  const Decision decided = decision(costs, pose, *measured);
  if (decided.reason == Reason::kInvalidInput) {
    stand(STATE_WAITING, to_string(decided.reason));
    return;
  }
  last_command_ = decided.command;
  roll_out_.drive(last_command_, host_.now().time_since_epoch());
  last_decision_ = host_.now();
  command_.publish(wire::to_message(effective, decided.command));
  if (view_.reader_count() > 0)
    view_.publish(wire::to_message(effective, frames::kOdom, decided.trajectory));
  conclude(decided, pose);
}

Decision FollowerComponent::decision(const grid::Grid<std::uint8_t>& costs,
                                     const geometry::Pose2& pose,
                                     const geometry::Twist2& measured) {
  const double elapsed = std::clamp(runtime::seconds(host_.now() - last_decision_), 0.0, 0.2);
  const auto* t = whiskers_.fresh();
  follower_->set_touches(t == nullptr ? kinematics::Whiskers{}
                                      : kinematics::Whiskers{t->front_left(), t->front_right(),
                                                             t->back_left(), t->back_right()});
  place_people(pose.position());
  const Status paced =
      follower_->set_pace(people_are_missing() ? std::min(pace_, careful_pace_) : pace_);
  assert(paced);  // within the parameters' bounds
  static_cast<void>(paced);
  if (mode_ == MODE_BACK_OFF)
    return follower_->back_off(costs, pose, measured, last_command_, elapsed, back_off_speed_,
                               everybody_);
  if (mode_ == MODE_ROTATE)
    return follower_->rotate(costs, pose, measured, last_command_, elapsed,
                             std::copysign(turn_rate_, amount_), everybody_);
  return follower_->decide(costs, pose, measured, last_command_, elapsed, everybody_);
}

/// Who in odom, or nobody that is known of.
const usher_msgs::msg::People* FollowerComponent::people_now() const {
  const auto* people = people_.fresh();
  return people != nullptr && people->header().frame_id() == frames::kOdom ? people : nullptr;
}

/// A robot that should be told of people, and is not, cannot tell who comes its way from what
/// stands.
bool FollowerComponent::people_are_missing() const {
  return people_now() == nullptr && (people_needed_ || people_.info() != nullptr);
}

/// Everybody who was seen lately, where they are by now; near the robot, where range finders are
/// blind, also who was seen there before.
void FollowerComponent::place_people(const geometry::Point2& here) {
  everybody_.clear();
  const auto* message = people_now();
  if (message == nullptr) return;
  const double age = runtime::seconds(host_.now() - people_.info()->effective);
  for (const auto& person : message->people()) {
    const geometry::Point2 velocity{person.vx(), person.vy()};
    const geometry::Point2 position = geometry::Point2{person.x(), person.y()} + age * velocity;
    if (!position.allFinite() || !velocity.allFinite()) continue;
    const bool near = (position - here).norm() < kBlind;
    if (!(static_cast<double>(person.unseen()) <= kSeenLately) && !near) continue;
    everybody_.push_back({position, velocity, kBody});
  }
}

/// The path lives in map, the robot drives in odom: follows what localization corrects between the
/// two.
bool FollowerComponent::place_path() {
  const auto newest = transforms_.buffer().newest(frames::kOdom, frames::kMap);
  if (!newest) return false;
  const auto odom_T_map =
      transforms_.lookup_planar(frames::kOdom, frames::kMap, runtime::Time(*newest));
  if (!odom_T_map) return false;
  if (path_placed_by_ &&
      geometry::distance(*path_placed_by_ * path_in_map_.back(),
                         *odom_T_map * path_in_map_.back()) < kPathShift &&
      std::abs(geometry::shortest_turn(path_placed_by_->yaw, odom_T_map->yaw)) < kPathTurn) {
    return true;
  }
  std::vector<geometry::Pose2> path(path_in_map_.size());
  for (std::size_t i = 0; i < path.size(); ++i) path[i] = *odom_T_map * path_in_map_[i];
  if (!follower_->set_path(path)) {
    ++rejected_;
    return false;
  }
  path_placed_by_ = *odom_T_map;
  return true;
}

void FollowerComponent::conclude(const Decision& decided, const geometry::Pose2& pose) {
  double remaining = 0.0;
  bool done = decided.reached;
  if (mode_ == MODE_PATH) {
    remaining = follower_->remaining();
  } else {
    if (!recovery_start_) recovery_start_ = pose, last_yaw_ = pose.yaw, turned_ = 0.0;
    turned_ += geometry::shortest_turn(last_yaw_, pose.yaw);
    last_yaw_ = pose.yaw;
    const double made =
        mode_ == MODE_ROTATE ? std::abs(turned_) : geometry::distance(*recovery_start_, pose);
    remaining = std::max(0.0, std::abs(amount_) - made);
    done = remaining == 0.0;
  }
  const bool stands = decided.blocked || decided.reason == Reason::kNoPath;
  if (!stands) {
    blocked_since_.reset();
  } else if (!blocked_since_) {
    blocked_since_ = host_.now();
  }
  if (done) {
    last_command_ = {};
    command_.publish(wire::to_message(host_.now(), last_command_));
  }
  publish_status(done     ? STATE_SUCCEEDED
                 : stands ? STATE_WAITING
                          : STATE_ACTIVE,
                 stands ? to_string(decided.reason) : "", remaining, decided.obstacle_distance);
  if (people_are_missing()) {
    host_.health().set(HealthState::kDegraded, "nobody tells of people: drives slowly");
  } else {
    host_.health().set(HealthState::kOk);
  }
}

void FollowerComponent::stand(std::uint8_t state, const std::string& reason) {
  last_command_ = roll_out_.stop(measured(), host_.now().time_since_epoch());
  last_decision_ = host_.now();
  command_.publish(wire::to_message(host_.now(), last_command_));
  publish_status(mode_ == MODE_STOP && state == STATE_WAITING ? STATE_IDLE : state, reason, 0.0,
                 std::numeric_limits<double>::infinity());
  if (state == STATE_WAITING) host_.health().set(HealthState::kDegraded, reason);
}

std::optional<geometry::Twist2> FollowerComponent::measured() const {
  const auto* odom = odom_.fresh();
  if (odom == nullptr) return std::nullopt;
  const auto twist = wire::from_message(odom->twist().twist());
  return twist.ok() ? std::optional(*twist) : std::nullopt;
}

void FollowerComponent::publish_status(std::uint8_t state, const std::string& reason,
                                       double remaining, double obstacle) {
  state_ = state;
  usher_msgs::msg::FollowStatus status;
  status.header(wire::header(host_.now(), frames::kOdom));
  status.id(goal_id_);
  status.state(state);
  status.reason(reason);
  status.remaining(static_cast<float>(remaining));
  status.blocked_for(
      blocked_since_ ? static_cast<float>(runtime::seconds(host_.now() - *blocked_since_)) : 0.0F);
  status.obstacle_distance(static_cast<float>(obstacle));
  status_.publish(status);
}

}  // namespace usher::local_planner
