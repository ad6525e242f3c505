// The critics of the dynamic window: what each trajectory is measured by.
#include <algorithm>
#include <cmath>
#include <limits>

#include "navigation/local_planner/core/dynamic_window.hpp"

namespace usher::local_planner {
namespace {

constexpr double kBehind = 0.3;            // [m] of path behind the robot that still counts as near
constexpr double kForesight = 3.0;         // [s] that moving discs are foreseen
constexpr double kPolylineStep = 0.1;      // [m] 3 mm off an arc of 0.5 m
constexpr double kTurnOnSpot = 0.15;       // [m/s] slower than this a turn is one on the spot
constexpr double kTurnMatters = 0.05;      // [rad/s]
constexpr double kTightPath = 4.0;         // the plan leads through the middle of a door
constexpr double kLanePath = 2.0;          // aside although the middle is cheaper
constexpr double kOscillationWay = 0.05;   // [m] after which the other sense is allowed again
constexpr double kOscillationTurn = 0.35;  // [rad]
constexpr double kRollOutStep = 0.1;       // [m] between tested places

}  // namespace

void DynamicWindow::choose_local_goal(const Input& input) {
  const grid::GridGeometry& geometry = input.costs.geometry();
  const double step = geometry.resolution;
  const auto inside = [&](const geometry::Point2& p) {
    const grid::Cell cell = geometry.cell_at(p);
    return cell.x >= 2 && cell.y >= 2 && cell.x < geometry.width - 2 &&
           cell.y < geometry.height - 2;
  };
  const auto open = [&](const geometry::Point2& p) {
    const std::uint8_t cost = input.costs.at(geometry.cell_at(p));
    return cost < grid::kInscribedCost ||
           (cost == grid::kUnknownCost && !config_.unknown_is_lethal);
  };
  // The last open point before the path leaves the window; the window's half circumference bounds
  // the walk.
  const double farthest = step * (geometry.width + geometry.height);
  double arc = path_.progress();
  local_goal_arc_ = arc;
  goal_in_window_ = false;
  while (arc - path_.progress() < farthest) {
    const geometry::Point2 point = path_.point(arc);
    if (!inside(point)) break;
    if (open(point)) local_goal_arc_ = arc;
    if (arc >= path_.length()) {
      goal_in_window_ = true;
      break;
    }
    arc = std::min(arc + step, path_.length());
  }
  const grid::Cell goal_cell = geometry.cell_at(path_.point(local_goal_arc_));
  wavefront_.set_obstacles(input.costs, grid::kInscribedCost, config_.unknown_is_lethal);
  way_open_ = false;
  if (!geometry.contains(goal_cell)) {  // the path is outside of the window
    goal_lengths_.assign(geometry.size(), grid::Wavefront::kUnreachable);
    front_lengths_ = goal_lengths_;
    aligned_ = false;
    return;
  }
  wavefront_.spread(goal_cell, goal_lengths_);
  const grid::Cell here = geometry.cell_at(input.pose.x, input.pose.y);
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const grid::Cell cell{here.x + dx, here.y + dy};
      if (geometry.contains(cell) &&
          goal_lengths_[geometry.index(cell)] < grid::Wavefront::kUnreachable)
        way_open_ = true;
    }
  }
  aligned_ = path_.remaining() > 2.0 * config_.forward_point;
  if (!aligned_) return;
  grid::Cell front = geometry.cell_at(path_.point(local_goal_arc_ + config_.forward_point));
  front = {std::clamp(front.x, 0, geometry.width - 1), std::clamp(front.y, 0, geometry.height - 1)};
  wavefront_.spread(front, front_lengths_);
}

/// Beyond the window nothing is known: that is no obstacle, the window will move.
bool DynamicWindow::leaves_window(const Input& input, const geometry::Point2& place) const {
  const grid::GridGeometry& geometry = input.costs.geometry();
  const double reach = config_.footprint.circumscribed_radius();
  const double x = place.x() - geometry.origin_x, y = place.y() - geometry.origin_y;
  return !(x >= reach && y >= reach && x <= geometry.width * geometry.resolution - reach &&
           y <= geometry.height * geometry.resolution - reach);
}

double DynamicWindow::obstacle_on_path(const Input& input) const {
  const grid::GridGeometry& geometry = input.costs.geometry();
  TurnedFootprint turned;
  const double end = std::min(
      path_.length(), path_.progress() + geometry.resolution * (geometry.width + geometry.height));
  double arc = path_.progress();
  while (arc < end) {
    arc += geometry.resolution;
    const geometry::Point2 point = path_.point(std::min(arc, end));
    if (leaves_window(input, point)) break;
    const double x = (point.x() - geometry.origin_x) / geometry.resolution;
    const double y = (point.y() - geometry.origin_y) / geometry.resolution;
    if (center_.clear_around(bits_, x, y)) continue;
    // The chord over a short stretch: a grid path's own segments only know eight directions.
    const geometry::Point2 along = path_.point(arc + 0.15) - path_.point(arc - 0.15);
    if (along.norm() < 1e-6) continue;
    center_.turn(along.x() / along.norm(), along.y() / along.norm(), geometry.resolution, turned);
    if (center_.touches(bits_, turned, x, y)) return arc - path_.progress();
  }
  return std::numeric_limits<double>::infinity();
}

void DynamicWindow::sample(const Input& input, double fastest) {
  const kinematics::AccelerationLimits& limits = config_.limits;
  const bool window = config_.sampling == Sampling::kDynamicWindow;
  const double reach = window ? config_.window : config_.simulated_time;
  const geometry::Twist2& last = input.last_command;
  const double slowest = std::min(config_.slowest, fastest);
  const double high =
      std::clamp(std::max(last.v, 0.0) + limits.acceleration * reach, slowest, fastest);
  const double low = std::clamp(last.v - limits.deceleration * reach, slowest, high);
  speeds_.resize(static_cast<std::size_t>(config_.speed_samples));
  const Ramp speed_ramp{limits.acceleration, limits.deceleration, config_.response.latency,
                        config_.response.time_constant, config_.response.acceleration};
  // Who walks is looked at for longer: there is time to let them pass.
  const double step = rollout_.settings().step;
  const int least_steps = input.walkers.empty() ? config_.steps
                                                : std::clamp(static_cast<int>(kForesight / step),
                                                             config_.steps, Rollout::kMostSteps);
  int most_steps = least_steps;
  const double anticipated = config_.response.time_constant + config_.response.latency;
  for (int i = 0; i < config_.speed_samples; ++i) {
    SpeedProfile& profile = speeds_[static_cast<std::size_t>(i)];
    // The slowest is always among them: slowing down is always allowed.
    double v = i == 0 ? slowest : high;
    if (i > 0 && i < config_.speed_samples - 1)
      v = low + (high - low) * (i - 1) / (config_.speed_samples - 2);
    // Told to slow down, the base keeps its speed for a while; then it stops within the measured
    // distance.
    profile.contact = v > config_.careful_speed ? 1 : 0;
    const double faster = std::max(std::abs(input.measured.v), v);
    profile.needed = config_.stopping.distance(v) + config_.margin + anticipated * (faster - v) +
                     (faster * faster - v * v) / (2.0 * limits.deceleration);
    if (goal_in_window_) profile.needed = std::min(profile.needed, path_.remaining() + 0.05);
    rollout_.profile(input.measured.v, last.v, v, speed_ramp, least_steps, profile);
    most_steps = std::max(most_steps, profile.steps);
  }
  sample_turns(input, reach, most_steps);
}

/// Turn rates that can be commanded within `reach` [s], each as the base follows it.
void DynamicWindow::sample_turns(const Input& input, double reach, int steps) {
  const kinematics::AccelerationLimits& limits = config_.limits;
  const Ramp turn_ramp{limits.angular_acceleration, limits.angular_acceleration,
                       config_.response.latency, config_.response.turn_time_constant,
                       config_.response.angular_acceleration};
  const double turn_reach = limits.angular_acceleration * reach;
  const double w = input.last_command.w;
  const double left = std::clamp(w + turn_reach, -config_.fastest_turn, config_.fastest_turn);
  const double right = std::clamp(w - turn_reach, -config_.fastest_turn, config_.fastest_turn);
  turns_.resize(static_cast<std::size_t>(config_.turn_samples));
  const double spacing = (left - right) / (config_.turn_samples - 1);
  for (int i = 0; i < config_.turn_samples; ++i) {
    double target = right + spacing * i;
    if (std::abs(target) <= 0.5 * spacing) target = 0.0;  // straight on, where it is within reach
    rollout_.profile(input.measured.w, w, target, turn_ramp, steps,
                     turns_[static_cast<std::size_t>(i)]);
  }
}

void DynamicWindow::measure_path(const Input& input) {
  // Relative to the robot, so that single precision is exact to micrometres.
  path_distance_.clear();
  const double begin = path_.progress() - kBehind;
  const double end = local_goal_arc_ + config_.forward_point;
  const double step = std::max(kPolylineStep, (end - begin) / 128.0);
  geometry::Point2 a = lane_.point(path_, begin);
  double arc = begin;
  while (arc < end) {
    const geometry::Point2 b = lane_.point(path_, std::min(arc + step, end));
    path_distance_.add(
        static_cast<float>(a.x() - input.pose.x), static_cast<float>(a.y() - input.pose.y),
        static_cast<float>(b.x() - input.pose.x), static_cast<float>(b.y() - input.pose.y));
    a = b;
    arc += step;
  }
  const std::size_t count = rollout_.trajectories().size();
  const std::size_t padded = (4 * count + 7) / 8 * 8;
  points_x_.resize(padded), points_y_.resize(padded), point_distances_.resize(padded);
  const auto ahead = static_cast<float>(config_.forward_point);
  for (std::size_t i = 0; i < 3 * count; ++i)
    points_x_[i] = rollout_.x()[i], points_y_[i] = rollout_.y()[i];
  for (std::size_t i = 0; i < count; ++i) {
    points_x_[3 * count + i] = rollout_.x()[3 * i + 2] + ahead * rollout_.end_cosine()[i];
    points_y_[3 * count + i] = rollout_.y()[3 * i + 2] + ahead * rollout_.end_sine()[i];
  }
  path_distance_.measure(points_x_, points_y_, point_distances_);
}

/// Bilinear between the centers of the reachable cells around the point; a closed point takes the
/// straight line.
double DynamicWindow::way_left(const std::vector<std::uint16_t>& lengths, const Input& input,
                               double x, double y) const {
  const grid::GridGeometry& geometry = input.costs.geometry();
  const double u = (input.pose.x + x - geometry.origin_x) / geometry.resolution - 0.5;
  const double v = (input.pose.y + y - geometry.origin_y) / geometry.resolution - 0.5;
  const int column = static_cast<int>(std::floor(u));
  const int row = static_cast<int>(std::floor(v));
  const double fu = u - column;
  const double fv = v - row;
  double sum = 0.0;
  double weights = 0.0;
  for (int k = 0; k < 4; ++k) {
    const grid::Cell cell{column + (k & 1), row + (k >> 1)};
    if (!geometry.contains(cell)) continue;
    const std::uint16_t length = lengths[geometry.index(cell)];
    if (length >= grid::Wavefront::kUnreachable) continue;
    const double weight = ((k & 1) ? fu : 1.0 - fu) * ((k >> 1) ? fv : 1.0 - fv) + 1e-6;
    sum += weight * length;
    weights += weight;
  }
  if (weights > 0.0) return sum / weights * geometry.resolution / grid::Wavefront::kUnitsPerCell;
  const geometry::Point2 goal = path_.point(local_goal_arc_);
  return 0.5 + std::hypot(goal.x() - input.pose.x - x, goal.y() - input.pose.y - y);
}

bool DynamicWindow::forbidden_turn(double speed, double turn) const {
  return std::abs(speed) < kTurnOnSpot && std::abs(turn) > kTurnMatters &&
         turn * oscillation_forbidden_ > 0.0;
}

void DynamicWindow::note_turn(const Input& input, const geometry::Twist2& command) {
  const geometry::Pose2& since = oscillation_pose_;
  if (distance(since, input.pose) > kOscillationWay ||
      std::abs(geometry::shortest_turn(since.yaw, input.pose.yaw)) > kOscillationTurn) {
    oscillation_forbidden_ = oscillation_sign_ = 0.0;
    oscillation_pose_ = input.pose;
  }
  if (std::abs(command.v) >= kTurnOnSpot || std::abs(command.w) <= kTurnMatters) return;
  const double sign = command.w > 0.0 ? 1.0 : -1.0;
  // The sense has changed without getting anywhere: no way back to the first.
  if (oscillation_sign_ * sign < 0.0) oscillation_forbidden_ = oscillation_sign_;
  if (oscillation_sign_ == 0.0) oscillation_pose_ = input.pose;
  oscillation_sign_ = sign;
}

CriticScores DynamicWindow::score(const Input& input, std::size_t index, double fastest) const {
  const Trajectory& trajectory = rollout_.trajectories()[index];
  const std::size_t count = rollout_.trajectories().size();
  const CriticWeights& weights = config_.weights;
  const double v = speeds_[static_cast<std::size_t>(trajectory.speed)].target;
  const double w = turns_[static_cast<std::size_t>(trajectory.turn)].target;
  const double end_x = rollout_.x()[3 * index + 2];
  const double end_y = rollout_.y()[3 * index + 2];
  CriticScores s;
  const double line = tight_ ? kTightPath : lane_.keeps_aside() ? kLanePath : 1.0;
  if (turns_to_) {
    const double yaw = std::atan2(rollout_.end_sine()[index], rollout_.end_cosine()[index]);
    s.goal = weights.goal * std::abs(geometry::shortest_turn(yaw, *turns_to_));
  } else {
    s.path = line * weights.path / 3.0 *
             (static_cast<double>(point_distances_[3 * index]) +
              static_cast<double>(point_distances_[3 * index + 1]) +
              static_cast<double>(point_distances_[3 * index + 2]));
    s.goal = weights.goal * way_left(goal_lengths_, input, end_x, end_y);
    if (aligned_) {
      s.alignment =
          line * weights.alignment * static_cast<double>(point_distances_[3 * count + index]);
      s.goal_front =
          weights.goal_front * way_left(front_lengths_, input,
                                        static_cast<double>(points_x_[3 * count + index]),
                                        static_cast<double>(points_y_[3 * count + index]));
    }
  }
  const double cut =
      trajectory.contact
          ? 1.0 -
                static_cast<double>(std::min(trajectory.free_steps, config_.steps)) / config_.steps
          : 0.0;
  s.obstacle = weights.obstacle * (static_cast<double>(trajectory.mean_cost) +
                                   static_cast<double>(trajectory.close) + cut);
  s.moving_obstacle = weights.moving_obstacle * static_cast<double>(trajectory.disc_cost);
  s.speed = weights.speed * std::max(0.0, fastest - v) / config_.pace;
  s.twirling = weights.twirling * std::abs(w);
  s.smoothness = weights.smoothness *
                 (std::abs(w - input.last_command.w) + 0.5 * std::abs(v - input.last_command.v));
  s.oscillation = forbidden_turn(v, w) ? weights.oscillation : 0.0;
  return s;
}

/// Anything may stop the base, not only who plans: it rolls out on the arc that it is on by then,
/// and not on the planned one (kinematics::RollOut). A slow base stands before it gets far.
bool DynamicWindow::rolls_out_free(const Input& input, std::size_t index) const {
  const Trajectory& trajectory = rollout_.trajectories()[index];
  const SpeedProfile& speed = speeds_[static_cast<std::size_t>(trajectory.speed)];
  if (speed.target <= config_.careful_speed) return true;
  const SpeedProfile& turn = turns_[static_cast<std::size_t>(trajectory.turn)];
  const auto step = static_cast<std::size_t>(config_.steps / 3);  // whose place is kept
  const double dt = rollout_.settings().step;
  geometry::Pose2 from{input.pose.x + static_cast<double>(rollout_.x()[3 * index]),
                       input.pose.y + static_cast<double>(rollout_.y()[3 * index]), input.pose.yaw};
  for (std::size_t k = 0; k < step; ++k)
    from.yaw += 0.5 * (turn.values[k] + turn.values[k + 1]) * dt;
  const geometry::Twist2 arc{speed.values[step], turn.values[step]};
  const double least = config_.stopping.distance(std::max(arc.v, speed.target)) + config_.margin;
  for (double way = kRollOutStep; arc.v > config_.slowest && way < least; way += kRollOutStep) {
    const geometry::Pose2 place = geometry::integrate(from, arc, way / arc.v);
    if (leaves_window(input, place.position())) break;
    if (touches(input, narrow_, place)) return false;
  }
  return true;
}

int DynamicWindow::best_trajectory(const Input& input, double fastest, CriticScores& best) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto trajectories = rollout_.trajectories();
  totals_.assign(trajectories.size(), kNever);
  for (std::size_t i = 0; i < trajectories.size(); ++i) {
    const Trajectory& trajectory = trajectories[i];
    if (!trajectory.admissible) continue;
    const double v = speeds_[static_cast<std::size_t>(trajectory.speed)].target;
    const double w = turns_[static_cast<std::size_t>(trajectory.turn)].target;
    if (std::abs(v * w) > config_.lateral_acceleration) continue;
    // Without the whole clearance its corners are as slow as itself.
    if (speeds_[static_cast<std::size_t>(trajectory.speed)].contact == 0 &&
        std::abs(w) > careful_turn_)
      continue;
    totals_[i] = score(input, i, fastest).total();
  }
  for (;;) {
    const auto least = std::min_element(totals_.begin(), totals_.end());
    if (least == totals_.end() || *least == kNever) return -1;
    const auto index = static_cast<std::size_t>(least - totals_.begin());
    if (rolls_out_free(input, index)) {
      best = score(input, index, fastest);
      return static_cast<int>(index);
    }
    *least = kNever;
  }
}

}  // namespace usher::local_planner
