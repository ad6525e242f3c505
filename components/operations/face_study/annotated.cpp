#include "operations/face_study/annotated.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "simulation/rendering/core/texture.hpp"

namespace usher::face_study {

namespace {

namespace fs = std::filesystem;

constexpr double kShared = 0.35;
constexpr int kDarts = 16;

Result<AnnotatedPicture> read_picture(const fs::path& path) {
  const cv::Mat bgr = cv::imread(path.string(), cv::IMREAD_COLOR);
  if (bgr.empty()) return Error{path.string() + ": no picture"};
  AnnotatedPicture picture;
  picture.name = path.stem().string();
  cv::cvtColor(bgr, picture.rgb, cv::COLOR_BGR2RGB);
  return picture;
}

/// Calls `visit` with each <image> and its picture.
template <class Visit>
Status each_image(const fs::path& file, const Visit& visit) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.string().c_str()) != tinyxml2::XML_SUCCESS)
    return Error{file.string() + ": " + document.ErrorStr()};
  const auto* images = tinyxml2::XMLHandle(document)
                           .FirstChildElement("dataset")
                           .FirstChildElement("images")
                           .ToElement();
  if (images == nullptr) return Error{file.string() + ": expected <dataset><images>"};
  for (const auto* image = images->FirstChildElement("image"); image != nullptr;
       image = image->NextSiblingElement("image")) {
    const char* name = image->Attribute("file");
    if (name == nullptr) return Error{file.string() + ": an image without a file"};
    auto picture = read_picture(file.parent_path() / name);
    if (!picture) return Error{picture.error()};
    visit(*image, std::move(picture).value());
  }
  return {};
}

template <class Visit>
void each_box(const tinyxml2::XMLElement& image, const Visit& visit) {
  for (const auto* box = image.FirstChildElement("box"); box != nullptr;
       box = box->NextSiblingElement("box"))
    visit(*box);
}

Status read_dlib(const fs::path& file, std::vector<AnnotatedPicture>& pictures) {
  return each_image(file, [&](const tinyxml2::XMLElement& image, AnnotatedPicture picture) {
    each_box(image, [&](const tinyxml2::XMLElement& box) {
      picture.faces.emplace_back(box.DoubleAttribute("left"), box.DoubleAttribute("top"),
                                 box.DoubleAttribute("width"), box.DoubleAttribute("height"));
    });
    pictures.push_back(std::move(picture));
  });
}

/// Landmarks of the 68-point scheme: 36 to 47 lie around the eyes, 8 is the chin.
struct Landmarks {
  cv::Point2d eyes{0, 0}, chin{0, 0};
  int found = 0;
};
constexpr int kLandmarks = 13;

Landmarks landmarks_of(const tinyxml2::XMLElement& box) {
  Landmarks marks;
  for (const auto* part = box.FirstChildElement("part"); part != nullptr;
       part = part->NextSiblingElement("part")) {
    const int number = part->IntAttribute("name", -1);
    const cv::Point2d at(part->DoubleAttribute("x"), part->DoubleAttribute("y"));
    const bool eye = number >= 36 && number < 48;
    if (eye) marks.eyes += at / 12.0;
    if (number == 8) marks.chin = at;
    marks.found += eye || number == 8;
  }
  return marks;
}

/// As the automatic exposure of a camera has it: the gray of a face's middle, by gain alone.
void expose(cv::Mat& portrait) {
  constexpr double kGray = 135.0, kMostGain = 3.0;
  const int side = portrait.cols;
  cv::Mat gray;
  cv::cvtColor(portrait(cv::Rect(side / 4, side / 4, side / 2, 5 * side / 8)), gray,
               cv::COLOR_RGB2GRAY);
  const double mean = std::max(1.0, cv::mean(gray)[0]);
  portrait.convertTo(portrait, -1, std::min(kMostGain, kGray / mean));
}

/// Eyes where drawn_face() has them, and the chin 0.12 m below them on a head of 0.1 m radius.
cv::Mat portrait(const cv::Mat& rgb, const Landmarks& marks) {
  constexpr double kSide = 128.0, kEyes = -0.12, kChin = 0.85;
  const cv::Point2d down = marks.chin - marks.eyes;
  const double scale = 0.5 * kSide * (kChin - kEyes) / cv::norm(down);
  const double turn = std::atan2(-down.x, down.y);
  const double c = scale * std::cos(turn), s = scale * std::sin(turn);
  const double wide_c = rendering::kFaceAspect * c, wide_s = rendering::kFaceAspect * s;
  const cv::Point2d eyes(0.5 * kSide, 0.5 * kSide * (1.0 + kEyes));
  const cv::Matx23d to_portrait(wide_c, wide_s,
                                eyes.x - wide_c * marks.eyes.x - wide_s * marks.eyes.y,  //
                                -s, c, eyes.y + s * marks.eyes.x - c * marks.eyes.y);
  cv::Mat upright;
  cv::warpAffine(rgb, upright, to_portrait, {static_cast<int>(kSide), static_cast<int>(kSide)},
                 cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  expose(upright);
  return upright;
}

/// Four numbers with commas between them; nothing when the line is something else.
std::optional<cv::Rect2d> box_of(const std::string& line) {
  double values[4] = {};
  const char* at = line.data();
  const char* end = at + line.size();
  for (double& value : values) {
    while (at < end && (*at == ' ' || *at == ',' || *at == '\t')) ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{}) return std::nullopt;
    at = next;
  }
  return cv::Rect2d(values[0], values[1], values[2], values[3]);
}

Status read_bristol(const fs::path& folder, std::vector<AnnotatedPicture>& pictures) {
  for (int i = 0; i < kDarts; ++i) {
    const std::string name = "dart" + std::to_string(i);
    if (!fs::exists(folder / (name + ".jpg"))) continue;
    auto picture = read_picture(folder / (name + ".jpg"));
    if (!picture) return Error{picture.error()};
    const fs::path points = folder / (name + "points.csv");
    std::ifstream stream(points);
    if (!stream) return Error{points.string() + ": cannot be opened"};
    for (std::string line; std::getline(stream, line);) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      const auto box = box_of(line);
      if (!box) return Error{points.string() + ": expected x, y, width, height, found " + line};
      picture->faces.push_back(*box);
    }
    pictures.push_back(std::move(picture).value());
  }
  return {};
}

}  // namespace

Result<std::vector<AnnotatedPicture>> read_annotated(const std::string& folder) {
  std::vector<AnnotatedPicture> pictures;
  const fs::path root = folder;
  for (const char* name : {"training.xml", "testing.xml"}) {
    if (!fs::exists(root / "dlib" / name)) continue;
    if (const auto status = read_dlib(root / "dlib" / name, pictures); !status)
      return Error{status.error()};
  }
  if (const auto status = read_bristol(root / "bristol", pictures); !status)
    return Error{status.error()};
  if (pictures.empty())
    return Error{folder + ": expected dlib/testing.xml or bristol/dart0.jpg, found neither"};
  return pictures;
}

Result<std::vector<cv::Mat>> read_portraits(const std::string& folder, double least) {
  std::vector<cv::Mat> portraits;
  for (const char* name : {"training", "testing"}) {
    const fs::path file =
        fs::path(folder) / "dlib" / (std::string(name) + "_with_face_landmarks.xml");
    const Status read =
        each_image(file, [&](const tinyxml2::XMLElement& image, const AnnotatedPicture& picture) {
          each_box(image, [&](const tinyxml2::XMLElement& box) {
            const Landmarks marks = landmarks_of(box);
            if (box.DoubleAttribute("width") >= least && marks.found == kLandmarks)
              portraits.push_back(portrait(picture.rgb, marks));
          });
        });
    if (!read) return Error{read.error()};
  }
  if (portraits.empty()) return Error{folder + ": no face with landmarks is that large"};
  return portraits;
}

FaceScore& FaceScore::operator+=(const FaceScore& other) {
  faces += other.faces, found += other.found;
  false_positives += other.false_positives, pictures += other.pictures;
  return *this;
}

FaceScore judge(const std::vector<face_detector::Hit>& hits, const std::vector<cv::Rect2d>& faces) {
  FaceScore score;
  score.pictures = 1;
  score.faces = static_cast<int>(faces.size());
  std::vector<bool> taken(faces.size(), false);
  for (const auto& hit : hits) {
    const cv::Rect2d box(hit.box.left, hit.box.top, hit.box.width, hit.box.height);
    double best = kShared;
    std::size_t which = faces.size();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const double common = (box & faces[i]).area();
      const double share = common / (box.area() + faces[i].area() - common);
      if (!taken[i] && share >= best) best = share, which = i;
    }
    if (which == faces.size()) {
      ++score.false_positives;
    } else {
      taken[which] = true;
      ++score.found;
    }
  }
  return score;
}

}  // namespace usher::face_study
