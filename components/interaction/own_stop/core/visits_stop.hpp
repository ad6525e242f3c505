#pragma once

#include <chrono>

namespace usher::own_stop {

using Time = std::chrono::nanoseconds;

/// When a stop that a visitor asked for ends with his visit, and what was answered before it.
class VisitsStop {
 public:
  /// An answer that sets the robot off so soon after a stop was given before it.
  static constexpr Time kAnswerLate = std::chrono::milliseconds(1500);

  void stop(Time now) { stopped_at_ = now; }
  /// An answer that sets the robot off now was given before the newest stop.
  bool late(Time now) const { return now - stopped_at_ < kAnswerLate; }

  /// Somebody is served or not, the supervisor navigates or not; true once, when the visit ends: a
  /// stop of this visitor must not hold the robot for the next. A dialogue that forgets its visit
  /// has not ended the journey.
  bool ends(bool served, bool navigates) {
    const bool goes_on = served || (visit_ && navigates);
    const bool ended = visit_ && !goes_on;
    visit_ = goes_on;
    return ended;
  }

 private:
  bool visit_ = false;
  Time stopped_at_ = -kAnswerLate;  ///< never
};

}  // namespace usher::own_stop
