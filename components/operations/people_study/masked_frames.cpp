#include "operations/people_study/masked_frames.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace usher::people_study {

namespace {

constexpr std::string_view kEnding = "_depth.png";
constexpr std::uint8_t kPerson = 128;

Result<imaging::Intrinsics> read_camera(const std::string& path, const cv::Size& size) {
  cv::Mat matrix;
  try {
    const cv::FileStorage file(path, cv::FileStorage::READ);
    if (file.isOpened()) file["intrinsic"] >> matrix;
  } catch (const cv::Exception& e) {
    return Error{path + ": " + e.what()};
  }
  if (matrix.rows != 3 || matrix.cols != 3) return Error{path + ": expected a 3 x 3 'intrinsic'"};
  matrix.convertTo(matrix, CV_64F);
  const imaging::Intrinsics camera{size.width,
                                   size.height,
                                   matrix.at<double>(0, 0),
                                   matrix.at<double>(1, 1),
                                   matrix.at<double>(0, 2),
                                   matrix.at<double>(1, 2)};
  if (const Status status = imaging::check(camera); !status)
    return Error{path + ": " + status.error()};
  return camera;
}

Result<MaskedFrame> read_frame(const std::string& path) {
  const cv::Mat depth = cv::imread(path + "_depth.png", cv::IMREAD_UNCHANGED);
  if (depth.type() != CV_16UC1 || depth.empty())
    return Error{path + "_depth.png: expected an image of one channel of 16 bits"};
  const cv::Mat mask = cv::imread(path + "_mask.jpg", cv::IMREAD_GRAYSCALE);
  if (mask.size() != depth.size())
    return Error{path + "_mask.jpg: expected an image of " + std::to_string(depth.cols) + " x " +
                 std::to_string(depth.rows)};
  const auto camera = read_camera(path + "_camera.xml", depth.size());
  if (!camera) return Error{camera.error()};
  MaskedFrame frame{std::filesystem::path(path).filename().string(), *camera, {}, {}};
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      frame.millimeters.push_back(depth.at<std::uint16_t>(row, column));
      frame.mask.push_back(mask.at<std::uint8_t>(row, column) >= kPerson);
    }
  }
  return frame;
}

}  // namespace

Result<std::vector<MaskedFrame>> read_masked_frames(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.ends_with(kEnding)) paths.push_back(path.substr(0, path.size() - kEnding.size()));
  }
  if (paths.empty()) return Error{folder + ": no *_depth.png"};
  std::sort(paths.begin(), paths.end());
  std::vector<MaskedFrame> frames;
  for (const std::string& path : paths) {
    auto frame = read_frame(path);
    if (!frame) return Error{frame.error()};
    frames.push_back(std::move(frame).value());
  }
  return frames;
}

}  // namespace usher::people_study
