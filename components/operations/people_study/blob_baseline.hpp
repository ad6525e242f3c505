#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "perception/people_detector/core/depth_detector.hpp"

namespace usher::people_study {

/// The people detector of thesis 4.4.3 for comparison: blobs of what the depth pipeline leaves,
/// and, one by one, what 8.3.3 proposes to make it better. What is farther than it looks counts as
/// background, as the thesis' figures suggest: else whoever stands before a wall is a part of it.
class BlobBaseline {
 public:
  struct Config {
    bool regions = false;        ///< segments the image by depth first
    bool deviation = false;      ///< only blobs whose depth deviates like that of people
    bool area_by_depth = false;  ///< an area in square metres, and so people up to 6 m
    double farthest = 2.0;       ///< [m] without area_by_depth
  };
  BlobBaseline(const imaging::Intrinsics& intrinsics, const Config& config);

  /// Nearest first. `image` is without floor and ceiling, of the size of the intrinsics.
  std::vector<people_detector::Sighting> find(const imaging::DepthImage& image,
                                              const people_detector::View& view);

 private:
  void find_blobs(const cv::Mat& depth, const people_detector::View& view,
                  std::vector<people_detector::Sighting>& sightings);

  imaging::Intrinsics intrinsics_;
  Config config_;
  cv::Ptr<cv::SimpleBlobDetector> detector_;
};

}  // namespace usher::people_study
