#include "operations/fault_windows/window.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "drivers/segway_rmp/core/device.hpp"
#include "foundation/grid/sampling.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/fault_windows/injection.hpp"
#include "operations/fault_windows/simulated_guard.hpp"
#include "operations/results/result_sheet.hpp"
#include "wire/conversions.hpp"
#include "wire/stopping.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using usher_msgs::msg::SupervisorStatus;

constexpr auto kStep = milliseconds(20);
constexpr int kStepsPerWord = 10;   // the operator repeats at 5 Hz
constexpr double kPatience = 45.0;  // [s] until it must have got to drive
constexpr int kMostAttempts = 6;
constexpr double kSpeedPeriod = 0.5;  // [s]
constexpr std::uint64_t kFirstId = 1000;
constexpr double kRaster = 1.0;  // [m]
constexpr double kRoom = 0.65;   // [m] of a start to the next wall

/// What an operator reads of why the robot stands: what only slows it, or is only told, is no
/// reason.
std::vector<std::string> lines_of(const SupervisorStatus& status) {
  using namespace usher_msgs::msg::SupervisorStatus_Constants;
  std::vector<std::string> lines;
  if (!status.reason().empty()) lines.push_back(status.reason());
  for (const auto& component : status.components()) {
    if (component.criticality() == CRITICALITY_STOP && component.health() != HEALTH_OK)
      lines.push_back(component.name() + ": " + component.reason());
  }
  return lines;
}

/// One run up to the end of its window.
class Window {
 public:
  Window(std::unique_ptr<LockstepRun> run, const WindowSetting& setting, WindowPlan plan)
      : run_(std::move(run)),
        setting_(setting),
        plan_(std::move(plan)),
        errand_(setting.locations[plan_.goal], kFirstId,
                {[this](const auto& request) {
                   world().publish(topics::kSupervisorRequest, request, Errand::kClient);
                 },
                 [this](const auto& goal) {
                   goal_ = goal;
                   world().publish(topics::kNavigateGoal, goal, Errand::kClient);
                 }}),
        guard_(world(), setting.robot_of(plan_.seed).targets.base_driver,
               segway_rmp::kGuardSilence) {
    watch_truth();
    watch_commands();
    watch_words();
  }

  /// False when it did not get to drive.
  bool drive_until_hit() {
    std::optional<double> from;
    while (now() < kPatience) {
      step();
      if (!from && speed_ > kHitSpeed) from = now();
      if (from && now() >= *from + plan_.delay && speed_ > kHitSpeed) return true;
    }
    return false;
  }

  void be_hit(WindowResult& result) {
    result.hit_at = now();
    result.hit_speed = speed_;
    judge_.hit(now(), expectations(plan_, setting_.robot_of(plan_.seed).targets));
    for (const Fault& fault : plan_.faults) {
      const auto writers = inject(fault, world());
      foreign_.insert(writers.begin(), writers.end());
    }
    result.speeds.push_back(speed_);
    while (now() < result.hit_at + kWindow) {
      step();
      if (now() >= result.hit_at + kSpeedPeriod * static_cast<double>(result.speeds.size()))
        result.speeds.push_back(speed_);
    }
    result.judgement = judge_.judgement(now());
    result.touches = touches_;
    result.digest = world().digest();
  }

  double now() { return runtime::seconds(world().elapsed()); }
  const RunRecord& record() const { return run_->record(); }

 private:
  runtime::LockstepWorld& world() { return run_->world(); }

  void step() {
    if (steps_++ % kStepsPerWord == 0) speak();
    world().run_for(kStep);
  }
  void speak() {
    errand_.step();
    // A navigator that was restarted is told again, as the guide does.
    if (forgotten_ && goal_) world().publish(topics::kNavigateGoal, *goal_, Errand::kClient);
  }
  bool foreign(const runtime::SampleInfo& info) const { return foreign_.contains(info.writer); }

  void watch_truth() {
    world().observe(topics::kSimGroundTruth, [this](const auto& truth, const auto&) {
      speed_ = truth.v();
      touches_ = truth.touches();
      if (const auto pose = wire::to_planar(truth.pose())) {
        judge_.truth(now(), *pose, {truth.v(), truth.w()}, truth.contacts(), truth.contact_with());
      }
    });
  }
  void watch_commands() {
    world().observe(topics::kDriveGrant, [this](const auto& grant, const auto& info) {
      judge_.grant(now(), foreign(info), grant.granted(), grant.writer(), grant.epoch());
    });
    world().observe(topics::kMovementEnable, [this](const auto& enable, const auto& info) {
      if (foreign(info) || !enable.movement()) return;
      judge_.enable(now(), {false, enable.manual(), enable.interaction(), enable.navigation()});
    });
    world().observe(topics::kDriveCommand, [this](const auto& command, const auto& info) {
      const geometry::Twist2 twist{command.v(), command.w()};
      judge_.command(now(), info.writer, command.epoch(), command.number(), twist);
      if (!foreign(info) && !spoils_commands()) judge_.chosen(now(), twist);
    });
    world().observe(topics::kSimBaseCommand, [this](const auto& wheels, const auto&) {
      judge_.wheels(now(), {wheels.v(), wheels.w()});
    });
    world().observe(topics::kMovementStatus, [this](const auto& status, const auto&) {
      judge_.limit(now(), status.velocity_current_linear_max());
    });
    watch_wish(topics::kCmdVelManual, 1);
    watch_wish(topics::kCmdVelInteraction, 2);
    watch_wish(topics::kCmdVelNavigation, 3);
  }
  void watch_wish(const topics::Topic<geometry_msgs::msg::TwistStamped>& topic,
                  std::size_t source) {
    world().observe(topic, [this, source](const auto& wish, const auto& info) {
      if (foreign(info)) return;
      judge_.wish(now(), source, {wish.twist().linear().x(), wish.twist().angular().z()});
    });
  }
  void watch_words() {
    world().observe(topics::kSupervisorStatus, [this](const auto& status, const auto&) {
      errand_.take(status);
      judge_.told(now(), lines_of(status));
    });
    world().observe(topics::kNavigateStatus, [this](const auto& status, const auto&) {
      errand_.take(status);
      judge_.navigation(now(), status.state(), status.reason());
      forgotten_ = goal_ && status.state() == usher_msgs::msg::GoalStatus_Constants::STATE_IDLE;
    });
  }
  /// What is written then is not what movement_control chose.
  bool spoils_commands() const {
    return std::any_of(plan_.faults.begin(), plan_.faults.end(),
                       [](const Fault& fault) { return fault.kind == FaultKind::kBadCommand; });
  }

  std::unique_ptr<LockstepRun> run_;
  const WindowSetting& setting_;
  WindowPlan plan_;
  Errand errand_;
  SimulatedGuard guard_;
  WindowJudge judge_;
  std::set<runtime::Guid> foreign_;
  double speed_ = 0.0;
  std::uint32_t touches_ = 0;
  int steps_ = 0;
  std::optional<usher_msgs::msg::NavigateGoal> goal_;
  bool forgotten_ = false;  ///< by the navigator
};

Deployment placed(const WindowSetting& setting, const WindowPlan& plan) {
  Deployment deployment = setting.robot_of(plan.seed).deployment;
  const geometry::Point2& start = setting.starts[plan.start];
  char pose[96];
  std::snprintf(pose, sizeof(pose), "[%.3f, %.3f, %.4f]", start.x(), start.y(), plan.yaw);
  set_site_value(deployment, "site.initial_pose", pose);
  if (!plan.sensing_apart) return deployment;
  for (auto& file : deployment.files) {
    const bool senses =
        file.name == "lms100" || file.name == "sensor_board" || file.name == "scan_filter";
    if (senses) file.host = "sensing";
  }
  return deployment;
}

/// Crossings of a raster that are free around, for the robot and whoever passes.
std::vector<geometry::Point2> free_places(const grid::OccupancyGrid& map) {
  grid::FreeSpace space;
  space.build(map, kRoom);
  Random unused(0);
  std::vector<geometry::Point2> places;
  grid::sample_points(space, map, {.sampling = grid::Sampling::kGrid, .grid_step = kRaster}, unused,
                      places);
  return places;
}

Status save_trace(const RunRecord& record, const WindowSetting& setting, const std::string& title,
                  const std::string& trace) {
  const auto map = site_map(setting.blind.deployment);
  if (!map) return Error{map.error()};
  if (auto saved = write_file(trace + ".csv", run_csv(record)); !saved) return saved;
  return draw_run(record, *map, title, trace + ".png");
}

Result<WindowSetting::Robot> robot_from(const std::string& share, bool sees) {
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const std::string manifest = sees ? "marvin-depth-sim.yaml" : "marvin-sim.yaml";
  auto deployment =
      load_deployment(share + "/deploy/" + manifest, installation, {{"world", "people", "true"}});
  if (!deployment) return Error{deployment.error()};
  WindowSetting::Robot robot{std::move(deployment).value(), {}};
  FaultTargets& targets = robot.targets;
  targets.sees = sees;
  for (const auto& [name, movement] : robot.deployment.movement) {
    if (movement == Movement::kBaseDriver) targets.base_driver = name;
  }
  for (const auto& component : robot.deployment.manifest.components) {
    if (component.name == "world") continue;  // not of the robot
    targets.components.push_back(component.name);
    if (component.criticality == Criticality::kStop) targets.critical.insert(component.name);
  }
  return robot;
}

}  // namespace

Result<WindowSetting> window_setting(const std::string& share) {
  WindowSetting setting;
  for (const bool sees : {false, true}) {
    auto robot = robot_from(share, sees);
    if (!robot) return Error{robot.error()};
    (sees ? setting.seeing : setting.blind) = std::move(robot).value();
  }
  auto locations = site_locations(setting.blind.deployment);
  if (!locations) return Error{locations.error()};
  setting.locations = std::move(locations).value();
  const auto map = site_map(setting.blind.deployment);
  if (!map) return Error{map.error()};
  setting.starts = free_places(*map);
  for (auto* robot : {&setting.blind, &setting.seeing}) {
    robot->targets.locations = setting.locations.size();
    robot->targets.starts = setting.starts.size();
  }
  return setting;
}

Result<WindowResult> run_window(const WindowSetting& setting, std::uint64_t seed,
                                const std::string& trace) {
  const auto start = std::chrono::steady_clock::now();
  WindowResult result;
  result.seed = seed;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    result.plan = draw_window(seed, attempt, setting.robot_of(seed).targets);
    auto run = LockstepRun::create(placed(setting, result.plan),
                                   stream_seed(seed, "robot") + static_cast<unsigned>(attempt));
    if (!run) return Error{run.error()};
    Window window(std::move(run).value(), setting, result.plan);
    const bool drove = window.drive_until_hit();
    if (drove) window.be_hit(result);
    result.simulated += window.now();
    if (!drove) continue;
    result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!trace.empty()) {
      const std::string title = "seed " + std::to_string(seed) + ": " + result.plan.text();
      if (auto saved = save_trace(window.record(), setting, title, trace); !saved)
        return Error{saved.error()};
    }
    return result;
  }
  return Error{"seed " + std::to_string(seed) + ": the robot did not get to drive in " +
               std::to_string(kMostAttempts) + " windows"};
}

}  // namespace usher::operations
