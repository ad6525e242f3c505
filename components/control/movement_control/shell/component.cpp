#include "control/movement_control/shell/component.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/base_obedience/shell/read_response.hpp"
#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/manifest.hpp"
#include "wire/stopping.hpp"
#include "wire/whiskers.hpp"

namespace usher::movement_control {

namespace {

using std::chrono::milliseconds;

constexpr auto kEnableAge = milliseconds(120);
constexpr auto kCommandAge = milliseconds(250);
constexpr auto kWhiskerAge = milliseconds(300);
constexpr auto kLeanedAge = milliseconds(300);
constexpr auto kBaseAge = milliseconds(150);
constexpr auto kCostsAge = milliseconds(250);
constexpr auto kOdomAge = milliseconds(150);
constexpr auto kLocalizationAge = milliseconds(1000);
constexpr auto kPersonAge = milliseconds(500);
constexpr auto kLeaning = milliseconds(2500);  // at a start
constexpr double kLeans = 0.02;                // [rad]
constexpr double kSpeedsUp = 0.05;             // [m/s] slower than it is told
constexpr double kStanding = 0.01;             // [m/s]
constexpr double kReported = 1.4;              // [m/s] the status tells of what would stop this

/// Costs around the robot in odom; else where they lie is not known.
bool is_window(const usher_msgs::msg::Costmap& costs) {
  return costs.header().frame_id() == frames::kOdom && !costs.costs().empty() &&
         costs.costs().size() == std::size_t{costs.width()} * costs.height() &&
         costs.resolution() > 0.0F && std::isfinite(costs.resolution()) &&
         std::isfinite(costs.origin_x()) && std::isfinite(costs.origin_y());
}

const runtime::InputOptions kSource{.max_age = kCommandAge,
                                    .on_loss = "passes to the next source, or zero",
                                    .optional = true,
                                    .one_writer = true};

std::vector<drive::NamedComponent> components_of(const std::vector<runtime::Record>& manifest) {
  std::vector<drive::NamedComponent> components;
  components.reserve(manifest.size());
  for (const auto& record : manifest)
    components.push_back({record.text("name"), record.text("type")});
  return components;
}

float single(double value) { return static_cast<float>(value); }
float in_seconds(Time time) { return single(std::chrono::duration<double>(time).count()); }

}  // namespace

FreeSpaceParameters MovementControlComponent::read_free_space(runtime::Parameters& parameters,
                                                              const geometry::Footprint& outline) {
  FreeSpaceParameters p;
  p.half_width = outline.half_width();
  p.base_T_sensor.x = parameters.number("robot.laser.mount_x", "m", {-2, 2}, 0.0,
                                        "Laser ahead of the axle's middle.");
  return p;
}

Guard::Parameters MovementControlComponent::read_guard(runtime::Host& host) {
  auto& parameters = host.parameters();
  Guard::Parameters g;
  g.outline = wire::read_footprint(host);
  g.stopping = wire::read_stopping(host);
  g.turn_reaction = parameters.number("guard_reaction", "s", {0, 2}, g.turn_reaction,
                                      "From a measurement of the laser to a smaller command.");
  g.reaction = g.turn_reaction + parameters.number("robot.response.time_constant", "s", {0.05, 3},
                                                   0.5, "Lag of the base's speed.");
  g.turn_stop = parameters.number("robot.response.latency", "s", {0, 1}, 0.1,
                                  "From a command to the base's first change.") +
                parameters.number("robot.response.turn_time_constant", "s", {0.05, 3}, 0.2,
                                  "Lag of the base's turn rate.");
  g.margin = parameters.number("guard_margin", "m", {0, 0.5}, g.margin,
                               "Around the outline; within it the guard lets it creep only.");
  g.stand_off =
      parameters.number("guard_stand_off", "m", {0, 0.5}, g.stand_off,
                        "Left free before lethal cells, and by a planner that is stopped.");
  g.slowest = parameters.number("guard_slowest_v", "m/s", {0, 0.5}, g.slowest,
                                "What may be no faster before them stands: a balancing base would "
                                "creep up to them.");
  g.creep = parameters.number("guard_creep_v", "m/s", {0, 0.3}, g.creep,
                              "Of the outline's fastest point, within the margin.");
  g.blind = parameters.number("guard_blind_v", "m/s", {0, 0.8}, g.blind,
                              "Of the outline's fastest point, while no scan is heard.");
  return g;
}

Parameters MovementControlComponent::read_parameters(runtime::Host& host) {
  auto& parameters = host.parameters();
  Parameters p;
  p.guarded = parameters.flag("guard", true,
                              "Nobody moves the robot faster than it stops before what the "
                              "laser sees and the local costs know.");
  p.guard = read_guard(host);
  p.obeyed.linear = parameters.number("robot.limits.linear", "m/s", {0.1, 3}, p.obeyed.linear,
                                      "Faster commands are refused by the base.");
  p.obeyed.angular = parameters.number("robot.limits.angular", "rad/s", {0.1, 5}, p.obeyed.angular,
                                       "Faster commands are refused by the base.");
  const auto limit = [&](VelocityLimit& value, const std::string& name, const std::string& when) {
    value.linear = parameters.number(name + "_v", "m/s", {0, 1.5}, value.linear,
                                     "Greatest speed " + when + ".");
    value.angular = parameters.number(name + "_w", "rad/s", {0, 2}, value.angular,
                                      "Greatest turn rate " + when + ".");
  };
  limit(p.open, "open", "in open space (4 x 4 m, corridors of 2.5 m)");
  limit(p.corridor, "corridor", "in corridors of 1.4 m and rooms of 3 x 3 m");
  limit(p.confined, "confined", "in confined places");
  limit(p.person_ahead, "person_ahead", "with a person ahead");
  limit(p.localization_degraded, "localization_degraded", "while the pose is uncertain");
  limit(p.localization_lost, "localization_lost", "of the navigation while the pose is lost");
  limit(p.low_battery, "low_battery", "with a low battery");
  p.reverse = parameters.number("reverse_v", "m/s", {0, 1}, p.reverse,
                                "Greatest speed backwards, where nothing sees.");
  p.touched = parameters.number("touched_v", "m/s", {0, 0.3}, p.touched,
                                "Greatest speed past what a whisker touches.");
  p.whiskers = wire::read_whiskers(host);
  p.largest_drop = parameters.number("largest_drop", "m/s", {0.1, 5}, p.largest_drop,
                                     "So much slower than it drives guard and reflex tell the "
                                     "base to be at most; a balancing one holds its speed when "
                                     "told more.");
  const auto acceleration = [&](AccelerationLimit& value, const std::string& name,
                                const std::string& unit) {
    value.speed_up = parameters.number(name + "_speed_up", unit, {0, 10}, value.speed_up,
                                       "Acceleration away from zero; 0 = at once.");
    value.slow_down = parameters.number(name + "_slow_down", unit, {0, 10}, value.slow_down,
                                        "Deceleration to a smaller speed; 0 = at once.");
    value.stop = parameters.number(name + "_stop", unit, {0, 10}, value.stop,
                                   "Deceleration to zero; 0 = at once.");
  };
  acceleration(p.linear, "linear", "m/s2");
  acceleration(p.angular, "angular", "rad/s2");
  p.jerk.v = parameters.number("linear_jerk", "m/s3", {0, 100}, p.jerk.v,
                               "How fast the acceleration of an operator and the interaction "
                               "builds up, and they turn back only when the base stands; 0 = at "
                               "once.");
  p.jerk.w = parameters.number("angular_jerk", "rad/s3", {0, 100}, p.jerk.w,
                               "Likewise when turning; 0 = at once.");
  p.response = drive::read_response(parameters);
  p.whiskers_required =
      parameters.flag("whiskers_required", p.whiskers_required, "Without whiskers nothing moves.");
  return p;
}

MovementControlComponent::MovementControlComponent(runtime::Host& host)
    : host_(host),
      parameters_(read_parameters(host)),
      free_space_(read_free_space(host.parameters(), parameters_.guard.outline)),
      core_(parameters_),
      surroundings_({.base_T_sensor = free_space_.base_T_sensor}),
      rejected_(host.health().counter("cmd_vel: rejected")),
      held_back_(host.health().counter("guard: held back the navigation")),
      rejected_costs_(host.health().counter("local costs: rejected")),
      manifest_(components_of(wire::read_manifest(host))),
      enable_(host, topics::kMovementEnable,
              {.max_age = kEnableAge, .on_loss = "commands zero", .one_writer = true}, manifest_,
              {}),
      manual_(host, topics::kCmdVelManual, kSource, manifest_, [this] { decide(); }),
      interaction_(host, topics::kCmdVelInteraction, kSource, manifest_, [this] { decide(); }),
      navigation_(host, topics::kCmdVelNavigation,
                  {.max_age = kCommandAge, .on_loss = "commands zero", .one_writer = true},
                  manifest_, [this] { decide(); }) {
  auto& parameters = host.parameters();
  assume_person_ =
      parameters.flag("assume_person_ahead", true,
                      "Until a people detector is heard, drive as if a person were ahead.");
  low_battery_ = parameters.number("low_battery_percent", "%", {0, 100}, 15.0,
                                   "Below this the battery is low.");

  scan_silence_ = runtime::from_seconds(parameters.number(
      "robot.laser.silence", "s", {0.05, 1}, 0.3, "A laser without a scan for so long is lost."));

  whiskers_ = host.input(topics::kWhiskers, {.max_age = kWhiskerAge,
                                             .on_loss = "commands zero where whiskers are required",
                                             .optional = true});
  base_ = host.input(topics::kBaseStatus, {.max_age = kBaseAge, .on_loss = "commands zero"});
  scan_ = host.input(
      topics::kScanFiltered, {.max_age = scan_silence_, .on_loss = "creeps"},
      [this](const auto& scan, const auto&) { take_scan(scan); },
      [this] {
        seen_at_.reset();
        surroundings_.forget();
        situation_.update(std::nullopt, host_.now().time_since_epoch());
      });
  costs_ =
      host.input(topics::kLocalCosts,
                 {.max_age = kCostsAge, .on_loss = "guards by the scan alone", .optional = true},
                 [this](const auto& costs, const auto&) {
                   if (!is_window(costs)) ++rejected_costs_;
                 });
  odom_ =
      host.input(topics::kOdom,
                 {.max_age = kOdomAge, .on_loss = "guards by the scan alone", .optional = true});
  localization_ = host.input(topics::kLocalizationStatus,
                             {.max_age = kLocalizationAge, .on_loss = "drives as if lost"});
  person_ = host.input(
      topics::kPersonAhead,
      {.max_age = kPersonAge, .on_loss = "drives as with a person ahead", .optional = true});
  people_ = host.input(topics::kPeople,
                       {.max_age = kPersonAge,
                        .on_loss = "what the costs know explains no touch: it may be somebody",
                        .optional = true});
  command_ = host.output(topics::kDriveCommand);
  status_ = host.output(topics::kMovementStatus);
  command_timer_ = host.timer("command", milliseconds(20), [this](auto) { decide(); });
  status_timer_ = host.timer("status", milliseconds(100), [this](auto) { publish_status(); });
}

std::optional<geometry::Twist2> MovementControlComponent::velocity(
    const RightfulInput<geometry_msgs::msg::TwistStamped>& source) {
  const auto* message = source.fresh();
  if (message == nullptr) return std::nullopt;
  // Not checked here: the core turns what is not finite into zero and says who sent it.
  return geometry::Twist2{message->twist().linear().x(), message->twist().angular().z()};
}

std::optional<geometry::Twist2> MovementControlComponent::measured() const {
  const auto* base = base_.fresh();
  if (base == nullptr || base->state() != usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING)
    return std::nullopt;
  return geometry::Twist2{base->v(), base->w()};
}

/// While MARVIN leans forward to speed up, most beams that look ahead may end on the floor; what is
/// near they still meet. Whoever does not lean forward, or is as fast as he is told, has no excuse.
bool MovementControlComponent::sees() const {
  const Time now = host_.now().time_since_epoch();
  const bool leans = leaned_at_ && now - *leaned_at_ < kLeanedAge;
  return seen_at_ && now - *seen_at_ < (leans ? kLeaning : scan_silence_);
}

/// Where the costs are lethal. They know the map's walls, which are elsewhere when the pose is
/// lost.
std::span<const geometry::Point2> MovementControlComponent::cells(double reach) {
  const auto* costs = costs_.fresh();
  const auto* odom = odom_.fresh();
  const auto* localization = localization_.fresh();
  if (costs == nullptr || odom == nullptr || !is_window(*costs) || localization == nullptr ||
      localization->state() == usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST)
    return {};
  const auto odom_T_base = wire::to_planar(odom->pose().pose());
  if (!odom_T_base) return {};
  return lethal_.around(*odom_T_base,
                        {.costs = costs->costs(),
                         .width = costs->width(),
                         .height = costs->height(),
                         .resolution = static_cast<double>(costs->resolution()),
                         .origin = {costs->origin_x(), costs->origin_y()}},
                        reach);
}

/// What counts for a robot that shall be, or is, so fast.
Guard::View MovementControlComponent::view(double speed) {
  return {surroundings_.points(), sees(), surroundings_.guessed(), cells(core_.reach(speed))};
}

/// Where people are, or were when they were last seen.
std::optional<std::span<const geometry::Point2>> MovementControlComponent::people() {
  const auto* people = people_.fresh();
  const auto* odom = odom_.fresh();
  if (people == nullptr || odom == nullptr || people->header().frame_id() != frames::kOdom)
    return std::nullopt;
  const auto odom_T_base = wire::to_planar(odom->pose().pose());
  if (!odom_T_base) return std::nullopt;
  const geometry::Pose2 base_T_odom = geometry::inverse(*odom_T_base);
  around_.clear();
  for (const auto& person : people->people())
    around_.push_back(base_T_odom * geometry::Point2(person.x(), person.y()));
  return around_;
}

Inputs MovementControlComponent::gather() {
  Inputs inputs;
  if (const auto* enable = enable_.fresh()) {
    inputs.enables = Enables{enable->movement(), enable->manual(), enable->interaction(),
                             enable->navigation(), enable->speed_factor()};
  }
  inputs.manual = velocity(manual_);
  inputs.interaction = velocity(interaction_);
  inputs.navigation = velocity(navigation_);
  if (const auto* w = whiskers_.fresh()) {
    inputs.whiskers = Whiskers{w->front_left(), w->front_right(), w->back_left(), w->back_right()};
  }
  inputs.person_ahead = person_ahead();
  inputs.people = people();
  inputs.situation = situation_.situation();
  if (const auto* localization = localization_.fresh()) {
    const auto state = static_cast<Localization>(localization->state());
    inputs.localization = state > Localization::kGood ? Localization::kLost : state;
  }
  if (const auto* base = base_.fresh()) {
    inputs.low_battery = base->battery_percent() < low_battery_;  // NaN, unknown, is not low
    inputs.motors_off = base->state() == usher_msgs::msg::BaseStatus_Constants::STATE_EMERGENCY;
    const bool speeds_up = core_.status().current.v - base->v() > kSpeedsUp;
    if (base->pitch() > kLeans && speeds_up) leaned_at_ = host_.now().time_since_epoch();
  }
  inputs.measured = measured();
  double fastest = 0.0;  // what is not finite reaches nowhere, and does not move the robot
  for (const auto& twist : {inputs.manual, inputs.interaction, inputs.navigation, inputs.measured})
    fastest = std::max(fastest, twist ? std::abs(twist->v) : 0.0);
  inputs.view = view(std::min(fastest, parameters_.open.linear));
  return inputs;
}

/// A people detector that was heard and fell silent is a person ahead.
std::optional<bool> MovementControlComponent::person_ahead() const {
  if (const auto* told = person_.fresh()) return !told->clear();
  if (person_.latest() != nullptr) return std::nullopt;
  return assume_person_;
}

void MovementControlComponent::take_scan(const sensor_msgs::msg::LaserScan& scan) {
  const auto now = host_.now().time_since_epoch();
  std::optional<FreeSpace> space;
  if (wire::check(scan)) {
    space = free_space(scan.ranges(), scan.angle_min(), scan.angle_increment(), free_space_);
    surroundings_.move(measured(), now);
    surroundings_.take({scan.ranges(), scan.angle_min(), scan.angle_increment()}, now);
  }
  if (space) seen_at_ = now;
  if (!wire::check(scan)) seen_at_.reset();
  situation_.update(space, now);
}

void MovementControlComponent::decide() {
  const auto now = host_.now().time_since_epoch();
  surroundings_.move(measured(), now);
  const Decision decision = core_.decide(gather(), now);
  rejected_ = core_.rejected();
  held_back_ = core_.held_back();
  const auto* enable = enable_.fresh();
  usher_msgs::msg::DriveCommand command;
  command.stamp(wire::to_message(host_.now()));
  command.epoch(enable != nullptr ? enable->epoch() : 0);
  command.number(++number_);
  command.v(decision.twist.v);
  command.w(decision.twist.w);
  command_.publish(command);
}

void MovementControlComponent::publish_status() {
  const auto& s = core_.status();
  usher_msgs::msg::MovementStatus m;
  m.header(wire::header(host_.now(), "base_footprint"));
  m.enable_movement(s.enables.movement);
  m.enable_manual(s.enables.manual);
  m.enable_interaction(s.enables.interaction);
  m.enable_navigation(s.enables.navigation);
  m.velocity_linear_max_human(single(s.max_human.linear));
  m.velocity_angular_max_human(single(s.max_human.angular));
  m.velocity_linear_max_normal(single(s.max_normal.linear));
  m.velocity_angular_max_normal(single(s.max_normal.angular));
  m.velocity_threshold_linear(single(s.threshold_linear.threshold));
  m.velocity_threshold_angular(single(s.threshold_angular.threshold));
  m.velocity_threshold_linear_time(in_seconds(s.threshold_linear.patience));
  m.velocity_threshold_angular_time(in_seconds(s.threshold_angular.patience));
  m.velocity_current_linear_max(single(s.max_current.linear));
  m.velocity_current_angular_max(single(s.max_current.angular));
  m.velocity_current_linear(single(s.current.v));
  m.velocity_current_angular(single(s.current.w));
  m.velocity_measured_linear(single(s.measured.v));
  m.velocity_measured_angular(single(s.measured.w));
  m.velocity_error_linear(single(s.error_linear.error));
  m.velocity_error_angular(single(s.error_angular.error));
  m.velocity_error_linear_time(in_seconds(s.error_linear.lasting));
  m.velocity_error_angular_time(in_seconds(s.error_angular.lasting));
  m.front_left(s.whiskers.front_left);
  m.front_right(s.whiskers.front_right);
  m.back_left(s.whiskers.back_left);
  m.back_right(s.whiskers.back_right);
  m.segway_connected(s.base_connected);
  m.ok(s.ok);
  m.source(static_cast<std::uint8_t>(s.source));
  m.situation(static_cast<std::uint8_t>(s.situation));
  m.limit_reason(std::string(text(s.limit)));
  const double way = sees() ? core_.guard().way(s.current, view(kReported)) : 0.0;  // nobody knows
  m.person_ahead(person_ahead().value_or(true));
  m.obstacle_distance(single(way));
  m.stopping_distance(single(parameters_.guard.stopping.distance(s.measured.v)));
  const bool stands = std::abs(s.measured.v) < kStanding;
  m.time_to_collision(stands ? std::numeric_limits<float>::infinity()
                             : single(way / std::abs(s.measured.v)));
  status_.publish(m);
  host_.health().set(s.ok ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
                     s.ok ? "" : std::string(text(s.limit)));
}

}  // namespace usher::movement_control
