#include "operations/experiments/people_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "operations/people_study/scoring.hpp"

namespace usher::operations {

namespace {

constexpr double kFar = 7.0;        // [m] the lightest gray
constexpr double kHalfBody = 0.25;  // [m]
constexpr double kSame = 0.5;       // [m] as people_study::judge pairs
constexpr double kShrunk = 0.7;
constexpr int kTitleHeight = 24;  // [pixels]
const cv::Scalar kGreen(60, 170, 40), kOrange(30, 140, 250), kBlue(230, 130, 30), kRed(40, 40, 230);

/// Where a point of the scene is in the image.
class Projection {
 public:
  Projection(const imaging::Intrinsics& camera, const people_detector::View& view)
      : camera_(camera), view_(view) {}
  cv::Point operator()(double forward, double left, double height) const {
    const double below = view_.height - height;
    const double depth =
        std::max(0.1, forward * std::cos(view_.down) + below * std::sin(view_.down));
    const double y = below * std::cos(view_.down) - forward * std::sin(view_.down);
    return {static_cast<int>(std::lround(camera_.cx - camera_.fx * left / depth)),
            static_cast<int>(std::lround(camera_.cy + camera_.fy * y / depth))};
  }

 private:
  imaging::Intrinsics camera_;
  people_detector::View view_;
};

bool is_found(const people_study::Truth& truth,
              std::span<const people_detector::Sighting> findings) {
  return std::any_of(findings.begin(), findings.end(), [&](const auto& one) {
    return std::hypot(one.forward - truth.forward, one.left - truth.left) <= kSame;
  });
}

}  // namespace

cv::Mat draw_people(const people_study::Studio::Shot& shot, const imaging::Intrinsics& camera,
                    const DrawnFindings& findings, const std::string& title) {
  cv::Mat picture(shot.processed.height, shot.processed.width, CV_8UC3);
  std::size_t pixel = 0;
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const double depth = 1e-3 * shot.processed.millimeters[pixel++];
      const auto gray =
          static_cast<std::uint8_t>(depth > 0.0 ? 30.0 + 190.0 * std::min(1.0, depth / kFar) : 255);
      picture.at<cv::Vec3b>(row, column) = {gray, gray, gray};
    }
  }
  const Projection at(camera, shot.view);
  for (const auto& one : findings.thesis)
    cv::circle(picture, at(one.forward, one.left, 1.0), 26, kOrange, 5, cv::LINE_AA);
  for (const auto& one : findings.usher) {
    const double top = std::max(0.5, one.height);
    cv::rectangle(picture, at(one.forward, one.left + kHalfBody, top),
                  at(one.forward, one.left - kHalfBody, 0.0), kGreen, 4, cv::LINE_AA);
  }
  for (const auto& truth : shot.truths) {
    if (truth.area <= 0.0) continue;
    const bool missed = truth.area >= people_study::kVisible && !is_found(truth, findings.usher);
    cv::Point foot = at(truth.forward, truth.left, 0.05);
    foot.y = std::min(foot.y, picture.rows - 8);
    cv::circle(picture, foot, 8, missed ? kRed : kBlue, -1, cv::LINE_AA);
  }
  cv::resize(picture, picture, {}, kShrunk, kShrunk, cv::INTER_AREA);
  cv::Mat framed(picture.rows + kTitleHeight + 4, picture.cols + 4, CV_8UC3,
                 cv::Scalar(255, 255, 255));
  picture.copyTo(framed(cv::Rect(2, kTitleHeight, picture.cols, picture.rows)));
  cv::rectangle(framed, cv::Rect(2, kTitleHeight, picture.cols, picture.rows),
                cv::Scalar(200, 200, 200));
  cv::putText(framed, title, {5, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(20, 20, 20), 1,
              cv::LINE_AA);
  return framed;
}

cv::Mat tile(const std::vector<cv::Mat>& pictures, int across) {
  std::vector<cv::Mat> rows;
  for (std::size_t i = 0; i < pictures.size(); i += static_cast<std::size_t>(across)) {
    std::vector<cv::Mat> row;
    for (std::size_t k = i; k < i + static_cast<std::size_t>(across); ++k) {
      row.push_back(k < pictures.size()
                        ? pictures[k]
                        : cv::Mat(pictures[0].size(), CV_8UC3, cv::Scalar(255, 255, 255)));
    }
    cv::hconcat(row, rows.emplace_back());
  }
  cv::Mat all;
  if (!rows.empty()) cv::vconcat(rows, all);
  return all;
}

}  // namespace usher::operations
