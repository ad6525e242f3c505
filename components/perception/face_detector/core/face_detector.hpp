#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "foundation/imaging/color_image.hpp"
#include "foundation/imaging/depth_image.hpp"
#include "perception/face_detector/core/depth_model.hpp"

namespace usher::face_detector {

struct FaceDetectorConfig {
  DepthModel model;
  Plausibility rules;
  double step = 1.1;  ///< {1.05..1.5} between the sizes that are looked for
  int neighbors = 3;  ///< {1..} windows that must agree
};

/// The cascades of Debian's opencv-data that this is made for, by name: default, alt, alt2,
/// alt_tree, lbp.
const std::vector<std::string>& cascade_names();
/// File of a cascade below the folder with haarcascades/ and lbpcascades/; an empty folder is the
/// one that was found when this was built.
std::string cascade_file(const std::string& name, const std::string& folder);

/// What a cascade takes for a face.
struct Hit {
  Box box;            ///< [pixels]
  int neighbors = 0;  ///< windows that agree
};

struct Face {
  Box box;             ///< [pixels]
  double depth = 0.0;  ///< [m] along the optical axis
  int neighbors = 0;   ///< windows that agree
};

/// Faces in a color image whose depth image is known pixel by pixel (meeting report III-B-4). What
/// the report does to the cascade's rectangles afterwards (algorithms 5 and 6) comes first here: a
/// window is looked at only where the depth lets expect a face of its size.
///
/// 1. The depth image, in cells of 8 pixels, says for every second size where a window's middle can
///    be: at the right distance, before what is beside it.
/// 2. There the cascade looks at every second place, on an image that is reduced so that a face
///    fills its smallest window.
/// 3. Around what passes it looks again as closely, and at the sizes beside, as over a whole image;
///    windows whose depth cannot be are dropped, the others grouped and judged by algorithm 6.
///
/// So a face that algorithm 5 finds is missed only where not one window of the second step
/// passes. Deterministic. At most 30 ms for 640 x 480 on one core (usher bench faces).
class FaceDetector {
 public:
  static constexpr std::size_t kMostFaces = 32;

  /// Reads the cascade, blocking. The error says which value, or what of the file, cannot be.
  static Result<FaceDetector> make(const std::string& cascade_file,
                                   const FaceDetectorConfig& config);
  FaceDetector(FaceDetector&&) noexcept;
  FaceDetector& operator=(FaceDetector&&) noexcept;
  ~FaceDetector();

  /// The faces of an image, the nearest first; valid until the next call. The error says why the
  /// two images are no pair.
  Result<std::span<const Face>> find(const imaging::ColorImage& color,
                                     const imaging::DepthImage& depth);

  /// Algorithm 5 as printed: the cascade over the whole image, then algorithm 6.
  Result<std::span<const Face>> find_as_printed(const imaging::ColorImage& color,
                                                const imaging::DepthImage& depth);
  /// Its first line alone: what the cascade takes for faces, without any depth.
  std::vector<Hit> find_anywhere(const imaging::ColorImage& color);

  /// Share of all windows of a search over the whole image, in pixels, that the last find() looked
  /// at: what the depth saves.
  double searched() const;
  const FaceDetectorConfig& config() const { return config_; }

 private:
  struct Search;
  explicit FaceDetector(std::unique_ptr<Search> search);
  void drop_implausible(const imaging::DepthImage& depth);
  void judge(const std::vector<Hit>& hits, const imaging::DepthImage& depth,
             const Plausibility& rules);

  FaceDetectorConfig config_;
  std::unique_ptr<Search> search_;
  std::vector<std::uint16_t> scratch_;
  std::vector<Face> faces_;
};

}  // namespace usher::face_detector
