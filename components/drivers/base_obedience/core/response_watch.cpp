#include "drivers/base_obedience/core/response_watch.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::drive {

namespace {

constexpr double kLeastLacking = 0.08;  // [m/s] or [rad/s] less may be a balancing base's sway

/// Signed distance of `value` from [low, high]; 0 inside.
double outside(double value, double low, double high) {
  return value > high ? value - high : value < low ? value - low : 0.0;
}

}  // namespace

ResponseWatch::ResponseWatch() : ResponseWatch(Parameters{}) {}

ResponseWatch::ResponseWatch(const Parameters& parameters)
    : parameters_(parameters), slice_(parameters.response / (kBuckets - 1)) {
  assert(slice_ > Time::zero() && parameters.overshoot >= 0.0);
}

void ResponseWatch::reset(const geometry::Twist2& found) {
  *this = ResponseWatch(parameters_);
  linear_.history.fill({found.v, found.v});
  angular_.history.fill({found.w, found.w});
}

void ResponseWatch::advance(Time now) {
  const std::int64_t bucket = now / slice_;
  if (!started_) bucket_ = bucket;
  // Slices without a look carry the command that held through them.
  const std::int64_t missed = std::min<std::int64_t>(bucket - bucket_, kBuckets);
  for (std::int64_t i = 0; i < missed; ++i) {
    const auto slot = static_cast<std::size_t>((bucket - i) % static_cast<std::int64_t>(kBuckets));
    linear_.history[slot] = {linear_.last, linear_.last};
    angular_.history[slot] = {angular_.last, angular_.last};
  }
  bucket_ = std::max(bucket, bucket_);
}

ResponseWatch::Verdict ResponseWatch::judge(AxisState& axis, const Axis& limits, double standing,
                                            double commanded, double measured, Time elapsed) {
  const auto slot = static_cast<std::size_t>(bucket_ % static_cast<std::int64_t>(kBuckets));
  Span& present = axis.history[slot];
  present.low = std::min(present.low, commanded);
  present.high = std::max(present.high, commanded);
  axis.last = commanded;

  Span span = present;
  for (const Span& slice : axis.history) {
    span.low = std::min(span.low, slice.low);
    span.high = std::max(span.high, slice.high);
  }
  const double overshoot = parameters_.overshoot * (span.high - span.low);
  const double low = span.low - overshoot;
  const double high = span.high + overshoot;
  axis.error.error = -outside(measured, low, high);
  const double excess = outside(measured, std::min(low, 0.0), std::max(high, 0.0));

  const bool stands = span.low == 0.0 && span.high == 0.0;
  const double threshold = stands ? std::min(standing, limits.threshold) : limits.threshold;
  // Half of the slowest command that it was told is missed by no base that follows.
  const double slowest = std::max({low, -high, 0.0});
  const bool lacks = slowest > 0.0 && axis.error.error * low > 0.0;
  const double tolerated =
      lacks ? std::min(threshold, std::max(kLeastLacking, 0.5 * slowest)) : threshold;
  axis.error.lasting =
      std::abs(axis.error.error) > tolerated ? axis.error.lasting + elapsed : Time::zero();
  axis.excess_lasting = std::abs(excess) > threshold ? axis.excess_lasting + elapsed : Time::zero();

  axis.far_lasting =
      std::abs(excess) > limits.threshold ? axis.far_lasting + elapsed : Time::zero();

  if (axis.excess_lasting > Time::zero() && axis.excess_lasting >= limits.patience) {
    return Verdict::kDisobeys;
  }
  if (axis.error.lasting > Time::zero() && axis.error.lasting >= limits.patience) {
    return Verdict::kFallsShort;
  }
  return Verdict::kObeys;
}

bool ResponseWatch::runs_away() const {
  const auto lasts = [](const AxisState& axis, const Axis& limits) {
    return axis.far_lasting > Time::zero() && axis.far_lasting >= limits.patience;
  };
  return lasts(linear_, parameters_.linear) || lasts(angular_, parameters_.angular);
}

ResponseWatch::Verdict ResponseWatch::observe(const geometry::Twist2& commanded,
                                              const geometry::Twist2& measured, Time now) {
  if (!measured.finite() || !commanded.finite()) return verdict_;
  assert(now >= Time::zero());
  // A gap between two looks proves nothing about the time in between.
  const Time elapsed = started_ ? std::clamp(now - last_now_, Time::zero(), slice_) : Time::zero();
  advance(now);
  started_ = true;
  last_now_ = now;
  const Verdict linear = judge(linear_, parameters_.linear, parameters_.standing_linear,
                               commanded.v, measured.v, elapsed);
  const Verdict angular = judge(angular_, parameters_.angular, parameters_.standing_angular,
                                commanded.w, measured.w, elapsed);
  verdict_ = std::max(linear, angular);
  return verdict_;
}

}  // namespace usher::drive
