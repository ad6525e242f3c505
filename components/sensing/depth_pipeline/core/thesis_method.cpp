#include "sensing/depth_pipeline/core/thesis_method.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace usher::depth_pipeline {

namespace {
constexpr double kMostValue = 255.0;
constexpr double kNever = std::numeric_limits<double>::infinity();
}  // namespace

ThesisMethod::ThesisMethod(const Config& config) : config_(config) {
  for (std::size_t v = 0; v < threshold_.size(); ++v) {
    const auto value = static_cast<double>(v);
    threshold_[v] = config_.threshold_base + config_.threshold_growth * value * value;
  }
}

void ThesisMethod::process(const cv::Mat& image, const CameraPose& pose) {
  predict(image.rows, pose);
  valid_ = image.clone();
  valid_.setTo(kMostValue, image < 2);  // 4.8
  cv::morphologyEx(valid_, opened_, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  processed_ = opened_.clone();
  association_ = cv::Mat::zeros(opened_.size(), CV_8U);
  for (int row = 0; row < opened_.rows; ++row) {  // 4.20
    const auto index = static_cast<std::size_t>(row);
    for (int column = 0; column < opened_.cols; ++column) {
      const int value = opened_.at<std::uint8_t>(row, column);
      const bool ground = std::abs(value - ground_[index]) < threshold(value);
      const bool ceiling = value > ceiling_[index];
      if (!ground && !ceiling) continue;
      processed_.at<std::uint8_t>(row, column) = 255;
      if (value < 255) association_.at<std::uint8_t>(row, column) = ground ? 1 : 2;
    }
  }
  make_scan();
}

void ThesisMethod::predict(int rows, const CameraPose& pose) {
  ground_.assign(static_cast<std::size_t>(rows), kNever);
  ceiling_.assign(static_cast<std::size_t>(rows), kNever);
  // In the frame of figure 4.15, y down: the ground rises toward the camera's axis.
  const double m = -std::tan(pose.down);                                           // 4.13
  const double c_ground = pose.height / std::cos(pose.down);                       // 4.14
  const double c_ceiling = (pose.height - config_.ceiling) / std::cos(pose.down);  // 4.14
  for (int row = 0; row < rows; ++row) {
    const double angle = (row - 0.5 * rows) / rows * config_.vertical_fov;  // 4.10
    const double difference = std::tan(angle) - m;
    const auto index = static_cast<std::size_t>(row);
    const double ground = c_ground / difference;  // 4.18
    const double ceiling = c_ceiling / difference;
    if (ground > 0.0) ground_[index] = ground / config_.far * kMostValue;  // 4.19
    if (ceiling > 0.0) ceiling_[index] = ceiling / config_.far * kMostValue;
  }
}

void ThesisMethod::make_scan() {
  const int columns = processed_.cols;
  scan_.bearings.resize(static_cast<std::size_t>(columns));
  scan_.ranges.resize(static_cast<std::size_t>(columns));
  for (int column = 0; column < columns; ++column) {
    std::uint8_t nearest = 255;
    for (int row = 0; row < processed_.rows; ++row) {
      nearest = std::min(nearest, processed_.at<std::uint8_t>(row, column));
    }
    const double bearing = (column - 0.5 * columns) / columns * config_.horizontal_fov;  // 4.21
    const double depth = nearest / kMostValue * config_.far;                             // 4.9
    scan_.bearings[static_cast<std::size_t>(column)] = bearing;
    scan_.ranges[static_cast<std::size_t>(column)] = depth / std::cos(bearing);  // 4.22
  }
}

cv::Mat ThesisMethod::narrow(const DepthImage& image, double far) {
  cv::Mat narrow(image.height, image.width, CV_8U);
  const double scale = kMostValue / (far * 1e3);
  for (std::size_t i = 0; i < image.millimeters.size(); ++i) {
    narrow.data[i] =
        static_cast<std::uint8_t>(std::min(kMostValue, std::round(image.millimeters[i] * scale)));
  }
  return narrow;
}

}  // namespace usher::depth_pipeline
