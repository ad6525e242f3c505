#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "operations/people_study/scene.hpp"

namespace usher::operations {

/// What is drawn into a picture of a scene.
struct DrawnFindings {
  std::span<const people_detector::Sighting> usher;   ///< green boxes
  std::span<const people_detector::Sighting> thesis;  ///< orange rings
};

/// A scene as the detectors see it, without floor and ceiling: near is dark, nothing is white. Who
/// is there has a blue foot, red when Usher's detector missed who must be found.
cv::Mat draw_people(const people_study::Studio::Shot& shot, const imaging::Intrinsics& camera,
                    const DrawnFindings& findings, const std::string& title);

/// Pictures of one size in rows of `across`.
cv::Mat tile(const std::vector<cv::Mat>& pictures, int across);

}  // namespace usher::operations
