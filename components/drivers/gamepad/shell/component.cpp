#include "drivers/gamepad/shell/component.hpp"

#include "wire/conversions.hpp"

namespace usher::gamepad {

namespace {
constexpr auto kRepeat = std::chrono::milliseconds(50);
}  // namespace

GamepadComponent::GamepadComponent(runtime::Host& host)
    : host_(host),
      hold_timeout_(runtime::from_seconds(host.parameters().number(
          "hold_timeout", "s", {0.5, 10}, 2.0,
          "A pad that says nothing for so long, while a button is held and a stick is out of its "
          "middle, may have lost its power: the button counts as released until it is pressed "
          "anew."))),
      rejected_(host.health().counter("records: rejected")),
      let_go_(host.health().counter("holds: too long without a word")),
      joy_(host.output(topics::kJoy)) {
  const std::string device = host.parameters().text("device", "device:///dev/input/js0",
                                                    "The pad; may come and go at any time.");
  host.open_stream(device, {.on_open =
                                [this] {
                                  there_ = true;
                                  heard_at_ = host_.now();
                                },
                            .on_bytes = [this](auto bytes) { received(bytes); },
                            .on_close =
                                [this](const std::string&) {
                                  if (!there_) return;  // there was none
                                  there_ = false;
                                  pad_.reset();
                                  publish();  // a pad without sticks and buttons: all released
                                }});
  timer_ = host.timer("repeat", kRepeat, [this](auto) { repeat(); });
  // A robot without a pad is well: an operator brings one when it is needed.
  host.health().set(runtime::HealthState::kOk);
}

void GamepadComponent::received(std::span<const std::uint8_t> bytes) {
  const auto before = pad_.records();
  if (pad_.received(bytes)) publish();
  if (pad_.records() != before) heard_at_ = host_.now();
  rejected_ = pad_.rejected();
}

void GamepadComponent::repeat() {
  if (!there_) return;
  if (host_.now() - heard_at_ >= hold_timeout_ && pad_.let_go()) ++let_go_;
  publish();
}

void GamepadComponent::publish() {
  sensor_msgs::msg::Joy message;
  message.header(wire::header(host_.now(), ""));
  message.axes(pad_.axes());
  message.buttons(pad_.buttons());
  joy_.publish(message);
}

}  // namespace usher::gamepad
