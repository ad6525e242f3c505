#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

namespace usher::depth_pipeline {

/// The newest readings of the tilt servo, so that an image is judged with the tilt of its own time:
/// the last 0.8 s at 20 Hz.
class TiltHistory {
 public:
  using Stamp = std::chrono::nanoseconds;  ///< since the epoch of the host

  static constexpr std::size_t kCapacity = 16;
  static constexpr double kStill = 0.01;  ///< [rad] readings that are farther apart are of a turn

  /// Takes a reading [rad]; false when it is not finite or not newer than the newest.
  bool add(Stamp stamp, double servo);

  /// Two readings are there, and one of them is not newer than the time.
  bool reaches(Stamp stamp) const;
  /// [rad] The servo at a time that it reaches: what the readings before and after it agree on,
  /// after the newest the newest two. Nothing: it turned.
  std::optional<double> at(Stamp stamp) const;

  /// The newest two readings do not agree. False while there are not two.
  bool turns() const;
  /// Both of the newest reading; only when there is one.
  Stamp newest_stamp() const { return back(0).stamp; }
  double newest() const { return back(0).servo; }

 private:
  struct Reading {
    Stamp stamp{};
    double servo = 0.0;
  };
  /// i = 0 is the newest.
  const Reading& back(std::size_t i) const {
    return readings_[(next_ + kCapacity - 1 - i) % kCapacity];
  }

  std::array<Reading, kCapacity> readings_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace usher::depth_pipeline
