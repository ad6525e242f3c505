#include "drivers/segway_rmp/shell/base_driver.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::segway_rmp {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

/// Silence of command or grant is noticed within this; the base is told again in every cycle.
constexpr auto kCycle = milliseconds(10);

drive::BaseObedience::Limits read_limits(runtime::Parameters& parameters) {
  drive::BaseObedience::Limits limits;
  limits.linear = parameters.number("robot.limits.linear", "m/s", {0.1, 3}, limits.linear,
                                    "Faster commands are refused.");
  limits.angular = parameters.number("robot.limits.angular", "rad/s", {0.1, 5}, limits.angular,
                                     "Faster commands are refused.");
  return limits;
}

Odometry::Parameters read_odometry(runtime::Parameters& parameters) {
  Odometry::Parameters p;
  p.wheel_radius = parameters.number("robot.wheel_radius", "m", {0.05, 0.5}, p.wheel_radius,
                                     "Of the driven wheels; also the axle's height.");
  p.track = parameters.number("robot.track", "m", {0.1, 2}, p.track,
                              "Effective distance of the wheels, for turning.");
  return p;
}

}  // namespace

BaseDriver::BaseDriver(runtime::Host& host, Device device)
    : host_(host),
      device_(std::move(device)),
      obedience_(read_limits(host.parameters())),
      geometry_(read_odometry(host.parameters())),
      odometry_(geometry_),
      rejected_feedback_(host.health().counter("feedback: rejected")),
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
  battery_ = host.output(topics::kBattery);
  cycle_timer_ = host.timer("cycle", kCycle, [this](auto) { cycle(); });
  slow_timer_ = host.timer("battery", milliseconds(1000), [this](auto) { publish_battery(); });
}

void BaseDriver::cycle() {
  decision_ = obedience_.permitted(host_.now().time_since_epoch());
  device_.drive(decision_.twist);
}

void BaseDriver::take_request(const usher_msgs::msg::BaseRequest& request) {
  using namespace usher_msgs::msg::BaseRequest_Constants;
  if (request.id() == last_request_) return;
  last_request_ = request.id();
  if (request.command() == COMMAND_EMERGENCY_STOP) device_.emergency_stop();
  if (request.command() == COMMAND_RESET) device_.reset();
}

void BaseDriver::take(const SegwayFeedback& feedback) {
  feedback_ = feedback;
  disconnected_.clear();
  if (odometry_.update(feedback)) publish_odometry(feedback);
  rejected_feedback_ = odometry_.rejected();
  publish_status(feedback);
  const bool balances = feedback.mode == Mode::kBalancing;
  host_.health().set(balances ? HealthState::kOk : HealthState::kDegraded,
                     balances ? "" : "the base does not balance");
}

void BaseDriver::disconnected(const std::string& reason) {
  disconnected_ = reason;
  odometry_.interrupt();
  feedback_ = {};
  feedback_.mode = Mode::kDisconnected;
  feedback_.stamp = host_.now().time_since_epoch();
  publish_status(feedback_);
  host_.health().set(HealthState::kDegraded, reason);
}

void BaseDriver::publish_odometry(const SegwayFeedback& feedback) {
  const runtime::Time stamp(feedback.stamp);
  nav_msgs::msg::Odometry message;
  message.header(wire::header(stamp, frames::kOdom));
  message.child_frame_id(frames::kBaseFootprint);
  message.pose().pose(wire::to_message(odometry_.pose()));
  message.twist().twist(wire::to_message(stamp, odometry_.twist()).twist());
  odom_.publish(message);

  geometry::Pose3 footprint_T_base;
  footprint_T_base.translation.z() = geometry_.wheel_radius;
  footprint_T_base.rotation = geometry::from_roll_pitch_yaw(0.0, feedback.pitch, 0.0);
  tf2_msgs::msg::TFMessage frames;
  frames.transforms().push_back(wire::transform(stamp, frames::kOdom, frames::kBaseFootprint,
                                                geometry::to_space(odometry_.pose())));
  frames.transforms().push_back(
      wire::transform(stamp, frames::kBaseFootprint, frames::kBaseLink, footprint_T_base));
  transforms_.publish(frames);
}

void BaseDriver::publish_status(const SegwayFeedback& feedback) {
  usher_msgs::msg::BaseStatus message;
  message.header(wire::header(runtime::Time(feedback.stamp), frames::kBaseLink));
  message.state(static_cast<std::uint8_t>(feedback.mode));
  message.pitch(feedback.pitch);
  message.pitch_rate(feedback.pitch_rate);
  message.v(odometry_.twist().v);
  message.w(odometry_.twist().w);
  message.v_commanded(decision_.twist.v);
  message.w_commanded(decision_.twist.w);
  message.battery_percent(static_cast<float>(feedback.battery_percent));
  message.epoch(obedience_.highest_epoch());
  message.obedience(static_cast<std::uint8_t>(decision_.reason));
  const bool obeys = decision_.reason == drive::Reason::kObeyed;
  message.reason(!disconnected_.empty() ? disconnected_
                 : obeys                ? ""
                                        : std::string(drive::text(decision_.reason)));
  status_.publish(message);
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

}  // namespace usher::segway_rmp
