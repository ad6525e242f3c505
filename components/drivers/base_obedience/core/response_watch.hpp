#pragma once

#include <array>
#include <cstdint>

#include "drivers/base_obedience/core/base_obedience.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::drive {

/// Compares what a base does with what it was told, allowing for its slow response.
///
/// The predicted response of a base: within `response` it gets from any command to any other, on
/// the way it stays between them, except for an overshoot that is a fraction of the step. So at
/// every moment the velocity lies in the span of the commands of the last `response`, widened by
/// `overshoot` times that span. This holds for a first-order lag, for a dead time, and for the
/// two-phase stop of a balancing base, so none of them raises an alarm; what leaves the span does.
///
/// Leaving it away from zero, or against the commanded direction, is disobedience. Leaving it
/// toward zero is falling short: a base that stands although it should drive is no hazard. So is
/// driving with less than half of the slowest command in the span, however slow that is.
///
/// No allocation; a call costs a few dozen comparisons. `now` must not go back.
class ResponseWatch {
 public:
  struct Axis {
    double threshold = 0.0;  ///< error that is tolerated for ever; [m/s] or [rad/s]
    Time patience{};         ///< a larger error must last so long
  };
  struct Parameters {
    Time response = std::chrono::milliseconds(2500);  ///< {> 0}
    double overshoot = 0.3;                           ///< {>= 0} fraction of the span
    Axis linear{0.5, std::chrono::milliseconds(1000)};
    Axis angular{0.8, std::chrono::milliseconds(1000)};
    /// Instead of the thresholds where only zero was commanded for `response`: who is told to stand
    /// has no response to be slow with. More than a balancing base sways.
    double standing_linear = 0.25;   ///< {> 0, at most linear.threshold counts} [m/s]
    double standing_angular = 0.35;  ///< {> 0, at most angular.threshold counts} [rad/s]
  };

  enum class Verdict : std::uint8_t { kObeys, kFallsShort, kDisobeys };

  struct AxisError {
    double error = 0.0;  ///< nearest predicted velocity minus the measured one
    Time lasting{};      ///< for how long its size has been above the threshold
  };

  ResponseWatch();
  explicit ResponseWatch(const Parameters& parameters);

  /// One look at the base: the command that it should be driving (zero when it may not drive) and
  /// the measured velocity. A measured value that is not finite is ignored.
  Verdict observe(const geometry::Twist2& commanded, const geometry::Twist2& measured, Time now);

  Verdict verdict() const { return verdict_; }
  /// It disobeys by more than `threshold`, also of one that stands: it drives by itself. Who pushes
  /// a standing base makes it disobey, but seldom so.
  bool runs_away() const;
  const AxisError& linear() const { return linear_.error; }
  const AxisError& angular() const { return angular_.error; }

  /// Forgets commands and errors, as after a restart of the base. A base that is found moving has
  /// `response` to get to its command.
  void reset(const geometry::Twist2& found = {});

 private:
  static constexpr std::size_t kBuckets = 26;  ///< the window and the bucket being filled

  struct Span {
    double low = 0.0;
    double high = 0.0;
  };
  struct AxisState {
    std::array<Span, kBuckets> history{};  ///< span of the commands in each slice of time
    double last = 0.0;                     ///< the command that holds until the next one
    AxisError error;
    Time excess_lasting{};
    Time far_lasting{};  ///< of an excess over `threshold`, also where it stands
  };

  void advance(Time now);
  Verdict judge(AxisState& axis, const Axis& limits, double standing, double commanded,
                double measured, Time elapsed);

  Parameters parameters_;
  Time slice_;
  bool started_ = false;
  Time last_now_{};
  std::int64_t bucket_ = 0;  ///< number of the slice of time being filled
  AxisState linear_;
  AxisState angular_;
  Verdict verdict_ = Verdict::kObeys;
};

}  // namespace usher::drive
