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
///
/// The kernel tells changes only, and a wireless pad that has lost its power or its link tells none
/// at all: whoever reads has to bound how long a held button holds (let_go()).
class Joystick {
 public:
  static constexpr std::size_t kMostAxes = 64;
  static constexpr std::size_t kMostButtons = 128;

  /// Bytes as they come, whole records or parts. True when the state changed.
  bool received(std::span<const std::uint8_t> bytes);
  /// It was silent for too long. While a button is held and a stick is out of its middle, every
  /// held button counts as released until it is pressed anew: true, and else nothing is changed. An
  /// axis that has not moved since the pad was opened is no such stick: triggers rest at an end of
  /// theirs.
  bool let_go();
  /// The pad is gone: nothing is pressed, nothing is known of its size.
  void reset();

  const std::vector<float>& axes() const { return axes_; }
  const std::vector<std::int32_t>& buttons() const { return buttons_; }  ///< 0 or 1
  std::uint64_t rejected() const { return rejected_; }
  std::uint64_t records() const { return records_; }  ///< that made sense, changes or not

 private:
  static constexpr std::size_t kRecord = 8;
  bool take();
  bool take_button(std::size_t number, bool down);
  bool take_axis(std::size_t number, float value);

  std::array<std::uint8_t, kRecord> record_{};
  std::size_t filled_ = 0;
  std::vector<float> axes_;
  std::vector<std::int32_t> buttons_;
  std::array<bool, kMostAxes> described_{};    ///< its first value is known
  std::array<bool, kMostAxes> moved_{};        ///< and it had another one since
  std::array<bool, kMostButtons> withheld_{};  ///< held for too long, and still
  std::uint64_t rejected_ = 0;
  std::uint64_t records_ = 0;
};

}  // namespace usher::gamepad
