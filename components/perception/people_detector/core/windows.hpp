#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/imaging/depth_image.hpp"

namespace usher::people_detector {

/// Where a camera looks from.
struct View {
  double height = 0.9;  ///< [m] above the floor
  double down = 0.0;    ///< [rad] of the optical axis below the horizon
  double roll = 0.0;    ///< [rad] positive: the image's right side is lower
};

/// A place where a surface stands upright: somebody may be there. Seen from the camera's foot.
struct Candidate {
  float forward = 0.0F;  ///< [m] of the surface, in the camera's direction
  float left = 0.0F;     ///< [m]
  float extent = 0.0F;   ///< [m] of surface above each other, as far as it is visible
};

/// Cuts windows of the size of a person, 1.12 m wide and 2 m high, out of a depth image, wherever a
/// surface stands. What a window holds does not depend on how far away it is: it is sampled on a
/// grid of 7 x 8.5 cm in space, and says for each cell whether a surface is there, how much nearer
/// or farther than the window, whether one looks past it, or whether something nearer hides it.
/// Cells out of the image say nothing.
class Windows {
 public:
  static constexpr int kAcross = 16, kUp = 24;                                      ///< cells
  static constexpr double kCellWidth = 0.07, kCellHeight = 0.085, kLowest = 0.045;  ///< [m]
  static constexpr double kDepth = 0.5;                                             ///< [m]
  static constexpr int kChannels = 3;
  static constexpr int kOthers = 8;  ///< inputs that are no cells
  static constexpr int kInputs = kAcross * kUp * kChannels + kOthers;
  static constexpr std::int16_t kOne = 64;  ///< what 1 is among the inputs
  using Inputs = std::array<std::int16_t, kInputs>;

  struct Config {
    double nearest = 0.4;       ///< [m] {0.2..2}
    double farthest = 6.3;      ///< [m] {1..8}
    double least_extent = 0.3;  ///< [m] {0.1..1} of a surface that may be somebody
    double step = 0.05;         ///< [m] {0.02..0.2} between two windows
  };
  Windows(const imaging::Intrinsics& intrinsics, const Config& config);

  /// Finds the candidates of an image without floor and ceiling (0 = nothing) that has the size of
  /// the intrinsics. No allocation once it has seen the most candidates.
  void take(const imaging::DepthImage& image, const View& view);
  std::span<const Candidate> candidates() const { return candidates_; }

  /// What the window around a candidate holds.
  void describe(const Candidate& candidate, Inputs& inputs) const;
  /// The same window with left and right exchanged.
  static void mirror(const Inputs& inputs, Inputs& mirrored);
  struct Top {
    double height = 0.0;  ///< [m] of the highest surface; 0: it leaves the image, or none is there
    bool head_hidden = false;  ///< something nearer hides where a head may be above it
  };
  Top top(const Candidate& candidate) const;

 private:
  void thin(const imaging::DepthImage& image);
  void fill_histograms();
  void find_candidates();

  imaging::Intrinsics intrinsics_;
  Config config_;
  View view_;
  double cos_down_ = 1.0, sin_down_ = 0.0, cos_roll_ = 1.0, sin_roll_ = 0.0;
  int step_ = 1;  // pixels of the image to one of the thinned image
  int width_ = 0, height_ = 0, strips_ = 0, bins_ = 0;
  std::vector<std::uint16_t> thinned_;
  std::vector<float> histograms_;
  std::vector<Candidate> candidates_;
};

}  // namespace usher::people_detector
