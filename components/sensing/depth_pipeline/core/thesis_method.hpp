#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "sensing/depth_pipeline/core/camera.hpp"

namespace usher::depth_pipeline {

/// The pipeline as the MARVIN thesis prints it (section 4.4.1, figure 4.18), on 8-bit images: what
/// experiments and benchmarks compare with, never what a robot runs. Only the printed slips are
/// corrected: c = h / cos(pitch) in 4.14, and the sign of the ceiling's height.
class ThesisMethod {
 public:
  struct Config {
    double vertical_fov = 1.0471975511965976;  ///< [rad] 60 deg
    double horizontal_fov = 1.2322024524;      ///< [rad] 70.6 deg
    double far = 12.0;                         ///< [m] of the value 255
    double ceiling = 2.0;                      ///< [m]
    /// Figure 4.16: the threshold over the value; ours, its values are not printed.
    double threshold_base = 2.0;
    double threshold_growth = 1.5e-3;  ///< times the square of the value
  };

  explicit ThesisMethod(const Config& config);

  struct Scan {
    std::vector<double> bearings;  ///< [rad] of each column, to the right (4.21)
    std::vector<double> ranges;    ///< [m] (4.22), `far` and more: nothing
  };

  /// An 8-bit image; every intermediate picture stays until the next call.
  void process(const cv::Mat& image, const CameraPose& pose);

  const cv::Mat& opened() const { return opened_; }           ///< figure 4.12
  const cv::Mat& associated() const { return association_; }  ///< 4.17a: 1 ground, 2 ceiling
  const cv::Mat& processed() const { return processed_; }     ///< figure 4.17b, 255 = removed
  const Scan& scan() const { return scan_; }
  /// 4.19, of each row; beyond 255: not in the image.
  const std::vector<double>& ground() const { return ground_; }
  const std::vector<double>& ceiling() const { return ceiling_; }
  double threshold(int value) const { return threshold_[static_cast<std::size_t>(value)]; }

  /// A depth image in millimetres as the 8-bit image of the thesis.
  static cv::Mat narrow(const DepthImage& image, double far);

 private:
  void predict(int rows, const CameraPose& pose);
  void make_scan();

  Config config_;
  std::array<double, 256> threshold_{};
  std::vector<double> ground_, ceiling_;
  cv::Mat valid_, opened_, association_, processed_;
  Scan scan_;
};

}  // namespace usher::depth_pipeline
