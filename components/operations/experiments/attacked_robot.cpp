#include "operations/experiments/attacked_robot.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "drivers/base_obedience/core/writer_id.hpp"
#include "interaction/finger/core/tap.hpp"
#include "runtime/guard/port.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;
using namespace usher_msgs::msg;

constexpr const char* kOperator = "operator";
constexpr auto kRound = milliseconds(10);
constexpr auto kJoyPeriod = milliseconds(40);
constexpr double kStanding = 0.02;  // [m/s] [rad/s]
/// Of manual_control's defaults: full deflection.
constexpr double kFullLinear = 0.8, kFullAngular = 0.8, kDeadZone = 0.12;

float deflection(double share) {
  if (share == 0.0) return 0.0F;
  return static_cast<float>(std::copysign(kDeadZone + (1.0 - kDeadZone) * std::abs(share), share));
}

/// Ports of its own for each domain: two robots may run beside each other.
std::string emulator_address(std::uint32_t domain) {
  return "127.0.0.1:" + std::to_string(17420 + domain);
}
std::string finger_address(std::uint32_t domain) {
  return "127.0.0.1:" + std::to_string(17720 + domain);
}

/// A line to somebody who listens there; -1 = nobody does.
int connect_to(const std::string& uri) {
  const auto address = runtime::StreamAddress::parse(uri);
  const int line = address ? runtime::open_port(*address) : -1;
  if (line < 0) return -1;
  pollfd decided{line, POLLOUT, 0};
  int error = 0;
  socklen_t size = sizeof(error);
  if (::poll(&decided, 1, 1000) == 1 &&
      ::getsockopt(line, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0)
    return line;
  ::close(line);
  return -1;
}

}  // namespace

AttackedRobot::AttackedRobot(Launcher launcher, Deployment deployment, std::uint32_t domain)
    : launcher_(std::move(launcher)), deployment_(std::move(deployment)), domain_(domain) {}

Result<std::unique_ptr<AttackedRobot>> AttackedRobot::launch(const Installation& installation,
                                                             const std::string& run_directory,
                                                             std::uint32_t domain) {
  const std::string base = emulator_address(domain);
  auto deployment =
      load_deployment(installation.share + "/deploy/marvin-emulated.yaml", installation,
                      {{"segway_rmp", "address", "tcp://" + base},
                       {"segway_emulator", "address", "listen://" + base},
                       {"tablet", "finger", "listen://" + finger_address(domain)}});
  if (!deployment) return Error{deployment.error()};
  deployment->manifest.domain = domain;
  // A component may be killed more often than a robot would forgive.
  for (auto& component : deployment->manifest.components) component.restart_budget = 1000;
  for (auto& file : deployment->files) file.domain = domain;
  auto launcher = Launcher::create(*deployment, {"", installation.programs, run_directory});
  if (!launcher) return Error{launcher.error()};
  std::unique_ptr<AttackedRobot> robot(
      new AttackedRobot(std::move(launcher).value(), std::move(deployment).value(), domain));
  if (auto status = robot->listen(); !status) return Error{status.error()};
  robot->hand_ = std::thread([self = robot.get()] { self->run(); });
  return robot;
}

AttackedRobot::~AttackedRobot() {
  ends_ = true;
  if (hand_.joinable()) hand_.join();
  if (finger_ >= 0) ::close(finger_);
}

Status AttackedRobot::listen() {
  auto observer = Observer::create({.name = kOperator, .host = "nuc", .domain = domain_});
  if (!observer) return Error{observer.error()};
  observer_ = std::move(observer).value();
  Status status;
  const auto keep = [&](auto made, auto& port) {
    if (made) {
      port = std::move(made).value();
    } else {
      status = Error{made.error()};
    }
  };
  const auto note = [this](auto change) {
    {
      const std::lock_guard lock(mutex_);
      change();
    }
    changed_.notify_all();
  };
  keep(observer_->reader(topics::kSimBaseCommand,
                         [this, note](const auto& message, const auto&) {
                           using namespace usher_sim_msgs::msg::BaseCommand_Constants;
                           const Wheels wheels{Clock::now(), message.v(), message.w(),
                                               message.mode() == MODE_EMERGENCY_STOP};
                           note([&] { wheels_.push_back(wheels); });
                         }),
       wheels_reader_);
  keep(observer_->reader(
           topics::kSimGroundTruth,
           [this, note](const auto& message, const auto&) {
             const auto pose = wire::to_planar(message.pose());
             if (!pose) return;
             const Motion motion{Clock::now(), *pose, message.v(), message.w(), message.contacts()};
             note([&] { motions_.push_back(motion); });
           }),
       truth_reader_);
  keep(observer_->reader(topics::kSupervisorStatus,
                         [this, note](const auto& message, const auto&) {
                           note([&] {
                             status_ = message;
                             status_at_ = Clock::now();
                             if (!message.granted())
                               note_withdrawn(wire::from_message(message.header().stamp()));
                           });
                         }),
       status_reader_);
  keep(observer_->reader(topics::kDriveGrant,
                         [this, note](const auto& message, const Observer::RawSample& sample) {
                           note([&] {
                             if (granted_ && !message.granted()) ++grants_lost_;
                             granted_ = message.granted();
                             note_grant(message, sample.writer);
                           });
                         }),
       grant_reader_);
  keep(observer_->reader(topics::kHeartbeat,
                         [this, note](const auto& message, const Observer::RawSample& sample) {
                           note([&] {
                             lives_[message.component_name()] = sample.writer;
                             heard_[message.component_name()] = Clock::now();
                             note_count(message);
                           });
                         }),
       heartbeat_reader_);
  keep(observer_->reader(topics::kDialogueScreen,
                         [this, note](const auto& message, const auto&) {
                           note([&] { screen_ = message.id(); });
                         }),
       screen_reader_);
  keep(observer_->writer(topics::kJoy), joy_);
  keep(observer_->writer(topics::kInteractionTarget), target_);
  keep(observer_->writer(topics::kSupervisorRequest), request_);
  keep(observer_->writer(topics::kNavigateGoal), goal_);
  keep(observer_->writer(topics::kNavigateCancel), cancel_);
  return status;
}

/// Under the mutex.
void AttackedRobot::note_count(const Heartbeat& heartbeat) {
  if (heartbeat.component_name() != counted_component_) return;
  std::uint64_t sum = 0;
  for (const auto& counter : heartbeat.counters()) {
    if (std::ranges::find(counted_names_, counter.name()) != counted_names_.end())
      sum += counter.count();
  }
  counts_.push_back({wire::from_message(heartbeat.header().stamp()), sum});
}

/// Under the mutex. Somebody else may write grants, too.
void AttackedRobot::note_grant(const DriveGrant& grant, const runtime::Guid& writer) {
  const auto supervisor = lives_.find("supervisor");
  if (supervisor == lives_.end() || !drive::same_participant(writer, supervisor->second)) return;
  const auto at = wire::from_message(grant.stamp());
  if (!grant.granted()) {
    note_withdrawn(at);
    return;
  }
  if (granted_until_ && at > *granted_until_) note_withdrawn(*granted_until_);  // it was late
  granted_until_ = at + runtime::from_seconds(static_cast<double>(grant.valid_for()));
}

/// Under the mutex.
void AttackedRobot::note_withdrawn(runtime::Time at) {
  if (!withdrawn_) withdrawn_ = at;
}

void AttackedRobot::run() {
  auto next_joy = Clock::now();
  while (!ends_) {
    {
      const std::lock_guard lock(mutex_);
      for (const auto& [component, at] : heard_) launcher_.heard(component, at);
      launcher_.poll();
      for (auto& event : launcher_.events()) events_.push_back(std::move(event));
    }
    if (Clock::now() >= next_joy) {
      next_joy = Clock::now() + kJoyPeriod;
      send_joy();
      send_target();
    }
    std::this_thread::sleep_for(kRound);
  }
}

void AttackedRobot::send_joy() {
  sensor_msgs::msg::Joy message;
  message.header(wire::header(observer_->now(), ""));
  {
    const std::lock_guard lock(mutex_);
    message.axes({0.0F, forward_, 0.0F, turn_});
    message.buttons({0, 0, 0, 0, held_ ? 1 : 0});
  }
  joy_->write(message);
}

void AttackedRobot::send_target() {
  FaceTarget message;
  message.header(wire::header(observer_->now(), "base_footprint"));
  {
    const std::lock_guard lock(mutex_);
    if (!facing_) return;
    message.mode(*facing_);
  }
  target_->write(message);
}

void AttackedRobot::let_it_search(bool search) {
  using namespace FaceTarget_Constants;
  const std::lock_guard lock(mutex_);
  facing_ = search ? MODE_SEARCH : MODE_STAND;
}

void AttackedRobot::hold(double v, double w) {
  const std::lock_guard lock(mutex_);
  held_ = true;
  forward_ = deflection(v / kFullLinear);
  turn_ = deflection(w / kFullAngular);
}

void AttackedRobot::release() {
  const std::lock_guard lock(mutex_);
  held_ = false;
}

Status AttackedRobot::touch(const std::string& button) {
  const std::lock_guard lock(mutex_);
  if (finger_ < 0) finger_ = connect_to("tcp://" + finger_address(domain_));
  if (finger_ < 0) return Error{"the tablet takes no finger at " + finger_address(domain_)};
  const std::string line = finger::to_line({screen_, false, button});
  const auto sent = ::send(finger_, line.data(), line.size(), MSG_NOSIGNAL);
  if (sent == static_cast<ssize_t>(line.size())) return {};
  ::close(finger_);
  finger_ = -1;
  return Error{"the tablet's line for fingers broke"};
}

bool AttackedRobot::set_out(const std::string& place, milliseconds patience) {
  constexpr double kDriving = 0.2;  // [m/s]
  const Instant until = Clock::now() + patience;
  NavigateGoal goal;
  goal.id(goal_id_ = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count() / 1000));
  goal.client(kOperator);
  goal.location(place);
  while (Clock::now() < until) {
    goal_->write(goal);
    if (wait_for([&] { return drives(kDriving); }, milliseconds(200))) return true;
  }
  return false;
}

void AttackedRobot::call_off() {
  GoalCancel cancel;
  cancel.id(goal_id_);
  cancel.client(kOperator);
  cancel_->write(cancel);
}

bool AttackedRobot::ask(std::uint8_t command, milliseconds patience) {
  const Instant until = Clock::now() + patience;
  SupervisorRequest request;
  request.client(kOperator);
  request.command(command);
  if (command == SupervisorRequest_Constants::COMMAND_NAVIGATION_START) request.goal("nowhere");
  while (Clock::now() < until) {
    request.id(static_cast<std::uint64_t>(Clock::now().time_since_epoch().count() / 1000));
    request_->write(request);
    const auto answered = [&] {
      return status_ && status_->last_request() == request.id() &&
             status_->last_request_client() == kOperator;
    };
    if (wait_for(answered, milliseconds(300))) {
      const std::lock_guard lock(mutex_);
      if (status_->last_request_done()) return true;
    }
  }
  return false;
}

bool AttackedRobot::all_well() const {
  return status_ && Clock::now() - status_at_ < std::chrono::seconds(1) && status_->granted() &&
         std::all_of(status_->components().begin(), status_->components().end(),
                     [](const auto& component) {
                       return component.health() == SupervisorStatus_Constants::HEALTH_OK ||
                              component.health() == SupervisorStatus_Constants::HEALTH_DEGRADED;
                     });
}

bool AttackedRobot::stands() const {
  if (motions_.empty()) return false;
  for (auto motion = motions_.rbegin(); motion != motions_.rend(); ++motion) {
    if (std::abs(motion->v) > kStanding || std::abs(motion->w) > 3.0 * kStanding) return false;
    if (motions_.back().at - motion->at > milliseconds(100)) return true;
  }
  return false;
}
bool AttackedRobot::stays() const {
  const Instant now = Clock::now();
  bool told_late = false;
  for (auto wheels = wheels_.rbegin(); wheels != wheels_.rend(); ++wheels) {
    if (now - wheels->at > milliseconds(200)) break;
    if (!wheels->still() || wheels->off) return false;
    told_late = true;
  }
  return told_late && stands();
}

std::string AttackedRobot::motion_story() {
  const std::lock_guard lock(mutex_);
  if (motions_.empty() || wheels_.empty()) return "nothing is heard of its base";
  const auto twist = [](double v, double w) {
    return std::to_string(v) + " m/s " + std::to_string(w) + " rad/s";
  };
  return twist(motions_.back().v, motions_.back().w) + ", its wheels told " +
         twist(wheels_.back().v, wheels_.back().w) + (wheels_.back().off ? " and off" : "");
}

std::uint64_t AttackedRobot::counted_with_the_right() const {
  if (!granted_until_ || counts_.empty()) return 0;
  const runtime::Time until = withdrawn_ ? std::min(*withdrawn_, *granted_until_) : *granted_until_;
  std::uint64_t most = counts_.front().number;
  for (const Count& known : counts_) {
    if (known.at <= until) most = std::max(most, known.number);
  }
  return most - counts_.front().number;
}

std::optional<runtime::Guid> AttackedRobot::life_of(const std::string& component) const {
  const auto found = lives_.find(component);
  return found == lives_.end() ? std::nullopt : std::optional(found->second);
}

void AttackedRobot::forget() {
  const std::lock_guard lock(mutex_);
  wheels_.clear();
  motions_.clear();
  withdrawn_.reset();
  if (counts_.size() > 1) counts_ = {counts_.back()};
}

bool AttackedRobot::count(const std::string& component, std::vector<std::string> names) {
  {
    const std::lock_guard lock(mutex_);
    counted_component_ = component;
    counted_names_ = std::move(names);
    counts_.clear();
  }
  return wait_for([&] { return !counts_.empty(); }, std::chrono::seconds(20));
}

pid_t AttackedRobot::process(const std::string& component) {
  const std::lock_guard lock(mutex_);
  const auto* found = launcher_.find(component);
  return found == nullptr ? 0 : found->pid;
}

std::string AttackedRobot::complaints() {
  const std::lock_guard lock(mutex_);
  std::string text = status_ ? status_->reason() : "no word from the supervisor";
  if (status_) {
    for (const auto& component : status_->components()) {
      if (component.health() != SupervisorStatus_Constants::HEALTH_OK)
        text += "; " + component.name() + ": " + component.reason();
    }
  }
  for (const auto& event : events_) text += "\n  " + event;
  return text;
}

std::vector<std::string> AttackedRobot::components(const std::string& criticality) const {
  std::vector<std::string> names;
  for (const auto& component : deployment_.manifest.components) {
    if (to_string(component.criticality) == criticality) names.push_back(component.name);
  }
  return names;
}

}  // namespace usher::operations
