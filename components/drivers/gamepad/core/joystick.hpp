#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace usher::gamepad {

/// The state of a gamepad, from the event records of Linux' joystick interface (/dev/input/jsN):
/// 8 octets each, native order: time [ms], value, type, number. After opening the kernel describes
/// the present state, so the sizes are those of the pad.
///
/// Axes are -1..1 with the signs that ROS has for `joy`: forward and left are positive (Linux: the
/// other way round). A record that makes no sense is counted and changes nothing.
class Joystick {
 public:
  static constexpr std::size_t kMostAxes = 64;
  static constexpr std::size_t kMostButtons = 128;

  /// Bytes as they come, whole records or parts. True when the state changed.
  bool received(std::span<const std::uint8_t> bytes);
  /// The pad is gone: nothing is pressed, nothing is known of its size.
  void reset();

  const std::vector<float>& axes() const { return axes_; }
  const std::vector<std::int32_t>& buttons() const { return buttons_; }  ///< 0 or 1
  std::uint64_t rejected() const { return rejected_; }

 private:
  static constexpr std::size_t kRecord = 8;
  bool take();

  std::array<std::uint8_t, kRecord> record_{};
  std::size_t filled_ = 0;
  std::vector<float> axes_;
  std::vector<std::int32_t> buttons_;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::gamepad
