#include "drivers/base_obedience/shell/obedient_base.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/stopping.hpp"

namespace usher::drive {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

/// Silence of command or grant is noticed within this; the base is told again in every cycle.
constexpr auto kCycle = milliseconds(10);
constexpr auto kSilence = BaseObedience::Limits{}.command_expiry;
constexpr auto kReportAge = milliseconds(100);  // an older one tells not how the base rolls
constexpr const char* kOnLoss = "commands zero to the base";
constexpr const char* kOdometryKey = "session.odometry";
constexpr auto kKeep = milliseconds(200);  // the pose, when it is another one
constexpr double kKeptStep = 0.02;         // [m], [rad] than that

BaseObedience::Limits read_limits(runtime::Parameters& parameters) {
  BaseObedience::Limits limits;
  limits.linear = parameters.number("robot.limits.linear", "m/s", {0.1, 3}, limits.linear,
                                    "Faster commands are refused.");
  limits.angular = parameters.number("robot.limits.angular", "rad/s", {0.1, 5}, limits.angular,
                                     "Faster commands are refused.");
  return limits;
}

std::string to_text(const geometry::Pose2& pose, const std::string& beside) {
  std::ostringstream text;
  text.precision(17);
  text << pose.x << ' ' << pose.y << ' ' << pose.yaw << '\n' << beside;
  return text.str();
}

}  // namespace

ObedientBase::ObedientBase(runtime::Host& host, BaseDevice device, double wheel_radius,
                           std::function<void()> cycled)
    : host_(host),
      device_(std::move(device)),
      cycled_(std::move(cycled)),
      obedience_(read_limits(host.parameters())),
      stopping_(wire::read_stopping(host)),
      wheel_radius_(host.parameters().number("robot.wheel_radius", "m", {0.05, 0.5}, wheel_radius,
                                             "Of the driven wheels; also the axle's height.")),
      odometry_memory_(host, kOdometryKey),
      grantors_({host.parameters().text("grantor", "supervisor",
                                        "The component that may grant the right to drive.")}),
      foreign_grants_(host.health().counter("grants: foreign writer")),
      foreign_(host.health().counter("commands: foreign writer")),
      foreign_requests_(host.health().counter("requests: foreign writer")) {
  std::istringstream found(odometry_memory_.found());
  geometry::Pose2 pose;
  if (found >> pose.x >> pose.y >> pose.yaw && pose.finite()) {
    odom_T_start_ = odom_T_base_ = kept_odometry_ = pose;
    std::getline(found >> std::ws, found_beside_);
  }
  grant_ = host.input(
      topics::kDriveGrant, {.max_age = kSilence, .on_loss = kOnLoss},
      [this](const auto& message, const auto& info) {
        if (!may_grant(info.writer, info.effective)) return;
        const double told = std::isfinite(message.valid_for()) ? message.valid_for() : 0.0;
        const std::chrono::duration<double> valid_for(std::clamp(told, 0.0, 1.0));
        obedience_.grant(
            {message.granted() ? message.writer() : kNobody, message.epoch(), info.writer,
             host_.now() - info.effective, std::chrono::duration_cast<Time>(valid_for)},
            host_.now().time_since_epoch());
      },
      [this] { cycle(); });
  host.watch_writers(std::string(topics::kDriveGrant.name),
                     [this](const runtime::WriterInfo& writer) {
                       if (writer.alive) {
                         grantors_.appeared({writer.guid, writer.participant, writer.host},
                                            host_.now().time_since_epoch());
                       } else {
                         grantors_.gone(writer.guid);
                       }
                     });
  command_ = host.input(
      topics::kDriveCommand, {.max_age = kSilence, .on_loss = kOnLoss},
      [this](const auto& message, const auto& info) {
        decision_ = obedience_.permitted({info.writer,
                                          message.epoch(),
                                          message.number(),
                                          {message.v(), message.w()},
                                          host_.now() - info.effective},
                                         host_.now().time_since_epoch());
        foreign_ = obedience_.count(Reason::kForeignWriter);
        drive();
      },
      [this] { cycle(); });
  request_ = host.input(
      topics::kBaseRequest, {.optional = true},
      [this](const auto& request, const auto& info) { take_request(request, info.writer); });
  status_ = host.output(topics::kBaseStatus);
  odom_ = host.output(topics::kOdom);
  transforms_ = host.output(topics::kTf);
  battery_ = host.output(topics::kBattery);
  cycle_timer_ = host.timer("cycle", kCycle, [this](auto) { cycle(); });
  battery_timer_ = host.timer("battery", milliseconds(1000), [this](auto) { publish_battery(); });
  keep_timer_ = host.timer("keep", kKeep, [this](auto) { keep_odometry(); });
}

/// By a name that discovery gave. Who took the supervisor's is unmasked by its life, and is nobody
/// then, though it dies; a liar that nobody was met beside looks like its restart.
bool ObedientBase::may_grant(const runtime::Guid& writer, runtime::Time written) {
  grantors_.alive(writer, written.time_since_epoch());
  const bool may = grantors_.trusted(writer);
  if (!may) ++foreign_grants_;
  return may;
}

void ObedientBase::cycle() {
  decision_ = obedience_.permitted(host_.now().time_since_epoch());
  drive();
  cycled_();
}

/// Without motors it keeps no arc.
bool ObedientBase::slides() const {
  return motors_off_ || report_.state == usher_msgs::msg::BaseStatus_Constants::STATE_EMERGENCY;
}

void ObedientBase::drive() {
  const Time now = host_.now().time_since_epoch();
  // A verdict on a foreign command changes nothing, and what is driven beside it may be alive.
  if (obedience_.permitted(now).reason == Reason::kObeyed) {
    roll_out_.drive(decision_.twist, now);
  } else if (slides()) {
    decision_.twist = {};
  } else {
    const bool known = connected() && now - report_.stamp < kReportAge;
    decision_.twist = roll_out_.stop(known ? std::optional(report_.twist) : std::nullopt, now);
  }
  device_.drive(decision_.twist);
  const auto rest = slides() ? kinematics::RollOut::Rest{} : roll_out_.rest(stopping_);
  device_.last_will(rest.twist, rest.lasts);
}

void ObedientBase::take_request(const usher_msgs::msg::BaseRequest& request,
                                const runtime::Guid& writer) {
  using namespace usher_msgs::msg::BaseRequest_Constants;
  if (!obedience_.of_grantor(writer, host_.now().time_since_epoch())) {
    ++foreign_requests_;
    return;
  }
  if (request.id() == last_request_) return;
  last_request_ = request.id();
  if (request.command() == COMMAND_EMERGENCY_STOP) {
    motors_off_ = true;
    drive();  // and no older will
    device_.emergency_stop();
  } else if (request.command() == COMMAND_RESET) {
    motors_off_ = false;
    device_.reset();
  }
}

void ObedientBase::report(const BaseReport& report) {
  report_ = report;
  disconnected_.clear();
  publish_status();
}

void ObedientBase::disconnected(const std::string& reason) {
  disconnected_ = reason;
  report_ = {.stamp = host_.now().time_since_epoch(),
             .state = usher_msgs::msg::BaseStatus_Constants::STATE_DISCONNECTED};
  host_.health().set(HealthState::kDegraded, reason);
  publish_status();
}

void ObedientBase::publish_odometry(Time at, const geometry::Pose2& pose,
                                    const geometry::Twist2& twist, double pitch) {
  const runtime::Time stamp(at);
  odom_T_base_ = odom_T_start_ * pose;
  nav_msgs::msg::Odometry message;
  message.header(wire::header(stamp, frames::kOdom));
  message.child_frame_id(frames::kBaseFootprint);
  message.pose().pose(wire::to_message(odom_T_base_));
  message.twist().twist(wire::to_message(stamp, twist).twist());
  odom_.publish(message);

  geometry::Pose3 footprint_T_base;
  footprint_T_base.translation.z() = wheel_radius_;
  footprint_T_base.rotation = geometry::from_roll_pitch_yaw(0.0, pitch, 0.0);
  tf2_msgs::msg::TFMessage frames;
  frames.transforms().push_back(wire::transform(stamp, frames::kOdom, frames::kBaseFootprint,
                                                geometry::to_space(odom_T_base_)));
  frames.transforms().push_back(
      wire::transform(stamp, frames::kBaseFootprint, frames::kBaseLink, footprint_T_base));
  transforms_.publish(frames);
}

void ObedientBase::keep_odometry() {
  const geometry::Pose2 step = geometry::inverse(kept_odometry_) * odom_T_base_;
  if (std::hypot(step.x, step.y) < kKeptStep && std::abs(step.yaw) < kKeptStep) return;
  kept_odometry_ = odom_T_base_;
  odometry_memory_.keep(to_text(odom_T_base_, beside_()));
}

void ObedientBase::publish_status() {
  usher_msgs::msg::BaseStatus message;
  message.header(wire::header(runtime::Time(report_.stamp), frames::kBaseLink));
  message.state(report_.state);
  message.pitch(report_.pitch);
  message.pitch_rate(report_.pitch_rate);
  message.v(report_.twist.v);
  message.w(report_.twist.w);
  message.v_commanded(decision_.twist.v);
  message.w_commanded(decision_.twist.w);
  message.battery_percent(static_cast<float>(report_.battery_percent));
  message.epoch(obedience_.highest_epoch());
  message.obedience(static_cast<std::uint8_t>(decision_.reason));
  const bool obeys = decision_.reason == Reason::kObeyed;
  message.reason(!disconnected_.empty() ? disconnected_
                 : obeys                ? ""
                                        : std::string(text(decision_.reason)));
  status_.publish(message);
}

void ObedientBase::publish_battery() {
  if (!connected()) {
    disconnected(disconnected_);
    return;
  }
  sensor_msgs::msg::BatteryState message;
  message.header(wire::header(runtime::Time(report_.stamp), frames::kBaseLink));
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  message.voltage(unknown);
  message.temperature(unknown);
  message.current(unknown);
  message.charge(unknown);
  message.capacity(unknown);
  message.design_capacity(unknown);
  message.percentage(static_cast<float>(report_.battery_percent / 100.0));
  message.present(true);
  battery_.publish(message);
}

}  // namespace usher::drive
