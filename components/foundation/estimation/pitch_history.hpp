#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "foundation/result/result.hpp"

namespace usher::estimation {

using Stamp = std::chrono::nanoseconds;  ///< since the epoch of the host

/// How the body leans at one time.
struct Pitch {
  double angle = 0.0;  ///< [rad] positive leans forward
  double rate = 0.0;   ///< [rad/s]
};

/// The pitch of the last 1.28 s at 100 Hz, so that a scan is corrected with the pitch of its own
/// time. Between two samples the cubic through both angles and rates, after the newest a straight
/// line for at most `reach`.
class PitchHistory {
 public:
  static constexpr std::size_t kCapacity = 128;

  explicit PitchHistory(Stamp reach = std::chrono::milliseconds(20)) : reach_(reach) {}

  /// Takes a sample; one that is not finite, steeper than 1.5 rad or not newer than the newest is
  /// refused.
  Status add(Stamp stamp, const Pitch& pitch);

  /// The pitch at a time, or the reason why it is not known: before the memory, beyond the reach,
  /// or between (not at) two samples more than 0.1 s apart.
  Result<Pitch> at(Stamp stamp) const;

  std::size_t size() const { return count_; }

 private:
  struct Sample {
    Stamp stamp{};
    Pitch pitch;
  };
  /// i = 0 is the newest.
  const Sample& back(std::size_t i) const {
    return samples_[(next_ + 2 * kCapacity - 1 - i) % kCapacity];
  }

  Stamp reach_;
  std::array<Sample, kCapacity> samples_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace usher::estimation
