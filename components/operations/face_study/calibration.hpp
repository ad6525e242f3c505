#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/kinect/core/recording.hpp"
#include "perception/face_detector/core/face_detector.hpp"

namespace usher::face_study {

/// Faces of somebody who steps back from the camera (meeting report III-B-4).
struct FaceSamples {
  std::vector<face_detector::FaceSample> center, side;
  int images = 0;
};

/// Adds the faces of a recording with depth and color: of each pair of images the one that most
/// windows agree on. `progress` hears each image's number. The error names the file.
Status add_samples(const kinect::Recording& recording, face_detector::FaceDetector& anywhere,
                   FaceSamples& samples, const std::function<void(std::size_t)>& progress);

struct FaceCalibration {
  face_detector::FittedModel center, side;
};

/// The pair of models. Refused with the reason, and with the part of the image.
Result<FaceCalibration> fit_models(const FaceSamples& samples);

/// For the robot's file.
std::string as_yaml(const FaceCalibration& found);

}  // namespace usher::face_study
