#include "navigation/local_planner/core/rollout.hpp"

#include <algorithm>
#include <cmath>

namespace usher::local_planner {
namespace {

/// Cosine and sine of a step's turn (below 0.5 rad): a short series, the same bits on every
/// machine, error < 1e-12.
void small_turn(double a, double& cosine, double& sine) {
  const double q = a * a;
  cosine =
      1.0 + q * (-1.0 / 2 + q * (1.0 / 24 + q * (-1.0 / 720 + q * (1.0 / 40320 - q / 3628800))));
  sine = a * (1.0 + q * (-1.0 / 6 +
                         q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880 - q / 39916800)))));
}

}  // namespace

/// What all trajectories of a run share.
struct Rollout::Frame {
  const RolloutStart& start;
  const grid::Grid<std::uint8_t>& costs;
  const LethalBits& bits;
  const ContactTests& contacts;
  const Footprint& footprint;
  std::span<const MovingDisc> discs;
  double cells;  // per metre
  double x, y;   // the start in cells
};

void Rollout::profile(double now, double in_flight, double target, const Ramp& ramp, int steps,
                      SpeedProfile& profile) const {
  profile.target = target;
  profile.values.resize(kMostSteps + 1);
  profile.way.resize(kMostSteps + 1);
  const double dt = settings_.step;
  // 1 - exp(-a) by its Pade approximant: no library function whose last bit depends on the
  // processor.
  const double a = dt / std::max(ramp.time_constant, 0.25 * dt);
  const double gain = a / (1.0 + 0.5 * a + a * a / 12.0);
  const double most = ramp.acceleration * dt;
  double command = in_flight;
  double value = now;
  profile.values[0] = value;
  profile.way[0] = 0.0;
  int k = 0;
  while (k < kMostSteps &&
         (k < steps || profile.way[static_cast<std::size_t>(k)] < profile.needed)) {
    const auto i = static_cast<std::size_t>(++k);
    if (k * dt > ramp.latency)
      command = kinematics::ramped(command, target, ramp.rise * dt, ramp.fall * dt);
    value += std::clamp((command - value) * gain, -most, most);
    profile.values[i] = value;
    profile.way[i] = profile.way[i - 1] + 0.5 * std::abs(profile.values[i - 1] + value) * dt;
  }
  profile.steps = k;
}

void Rollout::directions(double yaw, const SpeedProfile& turn) {
  cosine_[0] = std::cos(yaw);
  sine_[0] = std::sin(yaw);
  for (int k = 1; k <= turn.steps; ++k) {
    const auto i = static_cast<std::size_t>(k);
    double c = 1.0;
    double s = 0.0;
    small_turn(0.5 * (turn.values[i - 1] + turn.values[i]) * settings_.step, c, s);
    cosine_[k] = c * cosine_[k - 1] - s * sine_[k - 1];
    sine_[k] = s * cosine_[k - 1] + c * sine_[k - 1];
  }
  turned_ready_ = {};
}

bool Rollout::touches(const Frame& frame, double x, double y, int step, int contact) {
  const auto c = static_cast<std::size_t>(contact);
  const ContactTest& test = *frame.contacts[c];
  const auto k = static_cast<std::size_t>(step);
  if ((turned_ready_[c] >> k & 1U) == 0) {
    if (test.clear_around(frame.bits, x, y)) return false;
    test.turn(cosine_[k], sine_[k], frame.costs.resolution(), turned_[c][k]);
    turned_ready_[c] |= std::uint64_t{1} << k;
  }
  return test.touches(frame.bits, turned_[c][k], x, y);
}

bool Rollout::meets_disc(const Frame& frame, double x, double y, int step, int contact,
                         float& brush) const {
  const double clearance = (contact == 0 ? 0.25 : 1.0) * settings_.disc_clearance;
  const double time = step * settings_.step;
  const double px = frame.costs.geometry().origin_x + x / frame.cells;
  const double py = frame.costs.geometry().origin_y + y / frame.cells;
  for (const MovingDisc& disc : frame.discs) {
    const double dx = disc.position.x() + time * disc.velocity.x() - px;
    const double dy = disc.position.y() + time * disc.velocity.y() - py;
    const double far = frame.footprint.circumscribed_radius() + disc.radius +
                       settings_.comfortable + disc.velocity.norm();
    if (dx * dx + dy * dy >= far * far) continue;
    const geometry::Point2 in_base(cosine_[step] * dx + sine_[step] * dy,
                                   cosine_[step] * dy - sine_[step] * dx);
    const double gap = frame.footprint.distance(in_base) - disc.radius;
    if (gap <= clearance) return true;
    // Nobody likes to be cut off: the way that the disc takes within a second counts like itself.
    const double speed_squared = disc.velocity.squaredNorm();
    const double ahead = -(dx * disc.velocity.x() + dy * disc.velocity.y());
    const double soon = speed_squared > 0.01 ? std::clamp(ahead / speed_squared, 0.0, 1.0) : 0.0;
    const double sx = dx + soon * disc.velocity.x();
    const double sy = dy + soon * disc.velocity.y();
    const geometry::Point2 way(cosine_[step] * sx + sine_[step] * sy,
                               cosine_[step] * sy - sine_[step] * sx);
    const double room = std::max(0.0, frame.footprint.distance(way) - disc.radius);
    brush = std::max(brush, static_cast<float>(1.0 - room / settings_.comfortable));
  }
  return false;
}

void Rollout::simulate(const Frame& frame, const SpeedProfile& speed, std::size_t index) {
  Trajectory& result = trajectories_[index];
  double x = frame.x;
  double y = frame.y;
  const double half_step = 0.5 * settings_.step * frame.cells;
  const int scored = settings_.scored_steps;
  const int parts[3] = {scored / 3, 2 * scored / 3, scored};
  int part = 0;
  const auto keep_point = [&](double at_x, double at_y) {
    x_[3 * index + static_cast<std::size_t>(part)] =
        static_cast<float>((at_x - frame.x) / frame.cells);
    y_[3 * index + static_cast<std::size_t>(part)] =
        static_cast<float>((at_y - frame.y) / frame.cells);
    ++part;
  };
  int cost_sum = 0;
  int close = 0;
  int k = 1;
  for (; k <= speed.steps; ++k) {
    // The mean of the directions before and after is the chord of the arc to second order.
    const double length = (speed.values[static_cast<std::size_t>(k - 1)] +
                           speed.values[static_cast<std::size_t>(k)]) *
                          half_step * 0.5;
    const double next_x = x + length * (cosine_[k - 1] + cosine_[k]);
    const double next_y = y + length * (sine_[k - 1] + sine_[k]);
    // The wider outline first: where it is free, so is the narrower one.
    const bool wide = touches(frame, next_x, next_y, k, 1);
    result.contact = wide && (speed.contact == 1 || touches(frame, next_x, next_y, k, 0));
    if (!result.contact && !frame.discs.empty()) {
      result.disc = meets_disc(frame, next_x, next_y, k, speed.contact, result.disc_cost);
    }
    if (result.contact || result.disc) break;
    x = next_x, y = next_y;
    if (k > scored) continue;
    close += wide;
    const int cost =
        frame.costs.value_or({static_cast<int>(x), static_cast<int>(y)}, grid::kLethalCost);
    cost_sum += cost == grid::kUnknownCost && !settings_.unknown_is_lethal ? 0 : cost;
    if (k == parts[part]) keep_point(x, y);
  }
  result.free_steps = k - 1;
  while (part < 3) keep_point(x, y);
  result.contact = result.contact || result.disc;
  result.admissible =
      !result.contact || speed.way[static_cast<std::size_t>(result.free_steps)] >= speed.needed;
  // A wall can be stopped before; whoever walks also comes closer while the robot stops.
  if (result.disc && speed.contact == 1) result.admissible = false;
  const int counted = std::min(result.free_steps, scored);
  result.mean_cost =
      counted > 0 ? static_cast<float>(cost_sum) / (253.0F * static_cast<float>(counted)) : 1.0F;
  result.close = counted > 0 ? static_cast<float>(close) / static_cast<float>(counted) : 1.0F;
  end_cosine_[index] = static_cast<float>(cosine_[counted]);
  end_sine_[index] = static_cast<float>(sine_[counted]);
}

void Rollout::run(const RolloutStart& start, std::span<const SpeedProfile> speeds,
                  std::span<const SpeedProfile> turns, const grid::Grid<std::uint8_t>& costs,
                  const LethalBits& bits, const ContactTests& contacts, const Footprint& footprint,
                  std::span<const MovingDisc> discs) {
  const grid::GridGeometry& geometry = costs.geometry();
  const double cells = 1.0 / geometry.resolution;
  const Frame frame{start,
                    costs,
                    bits,
                    contacts,
                    footprint,
                    discs,
                    cells,
                    (start.pose.x - geometry.origin_x) * cells,
                    (start.pose.y - geometry.origin_y) * cells};
  const std::size_t count = speeds.size() * turns.size();
  trajectories_.assign(count, Trajectory{});
  x_.resize(3 * count), y_.resize(3 * count);
  end_cosine_.resize(count), end_sine_.resize(count);
  for (auto& turned : turned_) turned.resize(kMostSteps + 1);
  std::size_t index = 0;
  for (std::size_t t = 0; t < turns.size(); ++t) {
    directions(start.pose.yaw, turns[t]);
    for (std::size_t s = 0; s < speeds.size(); ++s, ++index) {
      trajectories_[index].speed = static_cast<int>(s);
      trajectories_[index].turn = static_cast<int>(t);
      simulate(frame, speeds[s], index);
    }
  }
}

void Rollout::poses(const RolloutStart& start, const SpeedProfile& speed, const SpeedProfile& turn,
                    int steps, std::vector<geometry::Pose2>& poses) const {
  poses.clear();
  geometry::Pose2 pose = start.pose;
  poses.push_back(pose);
  for (int k = 1; k <= std::min(steps, settings_.scored_steps); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const geometry::Twist2 mean{0.5 * (speed.values[i - 1] + speed.values[i]),
                                0.5 * (turn.values[i - 1] + turn.values[i])};
    pose = geometry::integrate(pose, mean, settings_.step);
    poses.push_back(pose);
  }
}

}  // namespace usher::local_planner
