#include "operations/experiments/depth_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace usher::operations {

namespace {

constexpr int kSide = 560;        // [pixels] of a view from above
constexpr double kReach = 5.5;    // [m]
constexpr int kTitleHeight = 26;  // [pixels]

cv::Point pixel_of(const cv::Point2d& point) {
  const double scale = kSide / (kReach + 0.5);
  return {static_cast<int>(std::lround(0.5 * kSide - point.y * scale)),
          static_cast<int>(std::lround(kSide - 0.3 * scale - point.x * scale))};
}

void write(cv::Mat& picture, const std::string& text, const cv::Point& at,
           const cv::Scalar& color) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat gray_depth(const imaging::DepthImage& image, double far) {
  cv::Mat gray = depth_pipeline::ThesisMethod::narrow(image, far);
  gray.setTo(255, gray == 0);
  return gray;
}

cv::Mat colored_planes(const cv::Mat& gray, const cv::Mat& association) {
  cv::Mat color;
  cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  color.setTo(cv::Scalar(90, 170, 80), association == 1);
  color.setTo(cv::Scalar(200, 130, 60), association == 2);
  return color;
}

std::vector<cv::Point2d> points_of(const depth_pipeline::ScanGeometry& geometry,
                                   const std::vector<float>& ranges) {
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (!std::isfinite(ranges[i])) continue;
    const double bearing = geometry.angle_min + static_cast<double>(i) * geometry.increment;
    const auto range = static_cast<double>(ranges[i]);
    points.emplace_back(range * std::cos(bearing), range * std::sin(bearing));
  }
  return points;
}

std::vector<cv::Point2d> points_of(const depth_pipeline::ThesisMethod::Scan& scan, double far) {
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (scan.ranges[i] >= far) continue;
    points.emplace_back(scan.ranges[i] * std::cos(scan.bearings[i]),
                        -scan.ranges[i] * std::sin(scan.bearings[i]));
  }
  return points;
}

cv::Mat draw_scans(const std::vector<DrawnScan>& scans, const std::string& title) {
  cv::Mat picture(kSide, kSide, CV_8UC3, cv::Scalar(40, 40, 40));
  for (int meter = -6; meter <= 6; ++meter) {
    const cv::Scalar line(75, 75, 75);
    cv::line(picture, pixel_of({-1.0, static_cast<double>(meter)}),
             pixel_of({kReach, static_cast<double>(meter)}), line);
    cv::line(picture, pixel_of({static_cast<double>(meter), -kReach}),
             pixel_of({static_cast<double>(meter), kReach}), line);
  }
  cv::circle(picture, pixel_of({0.0, 0.0}), 6, cv::Scalar(60, 60, 220), -1, cv::LINE_AA);
  int row = 40;
  for (const DrawnScan& scan : scans) {
    for (const cv::Point2d& point : scan.points)
      cv::circle(picture, pixel_of(point), 1, scan.color, -1, cv::LINE_AA);
    write(picture, scan.label, {10, row}, scan.color);
    row += 18;
  }
  write(picture, title, {10, 20}, cv::Scalar(230, 230, 230));
  return picture;
}

void mark_picture(cv::Mat& picture, const std::vector<Mark>& marks) {
  for (const Mark& mark : marks) {
    const cv::Point at(cvRound(mark.place.x), cvRound(mark.place.y));
    cv::circle(picture, at, 10, cv::Scalar(255, 255, 255), -1, cv::LINE_AA);
    cv::circle(picture, at, 10, cv::Scalar(40, 40, 220), 2, cv::LINE_AA);
    write(picture, mark.number, at + cv::Point(-4, 5), cv::Scalar(20, 20, 20));
  }
}

void mark_scans(cv::Mat& picture, const std::vector<Mark>& marks) {
  std::vector<Mark> in_pixels = marks;
  for (Mark& mark : in_pixels) mark.place = pixel_of(mark.place);
  mark_picture(picture, in_pixels);
}

Status save_row(const std::vector<std::pair<std::string, cv::Mat>>& pictures,
                const std::string& path) {
  int height = 0;
  for (const auto& [title, picture] : pictures) height = std::max(height, picture.rows);
  std::vector<cv::Mat> tiles;
  for (const auto& [title, picture] : pictures) {
    cv::Mat color;
    if (picture.channels() == 1) {
      cv::cvtColor(picture, color, cv::COLOR_GRAY2BGR);
    } else {
      color = picture;
    }
    cv::Mat tile(height + kTitleHeight, color.cols + 6, CV_8UC3, cv::Scalar(255, 255, 255));
    color.copyTo(tile(cv::Rect(3, kTitleHeight, color.cols, color.rows)));
    write(tile, title, {6, 18}, cv::Scalar(20, 20, 20));
    tiles.push_back(tile);
  }
  cv::Mat row;
  cv::hconcat(tiles, row);
  if (!cv::imwrite(path, row)) return Error{"cannot write " + path};
  return {};
}

}  // namespace usher::operations
