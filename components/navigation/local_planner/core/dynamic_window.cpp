// What to do in a cycle: turn, follow, stop, or report that there is no way. critics.cpp measures
// trajectories.
#include "navigation/local_planner/core/dynamic_window.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "foundation/result/bounds.hpp"

namespace usher::local_planner {
namespace {

using geometry::Pose2;
using geometry::Twist2;

constexpr double kStanding = 0.05;          // [m/s] slower than this the robot stands
constexpr double kSlowEnoughToTurn = 0.15;  // [m/s] below this a turn in place may begin
constexpr double kDodgeReach = 1.0;         // [s] of turning faster or slower, while it brakes
constexpr int kWorthATurn = 4;         // steps, where no arc is free, that another one must lead on
constexpr double kLongestCycle = 0.2;  // [s] a command is ramped for at most this long after a gap
constexpr double kLookAhead =
    0.5;  // [m] the direction of the path is that to the point this far along
constexpr double kDetourSight = 2.0;  // [m] of path: what stands on it nearer than this is passed
constexpr double kAligned = 0.15;     // [rad] a turn towards the path ends here
constexpr double kSweep =
    0.05;  // [rad] and [m] between tested poses of a turn or a recovery motion
constexpr double kLaneGap = 0.05;    // [m] beside the clearance, to what stands on its side
constexpr double kMeeting = 1.2;     // [m] of path within which somebody is met
constexpr double kWalksOn = 0.2;     // [m/s] the same way: no meeting
constexpr double kWalks = 0.3;       // [m/s] slower, the costs say all
constexpr double kAtTheRobot = 0.8;  // [m] from its middle
constexpr double kNeighbour = 1.2;   // [m] from its middle
constexpr double kUnsure = 0.05;     // [m] of where somebody is who stands that near
constexpr double kNoNearer = 1e-3;   // [m]
constexpr double kArmsLength = 0.4;  // [m] between robot and person
constexpr double kToward = 0.7;      // cosine: who is ahead
constexpr double kPolite = 6.0;      // [s] that it gives way
constexpr double kMetAnew = 3.0;     // [s] without anybody, until it does so again
constexpr double kSamePlace = 0.3;   // [m]
constexpr double kSparing = 0.12;    // [m] it backs off at most from a touch that it waits at
constexpr int kMostToAndFro = 3;     // moves that free one corner and touch with the other
constexpr double kWayOut = 1.0;      // [m] that arcs may take to turn it by kGain
constexpr double kGain = 0.3;        // [rad]
constexpr double kSoon = 0.65;       // [rad] of a turn whose room bounds its rate now
constexpr double kSways = 0.02;      // [m/s] that a base sways by while it turns

bool plausible(const Twist2& twist) {
  return twist.finite() && std::abs(twist.v) < 10.0 && std::abs(twist.w) < 20.0;
}

Decision refused() {
  Decision decision;
  decision.reason = Reason::kInvalidInput;
  return decision;
}

}  // namespace

Result<DynamicWindow> DynamicWindow::make(const DynamicWindowConfig& config, cpu::Simd simd) {
  if (const Status status = check(config); !status) return Error{status.error()};
  return DynamicWindow(config, simd);
}

DynamicWindow::DynamicWindow(const DynamicWindowConfig& config, cpu::Simd simd)
    : config_(config),
      roomy_(config.footprint.grown(config.clearance), CellExtent::kWhole, simd),
      narrow_(config.footprint.grown(0.5 * config.clearance), CellExtent::kWhole, simd),
      whole_(config.footprint, CellExtent::kWhole, simd),
      center_(config.footprint, CellExtent::kCenter, simd),
      rollout_({.step = config.simulated_time / config.steps,
                .scored_steps = config.steps,
                .unknown_is_lethal = config.unknown_is_lethal,
                .disc_clearance = config.disc_clearance},
               simd),
      wavefront_(simd),
      path_distance_(simd),
      lane_(config.footprint.inscribed_radius(), config.clearance + kLaneGap,
            config.keep_left ? -1.0 : 1.0),
      rods_(config.footprint, config.whiskers) {}

Status DynamicWindow::set_path(std::span<const Pose2> path) {
  const bool had_goal = !path_.empty();
  const Pose2 old = path_.goal();
  if (Status status = path_.set(path); !status) return status;
  const bool same_goal =
      had_goal && distance(old, path_.goal()) <= config_.position_tolerance &&
      std::abs(geometry::shortest_turn(old.yaw, path_.goal().yaw)) <= config_.yaw_tolerance;
  if (!same_goal) {
    position_reached_ = false;
    way_out_.reset();
  }
  return {};
}

void DynamicWindow::clear_path() {
  path_.clear();
  lane_.clear();
  position_reached_ = false;
  turning_ = 0;
  way_out_.reset();
}

Status DynamicWindow::set_pace(double pace) {
  if (Status status = within({{"pace", pace, config_.slowest, 3.0, "m/s"}}); !status) return status;
  config_.pace = pace;
  return {};
}

bool DynamicWindow::valid(const Input& input) const {
  const grid::GridGeometry& g = input.costs.geometry();
  const bool grid = g.width > 0 && g.height > 0 && g.width <= grid::Wavefront::kLargestSide &&
                    g.height <= grid::Wavefront::kLargestSide && g.resolution > 1e-3 &&
                    g.resolution < 1.0 && std::isfinite(g.origin_x) && std::isfinite(g.origin_y);
  if (!grid || !input.pose.finite() || !plausible(input.measured) || !plausible(input.last_command))
    return false;
  const double x = (input.pose.x - g.origin_x) / g.resolution;
  const double y = (input.pose.y - g.origin_y) / g.resolution;
  if (!(x >= 0.0 && y >= 0.0 && x < g.width && y < g.height)) return false;
  return std::all_of(input.people.begin(), input.people.end(), [](const MovingDisc& d) {
    return d.position.allFinite() && d.velocity.allFinite() && d.radius >= 0.0 && d.radius < 100.0;
  });
}

/// Whoever comes from behind sees the robot.
void DynamicWindow::find_walkers(const Pose2& pose, std::span<const MovingDisc> people) {
  const geometry::Point2 ahead(std::cos(pose.yaw), std::sin(pose.yaw));
  walkers_.clear();
  for (const MovingDisc& person : people) {
    if (person.velocity.norm() < kWalks) continue;
    if ((person.position - pose.position()).dot(ahead) < 0.0) continue;
    walkers_.push_back(person);
  }
}

/// Who walks, and who stands at the robot: the costs know a body to a cell, too little where it is
/// passed with a hand's breadth.
void DynamicWindow::find_neighbours(const Input& input) {
  const double kept = 0.25 * config_.disc_clearance;  // by the rollout, at this speed
  neighbours_ = walkers_;
  for (const MovingDisc& person : input.people) {
    const geometry::Point2 in_base = inverse(input.pose) * person.position;
    if (person.velocity.norm() >= kWalks || in_base.norm() > kNeighbour) continue;
    // Who is nearer already may be left, and passed no nearer than that.
    const double room = config_.footprint.distance(in_base) - kept - kNoNearer;
    if (room > 0.0)
      neighbours_.push_back({person.position, {0.0, 0.0}, std::min(person.radius + kUnsure, room)});
  }
}

void DynamicWindow::load(const Input& input) {
  bits_.assign(input.costs, config_.unknown_is_lethal,
               roomy_.reach_cells(input.costs.resolution()));
  stand_in_the_way(input);
  explain_touches(input);
}

namespace {
/// Visits the cells of the window whose centers lie within `radius` of a place.
template <class Visit>
void visit_cells(const grid::GridGeometry& g, const geometry::Point2& place, double radius,
                 Visit visit) {
  const double far = (g.width + g.height) * g.resolution + radius;
  if (!((place - geometry::Point2(g.origin_x, g.origin_y)).norm() <= far)) return;
  const grid::Cell middle = g.cell_at(place);
  const int reach = static_cast<int>(radius / g.resolution) + 1;
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
      if (g.contains({x, y}) && (g.center({x, y}) - place).norm() <= radius)
        visit(grid::Cell{x, y});
    }
  }
}
}  // namespace

/// Of somebody who stands at the robot the laser sees only what is beyond its blind range: all of
/// them is in the way, but for what would be in the robot.
void DynamicWindow::stand_in_the_way(const Input& input) {
  const grid::GridGeometry& g = input.costs.geometry();
  for (const MovingDisc& person : input.people) {
    if (person.velocity.norm() >= kWalks) continue;
    if ((person.position - input.pose.position()).norm() > kAtTheRobot) continue;
    visit_cells(g, person.position, std::min(person.radius, kAtTheRobot), [&](grid::Cell cell) {
      if (config_.footprint.distance(inverse(input.pose) * g.center(cell)) >= g.resolution)
        bits_.set(cell.x + bits_.rim(), cell.y + bits_.rim());
    });
  }
}

/// What the whiskers touch beside what is lethal where they are.
void DynamicWindow::explain_touches(const Input& input) {
  unexplained_ = touches_;
  if (!any(touches_)) return;
  at_whiskers_.clear();
  const Pose2 base_T_costs = inverse(input.pose);
  visit_cells(input.costs.geometry(), input.pose.position(), rods_.reach(), [&](grid::Cell cell) {
    if (input.costs.at(cell) == grid::kLethalCost)
      at_whiskers_.push_back(base_T_costs * input.costs.geometry().center(cell));
  });
  unexplained_ = kinematics::without(touches_, rods_.at_known(at_whiskers_));
}

/// Frees the cells of everybody; false: there is nobody.
bool DynamicWindow::leave_out_people(const Input& input) {
  for (const MovingDisc& person : input.people) {
    visit_cells(input.costs.geometry(), person.position,
                std::min(person.radius, kAtTheRobot) + kUnsure,
                [&](grid::Cell cell) { bits_.clear(cell.x + bits_.rim(), cell.y + bits_.rim()); });
  }
  return !input.people.empty();
}

Twist2 DynamicWindow::ramped(const Input& input, const Twist2& target, double fall) const {
  kinematics::AccelerationLimits limits = config_.limits;
  limits.deceleration = fall;
  return kinematics::limited(input.last_command, target, limits, input.seconds);
}

Decision DynamicWindow::halt(const Input& input, Reason reason, double deceleration) const {
  Decision decision;
  decision.reason = reason;
  decision.blocked = reason == Reason::kBlocked || reason == Reason::kTouching;
  decision.command = ramped(input, {}, deceleration);
  // Along the arc that it is on: that one was free when it was chosen.
  if (std::abs(input.measured.v) >= kStanding && std::abs(input.last_command.v) > 1e-3)
    decision.command.w = input.last_command.w * decision.command.v / input.last_command.v;
  return decision;
}

/// Along the arc that stays free for as far as the base may roll, if any within the lateral
/// acceleration and with half of the clearance; of equal ones the one that bends least from now.
/// Where none is free, nobody is dodged into a wall: people can step aside, a wall cannot. And then
/// the centers of cells decide: a post that a cell shows a little too large is no reason to turn
/// into the wall beside it.
Decision DynamicWindow::brake(const Input& input) {
  const double v = std::abs(input.measured.v);
  Decision decision =
      halt(input, v < kStanding ? Reason::kBlocked : Reason::kBraking, config_.braking);
  decision.blocked = true;
  if (v < kSlowEnoughToTurn) return decision;  // it sways, on the spot
  keep_speed(v);
  sample_turns(input, kDodgeReach, kept_.steps);
  const RolloutStart start{input.pose, input.measured, input.last_command};
  // Whether an arc is free all the way.
  const auto run = [&](const ContactTests& contacts) {
    rollout_.run(start, {&kept_, 1}, turns_, input.costs, bits_, contacts, config_.footprint, {});
    return std::ranges::any_of(rollout_.trajectories(), [&](const Trajectory& trajectory) {
      return trajectory.free_steps >= kept_.steps;
    });
  };
  const auto note = [&](std::vector<int>& free_steps) {
    free_steps.clear();
    for (const Trajectory& trajectory : rollout_.trajectories())
      free_steps.push_back(trajectory.free_steps);
  };
  bool found = run({&whole_, &narrow_});
  note(among_people_);
  if (!found && leave_out_people(input)) found = run({&whole_, &narrow_});
  note(without_people_);
  if (!found) found = run({&center_, &whole_});
  const auto turn = [&](const Trajectory& trajectory) {
    return turns_[static_cast<std::size_t>(trajectory.turn)].target;
  };
  // The turn rate falls with the speed, else an arc ends in a turn on the spot.
  const double along = braked_arc_ ? *braked_arc_ * v : input.last_command.w;
  const auto bend = [&](const Trajectory& trajectory) {
    return std::abs(turn(trajectory) - along);
  };
  auto best =
      std::ranges::min_element(rollout_.trajectories(), {}, [&](const Trajectory& trajectory) {
        const auto index = static_cast<std::size_t>(&trajectory - rollout_.trajectories().data());
        const bool hard = v * std::abs(turn(trajectory)) > config_.lateral_acceleration;
        return std::tuple(-trajectory.free_steps, -without_people_[index], -among_people_[index],
                          hard, trajectory.close > 0.0F, bend(trajectory));
      });
  // What bars every arc may be an echo from beside the way: the one that it is on was free.
  const auto same = std::ranges::min_element(rollout_.trajectories(), {}, bend);
  if (!found && best->free_steps < same->free_steps + kWorthATurn) best = same;
  arc_ = turn(*best) / v;
  decision.command.w = ramped(input, {0.0, turn(*best)}, config_.braking).w;
  return decision;
}

/// The way that the base may need to stop, as its speed now: told to stand it leans first, and
/// covers most of it before it gets slower.
void DynamicWindow::keep_speed(double v) {
  const double step = rollout_.settings().step;
  kept_.target = v;
  kept_.contact = 0;
  kept_.needed = config_.stopping.distance(v) + config_.margin;
  kept_.steps =
      std::clamp(static_cast<int>(std::ceil(kept_.needed / (v * step))), 1, Rollout::kMostSteps);
  kept_.values.assign(static_cast<std::size_t>(kept_.steps) + 1, v);
  kept_.way.resize(kept_.values.size());
  for (std::size_t k = 0; k < kept_.way.size(); ++k)
    kept_.way[k] = static_cast<double>(k) * step * v;
}

Decision DynamicWindow::decide(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                               const Twist2& measured, const Twist2& last_command,
                               double seconds_since_last, std::span<const MovingDisc> people) {
  const double seconds =
      seconds_since_last > 0.0 ? std::min(seconds_since_last, kLongestCycle) : 0.0;
  Input input{costs, pose, measured, last_command, seconds, people, {}};
  braked_arc_ = std::exchange(arc_, std::nullopt);
  if (!valid(input)) return refused();
  find_walkers(pose, people);
  input.walkers = walkers_;
  trail_.add(pose);
  if (path_.empty()) return halt(input, Reason::kNoPath, config_.limits.deceleration);
  path_.advance(pose.position());
  load(input);
  const double away = distance(pose, path_.goal());
  const bool abreast = path_.remaining() < 0.02;
  if (away < 0.6 * config_.position_tolerance || (away < config_.position_tolerance && abreast)) {
    position_reached_ = true;
  } else if (away > config_.position_tolerance + 0.1) {
    position_reached_ = false;
  }
  Decision decision = position_reached_ ? at_goal(input) : follow(input);
  if (decision.blocked) spare_front(input, decision);
  note_turn(input, decision.command);
  return decision;
}

/// Who has to wait with something at a front whisker backs off from it: a balancing base sways by
/// more than a whisker's length.
void DynamicWindow::spare_front(const Input& input, Decision& decision) {
  const kinematics::Whiskers& t = touches_;
  const bool front = t.front_left || t.front_right;
  const bool stands = std::abs(input.measured.v) < kSlowEnoughToTurn;
  if (!front || t.back_left || t.back_right || !stands) return;
  if (!touched_at_ || distance(*touched_at_, input.pose) > kSamePlace) touched_at_ = input.pose;
  if (distance(*touched_at_, input.pose) > kSparing) return;
  // A wall that it nearly touches behind may be a cell nearer than its cell tells.
  const Pose2 behind = geometry::integrate(input.pose, {-kSparing, 0.0}, 1.0);
  if (touches(input, narrow_, behind)) return;
  const Decision back = recover(input, {-config_.slowest, 0.0});
  if (back.blocked || back.reason != Reason::kRecovering) return;
  decision.command = back.command;
  decision.target = back.target;
}

Decision DynamicWindow::at_goal(const Input& input) {
  const double yaw = path_.goal().yaw;
  const bool turned =
      std::abs(geometry::shortest_turn(input.pose.yaw, yaw)) <= config_.yaw_tolerance;
  const bool standing = std::abs(input.measured.v) < kStanding && std::abs(input.measured.w) < 0.1;
  if (!turned) return turn_to(input, yaw, Reason::kTurningToGoal);
  turning_ = 0;
  Decision decision = halt(input, standing ? Reason::kReached : Reason::kTurningToGoal,
                           config_.limits.deceleration);
  decision.reached = standing;
  return decision;
}

bool DynamicWindow::touches(const Input& input, const ContactTest& contact,
                            const Pose2& pose) const {
  const grid::GridGeometry& geometry = input.costs.geometry();
  const double x = (pose.x - geometry.origin_x) * bits_.cells_per_metre();
  const double y = (pose.y - geometry.origin_y) * bits_.cells_per_metre();
  if (contact.clear_around(bits_, x, y)) return false;
  TurnedFootprint turned;
  contact.turn(std::cos(pose.yaw), std::sin(pose.yaw), geometry.resolution, turned);
  return contact.touches(bits_, turned, x, y);
}

/// The turn rate at which corners creep [rad/s], the slower the faster the base rolls meanwhile.
double DynamicWindow::creeping_turn(const Input& input) const {
  const double rolls = std::max(0.0, std::abs(input.measured.v) - kSways);
  return std::max(0.5 * config_.tight_turn,
                  config_.tight_turn - rolls / config_.footprint.circumscribed_radius());
}

/// The fastest turn in place by `angle` that its room and its whiskers allow [rad/s]; zero: none.
/// Touching what the costs know, corners creep, and only with half of the clearance for what comes
/// soon. movement_control, which watches for people and whether it presses, decides.
double DynamicWindow::turn_rate(const Input& input, double angle) const {
  if (kinematics::bars_turn(unexplained_, angle)) return 0.0;
  const bool touching = kinematics::bars_turn(touches_, angle);
  // Cells that it overlaps in part already cannot be asked to stay untouched.
  const ContactTest& least = touches(input, whole_, input.pose) ? center_ : whole_;
  double rate = config_.spot_turn;
  if (touching)
    rate = std::min(rate, 0.5 * config_.tight_speed / config_.footprint.circumscribed_radius());
  const int steps = static_cast<int>(std::ceil(std::abs(angle) / kSweep));
  for (int i = 0; i <= steps; ++i) {
    const Pose2 turned{input.pose.x, input.pose.y, input.pose.yaw + angle * i / std::max(steps, 1)};
    if (!touches(input, roomy_, turned)) continue;
    if (i * kSweep < kSoon) {
      const bool narrow = touches(input, narrow_, turned);
      if (touching && narrow) return 0.0;
      rate = std::min(rate, narrow ? creeping_turn(input) : 1.5 * config_.tight_turn);
    }
    if (i > 0 && touches(input, least, turned)) return 0.0;
  }
  return rate;
}

/// Most of a turn whose end has no room: askew before the posts of a door the base gets straight by
/// turning as far as they let it, then on by a little. Nothing where an arc could not take the
/// rest: it would wedge itself in.
std::optional<Decision> DynamicWindow::turn_a_little(const Input& input, double angle) {
  const double sense = angle > 0.0 ? 1.0 : -1.0;
  double free = 0.0, fastest = creeping_turn(input);
  while (free + kSweep < std::abs(angle)) {
    const double rate = turn_rate(input, sense * (free + kSweep));
    if (rate == 0.0) break;
    fastest = std::min(fastest, rate);
    free += kSweep;
  }
  if (free < 2.0 * kSweep || std::abs(angle) - free > kAligned + kSweep) return std::nullopt;
  Decision decision;
  decision.reason = Reason::kTurning;
  decision.target = {0.0, sense * fastest};
  decision.command = ramped(input, decision.target, config_.braking);
  return decision;
}

/// The small move that takes a touched corner out of the way of a turn; nothing when none does, or
/// none bars it (the thesis, fig. 6.3).
std::optional<Decision> DynamicWindow::free_corner(const Input& input, double angle) {
  const kinematics::Whiskers& t = touches_;
  const bool in_front = angle > 0.0 ? t.front_left : t.front_right;
  const bool behind = angle > 0.0 ? t.back_right : t.back_left;
  if (in_front == behind) return std::nullopt;
  if (in_front ? t.back_left || t.back_right : t.front_left || t.front_right) return std::nullopt;
  const int way = in_front ? -1 : 1;
  forget_other_places(input.pose.position());
  if (barred_.freeing == -way) ++barred_.to_and_fro;
  barred_.freeing = way;
  if (barred_.to_and_fro > kMostToAndFro) return halt(input, Reason::kBlocked, config_.braking);
  Decision decision = recover(input, {way * config_.slowest, 0.0});
  if (decision.blocked) return std::nullopt;
  return decision;
}

/// Forgets what barred turns elsewhere.
void DynamicWindow::forget_other_places(const geometry::Point2& position) {
  if ((position - barred_.at).norm() <= kSamePlace) return;
  barred_ = {};
  barred_.at = position;
}

/// Counts a turn that cannot go on. Twice in both senses at one place, and there is no room: more
/// to and fro would not find any.
bool DynamicWindow::is_given_up(const geometry::Point2& position, int sense) {
  forget_other_places(position);
  if (turning_ == sense) ++(sense > 0 ? barred_.left : barred_.right);
  return barred_.left >= 2 && barred_.right >= 2;
}

/// Whether arcs still may lead out of where there is no room to turn: along a wall, away from a
/// path that lies behind, they lead ever farther from it.
bool DynamicWindow::leads_out(const Input& input, double error) {
  const geometry::Point2 here = input.pose.position();
  if (!way_out_ || (here - way_out_->at).norm() > 2.0 * kWayOut || error < way_out_->error - kGain)
    way_out_ = WayOut{here, error};
  return (here - way_out_->at).norm() <= kWayOut;
}

Decision DynamicWindow::turn_to(const Input& input, double yaw, Reason reason) {
  if (std::abs(input.measured.v) > kSlowEnoughToTurn) {
    return halt(input, reason, config_.limits.deceleration);
  }
  double angle = geometry::shortest_turn(input.pose.yaw, yaw);
  // A turn that has begun keeps its sense, the long way round too, until it is nearly there.
  if (turning_ != 0 && std::abs(angle) > 0.5 && angle * turning_ < 0.0)
    angle += turning_ * 2.0 * geometry::kPi;
  double fastest = turn_rate(input, angle);
  if (fastest == 0.0) {
    if (auto decision = free_corner(input, angle)) return *decision;
    if (is_given_up(input.pose.position(), angle > 0.0 ? 1 : -1))
      return halt(input, Reason::kBlocked, config_.braking);
    angle += angle > 0.0 ? -2.0 * geometry::kPi : 2.0 * geometry::kPi;
    fastest = turn_rate(input, angle);
    if (fastest == 0.0) return halt(input, Reason::kBlocked, config_.braking);
  }
  turning_ = angle > 0.0 ? 1 : -1;
  const double remaining = std::abs(angle) - config_.response.turn_time_constant *
                                                 std::max(0.0, turning_ * input.measured.w);
  const double rate =
      std::min(fastest, std::max(config_.slowest_turn, remaining / config_.turn_stopping_time));
  Decision decision;
  decision.reason = reason;
  decision.target = {0.0, turning_ * rate};
  decision.command = ramped(input, decision.target, config_.braking);
  return decision;
}

bool DynamicWindow::must_turn_first(const Input& input, double& heading) {
  // Beside the path the robot joins it farther on, else a detour would look like a wrong heading.
  const double beside = (path_.point(path_.progress()) - input.pose.position()).norm();
  const double arc = path_.progress() + kLookAhead + 1.5 * beside;
  const geometry::Point2 ahead = path_.point(std::min(arc, path_.length()));
  const geometry::Point2 way = ahead - input.pose.position();
  if (way.norm() < 0.05) {
    turning_ = 0;
    return false;
  }
  heading = std::atan2(way.y(), way.x());
  const double error = std::abs(geometry::shortest_turn(input.pose.yaw, heading));
  const bool standing = std::abs(input.measured.v) < kSlowEnoughToTurn;
  if (turning_ != 0 && error < kAligned) {
    turning_ = 0;
    barred_ = {};
    way_out_.reset();
  }
  if (turning_ != 0) return true;
  return error > (standing ? 0.7 : 1.0) * config_.turn_first_angle;
}

/// Who meets a robot waits for it to stand before squeezing past: creeping on drives them back.
bool DynamicWindow::gives_way(const Input& input) {
  const bool met =
      std::any_of(input.people.begin(), input.people.end(), [&](const MovingDisc& person) {
        const geometry::Point2 way = person.position - input.pose.position();
        const geometry::Point2 heading(std::cos(input.pose.yaw), std::sin(input.pose.yaw));
        const double along = person.velocity.dot(heading);
        if (way.dot(heading) < 0.0 || along > kWalksOn) return false;
        // Who crosses is let by, or passed, by the trajectories: stopping on their way is no help.
        const double across =
            std::abs(person.velocity.y() * heading.x() - person.velocity.x() * heading.y());
        if (across > kWalks && across > std::abs(along)) return false;
        constexpr double kStep = 0.1;  // [m]
        for (int i = 0; kStep * i < kMeeting; ++i) {
          if ((path_.point(path_.progress() + kStep * i) - person.position).norm() <
              config_.footprint.inscribed_radius() + person.radius)
            return true;
        }
        return false;
      });
  met_nobody_ = met ? 0.0 : met_nobody_ + input.seconds;
  gave_way_ = met ? gave_way_ + input.seconds : met_nobody_ > kMetAnew ? 0.0 : gave_way_;
  return met && gave_way_ < kPolite;
}

/// Whether somebody stands or walks within arm's length, not behind: range finders are blind there,
/// and a step is quick.
bool DynamicWindow::somebody_beside(const Input& input) const {
  const geometry::Point2 heading(std::cos(input.pose.yaw), std::sin(input.pose.yaw));
  return std::any_of(input.people.begin(), input.people.end(), [&](const MovingDisc& person) {
    const geometry::Point2 way = person.position - input.pose.position();
    return way.dot(heading) > -config_.footprint.inscribed_radius() &&
           way.norm() < config_.footprint.inscribed_radius() + person.radius + kArmsLength;
  });
}

/// The speed from which it still stops before the nearest of those ahead, wherever its arc leads:
/// where they step next nobody foresees.
double DynamicWindow::speed_before_people(const Input& input) const {
  const geometry::Point2 heading(std::cos(input.pose.yaw), std::sin(input.pose.yaw));
  double fastest = config_.pace;
  for (const MovingDisc& person : input.people) {
    const geometry::Point2 way = person.position - input.pose.position();
    const double range = way.norm();
    if (way.dot(heading) < kToward * range) continue;
    const double gap = range - config_.footprint.inscribed_radius() - person.radius;
    fastest = std::min(fastest, config_.stopping.speed(gap));
  }
  return fastest;
}

Decision DynamicWindow::follow(const Input& input) {
  const double obstacle = obstacle_on_path(input);
  const auto with_obstacle = [obstacle](Decision decision) {
    decision.obstacle_distance = obstacle;
    return decision;
  };
  if (touches(input, center_, input.pose))
    return with_obstacle(halt(input, Reason::kTouching, config_.braking));
  double heading = input.pose.yaw;
  turns_to_.reset();
  if (must_turn_first(input, heading)) {
    const Decision decision = turn_to(input, heading, Reason::kTurning);
    turning_ = decision.blocked ? 0 : turning_;
    const double error = std::abs(geometry::shortest_turn(input.pose.yaw, heading));
    if (!decision.blocked || !leads_out(input, error)) return with_obstacle(decision);
    turns_to_ = heading;  // no room to turn in place: on an arc, if any leads out
  }
  choose_local_goal(input);
  lane_.choose(path_, input.costs, input.walkers, input.seconds);
  if (gives_way(input)) {
    Decision decision = brake(input);
    if (decision.reason == Reason::kBlocked) decision.reason = Reason::kGivingWay;
    return with_obstacle(decision);
  }
  // Slow towards the goal, and towards an obstacle that nothing leads around, by the distance that
  // stopping takes.
  const double lag =
      (config_.response.time_constant + config_.response.latency) * std::max(0.0, input.measured.v);
  double fastest = std::min(config_.pace, config_.stopping.speed(path_.remaining() - lag));
  if (!way_open_) {
    const double room = config_.stopping.speed(obstacle - config_.margin - lag);
    if (room < config_.slowest) return with_obstacle(brake(input));
    fastest = std::min(fastest, room);
  }
  if (somebody_beside(input)) fastest = std::min(fastest, config_.careful_speed);
  fastest = std::min(fastest, std::max(config_.careful_speed, speed_before_people(input)));
  fastest = std::max(fastest, config_.slowest);
  tight_ = false;
  // Squeezing is for where the plan leads through; past what stands on the plan only with room,
  // else it waits: people go on, and the next plan leads round what stays.
  const bool detour = obstacle < kDetourSight;
  Decision decision = detour ? drive(input, {&roomy_, &roomy_}, fastest, config_.pace)
                             : drive(input, {&narrow_, &roomy_}, fastest, config_.careful_speed);
  if (decision.admissible > 0) return with_obstacle(decision);
  // No arc fits: perhaps one does after a turn to the path, or slowly and with less room.
  const double error = geometry::shortest_turn(input.pose.yaw, heading);
  const bool standing = std::abs(input.measured.v) < kSlowEnoughToTurn;
  if (standing && std::abs(error) > kAligned && turn_rate(input, error) > 0.0) {
    return with_obstacle(turn_to(input, heading, Reason::kTurning));
  }
  if (detour) return with_obstacle(brake(input));
  const double slow = std::min({fastest, config_.tight_speed, config_.pace});
  tight_ = true;
  find_neighbours(input);
  Input tight = input;
  tight.walkers = neighbours_;
  decision = drive(tight, {&whole_, &narrow_}, slow, config_.tight_speed);
  // Who overlaps part of a cell already must be let out by its center, no corner swinging out.
  if (decision.admissible == 0 && touches(input, whole_, input.pose)) {
    decision = drive(tight, {&center_, &whole_}, slow,
                     config_.tight_turn * config_.footprint.circumscribed_radius());
  }
  decision.reason = Reason::kTight;
  if (decision.admissible > 0) return with_obstacle(decision);
  if (standing && std::abs(error) > kAligned) {
    if (const auto turn = turn_a_little(input, error)) return with_obstacle(*turn);
  }
  return with_obstacle(brake(input));
}

Decision DynamicWindow::drive(const Input& input, const ContactTests& contacts, double fastest,
                              double corner_speed) {
  careful_turn_ = corner_speed / config_.footprint.circumscribed_radius();
  sample(input, fastest);
  const RolloutStart start{input.pose, input.measured, input.last_command};
  rollout_.run(start, speeds_, turns_, input.costs, bits_, contacts, config_.footprint,
               input.walkers);
  Decision decision;
  decision.reason = Reason::kFollowing;
  decision.trajectories = static_cast<int>(rollout_.trajectories().size());
  measure_path(input);
  const int winner = best_trajectory(input, fastest, decision.scores);
  if (winner < 0) return decision;
  for (const Trajectory& trajectory : rollout_.trajectories())
    decision.admissible += trajectory.admissible;
  const Trajectory& best = rollout_.trajectories()[static_cast<std::size_t>(winner)];
  const SpeedProfile& speed = speeds_[static_cast<std::size_t>(best.speed)];
  const SpeedProfile& turn = turns_[static_cast<std::size_t>(best.turn)];
  decision.target = {speed.target, turn.target};
  decision.command = ramped(input, decision.target, config_.limits.deceleration);
  if (tight_ && decision.target.v > 0.0)
    decision.command.w = no_faster_than_it_rolls(input, decision);
  rollout_.poses(start, speed, turn, best.free_steps, winner_);
  decision.trajectory = winner_;
  return decision;
}

/// A base leans before it rolls, and turns at once: where there is little room its corner would
/// leave the arc that was tested.
double DynamicWindow::no_faster_than_it_rolls(const Input& input, const Decision& decision) const {
  const double part = std::clamp(input.measured.v / decision.target.v, 0.0, 1.0);
  const double most = std::max(config_.tight_turn, part * std::abs(decision.target.w));
  return std::clamp(decision.command.w, -most, most);
}

Decision DynamicWindow::recover(const Input& input, const Twist2& wanted) {
  if (!valid(input) || !plausible(wanted)) return refused();
  load(input);
  turning_ = 0;
  // What the whiskers leave of it is what will be driven, so that is what must be free.
  const Twist2 target = kinematics::whisker_reflex(wanted, touches_, config_.tight_speed);
  if (target.v == 0.0 && target.w == 0.0) return halt(input, Reason::kBlocked, config_.braking);
  // What it touches already must not hold it; anything else stops it.
  const grid::GridGeometry& geometry = input.costs.geometry();
  TurnedFootprint turned;
  center_.turn(std::cos(input.pose.yaw), std::sin(input.pose.yaw), geometry.resolution, turned);
  center_.erase_touched(bits_, turned, (input.pose.x - geometry.origin_x) * bits_.cells_per_metre(),
                        (input.pose.y - geometry.origin_y) * bits_.cells_per_metre());
  const double way = config_.stopping.distance(target.v) + config_.margin;
  const double angle = std::abs(target.w) * config_.turn_stopping_time + kAligned;
  const double reach = target.v != 0.0 ? way : angle;
  const int steps = static_cast<int>(std::ceil(reach / kSweep));
  const double seconds = reach / std::abs(target.v != 0.0 ? target.v : target.w);
  for (int i = 1; i <= steps; ++i) {
    const Pose2 ahead = geometry::integrate(input.pose, target, seconds * i / steps);
    if (touches(input, center_, ahead)) return halt(input, Reason::kBlocked, config_.braking);
  }
  Decision decision;
  decision.reason = Reason::kRecovering;
  decision.target = target;
  decision.command = ramped(input, target, config_.braking);
  return decision;
}

/// The sense of turn that takes the tail from what it feels before it can go back (the thesis,
/// fig. 6.3); 0: it feels nothing, or as much on both sides. What touches both whiskers of a side
/// stands beside the robot and bars no way back.
int DynamicWindow::turn_of_tail() const {
  const bool left = touches_.back_left && !touches_.front_left;
  const bool right = touches_.back_right && !touches_.front_right;
  return static_cast<int>(left) - static_cast<int>(right);
}

Decision DynamicWindow::back_off(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                                 const Twist2& measured, const Twist2& last_command,
                                 double seconds_since_last, double speed,
                                 std::span<const MovingDisc> people) {
  const double seconds =
      seconds_since_last > 0.0 ? std::min(seconds_since_last, kLongestCycle) : 0.0;
  if (!pose.finite()) return refused();
  barred_ = {};
  const double turn = trail_.turn_rate_back(pose, speed);
  const Input input{costs, pose, measured, last_command, seconds, people, {}};
  if (const int away = turn_of_tail(); away != 0) {
    if (!valid(input)) return refused();
    load(input);
    const double rate = std::min(turn_rate(input, away * kAligned), 2.0 * config_.tight_turn);
    return rate > 0.0 ? recover(input, {0.0, away * rate})
                      : halt(input, Reason::kBlocked, config_.braking);
  }
  const Decision back = recover(input, {-speed, turn});
  return back.blocked ? recover(input, {-speed, 0.0}) : back;
}

Decision DynamicWindow::rotate(const grid::Grid<std::uint8_t>& costs, const Pose2& pose,
                               const Twist2& measured, const Twist2& last_command,
                               double seconds_since_last, double rate,
                               std::span<const MovingDisc> people) {
  const double seconds =
      seconds_since_last > 0.0 ? std::min(seconds_since_last, kLongestCycle) : 0.0;
  const Input input{costs, pose, measured, last_command, seconds, people, {}};
  if (!valid(input) || !std::isfinite(rate)) return refused();
  load(input);
  // Looking around is worth no touch: only with room.
  const double angle = std::copysign(std::abs(rate) * config_.turn_stopping_time + kAligned, rate);
  if (turn_rate(input, angle) < config_.spot_turn)
    return halt(input, Reason::kBlocked, config_.braking);
  return recover(input, {0.0, rate});
}

}  // namespace usher::local_planner
