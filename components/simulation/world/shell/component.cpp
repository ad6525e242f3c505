#include "simulation/world/shell/component.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/map_file.hpp"
#include "wire/conversions.hpp"
#include "wire/footprint.hpp"
#include "wire/frames.hpp"
#include "wire/torso.hpp"
#include "wire/whiskers.hpp"

namespace usher::world {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
using namespace usher_sim_msgs::msg;

constexpr auto kStepTime = milliseconds(10);
static_assert(kStep == 0.01);
constexpr int kBoardEvery = 2;  // 50 Hz
constexpr int kTruthEvery = 2;  // 50 Hz
/// The firmware of the base holds a command for so long, then it stops.
constexpr auto kCommandHold = milliseconds(400);
/// More than this in one go would be a jump for the robot; the rest is time that the simulation
/// loses.
constexpr std::uint64_t kMostStepsAtOnce = 5;
constexpr double kBehind = 0.1;  // [s] of lag from which the simulation says that it is behind
constexpr auto kLately = std::chrono::seconds(5);  // since it lost time that it never makes up

/// The defaults are MARVIN's SICK LMS100.
void read_laser(runtime::Parameters& p, LaserConfig& laser) {
  laser.angle_min = p.number("robot.laser.angle_min", "rad", {-3.2, 0}, laser.angle_min,
                             "Bearing of the first beam.");
  laser.increment =
      p.number("robot.laser.increment", "rad", {0.001, 0.2}, laser.increment, "From beam to beam.");
  laser.count = static_cast<int>(
      p.integer("robot.laser.beams", "-", {2, 10000}, laser.count, "Beams of a turn."));
  laser.range_max = p.number("robot.laser.range_max", "m", {0.5, 100}, laser.range_max,
                             "Farther things give no echo.");
  laser.statistical_error = p.number("robot.laser.statistical_error", "m", {0, 0.2},
                                     laser.statistical_error, "Standard deviation of a range.");
  laser.relative_error = p.number("robot.laser.relative_error", "-", {0, 0.1}, laser.relative_error,
                                  "The same as share of the range, where that is more.");
  laser.systematic_error = p.number("robot.laser.systematic_error", "m", {0, 0.2},
                                    laser.systematic_error, "Bound of an error that stays.");
  laser.self_angle = p.number("robot.laser.self_filter", "rad", {0.1, 3.2}, laser.self_angle,
                              "Beams beyond, to either side, see the robot itself.");
}

usher_sim_msgs::msg::Person to_message(const world::Person& person, std::uint32_t id,
                                       const std::string& name) {
  usher_sim_msgs::msg::Person entry;
  entry.id(id);
  entry.name(name);
  entry.x(person.position.x());
  entry.y(person.position.y());
  entry.yaw(person.yaw);
  entry.v(person.velocity.norm());
  entry.height(person.height);
  entry.posture(static_cast<std::uint8_t>(person.posture));
  entry.upper(person.clothes.upper);
  entry.legs(person.clothes.legs);
  return entry;
}

}  // namespace

WorldConfig WorldComponent::read_robot(runtime::Host& host) {
  auto& p = host.parameters();
  WorldConfig config;
  RobotConfig& robot = config.robot;
  const auto footprint = wire::read_footprint(host);
  robot.footprint.assign(footprint.corners().begin(), footprint.corners().end());
  robot.whiskers.x = robot.whiskers.y = 0.0;
  for (const auto& corner : robot.footprint) {
    robot.whiskers.x = std::max(robot.whiskers.x, corner.x());
    robot.whiskers.y = std::max(robot.whiskers.y, corner.y());
  }
  const auto mount = wire::read_whiskers(host);
  robot.whiskers.length = mount.length;
  robot.whiskers.outward = mount.outward;
  robot.axle_height = p.number("robot.wheel_radius", "m", {0.05, 0.5}, 0.2355,
                               "Of the driven wheels; also the axle's height.");
  robot.lasers.front().mount.x =
      p.number("robot.laser.mount_x", "m", {-2, 2}, "Laser ahead of the axle's middle.");
  robot.lasers.front().mount.z =
      p.number("robot.laser.mount_z", "m", {-1, 3}, "Laser above the axle's middle.");
  read_laser(p, robot.lasers.front());
  robot.kind = p.choice("robot.base", {"segway", "pioneer"}, "segway",
                        "What the simulated robot drives on.") == "pioneer"
                   ? RobotConfig::Kind::kPioneer
                   : RobotConfig::Kind::kSegway;
  double& track =
      robot.kind == RobotConfig::Kind::kPioneer ? robot.pioneer.track : robot.segway.track;
  track =
      p.number("robot.track", "m", {0.1, 2}, track,
               "Between the wheels as turns show it: their travels' difference over the angle.");
  robot.sonar.count = static_cast<int>(p.integer("robot.ultrasonic.count", "-", {1, 16}, 5,
                                                 "Sensors on the ring, the middle looks ahead."));
  robot.sonar.range_max =
      p.number("robot.ultrasonic.range_max", "m", {0.5, 10}, 6.0, "Farther things are not heard.");
  robot.height = p.number("robot.height", "m", {0.1, 3}, robot.height,
                          "Of the whole robot: what is higher does not touch it.");
  robot.sonar.ring_radius = p.number("robot.ultrasonic.mount_x", "m", {-2, 2},
                                     "Ring of the ultrasonic sensors ahead of the axle's middle.");
  robot.sonar.z = p.number("robot.ultrasonic.mount_z", "m", {-1, 3},
                           "Ring of the ultrasonic sensors above the axle's middle.");
  robot.sonar.spacing = p.number("robot.ultrasonic.spacing", "rad", {0.05, 1.6},
                                 "Angle between two ultrasonic sensors.");
  return config;
}

std::unique_ptr<World> WorldComponent::make(runtime::Host& host) {
  auto& p = host.parameters();
  WorldConfig config = read_robot(host);
  people_of_ = p.text("people_of", "",
                      "Robot of the fleet whose world moves the people; empty: this one does.");
  config.name = host.robot_name();
  config.moves_people = people_of_.empty();
  const std::string building_file = p.file(
      "site.world", "", "The building (world.yaml); without it the walls of the site's map.");
  const std::string map_file =
      p.file("site.map", "", "YAML of the site's map, in map_server form.");
  const std::string people_file = p.file("site.people", "", "Who walks there (people.yaml).");
  const bool with_people = p.flag("people", false, "Whether anybody walks there.");
  const auto bystanders =
      p.numbers("bystanders", "m", {-1000, 1000}, 0, 20, {},
                "x, y of more people, who stand there until they are sent: bystander_1 and so on.");
  if (bystanders.size() % 2 != 0) host.fault("bystanders must have pairs of x, y");
  const auto start = p.numbers("site.initial_pose", "-", {-1e4, 1e4}, 3, 3, {0, 0, 0},
                               "Where the robot usually starts: x in m, y in m, yaw in rad.");
  if (building_file.empty() && map_file.empty()) return nullptr;

  std::vector<PersonPlan> people;
  if (with_people && config.moves_people && !people_file.empty()) {
    auto loaded = load_people(people_file);
    if (!loaded) host.fault(loaded.error());
    people = std::move(loaded).value();
    for (std::size_t i = 0; i + 1 < bystanders.size(); i += 2) {
      PersonPlan plan;
      plan.name = "bystander_" + std::to_string(i / 2 + 1);
      plan.start = {bystanders[i], bystanders[i + 1]};
      people.push_back(std::move(plan));
    }
  }
  const Pose2 robot{start[0], start[1], start[2]};
  const std::uint64_t seed = seed_ = host.random("world").next();
  if (!building_file.empty()) {
    auto building = load_building(building_file);
    if (!building) host.fault(building.error());
    return std::make_unique<World>(config, std::move(building).value(), people, robot, seed);
  }
  auto map = grid::load_map(map_file);
  if (!map) host.fault(map.error());
  return std::make_unique<World>(config, std::move(map).value(), people, robot, seed);
}

WorldComponent::WorldComponent(runtime::Host& host)
    : host_(host),
      torso_(wire::read_torso_limits(host)),
      world_(make(host)),
      rejected_(host.health().counter("commands: rejected")),
      late_steps_(host.health().counter("steps: late")) {
  auto& p = host.parameters();
  range_min_ = p.number("robot.laser.range_min", "m", {0, 5}, 0.5, "Nearer ranges are no ranges.");
  scan_every_ = std::lround(
      p.number("robot.laser.period", "s", {0.01, 1}, 0.02, "Of a turn of the laser.") / kStep);
  command_ = host.input(
      topics::kSimBaseCommand,
      {.max_age = kCommandHold, .on_loss = "the base stops, as its firmware does"},
      [this](const auto& command, const auto&) { take_command(command); },
      [this] {
        if (world_) world_->base().command({});
      });
  person_goal_ = host.input(topics::kSimPersonGoal, {.optional = true},
                            [this](const auto& goal, const auto&) { take_person_goal(goal); });
  depth_ = std::make_unique<DepthOutput>(host, world_.get(), seed_);
  tilt_command_ =
      host.input(topics::kSimSensorBoardCommand, {.optional = true},
                 [this](const auto& command, const auto&) { depth_->set_tilt(command.tilt()); });
  torso_command_ = host.input(topics::kSimTorsoCommand, {.optional = true},
                              [this](const auto& command, const auto&) { take_torso(command); });
  feedback_ = host.output(topics::kSimBaseFeedback);
  scans_ = host.output(topics::kSimScan);
  boards_ = host.output(topics::kSimSensorBoard);
  torsos_ = host.output(topics::kSimTorso);
  truth_ = host.output(topics::kSimGroundTruth);
  host.input(topics::kFleetSimBody, {.optional = true},
             [this](const auto& body, const auto&) { take_body(body); });
  host.input(topics::kFleetSimPeople, {.optional = true},
             [this](const auto& people, const auto&) { take_people(people); });
  host.input(topics::kFleetSimPersonGoal, {.optional = true},
             [this](const auto& goal, const auto&) {
               if (people_of_.empty()) move_person(goal.goal(), goal.robot());
             });
  bodies_ = host.output(topics::kFleetSimBody);
  people_ = host.output(topics::kFleetSimPeople);
  person_goals_ = host.output(topics::kFleetSimPersonGoal);
  timer_ = host.timer("step", kStepTime, [this](std::uint64_t skipped) { advance(skipped); });
  start_ = host.now();
  if (!world_)
    host.health().set(HealthState::kDegraded,
                      "neither a world nor a map is set (site.world, site.map)");
}

void WorldComponent::take_command(const BaseCommand& command) {
  if (!world_) return;
  if (!std::isfinite(command.v()) || !std::isfinite(command.w())) {
    ++rejected_;
    return;
  }
  switch (command.mode()) {
    case BaseCommand_Constants::MODE_EMERGENCY_STOP:
      world_->base().emergency_stop();
      break;
    case BaseCommand_Constants::MODE_RESET:
      world_->base().reset();
      break;
    default:
      world_->base().command({command.v(), command.w()});
  }
}

void WorldComponent::take_person_goal(const PersonGoal& goal) {
  if (people_of_.empty()) return move_person(goal, host_.robot_name());
  FleetPersonGoal message;
  message.robot(host_.robot_name());
  message.goal(goal);
  person_goals_.publish(message);
}

void WorldComponent::move_person(const PersonGoal& goal, const std::string& leader) {
  if (!world_ ||
      !world_->send_person(goal.name(), {goal.x(), goal.y()}, goal.speed(), goal.follow(), leader))
    ++rejected_;
}

void WorldComponent::take_torso(const TorsoCommand& command) {
  if (!kinematics::finite(command.joints())) {
    ++rejected_;
    return;
  }
  torso_.command(command.joints(), command.left_eye(), command.right_eye());
}

/// A robot whose world falls silent stays where it was.
void WorldComponent::take_body(const FleetBody& body) {
  constexpr std::size_t kMostCorners = 64;
  const Pose2 pose{body.x(), body.y(), body.yaw()};
  const auto& corners = body.footprint();
  if (!world_ || body.robot() == host_.robot_name()) return;
  if (!pose.finite() || corners.size() < 3 || corners.size() > kMostCorners) {
    ++rejected_;
    return;
  }
  OtherRobot& other = others_[body.robot()];
  other.name = body.robot();
  other.pose = pose;
  other.height = body.height();
  other.outline.clear();
  for (const auto& corner : corners) other.outline.emplace_back(corner.x(), corner.y());
}

void WorldComponent::take_people(const FleetPeople& message) {
  if (!world_ || people_of_.empty() || message.robot() != people_of_) return;
  std::vector<world::Person> people;
  std::vector<Mover> bodies;
  people.reserve(message.people().size());
  bodies.reserve(message.people().size());
  for (const auto& entry : message.people()) {
    world::Person& person = people.emplace_back();
    person.name = entry.person().name();
    person.scripted = entry.scripted();
    person.position = {entry.person().x(), entry.person().y()};
    person.velocity = {entry.vx(), entry.vy()};
    person.yaw = entry.person().yaw();
    person.radius = entry.radius();
    person.height = entry.person().height();
    person.posture = static_cast<rendering::Posture>(
        std::min<std::uint8_t>(entry.person().posture(), Person_Constants::POSTURE_ARMS_OUT));
    person.stride = entry.stride();
    person.clothes = {entry.person().upper(), entry.person().legs()};
    bodies.push_back({person.position, person.radius, entry.top()});
  }
  world_->show_people(std::move(people), std::move(bodies));
}

void WorldComponent::advance(std::uint64_t skipped) {
  if (!world_) return;
  late_steps_ += skipped;
  const std::uint64_t due = std::min<std::uint64_t>(skipped + 1, kMostStepsAtOnce);
  if (!others_.empty()) {
    std::vector<OtherRobot> others;
    others.reserve(others_.size());
    for (const auto& [name, other] : others_) others.push_back(other);
    world_->show_robots(std::move(others));
  }
  bool scan = false, board = false, truth = false;
  for (std::uint64_t i = 0; i < due; ++i) {
    world_->step();
    torso_.step();
    ++steps_;
    depth_->step(host_.now());
    scan = scan || steps_ % scan_every_ == 0;
    board = board || steps_ % kBoardEvery == 0;
    truth = truth || steps_ % kTruthEvery == 0;
  }
  publish_feedback();
  if (!host_.robot_name().empty()) publish_to_fleet();
  if (scan) publish_scan();
  if (board) publish_sensor_board();
  if (board && torso_.exists()) publish_torso();
  if (truth) publish_truth();
  const double lag = runtime::seconds(host_.now() - start_) - static_cast<double>(steps_) * kStep;
  if (skipped + 1 > due) fell_behind_at_ = host_.now();
  const bool behind = lag > kBehind && host_.now() - fell_behind_at_ < kLately;
  host_.health().set(behind ? HealthState::kDegraded : HealthState::kOk,
                     behind ? "the simulation is " + std::to_string(lag) + " s behind" : "");
}

void WorldComponent::publish_feedback() {
  const BaseReadings& readings = world_->base().readings();
  BaseFeedback message;
  message.header(wire::header(host_.now(), frames::kBaseLink));
  message.balancing(readings.motors_on);
  message.emergency(readings.emergency);
  message.pitch(readings.pitch);
  message.pitch_rate(readings.pitch_rate);
  message.left_travel(readings.left_travel);
  message.right_travel(readings.right_travel);
  message.left_velocity(readings.left_velocity);
  message.right_velocity(readings.right_velocity);
  message.yaw_rate(readings.yaw_rate);
  message.battery_percent(static_cast<float>(readings.battery_percent));
  feedback_.publish(message);
}

void WorldComponent::publish_scan() {
  const LaserConfig& laser = world_->config().robot.lasers.front();
  world_->scan(0, scan_.ranges());
  scan_.header(wire::header(host_.now(), "laser"));
  scan_.angle_min(static_cast<float>(laser.angle_min));
  scan_.angle_increment(static_cast<float>(laser.increment));
  scan_.angle_max(static_cast<float>(
      laser.angle_min + laser.increment * (static_cast<double>(scan_.ranges().size()) - 1.0)));
  scan_.scan_time(static_cast<float>(static_cast<double>(scan_every_) * kStep));
  scan_.range_min(static_cast<float>(range_min_));
  scan_.range_max(static_cast<float>(laser.range_max));
  scans_.publish(scan_);
}

void WorldComponent::publish_sensor_board() {
  world_->sonar(board_.ranges());
  const WhiskerContacts contacts = world_->whiskers();
  board_.header(wire::header(host_.now(), frames::kBaseLink));
  board_.front_left(contacts.front_left);
  board_.front_right(contacts.front_right);
  board_.back_left(contacts.back_left);
  board_.back_right(contacts.back_right);
  board_.tilt(depth_->tilt());
  boards_.publish(board_);
}

void WorldComponent::publish_torso() {
  TorsoReading message;
  message.header(wire::header(host_.now(), ""));
  message.joints(torso_.joints());
  message.left_eye(torso_.left_eye());
  message.right_eye(torso_.right_eye());
  torsos_.publish(message);
}

void WorldComponent::publish_truth() {
  const BaseTruth& base = world_->base().truth();
  const GroundTruth& judge = world_->truth();
  usher_sim_msgs::msg::GroundTruth message;
  message.header(wire::header(host_.now(), frames::kMap));
  message.pose(wire::to_message(base.pose));
  message.v(base.twist.v);
  message.w(base.twist.w);
  message.pitch(base.pitch);
  message.clearance(judge.clearance);
  message.contacts(judge.contacts);
  message.touches(judge.touches);
  message.contact_with(judge.contact_with);
  message.lag(
      std::max(0.0, runtime::seconds(host_.now() - start_) - static_cast<double>(steps_) * kStep));
  std::uint32_t id = 0;
  for (const auto& person : world_->people())
    message.people().push_back(to_message(person, id++, person.scripted ? person.name : ""));
  truth_.publish(message);
}

void WorldComponent::publish_to_fleet() {
  const Pose2 pose = world_->base().truth().pose;
  FleetBody body;
  body.header(wire::header(host_.now(), frames::kMap));
  body.robot(host_.robot_name());
  body.x(pose.x);
  body.y(pose.y);
  body.yaw(pose.yaw);
  body.height(world_->config().robot.height);
  for (const Point2& corner : world_->config().robot.footprint) {
    auto& point = body.footprint().emplace_back();
    point.x(static_cast<float>(corner.x()));
    point.y(static_cast<float>(corner.y()));
  }
  bodies_.publish(body);
  if (!people_of_.empty()) return;
  FleetPeople message;
  message.header(body.header());
  message.robot(host_.robot_name());
  const auto people = world_->people();
  const auto movers = world_->bodies();
  for (std::size_t i = 0; i < people.size(); ++i) {
    auto& entry = message.people().emplace_back();
    entry.person(to_message(people[i], static_cast<std::uint32_t>(i), people[i].name));
    entry.scripted(people[i].scripted);
    entry.vx(people[i].velocity.x());
    entry.vy(people[i].velocity.y());
    entry.radius(people[i].radius);
    entry.top(movers[i].top);
    entry.stride(people[i].stride);
  }
  people_.publish(message);
}

}  // namespace usher::world
