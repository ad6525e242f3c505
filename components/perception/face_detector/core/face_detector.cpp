#include "perception/face_detector/core/face_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "perception/face_detector/core/cascade.hpp"
#include "perception/face_detector/core/cell_map.hpp"

namespace usher::face_detector {

namespace {

constexpr int kBeside = 2;           // sizes that are looked at beside those that passed
constexpr double kAround = 0.2;      // of a window, that is looked at around those that passed
constexpr double kOfAWindow = 0.35;  // of the depth: those of one face differ that much in size
constexpr double kSlack = 0.05;      // of the depth, over half a size

Status check_pair(const imaging::ColorImage& color, const imaging::DepthImage& depth) {
  const auto words = [](int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
  };
  if (color.width < 1 || color.height < 1 ||
      color.rgb.size() !=
          3 * static_cast<std::size_t>(color.width) * static_cast<std::size_t>(color.height)) {
    return Error{"a color image of " + words(color.width, color.height) + " carries " +
                 std::to_string(color.rgb.size()) + " bytes"};
  }
  if (depth.width != color.width || depth.height != color.height ||
      depth.millimeters.size() * 3 != color.rgb.size()) {
    return Error{"the depth image must have the size of the color image, " +
                 words(color.width, color.height) + ", got " + words(depth.width, depth.height)};
  }
  return {};
}

/// What looking for windows costs whose middles lie in a box: the windows, and, less, the pixels.
double cost(const cv::Rect& box, int margin) {
  constexpr double kPixel = 0.25;
  return box.area() + kPixel * (box.width + margin) * (box.height + margin);
}

/// Boxes are searched as one where that costs less.
void merge(std::vector<cv::Rect>& boxes, int margin) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t k = i + 1; k < boxes.size(); ++k) {
      const cv::Rect both = boxes[i] | boxes[k];
      if (cost(both, margin) > cost(boxes[i], margin) + cost(boxes[k], margin)) continue;
      boxes[i] = both;
      boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(k));
      k = i;  // the larger one may meet those before
    }
  }
}

/// The marked cells as boxes [pixels]: runs of columns in bands as high as half a window.
void boxes_of(const cv::Mat& marks, int side, std::vector<cv::Rect>& boxes) {
  const int band = std::max(2, side / (2 * CellMap::kCell));
  for (int top = 0; top < marks.rows; top += band) {
    const int bottom = std::min(marks.rows, top + band);
    int start = -1;
    for (int column = 0; column <= marks.cols; ++column) {
      bool marked = false;
      for (int row = top; row < bottom && column < marks.cols; ++row)
        marked = marked || marks.at<std::uint8_t>(row, column) != 0;
      if (marked && start < 0) start = column;
      if (marked || start < 0) continue;
      boxes.emplace_back(cv::Point(start, top) * CellMap::kCell,
                         cv::Size(column - start, bottom - top) * CellMap::kCell);
      start = -1;
    }
  }
}

cv::Rect grown(const cv::Rect& box, int by) {
  return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

}  // namespace

const std::vector<std::string>& cascade_names() {
  static const std::vector<std::string> names{"default", "alt", "alt2", "alt_tree", "lbp"};
  return names;
}

std::string cascade_file(const std::string& name, const std::string& folder) {
  const std::string root = folder.empty() ? USHER_CASCADES : folder;
  if (name == "lbp") return root + "/lbpcascades/lbpcascade_frontalface.xml";
  return root + "/haarcascades/haarcascade_frontalface_" + name + ".xml";
}

/// Where the cascade is asked, and what it says.
struct FaceDetector::Search {
  Search(Cascade with, const FaceDetectorConfig& values);
  void make_gray(const imaging::ColorImage& color);
  /// Marks the cells where the middle of a window of this side can be; false when there are none.
  bool mark(int side);
  void look_roughly(int side);
  void look_closely();
  std::vector<Hit> hits();

  Cascade cascade;
  FaceDetectorConfig config;
  std::vector<int> sides;  // [pixels] of the windows
  cv::Mat gray, reduced, marks;
  CellMap cells;
  std::vector<cv::Rect> regions, windows, rough, close;
  double searched = 0.0;
};

FaceDetector::Search::Search(Cascade with, const FaceDetectorConfig& values)
    : cascade(std::move(with)), config(values) {
  const double most = std::max(config.model.center.most, config.model.side.most);
  for (double factor = 1.0; factor * cascade.window() <= most; factor *= config.step)
    sides.push_back(cvRound(factor * cascade.window()));
  if (sides.empty()) sides.push_back(cascade.window());
}

Result<FaceDetector> FaceDetector::make(const std::string& cascade_file,
                                        const FaceDetectorConfig& config) {
  for (const SizeModel* model : {&config.model.center, &config.model.side}) {
    if (const auto status = check(*model); !status) return Error{status.error()};
  }
  const auto& rules = config.rules;
  if (!(rules.near > 0.0 && rules.near < rules.far && rules.far < 60.0))
    return Error{"faces must be looked for between two distances within (0, 60) m"};
  if (!(rules.tolerance > 0.0 && rules.tolerance < 1.0 && rules.middle > 0.0 &&
        rules.middle <= 1.0 && rules.measured >= 0.0 && rules.measured <= 1.0 &&
        rules.whole >= 0.0 && rules.whole <= 1.0)) {
    return Error{"tolerance, middle, measured and whole share must be in (0, 1)"};
  }
  if (!(config.step >= 1.05 && config.step <= 1.5) || config.neighbors < 1)
    return Error{"the step between sizes must be in [1.05, 1.5], neighbors at least 1"};
  auto cascade = Cascade::load(cascade_file);
  if (!cascade) return Error{cascade.error()};
  return FaceDetector(std::make_unique<Search>(std::move(cascade).value(), config));
}

FaceDetector::FaceDetector(std::unique_ptr<Search> search)
    : config_(search->config), search_(std::move(search)) {}
FaceDetector::FaceDetector(FaceDetector&&) noexcept = default;
FaceDetector& FaceDetector::operator=(FaceDetector&&) noexcept = default;
FaceDetector::~FaceDetector() = default;

double FaceDetector::searched() const { return search_->searched; }

void FaceDetector::Search::make_gray(const imaging::ColorImage& color) {
  // OpenCV's matrices know no constant memory; this one is only read.
  const cv::Mat rgb(color.height, color.width, CV_8UC3,
                    const_cast<std::uint8_t*>(color.rgb.data()));
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  cv::equalizeHist(gray, gray);
}

bool FaceDetector::Search::mark(int side) {
  const auto& rules = config.rules;
  // One size of the rough ladder is enough for a depth: cascades forgive as much.
  const double most = config.step * (1.0 + kSlack);
  const auto span_of = [&](const SizeModel& model) {
    if (!model.holds(side)) return CellMap::Span{};
    const double depth = model.depth(side);
    return CellMap::Span{std::max(rules.near, depth / most), std::min(rules.far, depth * most)};
  };
  marks.create(cells.rows(), cells.columns(), CV_8UC1);
  const int count =
      cells.mark(side, span_of(config.model.center), span_of(config.model.side), config.model,
                 rules.relief, {marks.ptr<std::uint8_t>(), marks.total()});
  if (count == 0) return false;
  // The middle that algorithm 6 measures reaches this far into the cells beside.
  const int reach = static_cast<int>(std::ceil(0.5 * rules.middle * side / CellMap::kCell));
  cv::dilate(marks, marks,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
  return true;
}

void FaceDetector::Search::look_roughly(int side) {
  regions.clear();
  boxes_of(marks, side, regions);
  merge(regions, side);
  const cv::Rect image({0, 0}, gray.size());
  const int window = cascade.window();
  const double scale = static_cast<double>(side) / window;
  for (const cv::Rect& middles : regions) {
    const cv::Rect region = grown(middles, side / 2 + 1) & image;
    if (region.width < side || region.height < side) continue;
    const cv::Size size(cvRound(region.width / scale), cvRound(region.height / scale));
    cv::resize(gray(region), reduced, size, 0.0, 0.0, cv::INTER_LINEAR);
    searched += static_cast<double>((middles & image).area());
    windows.clear();
    cascade.search(reduced, config.step, window, window, {}, windows);
    for (const cv::Rect& hit : windows) {
      rough.emplace_back(region.x + cvRound(hit.x * scale), region.y + cvRound(hit.y * scale), side,
                         side);
    }
  }
}

void FaceDetector::Search::look_closely() {
  // What lies together is looked at as one, with the sizes of all of it.
  std::vector<cv::Rect> clusters;
  for (const cv::Rect& hit : rough)
    clusters.push_back(grown(hit, cvRound(kAround * hit.width)) & cv::Rect({0, 0}, gray.size()));
  merge(clusters, 0);
  const double beside = std::pow(config.step, kBeside + 0.5);
  close.clear();
  for (const cv::Rect& cluster : clusters) {
    int least = sides.back(), most = 0;
    for (const cv::Rect& hit : rough) {
      if (!cluster.contains((hit.tl() + hit.br()) / 2)) continue;
      least = std::min(least, hit.width), most = std::max(most, hit.width);
    }
    if (most == 0) continue;
    cascade.search(gray(cluster), config.step, std::max(cascade.window(), cvRound(least / beside)),
                   cvRound(most * beside), cluster.tl(), close);
  }
}

std::vector<Hit> FaceDetector::Search::hits() {
  std::vector<Hit> all;
  for (const Agreement& one : group(close, config.neighbors)) {
    const cv::Rect2d box = one.box;
    all.push_back({{box.x, box.y, box.width, box.height}, one.neighbors});
  }
  return all;
}

void FaceDetector::judge(const std::vector<Hit>& hits, const imaging::DepthImage& depth,
                         const Plausibility& rules) {
  faces_.clear();
  for (const Hit& hit : hits) {
    const auto measured = middle_depth(depth, hit.box, rules, scratch_);
    if (!measured || !plausible(hit.box, *measured, depth.width, config_.model, rules)) continue;
    if (rules.relief > 0.0 && search_->cells.relief(hit.box.column(), hit.box.row(), hit.box.width,
                                                    *measured) < rules.relief)
      continue;
    if (rules.whole > 0.0 && share_at(depth, hit.box, *measured) < rules.whole) continue;
    faces_.push_back({hit.box, *measured, hit.neighbors});
  }
  std::sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) {
    return std::tie(a.depth, a.box.left, a.box.top) < std::tie(b.depth, b.box.left, b.box.top);
  });
  if (faces_.size() > kMostFaces) faces_.resize(kMostFaces);
}

/// Windows that another surface is behind, say a picture on the wall beside a head, must not
/// become one with those of the head.
void FaceDetector::drop_implausible(const imaging::DepthImage& depth) {
  Plausibility rules = config_.rules;
  rules.tolerance = std::max(rules.tolerance, kOfAWindow);
  std::erase_if(search_->close, [&](const cv::Rect& window) {
    const cv::Rect2d wide = window;
    const Box box{wide.x, wide.y, wide.width, wide.height};
    const auto measured = middle_depth(depth, box, rules, scratch_);
    return !measured || !plausible(box, *measured, depth.width, config_.model, rules);
  });
}

Result<std::span<const Face>> FaceDetector::find(const imaging::ColorImage& color,
                                                 const imaging::DepthImage& depth) {
  if (const auto status = check_pair(color, depth); !status) return Error{status.error()};
  Search& s = *search_;
  s.make_gray(color);
  s.cells.measure(depth);
  s.rough.clear();
  s.searched = 0.0;
  for (std::size_t i = 0; i < s.sides.size(); i += 2) {
    const int side = s.sides[i];
    if (side > std::min(color.width, color.height)) break;
    if (s.mark(side)) s.look_roughly(side);
  }
  s.searched /= static_cast<double>(s.gray.total() * s.sides.size());
  s.look_closely();
  drop_implausible(depth);
  judge(s.hits(), depth, config_.rules);
  return std::span<const Face>(faces_);
}

std::vector<Hit> FaceDetector::find_anywhere(const imaging::ColorImage& color) {
  Search& s = *search_;
  s.make_gray(color);
  s.close.clear();
  s.cascade.search(s.gray, config_.step, s.cascade.window(), s.sides.back(), {}, s.close);
  return s.hits();
}

Result<std::span<const Face>> FaceDetector::find_as_printed(const imaging::ColorImage& color,
                                                            const imaging::DepthImage& depth) {
  if (const auto status = check_pair(color, depth); !status) return Error{status.error()};
  Plausibility printed = config_.rules;
  printed.relief = printed.whole = 0.0;
  judge(find_anywhere(color), depth, printed);
  return std::span<const Face>(faces_);
}

}  // namespace usher::face_detector
