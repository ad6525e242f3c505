#include "drivers/p3dx/shell/base_driver.hpp"

#include <cmath>
#include <limits>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::p3dx {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

/// Silence of command or grant is noticed within this.
constexpr auto kCycle = milliseconds(10);
/// So long the pose follows the last measured velocity.
constexpr double kLongestPrediction = 0.15;  // [s]
constexpr const char* kRing = "ultrasonic";

drive::BaseObedience::Limits read_limits(runtime::Parameters& parameters) {
  drive::BaseObedience::Limits limits;
  limits.linear = parameters.number("robot.limits.linear", "m/s", {0.1, 3}, limits.linear,
                                    "Faster commands are refused.");
  limits.angular = parameters.number("robot.limits.angular", "rad/s", {0.1, 5}, limits.angular,
                                     "Faster commands are refused.");
  return limits;
}

}  // namespace

BaseDriver::BaseDriver(runtime::Host& host, Device device)
    : host_(host),
      device_(std::move(device)),
      obedience_(read_limits(host.parameters())),
      wheel_radius_(host.parameters().number("robot.wheel_radius", "m", {0.05, 0.5}, 0.0975,
                                             "Of the driven wheels; also the axle's height.")),
      ring_radius_(
          host.parameters().number("robot.ultrasonic.mount_x", "m", {-2, 2},
                                   "Ring of the ultrasonic sensors ahead of the axle's middle.")),
      ring_height_(
          host.parameters().number("robot.ultrasonic.mount_z", "m", {-1, 3},
                                   "Ring of the ultrasonic sensors above the axle's middle.")),
      foreign_(host.health().counter("commands: foreign writer")) {
  grant_ = host.input(
      topics::kDriveGrant, {.max_age = milliseconds(120), .on_loss = "commands zero to the base"},
      [this](const auto& message, const auto& info) {
        const auto valid_for = std::chrono::duration<double>(
            std::isfinite(message.valid_for()) ? static_cast<double>(message.valid_for()) : 0.0);
        obedience_.grant(
            {message.granted() ? message.writer() : drive::kNobody, message.epoch(), info.writer,
             host_.now() - info.effective, std::chrono::duration_cast<drive::Time>(valid_for)},
            host_.now().time_since_epoch());
      },
      [this] { cycle(); });
  command_ = host.input(
      topics::kDriveCommand, {.max_age = milliseconds(120), .on_loss = "commands zero to the base"},
      [this](const auto& message, const auto& info) {
        decision_ = obedience_.permitted({info.writer,
                                          message.epoch(),
                                          message.number(),
                                          {message.v(), message.w()},
                                          host_.now() - info.effective},
                                         host_.now().time_since_epoch());
        foreign_ = obedience_.count(drive::Reason::kForeignWriter);
        device_.drive(decision_.twist);
      },
      [this] { cycle(); });
  request_ = host.input(topics::kBaseRequest, {.optional = true},
                        [this](const auto& request, const auto&) { take_request(request); });
  status_ = host.output(topics::kBaseStatus);
  odom_ = host.output(topics::kOdom);
  transforms_ = host.output(topics::kTf);
  mounts_ = host.output(topics::kTfStatic);
  sonar_ = host.output(topics::kUltrasonic);
  battery_ = host.output(topics::kBattery);
  cycle_timer_ = host.timer("cycle", kCycle, [this](auto) { cycle(); });
  sonar_timer_ = host.timer("sonar", milliseconds(50), [this](auto) { publish_sonar(); });
  slow_timer_ = host.timer("battery", milliseconds(1000), [this](auto) { publish_battery(); });
  place_frames();
}

void BaseDriver::place_frames() {
  geometry::Pose3 base_T_ring;
  base_T_ring.translation.z() = ring_height_;
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      wire::transform(host_.now(), frames::kBaseLink, kRing, base_T_ring));
  mounts_.publish(message);
}

void BaseDriver::cycle() {
  decision_ = obedience_.permitted(host_.now().time_since_epoch());
  device_.drive(decision_.twist);
  if (!disconnected_.empty()) return;
  const double age =
      std::chrono::duration<double>(host_.now().time_since_epoch() - feedback_.stamp).count();
  if (age > kLongestPrediction) return;  // the frames grow old, and whoever needs them stops
  publish_odometry(geometry::integrate(feedback_.pose, feedback_.twist, age), host_.now());
  publish_status(host_.now());
}

void BaseDriver::take_request(const usher_msgs::msg::BaseRequest& request) {
  using namespace usher_msgs::msg::BaseRequest_Constants;
  if (request.id() == last_request_) return;
  last_request_ = request.id();
  if (request.command() == COMMAND_EMERGENCY_STOP) device_.emergency_stop();
  if (request.command() == COMMAND_RESET) device_.reset();
}

void BaseDriver::take(const Feedback& feedback) {
  feedback_ = feedback;
  disconnected_.clear();
  host_.health().set(warning_.empty() ? HealthState::kOk : HealthState::kDegraded, warning_);
}

void BaseDriver::warn(const std::string& reason) { warning_ = reason; }

void BaseDriver::disconnected(const std::string& reason) {
  disconnected_ = reason;
  feedback_.mode = Mode::kDisconnected;
  feedback_.twist = {};
  host_.health().set(HealthState::kDegraded, reason);
  publish_status(host_.now());
}

void BaseDriver::publish_odometry(const geometry::Pose2& pose, runtime::Time stamp) {
  nav_msgs::msg::Odometry message;
  message.header(wire::header(stamp, frames::kOdom));
  message.child_frame_id(frames::kBaseFootprint);
  message.pose().pose(wire::to_message(pose));
  message.twist().twist(wire::to_message(stamp, feedback_.twist).twist());
  odom_.publish(message);

  geometry::Pose3 footprint_T_base;
  footprint_T_base.translation.z() = wheel_radius_;
  tf2_msgs::msg::TFMessage frames;
  frames.transforms().push_back(
      wire::transform(stamp, frames::kOdom, frames::kBaseFootprint, geometry::to_space(pose)));
  frames.transforms().push_back(
      wire::transform(stamp, frames::kBaseFootprint, frames::kBaseLink, footprint_T_base));
  transforms_.publish(frames);
}

void BaseDriver::publish_status(runtime::Time stamp) {
  usher_msgs::msg::BaseStatus message;
  message.header(wire::header(stamp, frames::kBaseLink));
  message.state(static_cast<std::uint8_t>(feedback_.mode));
  message.v(feedback_.twist.v);
  message.w(feedback_.twist.w);
  message.v_commanded(decision_.twist.v);
  message.w_commanded(decision_.twist.w);
  message.battery_percent(static_cast<float>(feedback_.battery_percent));
  message.epoch(obedience_.highest_epoch());
  message.obedience(static_cast<std::uint8_t>(decision_.reason));
  const bool obeys = decision_.reason == drive::Reason::kObeyed;
  message.reason(!disconnected_.empty() ? disconnected_
                 : obeys                ? ""
                                        : std::string(drive::text(decision_.reason)));
  status_.publish(message);
}

void BaseDriver::publish_sonar() {
  if (!disconnected_.empty()) return;
  constexpr float kRangeMin = 0.15F, kRangeMax = 5.0F, kPeriod = 0.05F;  // [m], [s]
  const auto ring = static_cast<float>(ring_radius_);
  sensor_msgs::msg::LaserScan scan;
  scan.header(wire::header(runtime::Time(feedback_.stamp), kRing));
  scan.angle_min(static_cast<float>(-0.5 * geometry::kPi));
  scan.angle_max(static_cast<float>(0.5 * geometry::kPi));
  scan.angle_increment(static_cast<float>(kSonarSpacing));
  scan.scan_time(kPeriod);
  scan.range_min(kRangeMin + ring);
  scan.range_max(kRangeMax + ring);
  for (const float range : feedback_.sonar) scan.ranges().push_back(range + ring);
  sonar_.publish(scan);
}

void BaseDriver::publish_battery() {
  if (!disconnected_.empty()) {
    disconnected(disconnected_);
    return;
  }
  sensor_msgs::msg::BatteryState message;
  message.header(wire::header(runtime::Time(feedback_.stamp), frames::kBaseLink));
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  message.voltage(unknown);
  message.temperature(unknown);
  message.current(unknown);
  message.charge(unknown);
  message.capacity(unknown);
  message.design_capacity(unknown);
  message.percentage(static_cast<float>(feedback_.battery_percent / 100.0));
  message.present(true);
  battery_.publish(message);
}

}  // namespace usher::p3dx
