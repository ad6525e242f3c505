#include "drivers/torso/shell/torso_driver.hpp"

#include "wire/conversions.hpp"
#include "wire/torso.hpp"

namespace usher::torso {

namespace {
constexpr auto kFrameAge = std::chrono::milliseconds(500);
}

SafeFrame::Parameters TorsoDriver::read_parameters(runtime::Host& host) {
  auto& p = host.parameters();
  SafeFrame::Parameters parameters;
  parameters.limits = wire::read_torso_limits(host);
  parameters.dim = p.number("dim", "-", {0, 1}, parameters.dim,
                            "Part of the eyes' brightness while nobody says what to show.");
  parameters.fade =
      p.number("fade", "s", {0.1, 10}, parameters.fade, "From full brightness to none.");
  return parameters;
}

TorsoDriver::TorsoDriver(runtime::Host& host)
    : host_(host),
      safe_(read_parameters(host)),
      rejected_(host.health().counter("frames: rejected")),
      frame_(
          host.input(topics::kTorsoFrame,
                     {.max_age = kFrameAge, .on_loss = "joints hold, eyes dim", .optional = true},
                     [this](const auto& frame, const auto&) {
                       if (!kinematics::finite(frame.joints())) ++rejected_;
                     })),
      status_(host.output(topics::kTorsoStatus)) {}

void TorsoDriver::measured(const Reading& reading, const std::string& reason) {
  if (!reading.moves)
    safe_.forget();  // servos that are off hold nothing: joints sag, or are pushed
  safe_.start_at(reading.frame.joints);
  usher_msgs::msg::TorsoStatus message;
  message.header(wire::header(runtime::Time(reading.stamp), ""));
  message.moves(reading.moves);
  message.joints(reading.frame.joints);
  message.left_eye(reading.frame.left_eye);
  message.right_eye(reading.frame.right_eye);
  message.reason(reason);
  status_.publish(message);
  host_.health().set(reason.empty() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
                     reason);
}

std::optional<TorsoFrame> TorsoDriver::step() {
  std::optional<TorsoFrame> wanted;
  if (const auto* frame = frame_.fresh())
    wanted = TorsoFrame{frame->joints(), frame->left_eye(), frame->right_eye()};
  return safe_.step(wanted ? &*wanted : nullptr, runtime::seconds(kTick));
}

void TorsoDriver::lost(const std::string& reason) {
  safe_.forget();
  host_.health().set(runtime::HealthState::kDegraded, reason);
}

}  // namespace usher::torso
