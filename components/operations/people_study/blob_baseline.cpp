#include "operations/people_study/blob_baseline.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace usher::people_study {

namespace {

using people_detector::Sighting;

constexpr double kFar = 12.0;                         // [m] that 255 means (thesis 4.9)
constexpr double kApart = 3.0;                        // [pixels] by which the background grows
constexpr double kRegion = 1.0;                       // [m] of depth
constexpr double kFarthest = 6.0;                     // [m] with an area by depth
constexpr double kLeastArea = 0.12, kMostArea = 0.9;  // [m^2]
constexpr double kLeastDeviation = 0.04, kMostDeviation = 0.22;  // [m]
constexpr float kLeastPixels = 3000.0F, kMostPixels = 60000.0F;

}  // namespace

BlobBaseline::BlobBaseline(const imaging::Intrinsics& intrinsics, const Config& config)
    : intrinsics_(intrinsics), config_(config) {
  cv::SimpleBlobDetector::Params params;
  params.filterByColor = true;
  params.blobColor = 255;
  params.minThreshold = 1;
  params.maxThreshold = 3;
  params.thresholdStep = 1;
  params.minRepeatability = 1;
  params.minDistBetweenBlobs = 1;
  params.filterByArea = true;
  params.minArea = config.area_by_depth ? 200.0F : kLeastPixels;
  params.maxArea = config.area_by_depth ? 150000.0F : kMostPixels;
  params.filterByInertia = true;
  params.minInertiaRatio = 0.0F;
  params.maxInertiaRatio = 0.3F;
  params.filterByConvexity = params.filterByCircularity = false;
  detector_ = cv::SimpleBlobDetector::create(params);
}

void BlobBaseline::find_blobs(const cv::Mat& depth, const people_detector::View& view,
                              std::vector<Sighting>& sightings) {
  const double reach = config_.area_by_depth ? kFarthest : config_.farthest;
  const cv::Mat foreground = (depth > 0) & (depth <= 1e3 * reach);
  cv::Mat distance, apart, labels;
  cv::distanceTransform(foreground, distance, cv::DIST_L2, 3);
  apart = distance > kApart;
  std::vector<cv::KeyPoint> blobs;
  detector_->detect(apart, blobs);
  cv::connectedComponents(apart, labels, 4);
  for (const cv::KeyPoint& blob : blobs) {
    const int column = std::clamp(cvRound(blob.pt.x), 0, depth.cols - 1);
    const int row = std::clamp(cvRound(blob.pt.y), 0, depth.rows - 1);
    const double z = 1e-3 * depth.at<std::uint16_t>(row, column);
    if (z <= 0.0) continue;
    const cv::Mat region = labels == labels.at<int>(row, column);
    if (config_.area_by_depth) {
      const double area = cv::countNonZero(region) * z * z / (intrinsics_.fx * intrinsics_.fy);
      if (area < kLeastArea || area > kMostArea) continue;
    }
    if (config_.deviation) {
      cv::Scalar mean, deviation;
      cv::meanStdDev(depth, mean, deviation, region);
      if (1e-3 * deviation[0] < kLeastDeviation || 1e-3 * deviation[0] > kMostDeviation) continue;
    }
    const double y = (row - intrinsics_.cy) / intrinsics_.fy;
    sightings.push_back({z * (std::cos(view.down) - y * std::sin(view.down)) + 0.1,
                         (intrinsics_.cx - column) / intrinsics_.fx * z, 0.0, 1.0});
  }
}

std::vector<Sighting> BlobBaseline::find(const imaging::DepthImage& image,
                                         const people_detector::View& view) {
  const cv::Mat whole(image.height, image.width, CV_16UC1,
                      const_cast<std::uint16_t*>(image.millimeters.data()));  // NOLINT: only read
  cv::Mat bytes, depth;  // 8 bits, as in the thesis
  whole.convertTo(bytes, CV_8U, 255.0 / (1e3 * kFar));
  bytes.convertTo(depth, CV_16U, 1e3 * kFar / 255.0);
  std::vector<Sighting> sightings;
  if (config_.regions) {
    for (int region = 0; region * kRegion < kFarthest; ++region) {
      const double near = region * kRegion;
      const cv::Mat inside = (depth > 1e3 * near) & (depth <= 1e3 * (near + kRegion));
      cv::Mat slice = cv::Mat::zeros(depth.size(), CV_16U);
      depth.copyTo(slice, inside);
      find_blobs(slice, view, sightings);
    }
  } else {
    find_blobs(depth, view, sightings);
  }
  std::sort(sightings.begin(), sightings.end(), [](const Sighting& a, const Sighting& b) {
    return std::hypot(a.forward, a.left) < std::hypot(b.forward, b.left);
  });
  return sightings;
}

}  // namespace usher::people_study
