#pragma once

#include <span>
#include <vector>

#include "foundation/imaging/appearance.hpp"
#include "foundation/result/result.hpp"
#include "perception/people_detector/core/network.hpp"
#include "perception/people_detector/core/windows.hpp"

namespace usher::people_detector {

/// Somebody in a depth image, seen from the camera's foot.
struct Sighting {
  double forward = 0.0;            ///< [m] the middle of the body, in the camera's direction
  double left = 0.0;               ///< [m]
  double height = 0.0;             ///< [m] of the highest visible point; 0: it leaves the image
  double score = 0.0;              ///< log odds, over the threshold
  imaging::Appearance appearance;  ///< not known without a color image
  bool head_hidden = false;        ///< something nearer may hide a head over the highest point
};

struct DetectorConfig {
  Windows::Config windows;
  double threshold = 0.5;  ///< [-] {-10..10} least log odds
  double same = 0.36;      ///< [m] {0.1..1} nearer bodies are the same
};

/// The error names the first value that cannot be.
Status check(const DetectorConfig& config);

/// Finds people in the images of a depth camera from which floor and ceiling are removed: a window
/// wherever a surface stands upright, a small trained network that says which windows show somebody
/// in their middle and where exactly that body is, the best of each cluster of such votes.
class DepthDetector {
 public:
  /// The error says what of intrinsics or configuration cannot be.
  static Result<DepthDetector> make(const imaging::Intrinsics& intrinsics,
                                    const DetectorConfig& config,
                                    const Network& network = trained_network());

  const imaging::Intrinsics& intrinsics() const { return intrinsics_; }

  /// Nearest first; the view stays valid until the next image. An image of another size or a view
  /// that no camera has is refused.
  Result<std::span<const Sighting>> find(const imaging::DepthImage& image, const View& view);

 private:
  struct Vote {
    float forward, left;  ///< [m] of a body's middle
    float score;
    int order;  ///< among the candidates; of equal scores the first counts
  };
  DepthDetector(const imaging::Intrinsics& intrinsics, const DetectorConfig& config,
                const Network& network);
  Verdict look(const Candidate& candidate);
  static bool are_near(const Vote& a, const Vote& b, double reach);
  bool is_taken(const Vote& vote) const;
  float score_of(const Vote& best) const;
  Sighting settle(const Vote& best, float score) const;

  imaging::Intrinsics intrinsics_;
  DetectorConfig config_;
  Windows windows_;
  Classifier classifier_;
  Windows::Inputs inputs_{}, mirrored_{};
  std::vector<Vote> votes_, taken_;
  std::vector<Sighting> sightings_;
};

}  // namespace usher::people_detector
