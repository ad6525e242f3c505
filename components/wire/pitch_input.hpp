#pragma once

#include <functional>

#include "foundation/estimation/pitch_history.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "wire/conversions.hpp"

namespace usher::wire {

/// A component's view of how the body leans: reads base/status into a PitchHistory. A status that
/// gives no pitch (not finite, not newer than the one before, stamped more than 20 ms ahead of now,
/// which would make all later ones old) is refused and counted ("base/status: refused"). After
/// 100 ms without a pitch, for whatever reason, the component is degraded (or worse) with that
/// reason.
///
/// A Pioneer (`robot.base`) stands upright whenever it is connected. Its statuses have the stamps
/// of the reports that they tell, ten a second: scans would wait for the next one, and 250 ms count
/// instead of 100.
class PitchInput {
 public:
  /// `on_loss` is for the contract; `on_pitch` runs after each pitch that is new; `without` is how
  /// the component is without one.
  PitchInput(runtime::Host& host, const char* on_loss, std::function<void()> on_pitch,
             runtime::HealthState without = runtime::HealthState::kDegraded);
  PitchInput(const PitchInput&) = delete;
  PitchInput& operator=(const PitchInput&) = delete;

  /// The pitch at a time, or the reason why it is not known.
  Result<estimation::Pitch> at(Time stamp) const;
  /// Whether one came within the last 100 ms.
  bool current() const;

 private:
  void take(const usher_msgs::msg::BaseStatus& status);
  Status add(const usher_msgs::msg::BaseStatus& status);

  runtime::Host& host_;
  std::function<void()> on_pitch_;
  const runtime::HealthState without_;
  const bool upright_;
  estimation::PitchHistory history_;
  Time heard_{};  ///< when the newest pitch came
  std::uint64_t& refused_;
  runtime::Input<usher_msgs::msg::BaseStatus> base_;
};

}  // namespace usher::wire
