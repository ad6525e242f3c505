#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "drivers/base_obedience/core/writer_id.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::manual_control {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// Which stick and button means what, numbered as in `joy`. The defaults are an Xbox pad and the
/// thesis, section 6.3: left stick forward, right stick turn, A and B movement, X and Y manual.
struct Mapping {
  std::size_t forward_axis = 1;  ///< positive forward
  std::size_t turn_axis = 3;     ///< positive left
  std::size_t dead_man = 4;      ///< LB: the robot drives only while it is held
  std::size_t movement_on = 0;   ///< A
  std::size_t movement_off = 1;  ///< B
  std::size_t manual_on = 2;     ///< X
  std::size_t manual_off = 3;    ///< Y
};

/// The participant of `usher teleop`, whose keys are sticks and buttons as this says, however the
/// robot's pad is laid out.
inline constexpr std::string_view kKeyboard = "operator";
inline constexpr Mapping kKeyboardMapping{};

struct Parameters {
  Mapping mapping;          ///< of every pad
  double linear = 0.8;      ///< [m/s] {> 0} at full deflection
  double angular = 0.8;     ///< [rad/s] {> 0}
  double dead_zone = 0.12;  ///< {0..0.9} of a stick's way that counts as rest
  Time patience =
      std::chrono::milliseconds(250);  ///< {> 0} of silence: the button counts as released
  Time farewell =
      std::chrono::milliseconds(300);  ///< zero is commanded for so long after a release
};

/// What an operator asks the supervisor for by a button.
enum class Wish : std::uint8_t { kNone, kMovementOn, kMovementOff, kManualOn, kManualOff };

/// One sample of `joy`.
struct Sticks {
  drive::WriterId writer{};  ///< whose pad it is
  std::span<const float> axes;
  std::span<const std::int32_t> buttons;
  bool late = false;      ///< too old to drive by; its buttons were pressed all the same
  bool keyboard = false;  ///< they mean what kKeyboardMapping says
};

/// From sticks and buttons to a velocity. It drives only while the dead-man button is held, on one
/// pad: the first that pressed it, until it releases it, speaks nonsense or is silent. A button
/// that is held when its pad is first heard counts only after it was released once; but for
/// movement_off, which counts at once.
///
/// Deterministic, no allocation. `now` must not go back.
class ManualControl {
 public:
  ManualControl() : ManualControl(Parameters{}) {}
  explicit ManualControl(const Parameters& parameters);

  /// The wish of a button that has just been pressed, on whatever pad.
  Wish take(const Sticks& sticks, Time now);

  /// What to command: nothing while nobody drives, so that other sources may.
  std::optional<geometry::Twist2> command(Time now);

  /// Somebody holds the button.
  bool held() const { return holder_.has_value(); }
  std::uint64_t rejected() const { return rejected_; }  ///< samples that were not finite

 private:
  static constexpr std::size_t kMostPads = 4;
  struct Pad {
    drive::WriterId writer{};
    Time heard_at{};
    bool seen_released = false;
    std::array<bool, 4> wishes{};  ///< buttons of the four wishes, movement_off first, as last seen
  };

  Pad& pad_of(const drive::WriterId& writer, Time now);
  const Mapping& mapping_of(const Sticks& sticks) const {
    return sticks.keyboard ? kKeyboardMapping : parameters_.mapping;
  }
  Wish edge(Pad& pad, const Sticks& sticks) const;
  void release(Time now);
  double deflection(float value) const;

  Parameters parameters_;
  std::array<Pad, kMostPads> pads_{};
  std::size_t pad_count_ = 0;
  std::optional<drive::WriterId> holder_;
  Time held_at_{};  ///< when the holder was last heard
  geometry::Twist2 twist_;
  std::optional<Time> released_at_;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::manual_control
