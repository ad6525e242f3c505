#include "navigation/local_planner/core/waypoint_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foundation/result/bounds.hpp"

namespace usher::local_planner {
namespace {

using geometry::Point2;
using geometry::Pose2;
using geometry::Twist2;

constexpr double kStanding = 0.05;     // [m/s] slower than this the robot stands
constexpr double kLongestCycle = 0.2;  // [s] a command is ramped for at most this long after a gap
constexpr double kCurveGain = 1.2;     // [rad/s] of turn for each radian off
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance_to_line(const Point2& point, const Point2& a, const Point2& b) {
  const Point2 way = b - a;
  const double squared = way.squaredNorm();
  if (squared == 0.0) return (point - a).norm();
  const double share = std::clamp((point - a).dot(way) / squared, 0.0, 1.0);
  return (a + share * way - point).norm();
}

Status check(const WaypointFollowerConfig& c) {
  return within({{"heading_tolerance", c.heading_tolerance, 0.02, 1.0, "rad"},
                 {"waypoint_radius", c.waypoint_radius, 0.05, 1.0, "m"},
                 {"safe_distance", c.safe_distance, 0.1, 3.0, "m"},
                 {"sector_angle", c.sector_angle, 0.2, 3.1, "rad"},
                 {"sectors", static_cast<double>(c.sectors), 1, SectorMedians::kMost},
                 {"lost_heading", c.lost_heading, c.heading_tolerance, 3.0, "rad"},
                 {"corner_tolerance", c.corner_tolerance, 0.005, 0.5, "m"}});
}

}  // namespace

void SectorMedians::take(std::span<const float> ranges, double angle_min, double increment,
                         const Pose2& base_T_laser) {
  readings_.resize(static_cast<std::size_t>(sectors_));
  for (auto& readings : readings_) readings.clear();
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float range = ranges[i];
    if (std::isnan(range) || range < 0.0F) continue;
    double bearing =
        geometry::normalized(base_T_laser.yaw + angle_min + static_cast<double>(i) * increment);
    float distance = range;
    if (std::isfinite(range)) {
      const double direction = angle_min + static_cast<double>(i) * increment;
      const Point2 end =
          base_T_laser * Point2(range * std::cos(direction), range * std::sin(direction));
      bearing = std::atan2(end.y(), end.x());
      distance = static_cast<float>(end.norm());
    }
    const double share = bearing / angle_ + 0.5;
    if (!(share >= 0.0 && share < 1.0)) continue;
    readings_[static_cast<std::size_t>(share * sectors_)].push_back(distance);
  }
  medians_.clear();
  for (auto& readings : readings_) {
    if (readings.empty()) {
      medians_.push_back(0.0);
      continue;
    }
    const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
    std::nth_element(readings.begin(), middle, readings.end());
    medians_.push_back(*middle);
  }
}

double SectorMedians::nearest() const {
  return medians_.empty() ? 0.0 : *std::min_element(medians_.begin(), medians_.end());
}

std::vector<Point2> corners(std::span<const Pose2> path, double tolerance) {
  if (path.empty()) return {};
  std::vector<bool> kept(path.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, path.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = tolerance;
    std::size_t corner = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance =
          distance_to_line(path[i].position(), path[first].position(), path[last].position());
      if (distance <= farthest) continue;
      farthest = distance;
      corner = i;
    }
    if (corner == first) continue;
    kept[corner] = true;
    open.emplace_back(first, corner);
    open.emplace_back(corner, last);
  }
  std::vector<Point2> corners;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (kept[i]) corners.push_back(path[i].position());
  }
  return corners;
}

Result<WaypointFollower> WaypointFollower::make(const WaypointFollowerConfig& config) {
  if (const Status status = check(config); !status) return Error{status.error()};
  auto window = DynamicWindow::make(config.motion);
  if (!window) return Error{window.error()};
  return WaypointFollower(config, std::move(window).value());
}

WaypointFollower::WaypointFollower(const WaypointFollowerConfig& config, DynamicWindow window)
    : config_(config), window_(std::move(window)), sectors_(config.sector_angle, config.sectors) {
  for (const Point2& corner : config.motion.footprint.corners()) {
    outline_ahead_ = std::max(outline_ahead_, corner.x());
    outline_beside_ = std::max(outline_beside_, std::abs(corner.y()));
  }
}

/// The first point of a path is where the robot is: it is consumed at once.
Status WaypointFollower::set_path(std::span<const Pose2> path) {
  const bool had_goal = !path_.empty();
  const Pose2 old = path_.goal();
  if (Status status = path_.set(path); !status) return status;
  waypoints_ = corners(path, config_.corner_tolerance);
  next_ = waypoints_.size() > 1 ? 1 : 0;
  turning_ = true;
  const bool same_goal =
      had_goal && geometry::distance(old, path_.goal()) <= motion().position_tolerance;
  if (!same_goal) arrived_ = false;
  return {};
}

void WaypointFollower::clear_path() {
  path_.clear();
  waypoints_.clear();
  arrived_ = false;
}

Status WaypointFollower::set_pace(double pace) {
  if (Status status = window_.set_pace(pace); !status) return status;
  config_.motion.pace = pace;
  return {};
}

void WaypointFollower::pass_waypoints(const Point2& position) {
  while (!last_waypoint() && (waypoints_[next_] - position).norm() < config_.waypoint_radius) {
    ++next_;
    turning_ = true;
  }
}

/// [rad] between the way to the next waypoint's end and the way after it; 0 at the last one.
double WaypointFollower::turn_at_next() const {
  if (last_waypoint() || next_ == 0) return 0.0;
  const Point2 here = waypoints_[next_] - waypoints_[next_ - 1];
  const Point2 there = waypoints_[next_ + 1] - waypoints_[next_];
  return std::abs(
      geometry::shortest_turn(std::atan2(here.y(), here.x()), std::atan2(there.y(), there.x())));
}

/// [m] to what a straight drive would meet.
double WaypointFollower::obstacle_ahead() const {
  double room = kInfinity;
  const auto medians = sectors_.medians();
  for (std::size_t i = 0; i < medians.size(); ++i) {
    const double bearing = sectors_.bearing(i);
    if (std::abs(medians[i] * std::sin(bearing)) > outline_beside_ + motion().clearance) continue;
    room = std::min(room, medians[i] * std::cos(bearing) - outline_ahead_);
  }
  return room;
}

Decision WaypointFollower::halt(const Input& input, Reason reason, double deceleration) const {
  kinematics::AccelerationLimits limits = motion().limits;
  limits.deceleration = deceleration;
  Decision decision;
  decision.reason = reason;
  decision.blocked = reason == Reason::kBlocked || reason == Reason::kBraking;
  decision.command = kinematics::limited(input.last_command, {}, limits, input.seconds);
  return decision;
}

/// In place; the long way round where the short one has no room.
Decision WaypointFollower::turn(const Input& input, double angle, Reason reason) {
  if (std::abs(input.measured.v) > kStanding || input.last_command.v != 0.0)
    return halt(input, reason, motion().limits.deceleration);
  const double rate = std::clamp(std::abs(angle) / motion().turn_stopping_time,
                                 motion().slowest_turn, motion().spot_turn);
  const int first = sense_ != 0 ? sense_ : angle > 0.0 ? 1 : -1;
  for (const int sense : {first, -first}) {
    Decision decision = rotate(input.costs, input.pose, input.measured, input.last_command,
                               input.seconds, sense * rate);
    if (decision.reason == Reason::kInvalidInput) return decision;
    if (decision.blocked) continue;
    sense_ = sense;
    decision.reason = reason;
    return decision;
  }
  return halt(input, Reason::kBlocked, motion().braking);
}

Decision WaypointFollower::at_goal(const Input& input) {
  const double angle = geometry::shortest_turn(input.pose.yaw, path_.goal().yaw);
  if (std::abs(angle) > motion().yaw_tolerance) return turn(input, angle, Reason::kTurningToGoal);
  const bool standing = std::abs(input.measured.v) < kStanding && std::abs(input.measured.w) < 0.1;
  sense_ = 0;
  Decision decision = halt(input, standing ? Reason::kReached : Reason::kTurningToGoal,
                           motion().limits.deceleration);
  decision.reached = standing;
  return decision;
}

Decision WaypointFollower::drive(const Input& input, double error, double distance) {
  const double lag = (motion().response.time_constant + motion().response.latency) *
                     std::max(0.0, input.measured.v);
  const auto stopping_before = [&](double room) { return motion().stopping.speed(room - lag); };
  double speed = std::min({motion().pace, stopping_before(path_.remaining()),
                           stopping_before(obstacle_ahead() - motion().margin)});
  // It stops to turn at the next corner.
  if (turn_at_next() > config_.heading_tolerance)
    speed = std::min(speed, stopping_before(distance - 0.5 * config_.waypoint_radius));
  speed = std::max(speed, motion().slowest);
  double turn = 0.0;
  if (std::abs(error) > config_.heading_tolerance)
    turn = std::clamp(kCurveGain * error, -motion().fastest_turn, motion().fastest_turn);
  Decision decision;
  decision.reason = Reason::kFollowing;
  decision.target = {speed, turn};
  decision.command =
      kinematics::limited(input.last_command, decision.target, motion().limits, input.seconds);
  way_.clear();
  constexpr int kShown = 10;
  for (int i = 0; i <= kShown; ++i)
    way_.push_back(
        geometry::integrate(input.pose, decision.target, motion().simulated_time * i / kShown));
  decision.trajectory = way_;
  return decision;
}

Decision WaypointFollower::decide(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                                  const Twist2& measured, const Twist2& last_command,
                                  double seconds_since_last, std::span<const MovingDisc>) {
  const double seconds =
      seconds_since_last > 0.0 ? std::min(seconds_since_last, kLongestCycle) : 0.0;
  const Input input{costs, pose, measured, last_command, seconds};
  if (!pose.finite() || !(pose.position().cwiseAbs().maxCoeff() < 1e6) || !measured.finite() ||
      !last_command.finite() || costs.empty() ||
      !costs.geometry().contains(costs.geometry().cell_at(pose.position()))) {
    Decision refused;
    refused.reason = Reason::kInvalidInput;
    return refused;
  }
  window_.note_place(pose);
  if (path_.empty()) return halt(input, Reason::kNoPath, motion().limits.deceleration);
  path_.advance(pose.position());
  pass_waypoints(pose.position());
  const Point2 way = waypoints_[next_] - pose.position();
  const double distance = way.norm();
  // Within half of its radius, so that it does not stop on the rim.
  if (last_waypoint() && distance < 0.5 * config_.waypoint_radius) arrived_ = true;
  if (last_waypoint() && distance > config_.waypoint_radius + 0.1) arrived_ = false;
  const double obstacle = sectors_.nearest();
  const auto with_obstacle = [obstacle](Decision decision) {
    decision.obstacle_distance = obstacle;
    return decision;
  };
  if (arrived_) return with_obstacle(at_goal(input));
  const double error = geometry::shortest_turn(pose.yaw, std::atan2(way.y(), way.x()));
  if (std::abs(error) > config_.lost_heading) turning_ = true;
  if (turning_ && std::abs(error) > config_.heading_tolerance)
    return with_obstacle(turn(input, error, Reason::kTurning));
  turning_ = false;
  sense_ = 0;
  if (obstacle < config_.safe_distance) {
    const bool standing = std::abs(measured.v) < kStanding;
    return with_obstacle(
        halt(input, standing ? Reason::kBlocked : Reason::kBraking, motion().braking));
  }
  return with_obstacle(drive(input, error, distance));
}

Decision WaypointFollower::back_off(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                                    const Twist2& measured, const Twist2& last_command,
                                    double seconds_since_last, double speed,
                                    std::span<const MovingDisc> people) {
  return window_.back_off(costs, pose, measured, last_command, seconds_since_last, speed, people);
}

Decision WaypointFollower::rotate(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                                  const Twist2& measured, const Twist2& last_command,
                                  double seconds_since_last, double rate,
                                  std::span<const MovingDisc> people) {
  return window_.rotate(costs, pose, measured, last_command, seconds_since_last, rate, people);
}

}  // namespace usher::local_planner
