#include "foundation/estimation/pose_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace usher::estimation {

PoseHistogram::PoseHistogram(double position, double yaw, std::size_t max_poses)
    : inverse_position_(1.0 / position),
      yaw_bins_(std::max(1, static_cast<std::int32_t>(std::lround(2.0 * geometry::kPi / yaw)))),
      slots_(std::bit_ceil(2 * std::max<std::size_t>(max_poses, 1)), kNone) {
  assert(position > 0.0 && yaw > 0.0);
  inverse_yaw_ = yaw_bins_ / (2.0 * geometry::kPi);
  keys_.reserve(max_poses);
  cluster_.reserve(max_poses);
  open_.reserve(max_poses);
}

void PoseHistogram::clear() {
  std::fill(slots_.begin(), slots_.end(), kNone);
  keys_.clear();
}

std::size_t PoseHistogram::slot_of(const Key& key) const {
  std::uint64_t hash = static_cast<std::uint32_t>(key.x) * 0x9e3779b97f4a7c15ULL;
  hash = (hash ^ (hash >> 29) ^ static_cast<std::uint32_t>(key.y)) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 32) ^ static_cast<std::uint32_t>(key.yaw)) * 0x94d049bb133111ebULL;
  std::size_t slot = (hash >> 32) & (slots_.size() - 1);
  while (slots_[slot] != kNone && !(keys_[slots_[slot]] == key)) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

std::uint32_t PoseHistogram::add(const geometry::Pose2& pose) {
  assert(pose.finite());
  auto yaw = static_cast<std::int32_t>(
      std::floor((geometry::normalized(pose.yaw) + geometry::kPi) * inverse_yaw_));
  if (yaw >= yaw_bins_) yaw = 0;  // pi is -pi
  const Key key{static_cast<std::int32_t>(std::floor(pose.x * inverse_position_)),
                static_cast<std::int32_t>(std::floor(pose.y * inverse_position_)), yaw};
  const std::size_t slot = slot_of(key);
  if (slots_[slot] == kNone) {
    assert(2 * keys_.size() < slots_.size());
    slots_[slot] = static_cast<std::uint32_t>(keys_.size());
    keys_.push_back(key);
  }
  return slots_[slot];
}

std::span<const std::uint32_t> PoseHistogram::clusters() {
  cluster_.assign(keys_.size(), kNone);
  cluster_count_ = 0;
  for (std::uint32_t seed = 0; seed < keys_.size(); ++seed) {
    if (cluster_[seed] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(cluster_count_++);
    cluster_[seed] = number;
    open_.assign(1, seed);
    while (!open_.empty()) {
      const Key from = keys_[open_.back()];
      open_.pop_back();
      for (std::int32_t i = 0; i < 27; ++i) {
        const std::int32_t yaw = (from.yaw + i / 9 - 1 + yaw_bins_) % yaw_bins_;
        const std::uint32_t bin =
            slots_[slot_of({from.x + i % 3 - 1, from.y + i / 3 % 3 - 1, yaw})];
        if (bin == kNone || cluster_[bin] != kNone) continue;
        cluster_[bin] = number;
        open_.push_back(bin);
      }
    }
  }
  return cluster_;
}

}  // namespace usher::estimation
