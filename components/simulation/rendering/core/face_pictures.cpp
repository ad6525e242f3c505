#include "simulation/rendering/core/face_pictures.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace usher::rendering {

namespace {
constexpr int kSide = 128;           // [pixels]
constexpr std::size_t kMost = 1000;  // pictures
}  // namespace

Result<std::vector<Texture>> load_faces(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string kind = at->path().extension().string();
    if (kind == ".png" || kind == ".jpg" || kind == ".pgm") files.push_back(at->path());
  }
  if (error) return Error{folder + ": " + error.message()};
  if (files.empty() || files.size() > kMost) {
    return Error{folder + ": expected 1 to " + std::to_string(kMost) +
                 " pictures (png, jpg, pgm), found " + std::to_string(files.size())};
  }
  std::sort(files.begin(), files.end());
  std::vector<Texture> faces;
  faces.reserve(files.size());
  for (const fs::path& file : files) {
    cv::Mat picture = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (picture.empty()) return Error{file.string() + ": no picture"};
    cv::resize(picture, picture, {kSide, kSide}, 0.0, 0.0, cv::INTER_AREA);
    cv::cvtColor(picture, picture, cv::COLOR_BGR2RGB);
    auto face = Texture::make(kSide, {picture.data, 3 * picture.total()});
    if (!face) return Error{file.string() + ": " + face.error()};
    faces.push_back(std::move(face).value());
  }
  return faces;
}

}  // namespace usher::rendering
