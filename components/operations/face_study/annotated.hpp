#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "foundation/imaging/color_image.hpp"
#include "foundation/result/result.hpp"
#include "perception/face_detector/core/face_detector.hpp"

namespace usher::face_study {

/// A photograph with boxes around the faces in it, drawn by hand.
struct AnnotatedPicture {
  std::string name;
  cv::Mat rgb;  ///< 8 bits, three channels, contiguous
  std::vector<cv::Rect2d> faces;

  imaging::ColorImage view() const { return {rgb.cols, rgb.rows, {rgb.data, 3 * rgb.total()}}; }
};

/// All pictures below `folder`: dlib/training.xml and testing.xml with their boxes, and
/// bristol/dart<N>.jpg with dart<N>points.csv (x, y, width, height; an empty file: no face). Errors
/// name the file.
Result<std::vector<AnnotatedPicture>> read_annotated(const std::string& folder);

/// Faces of photographs as the simulator's people wear them (rendering/core/texture.hpp): upright
/// by eyes and chin, exposed by the face, 128 x 128 pixels. Those of dlib/*_with_face_landmarks.xml
/// below `folder` whose box is at least `least` pixels wide. Errors name the file.
Result<std::vector<cv::Mat>> read_portraits(const std::string& folder, double least);

/// How a detector did.
struct FaceScore {
  int faces = 0, found = 0, false_positives = 0, pictures = 0;

  double sensitivity() const { return faces > 0 ? static_cast<double>(found) / faces : 0.0; }
  double false_per_picture() const {
    return pictures > 0 ? static_cast<double>(false_positives) / pictures : 0.0;
  }
  FaceScore& operator+=(const FaceScore& other);
};

/// A box is a face when it and one drawn by hand have 35 % of their union in common; each one
/// counts once.
FaceScore judge(const std::vector<face_detector::Hit>& hits, const std::vector<cv::Rect2d>& faces);

}  // namespace usher::face_study
