#include "drivers/gamepad/core/joystick.hpp"

#include <algorithm>
#include <cstring>

namespace usher::gamepad {

namespace {

constexpr std::uint8_t kButton = 0x01;
constexpr std::uint8_t kAxis = 0x02;
constexpr std::uint8_t kInitial = 0x80;  // joined to the others while the state is described
constexpr float kFullScale = 32767.0F;

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
    return change<std::int32_t>(buttons_, number, value);
  if (type == kAxis && number < kMostAxes) {
    const float scaled = -static_cast<float>(value) / kFullScale;
    return change(axes_, number, std::clamp(scaled, -1.0F, 1.0F) + 0.0F);
  }
  ++rejected_;
  return false;
}

}  // namespace usher::gamepad
