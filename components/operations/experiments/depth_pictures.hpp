#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "sensing/depth_pipeline/core/thesis_method.hpp"

namespace usher::operations {

/// Depth as the thesis prints it: black is near, white far or nothing. `far` [m] is white.
cv::Mat gray_depth(const imaging::DepthImage& image, double far);
/// Figure 4.17a: green floor, blue ceiling over the grey image.
cv::Mat colored_planes(const cv::Mat& gray, const cv::Mat& association);

/// One scan of several that are drawn over one another, seen from above.
struct DrawnScan {
  std::string label;
  cv::Scalar color;                 ///< blue, green, red
  std::vector<cv::Point2d> points;  ///< [m] ahead, left of the robot
};
std::vector<cv::Point2d> points_of(const depth_pipeline::ScanGeometry& geometry,
                                   const std::vector<float>& ranges);
std::vector<cv::Point2d> points_of(const depth_pipeline::ThesisMethod::Scan& scan, double far);
/// Figure 4.20b: the robot below in the middle, a grid of 1 m.
cv::Mat draw_scans(const std::vector<DrawnScan>& scans, const std::string& title);

/// A point of interest, as in table 4.1, in a picture or in a view from above.
struct Mark {
  std::string number;
  cv::Point2d place;  ///< pixels; [m] ahead, left of the robot
};
void mark_picture(cv::Mat& picture, const std::vector<Mark>& marks);
void mark_scans(cv::Mat& picture, const std::vector<Mark>& marks);

/// Pictures of one size beside one another, each with its title.
Status save_row(const std::vector<std::pair<std::string, cv::Mat>>& pictures,
                const std::string& path);

}  // namespace usher::operations
