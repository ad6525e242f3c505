#pragma once

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::face_detector {

/// A trained cascade of OpenCV [viola2004faces], Haar or LBP, on one thread and with results in an
/// order of their own: the same image gives the same hits.
class Cascade {
 public:
  /// Reads OpenCV's XML; the error names the file and what Debian package has it.
  static Result<Cascade> load(const std::string& path);
  Cascade(Cascade&&) = default;
  Cascade& operator=(Cascade&&) = default;

  /// Side [pixels] of the smallest window, the one that it was trained with.
  int window() const { return window_; }

  /// All windows of the sizes window() * step^n in [least, most] that pass; places as OpenCV
  /// samples them. Appends to `hits`, moved by `offset`.
  void search(const cv::Mat& gray, double step, int least, int most, cv::Point offset,
              std::vector<cv::Rect>& hits);

 private:
  Cascade() = default;
  cv::CascadeClassifier classifier_;
  int window_ = 0;
  std::vector<cv::Rect> found_;
};

/// A rectangle that several windows agree on.
struct Agreement {
  cv::Rect box;       ///< [pixels]
  int neighbors = 1;  ///< windows that agree
};

/// Rectangles that at least `neighbors` windows agree on, by position; sorts `windows` and takes
/// repetitions out.
std::vector<Agreement> group(std::vector<cv::Rect>& windows, int neighbors);

}  // namespace usher::face_detector
