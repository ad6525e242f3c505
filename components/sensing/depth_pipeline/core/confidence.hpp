#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace usher::depth_pipeline {

/// How far each bearing's range agrees with its rolling mean (thesis 4.23, with the absolute value
/// that it lacks): 1 - |d - mean| / threshold, 1 is full agreement. Noise that appears when the
/// pitch jumps agrees with nothing. "Nothing there" (infinity) counts as `far`.
/// What only the present frame measured has confidence 0.
class Confidence {
 public:
  static constexpr int kMostFrames = 8;

  /// `frames` in {1..kMostFrames} the mean is taken over, the present one included; 1 trusts all.
  Confidence(std::size_t bearings, int frames, double threshold, double far);

  /// Writes the intensities in [0, 1] and takes the ranges into the mean. NaN (not measured) gets 0
  /// and is no part of it. Ranges whose confidence is below `least` become NaN.
  void rate(std::span<float> ranges, double least, std::span<float> intensities);
  /// The next frame is of another time or direction: it is rated as the first one.
  void forget();

 private:
  int frames_;
  float threshold_, far_;
  std::size_t next_ = 0;
  std::vector<float> past_;  // frames_ rows; negative: not measured
};

}  // namespace usher::depth_pipeline
