#include "drivers/gamepad/shell/component.hpp"

#include "wire/conversions.hpp"

namespace usher::gamepad {

namespace {
constexpr auto kRepeat = std::chrono::milliseconds(50);
}  // namespace

GamepadComponent::GamepadComponent(runtime::Host& host)
    : host_(host),
      rejected_(host.health().counter("records: rejected")),
      joy_(host.output(topics::kJoy)) {
  const std::string device = host.parameters().text("device", "device:///dev/input/js0",
                                                    "The pad; may come and go at any time.");
  host.open_stream(device, {.on_open = [this] { there_ = true; },
                            .on_bytes =
                                [this](std::span<const std::uint8_t> bytes) {
                                  if (pad_.received(bytes)) publish();
                                  rejected_ = pad_.rejected();
                                },
                            .on_close =
                                [this](const std::string&) {
                                  if (!there_) return;  // there was none
                                  there_ = false;
                                  pad_.reset();
                                  publish();  // a pad without sticks and buttons: all released
                                }});
  timer_ = host.timer("repeat", kRepeat, [this](auto) {
    if (there_) publish();
  });
  // A robot without a pad is well: an operator brings one when it is needed.
  host.health().set(runtime::HealthState::kOk);
}

void GamepadComponent::publish() {
  sensor_msgs::msg::Joy message;
  message.header(wire::header(host_.now(), ""));
  message.axes(pad_.axes());
  message.buttons(pad_.buttons());
  joy_.publish(message);
}

}  // namespace usher::gamepad
