#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::estimation {

/// Which bins of pose space are occupied, and which of them hang together. An open-addressing
/// table: memory is set aside once, adding is O(1), and the numbers of bins and clusters follow the
/// order of adding alone.
class PoseHistogram {
 public:
  /// Bins of `position` [m] in x and y and about `yaw` [rad] (a whole number of bins makes the
  /// circle), for up to `max_poses` poses between two clear().
  PoseHistogram(double position, double yaw, std::size_t max_poses);

  void clear();
  /// The number of the pose's bin, counted from 0 in order of first use. The pose must be finite.
  std::uint32_t add(const geometry::Pose2& pose);
  /// How many bins are occupied.
  std::size_t bins() const { return keys_.size(); }

  /// For each bin the number of its cluster, counted from 0: bins that touch, also at a corner, are
  /// one cluster. Valid until the next add() or clear().
  std::span<const std::uint32_t> clusters();
  /// How many clusters the last call of clusters() found.
  std::size_t cluster_count() const { return cluster_count_; }

 private:
  struct Key {
    std::int32_t x, y, yaw;
    bool operator==(const Key&) const = default;
  };
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::size_t slot_of(const Key& key) const;

  double inverse_position_, inverse_yaw_;
  std::int32_t yaw_bins_;
  std::vector<std::uint32_t> slots_;  // bin number or kNone; a power of two, at most half full
  std::vector<Key> keys_;             // by bin number
  std::vector<std::uint32_t> cluster_;
  std::vector<std::uint32_t> open_;
  std::size_t cluster_count_ = 0;
};

}  // namespace usher::estimation
