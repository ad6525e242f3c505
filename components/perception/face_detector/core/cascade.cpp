#include "perception/face_detector/core/cascade.hpp"

#include <algorithm>
#include <tuple>

namespace usher::face_detector {

namespace {

constexpr double kSimilar = 0.2;  // of the side: what OpenCV's detectMultiScale takes for one

bool before(const cv::Rect& a, const cv::Rect& b) {
  return std::tie(a.y, a.x, a.width, a.height) < std::tie(b.y, b.x, b.width, b.height);
}

}  // namespace

Result<Cascade> Cascade::load(const std::string& path) {
  cv::setNumThreads(1);  // a component owns no threads, and these would not pay
  Cascade cascade;
  bool loaded = false;
  std::string reason = "is no cascade, or is missing: Debian's package opencv-data has them";
  try {
    loaded = cascade.classifier_.load(path);
  } catch (const cv::Exception& exception) {
    reason = "is no cascade: " + exception.err;
  }
  if (!loaded) return Error{path + " " + reason};
  const cv::Size window = cascade.classifier_.getOriginalWindowSize();
  if (window.width != window.height || window.width < 8) {
    return Error{path + ": expected a cascade of square windows, found " +
                 std::to_string(window.width) + " x " + std::to_string(window.height)};
  }
  cascade.window_ = window.width;
  return cascade;
}

void Cascade::search(const cv::Mat& gray, double step, int least, int most, cv::Point offset,
                     std::vector<cv::Rect>& hits) {
  if (gray.cols < least || gray.rows < least || least > most) return;
  classifier_.detectMultiScale(gray, found_, step, 0, 0, {least, least}, {most, most});
  for (const cv::Rect& box : found_) hits.push_back(box + offset);
}

std::vector<Agreement> group(std::vector<cv::Rect>& windows, int neighbors) {
  std::sort(windows.begin(), windows.end(), before);
  windows.erase(std::unique(windows.begin(), windows.end()), windows.end());
  std::vector<cv::Rect> boxes = windows;
  std::vector<int> counts;
  cv::groupRectangles(boxes, counts, std::max(1, neighbors), kSimilar);
  std::vector<Agreement> hits;
  for (std::size_t i = 0; i < boxes.size(); ++i) hits.push_back({boxes[i], counts[i]});
  std::sort(hits.begin(), hits.end(),
            [](const Agreement& a, const Agreement& b) { return before(a.box, b.box); });
  return hits;
}

}  // namespace usher::face_detector
