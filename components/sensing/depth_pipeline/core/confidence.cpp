#include "sensing/depth_pipeline/core/confidence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace usher::depth_pipeline {

namespace {
constexpr float kNotMeasured = -1.0F;
}

Confidence::Confidence(std::size_t bearings, int frames, double threshold, double far)
    : frames_(std::clamp(frames, 1, kMostFrames)),
      threshold_(static_cast<float>(threshold)),
      far_(static_cast<float>(far)),
      past_(bearings * static_cast<std::size_t>(frames_), kNotMeasured) {}

void Confidence::forget() { std::fill(past_.begin(), past_.end(), kNotMeasured); }

void Confidence::rate(std::span<float> ranges, double least, std::span<float> intensities) {
  const std::size_t count = ranges.size();
  assert(intensities.size() == count && past_.size() == count * static_cast<std::size_t>(frames_));
  float* const present = past_.data() + next_ * count;
  for (std::size_t i = 0; i < count; ++i) {
    present[i] = std::isnan(ranges[i]) ? kNotMeasured : std::min(ranges[i], far_);
    float sum = 0.0F;
    int measured = 0;
    for (std::size_t frame = 0; frame < static_cast<std::size_t>(frames_); ++frame) {
      const float range = past_[frame * count + i];
      if (range < 0.0F) continue;
      sum += range;
      ++measured;
    }
    if (present[i] < 0.0F) {
      intensities[i] = 0.0F;
      continue;
    }
    const float off = std::abs(present[i] - sum / static_cast<float>(measured));
    const bool confirmed = measured > 1 || frames_ == 1;
    intensities[i] = confirmed ? std::max(0.0F, 1.0F - off / threshold_) : 0.0F;
    if (intensities[i] < static_cast<float>(least))
      ranges[i] = std::numeric_limits<float>::quiet_NaN();
  }
  next_ = (next_ + 1) % static_cast<std::size_t>(frames_);
}

}  // namespace usher::depth_pipeline
