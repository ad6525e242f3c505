#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/stopping_distance.hpp"

namespace usher::kinematics {

/// What to tell a base that must stand now, so that it stays on its arc while it rolls out. A
/// balancing base that is told zero leans back first and rolls on for 1.48 s x v (thesis, table
/// 8.1) while its turn rate is gone after 0.2 s: straight on, off the arc that was free, into the
/// door post. So the forward velocity is zero at once, and the turn rate falls with the measured
/// speed. Where nothing measures, the base does what it was last told, and goes on turning for a
/// while: it rolls out all the same. A turn rate that it was not told lately is measured by
/// something that hangs, and counts only as far as it was told.
class RollOut {
 public:
  static constexpr double kStanding = 0.08;  ///< [m/s] slower it stands
  static constexpr double kStraight = 0.03;  ///< [rad/s] slower turns are a balancing base's sway
  static constexpr auto kBlind = std::chrono::milliseconds(1000);  ///< turns so long unmeasured
  static constexpr auto kPause = std::chrono::milliseconds(200);   ///< a longer one counts as this
  static constexpr double kTurnLag = 0.3;  ///< [s] {> 0} no base's turn rate follows later
  static constexpr double kSlows = 0.4;    ///< [m/s2] {> 0} a base that is not measured, at least
  static constexpr double kTurnSlack = 0.05;  ///< [rad/s] {>= 0} beside what it was told

  /// [m/s] No stop from this speed takes longer: MARVIN's, the slower of the bases. What hangs or
  /// is not measured turns a robot no longer.
  static std::chrono::nanoseconds longest(double speed) {
    const std::chrono::duration<double> time(std::min(2.5, 0.4 + 1.6 * std::abs(speed)));
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time);
  }

  /// It must stand, and does so much now; nothing and what is not finite are unmeasured. Called
  /// every cycle: where a clock jumped, the base has not rolled on meanwhile.
  geometry::Twist2 stop(const std::optional<geometry::Twist2>& measured,
                        std::chrono::nanoseconds called) {
    const std::chrono::nanoseconds now = passed(called);
    const bool known = measured && measured->finite();
    // Who begins while the base rolls, after a restart, knows that from the measurement alone, the
    // first that he hears.
    const bool learns = known && !rolled_at_;
    if (!stops_ || learns) {
      stops_ = true;
      if (learns) rolled_at_ = now;
      measured_at_ = known ? now : rolled_at_.value_or(now);
      onset_ = known ? *measured : geometry::Twist2{rolls_, driven_w_};
      onset_.w = std::clamp(onset_.w, least_turn_ - kTurnSlack, most_turn_ + kTurnSlack);
      if (std::abs(onset_.w) < kStraight) onset_.w = 0.0;
      share_ = 1.0;
    }
    if (known) {
      measured_at_ = now;
      const bool rolls = measured->v * onset_.v > 0.0 && std::abs(measured->v) > kStanding;
      share_ = rolls ? std::min(1.0, measured->v / onset_.v) : 0.0;
    }
    const std::chrono::nanoseconds most = longest(onset_.v);
    if (!(std::abs(onset_.v) > kStanding) || share_ == 0.0 || !rolled_at_ ||
        now - *rolled_at_ >= most || now - measured_at_ >= kBlind)
      return tell({}, now);
    return tell({0.0, onset_.w * share_}, now);
  }
  /// It may drive, and is told so: the next stop begins anew.
  void drive(const geometry::Twist2& told, std::chrono::nanoseconds called) {
    const std::chrono::nanoseconds now = passed(called);
    stops_ = false;
    tell(told, now);
    driven_w_ = told.w;
    // Without a speed it rolls out for somebody else, who keeps the arc.
    if (told.v != 0.0) rolled_at_ = now;
  }

  /// What to tell the base, and for how long, where from now on nobody measures and tells: it turns
  /// by as much as along its arc until it stands, for kBlind at most. No time where it stands or
  /// goes straight.
  struct Rest {
    geometry::Twist2 twist;
    std::chrono::nanoseconds lasts{};
  };
  Rest rest(const StoppingDistance& stopping) const {
    const double v = stops_ ? onset_.v * share_ : rolls_;
    const double w = stops_ ? onset_.w * share_ : driven_w_;
    if (!(std::abs(v) > kStanding) || std::abs(w) < kStraight) return {};
    const std::chrono::duration<double> stops(stopping.distance(v) / std::abs(v));
    const std::chrono::nanoseconds rolled = rolled_at_ ? passed_ - *rolled_at_ : passed_;
    const auto left = std::min<std::chrono::nanoseconds>(
        {kBlind, std::chrono::duration_cast<std::chrono::nanoseconds>(stops),
         longest(stops_ ? onset_.v : v) - rolled});
    return {{0.0, w}, std::max(left, std::chrono::nanoseconds::zero())};
  }

 private:
  /// The time since the first call, of each pause kPause at most.
  std::chrono::nanoseconds passed(std::chrono::nanoseconds called) {
    if (called_at_)
      passed_ += std::clamp<std::chrono::nanoseconds>(called - *called_at_, {}, kPause);
    called_at_ = called;
    return passed_;
  }
  /// What the base may roll and turn like after having been told so.
  geometry::Twist2 tell(const geometry::Twist2& twist, std::chrono::nanoseconds now) {
    const double seconds = told_at_ ? std::chrono::duration<double>(now - *told_at_).count() : 0.0;
    const double left = kTurnLag / (kTurnLag + seconds);
    least_turn_ = twist.w + std::min(0.0, (least_turn_ - twist.w) * left);
    most_turn_ = twist.w + std::max(0.0, (most_turn_ - twist.w) * left);
    const double rolls = std::max(0.0, std::abs(rolls_) - kSlows * seconds);
    rolls_ = std::abs(twist.v) >= rolls ? twist.v : std::copysign(rolls, rolls_);
    told_at_ = now;
    return twist;
  }

  static constexpr double kAnyTurn = 5.0;  // [rad/s] who has just begun does not know what was told
  std::optional<std::chrono::nanoseconds> called_at_;
  std::chrono::nanoseconds passed_{};
  bool stops_ = false;
  double rolls_ = 0.0, driven_w_ = 0.0;                ///< what it does by what it was told
  std::optional<std::chrono::nanoseconds> rolled_at_;  ///< when
  std::chrono::nanoseconds measured_at_{};
  geometry::Twist2 onset_;
  double share_ = 0.0;                                    ///< of the onset's turn rate
  double least_turn_ = -kAnyTurn, most_turn_ = kAnyTurn;  ///< [rad/s] of a base that obeys
  std::optional<std::chrono::nanoseconds> told_at_;
};

}  // namespace usher::kinematics
