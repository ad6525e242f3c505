#include "deployment/driven_robot.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

namespace usher::test {

using namespace usher_msgs::msg;

namespace {

constexpr double kDrives = 0.25;  // [m/s]
constexpr std::size_t kMostZeros = 100'000;

/// A port of its own for each domain: two robots may run beside each other.
std::string components(std::uint32_t domain, const std::string& more) {
  const std::string port = std::to_string(17'600 + domain);
  return "components:\n  segway_rmp: {restart_budget: 1000, parameters: {address: "
         "\"tcp://127.0.0.1:" +
         port + "\"}}\n  segway_emulator: {parameters: {address: \"listen://127.0.0.1:" + port +
         "\"}}\n" + more;
}

/// A line for each fault that holds until it is cleared.
std::string latched(const SupervisorStatus& status) {
  std::string lines;
  for (const auto& fault : status.faults()) {
    if (fault.latched() && fault.active())
      lines += fault.component_name() + ": " + fault.cause() + "\n";
  }
  return lines;
}

template <class Made, class Port>
void keep(Made made, Port& port) {
  assert(made);
  port = std::move(made).value();
}

}  // namespace

DrivenRobot::DrivenRobot(const std::string& more)
    : robot_(std::make_unique<RunningRobot>(test_domain(), "marvin-emulated.yaml",
                                            components(test_domain(), more))) {
  keep(robot_->observer().reader(
           topics::kSimBaseCommand,
           [this](const auto& message, const auto&) { judge_wheels(message.v(), message.w()); }),
       wheels_);
  keep(robot_->observer().reader(topics::kSimGroundTruth,
                                 [this](const auto& message, const auto&) {
                                   const std::lock_guard lock(mutex_);
                                   speed_ = std::abs(message.v());
                                   if (message.contacts() > contacts_) note_contact(message);
                                   contacts_ = message.contacts();
                                 }),
       truths_);
  keep(robot_->observer().reader(topics::kDriveGrant,
                                 [this](const auto& message, const auto&) {
                                   const std::lock_guard lock(mutex_);
                                   if (message.granted()) last_grant_ = Clock::now();
                                 }),
       grants_);
  keep(robot_->observer().writer(topics::kSupervisorRequest), requests_);
}

DrivenRobot::~DrivenRobot() {
  errand_.reset();
  requests_.reset();
  wheels_.reset();
  truths_.reset();
  grants_.reset();
}

void DrivenRobot::note_contact(const usher_sim_msgs::msg::GroundTruth& truth) {
  char line[200];
  std::snprintf(line, sizeof line,
                "contact with %s at (%.2f, %.2f), %.2f m/s, %.2f rad/s, simulation %.2f s late\n",
                truth.contact_with().c_str(), truth.pose().position().x(),
                truth.pose().position().y(), truth.v(), truth.w(), truth.lag());
  contact_story_ += line;
}

void DrivenRobot::judge_wheels(double v, double w) {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  if (v == 0.0 && zeros_.size() < kMostZeros) zeros_.push_back(now);
  if (v != 0.0)
    longest_without_grant_ = std::max(longest_without_grant_, Seconds(now - last_grant_).count());
  fastest_ = std::max(fastest_, std::abs(v));
  fastest_turn_ = std::max(fastest_turn_, std::abs(w));
}

bool DrivenRobot::may_drive() const {
  using namespace SupervisorStatus_Constants;
  const auto status = robot_->status();
  return robot_->hears_supervisor() && status && status->granted() &&
         std::all_of(
             status->components().begin(), status->components().end(), [](const auto& component) {
               return component.health() == HEALTH_OK || component.health() == HEALTH_DEGRADED;
             });
}

bool DrivenRobot::is_ready() {
  const auto until = Clock::now() + std::chrono::seconds(90);
  while (Clock::now() < until) {
    if (robot_->wait_for([&] { return may_drive(); }, Seconds(1))) return true;
    const auto status = robot_->status();
    if (const std::string faults = status ? latched(*status) : ""; !faults.empty()) {
      if (!cleared_.ends_with(faults)) cleared_ += faults;
      ask(SupervisorRequest_Constants::COMMAND_CLEAR);
    }
  }
  return false;
}

void DrivenRobot::ask(std::uint8_t command) {
  SupervisorRequest request;
  request.id(
      request_id_ = std::max<std::uint64_t>(
          request_id_ + 1, static_cast<std::uint64_t>(Clock::now().time_since_epoch().count())));
  request.client("operator");
  request.command(command);
  requests_->write(request);
}

bool DrivenRobot::sets_out(const std::string& place) {
  if (!is_ready()) return false;
  errand_ = robot_->command({"goto", place});
  return robot_->wait_for([&] { return speed() > kDrives; }, Seconds(30));
}

bool DrivenRobot::under_way() const {
  return errand_ && errand_->output().find("arrived") == std::string::npos &&
         errand_->errors().empty();
}

double DrivenRobot::speed() const {
  const std::lock_guard lock(mutex_);
  return speed_;
}

std::uint32_t DrivenRobot::contacts() const {
  const std::lock_guard lock(mutex_);
  return contacts_;
}

std::string DrivenRobot::contact_story() const {
  const std::lock_guard lock(mutex_);
  return contact_story_;
}

void DrivenRobot::forget() {
  const std::lock_guard lock(mutex_);
  zeros_.clear();
  longest_without_grant_ = fastest_ = fastest_turn_ = 0.0;
}

std::optional<DrivenRobot::Clock::time_point> DrivenRobot::zero_since(
    Clock::time_point from) const {
  const std::lock_guard lock(mutex_);
  const auto at = std::lower_bound(zeros_.begin(), zeros_.end(), from);
  return at == zeros_.end() ? std::nullopt : std::optional(*at);
}

double DrivenRobot::longest_without_grant() const {
  const std::lock_guard lock(mutex_);
  return longest_without_grant_;
}

double DrivenRobot::fastest() const {
  const std::lock_guard lock(mutex_);
  return fastest_;
}

double DrivenRobot::fastest_turn() const {
  const std::lock_guard lock(mutex_);
  return fastest_turn_;
}

std::string DrivenRobot::reason() const {
  const auto status = robot_->status();
  return status ? (status->granted() ? std::string() : status->reason())
                : "no word from the supervisor";
}

}  // namespace usher::test
