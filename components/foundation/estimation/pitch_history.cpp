#include "foundation/estimation/pitch_history.hpp"

#include <cmath>
#include <string>

namespace usher::estimation {
namespace {

constexpr double kSteepest = 1.5;                       // [rad]
constexpr Stamp kGap = std::chrono::milliseconds(100);  // no line is drawn over a longer silence

double seconds(Stamp stamp) { return std::chrono::duration<double>(stamp).count(); }

std::string milliseconds(Stamp stamp) { return std::to_string(stamp.count() / 1000000) + " ms"; }

}  // namespace

Status PitchHistory::add(Stamp stamp, const Pitch& pitch) {
  if (!std::isfinite(pitch.rate) || !(std::abs(pitch.angle) <= kSteepest)) {
    return Error{"pitch must be within 1.5 rad and its rate finite, got " +
                 std::to_string(pitch.angle) + " rad, " + std::to_string(pitch.rate) + " rad/s"};
  }
  if (count_ > 0 && stamp <= back(0).stamp) {
    return Error{"pitch must be newer than the one before, got one " +
                 milliseconds(back(0).stamp - stamp) + " older"};
  }
  samples_[next_] = {stamp, pitch};
  next_ = (next_ + 1) % kCapacity;
  if (count_ < kCapacity) ++count_;
  return {};
}

Result<Pitch> PitchHistory::at(Stamp stamp) const {
  if (count_ == 0) return Error{"no pitch is known yet"};
  const Sample& newest = back(0);
  if (stamp >= newest.stamp) {
    const Stamp ahead = stamp - newest.stamp;
    if (ahead > reach_) return Error{"the newest pitch is " + milliseconds(ahead) + " too old"};
    return Pitch{newest.pitch.angle + newest.pitch.rate * seconds(ahead), newest.pitch.rate};
  }
  for (std::size_t i = 1; i < count_; ++i) {
    const Sample& a = back(i);
    if (stamp < a.stamp) continue;
    if (stamp == a.stamp) return a.pitch;
    const Sample& b = back(i - 1);
    if (b.stamp - a.stamp > kGap) {
      return Error{"the pitch has a gap of " + milliseconds(b.stamp - a.stamp) + " there"};
    }
    // Cubic Hermite.
    const double h = seconds(b.stamp - a.stamp);
    const double s = seconds(stamp - a.stamp) / h;
    const double rise = b.pitch.angle - a.pitch.angle;
    const double from = a.pitch.rate * h - rise;
    const double to = b.pitch.rate * h - rise;
    const double bend = (1.0 - s) * from - s * to;
    const double angle = a.pitch.angle + s * rise + s * (1.0 - s) * bend;
    const double rate = (rise + (1.0 - 2.0 * s) * bend - s * (1.0 - s) * (from + to)) / h;
    return Pitch{angle, rate};
  }
  return Error{"the pitch is remembered only for the last " +
               milliseconds(newest.stamp - back(count_ - 1).stamp)};
}

}  // namespace usher::estimation
