#include "drivers/gamepad/core/joystick.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace usher::gamepad {

namespace {

constexpr std::uint8_t kButton = 0x01;
constexpr std::uint8_t kAxis = 0x02;
constexpr std::uint8_t kInitial = 0x80;  // joined to the others while the state is described
constexpr float kFullScale = 32767.0F;
constexpr float kMiddle = 0.12F;  // as manual_control's dead zone

template <class Value>
bool change(std::vector<Value>& values, std::size_t index, Value value) {
  if (index >= values.size()) values.resize(index + 1);
  const bool changed = values[index] != value;
  values[index] = value;
  return changed;
}

}  // namespace

void Joystick::reset() {
  filled_ = 0;
  axes_.clear();
  buttons_.clear();
  described_ = moved_ = {};
  withheld_ = {};
}

bool Joystick::let_go() {
  bool away = false;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    away = away || (moved_[i] && std::abs(axes_[i]) > kMiddle);
  if (!away) return false;
  bool changed = false;
  for (std::size_t i = 0; i < buttons_.size(); ++i) {
    if (buttons_[i] == 0) continue;
    buttons_[i] = 0;
    withheld_[i] = changed = true;
  }
  return changed;
}

bool Joystick::received(std::span<const std::uint8_t> bytes) {
  bool changed = false;
  for (const std::uint8_t byte : bytes) {
    record_[filled_++] = byte;
    if (filled_ < kRecord) continue;
    filled_ = 0;
    changed = take() || changed;
  }
  return changed;
}

bool Joystick::take() {
  std::int16_t value = 0;
  std::memcpy(&value, record_.data() + 4, sizeof(value));
  const auto type = static_cast<std::uint8_t>(record_[6] & ~kInitial);
  const std::size_t number = record_[7];
  if (type == kButton && number < kMostButtons && (value == 0 || value == 1))
    return take_button(number, value == 1);
  if (type == kAxis && number < kMostAxes) {
    const float scaled = -static_cast<float>(value) / kFullScale;
    return take_axis(number, std::clamp(scaled, -1.0F, 1.0F) + 0.0F);
  }
  ++rejected_;
  return false;
}

bool Joystick::take_button(std::size_t number, bool down) {
  ++records_;
  withheld_[number] = withheld_[number] && down;
  return change<std::int32_t>(buttons_, number, down && !withheld_[number] ? 1 : 0);
}

bool Joystick::take_axis(std::size_t number, float value) {
  ++records_;
  const bool changed = change(axes_, number, value);
  moved_[number] = moved_[number] || (changed && described_[number]);
  described_[number] = true;
  return changed;
}

}  // namespace usher::gamepad
