#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"
#include "operations/face_study/annotated.hpp"
#include "operations/face_study/stage.hpp"

namespace usher::operations {

namespace {

using face_detector::Box;
using face_detector::DepthModel;
using face_detector::FaceDetector;
using face_detector::FaceDetectorConfig;
using face_detector::FaceSample;
using face_study::Stage;

constexpr int kPoses = 100;  // of a seed
constexpr int kSeeds = 3;
constexpr std::size_t kFeatures = 11;
constexpr const char* kPhotographs = "photographs";
constexpr double kLeastPortrait = 60.0;  // [pixels]
constexpr double kAlike = 2.0;           // between the sizes of two rectangles around one face
constexpr double kHalfView = 0.45;  // of the distance: as far aside a face is whole in the image

/// Whether a rectangle is that of something at a point; of a face when the point has a width, the
/// face's: a much larger rectangle that happens to lie there is none.
bool covers(const Box& box, const Box& point) {
  if (point.width > 0.0 && std::abs(std::log(box.width / point.width)) > std::log(kAlike))
    return false;
  return std::abs(box.column() - point.left) < 0.5 * box.width &&
         std::abs(box.row() - point.top) < 0.5 * box.height;
}

Eigen::Vector3d face_of(const rendering::Body& body) { return rendering::head_of(body).middle; }

/// Where a face is in the image, and how wide.
Box place_of(const Stage& stage, const rendering::Body& body) {
  Box place = stage.pixel_of(face_of(body));
  place.width = 1.0 / (DepthModel().center.b * body.pose.x);
  return place;
}

/// Two people, one tall and one short, step back before the camera (report III-B-4): in the middle
/// of the image, or towards a side.
Result<face_detector::FittedModel> step_back(FaceDetector& anywhere, Stage& stage, bool center) {
  std::vector<FaceSample> samples;
  std::vector<std::uint16_t> scratch;
  const DepthModel usual;
  for (const double height : {1.65, 1.85}) {
    for (int step = 0; step < 46; ++step) {
      const double ahead = 0.8 + 0.06 * step;
      for (const double side : {-1.0, 1.0}) {
        const double left = side * ahead * (center ? 0.08 : 0.36);
        const auto body = face_study::standing(ahead, left, height);
        const auto& shot = stage.shoot({body});
        const Box place = stage.pixel_of(face_of(body));
        for (const auto& hit : anywhere.find_anywhere(shot.color())) {
          if (!covers(hit.box, place) || usual.is_center(hit.box.column(), shot.width) != center)
            continue;
          const auto depth = face_detector::middle_depth(shot.depth(), hit.box, {}, scratch);
          if (depth) samples.push_back({hit.box.width, *depth});
        }
      }
    }
  }
  return face_detector::fit_size_model(samples);
}

struct Judged {
  const char* name;
  int found = 0;            // poses whose face was found
  int false_positives = 0;  // over all poses
  std::array<bool, kFeatures> taken{};
  int features() const { return static_cast<int>(std::count(taken.begin(), taken.end(), true)); }
};

template <class Boxes>
void judge(const Boxes& boxes, const Box& face, const std::vector<Box>& features, Judged& judged) {
  bool found = false;
  for (const auto& one : boxes) {
    if (covers(one.box, face)) {
      found = true;
      continue;
    }
    ++judged.false_positives;
    for (std::size_t i = 0; i < features.size(); ++i)
      judged.taken[i] = judged.taken[i] || covers(one.box, features[i]);
  }
  judged.found += found;
}

void draw(cv::Mat& picture, const Box& box, const cv::Scalar& color, int thickness) {
  cv::rectangle(picture, cv::Rect2d(box.left, box.top, box.width, box.height), color, thickness,
                cv::LINE_AA);
}

/// Refused rectangles in red, those of our search in green.
cv::Mat drawn(const Stage::Shot& shot, const std::vector<face_detector::Hit>& hits,
              std::span<const face_detector::Face> faces) {
  const cv::Mat rgb(shot.height, shot.width, CV_8UC3, const_cast<std::uint8_t*>(shot.rgb.data()));
  cv::Mat picture;
  cv::cvtColor(rgb, picture, cv::COLOR_RGB2BGR);
  for (const auto& hit : hits) draw(picture, hit.box, {60, 60, 220}, 1);
  for (const auto& face : faces) draw(picture, face.box, {80, 190, 60}, 3);
  return picture;
}

/// The head of a shot, as large at any distance, with what was found.
cv::Mat tile_of(const Stage::Shot& shot, const Box& head, double ahead,
                const std::vector<face_detector::Hit>& hits,
                std::span<const face_detector::Face> faces) {
  const int half = cvRound(120.0 / ahead);
  const cv::Rect part(cvRound(head.left) - half, cvRound(head.top) - half, 2 * half, 2 * half);
  cv::Mat tile;
  cv::resize(drawn(shot, hits, faces)(part & cv::Rect(0, 0, shot.width, shot.height)), tile,
             {96, 96}, 0.0, 0.0, cv::INTER_LINEAR);
  return tile;
}

/// Photographed faces at one distance.
struct Photographed {
  double ahead = 0.0;  // [m]
  Judged cascade{"cascade"}, algorithm{"algorithm 6"}, search{"search"};
  std::vector<cv::Mat> tiles;
};

Result<std::vector<Photographed>> look_at_photographs(const std::vector<cv::Mat>& portraits) {
  auto detector = FaceDetector::make(face_detector::cascade_file("alt", ""), {});
  if (!detector) return Error{detector.error()};
  std::vector<Photographed> all{{1.25}, {1.5}, {2.0}, {2.5}, {3.0}};
  for (const cv::Mat& portrait : portraits) {
    auto face = rendering::Texture::make(portrait.cols, {portrait.data, 3 * portrait.total()});
    if (!face) return Error{face.error()};
    auto stage = Stage::make(0, 3, {std::move(face).value()});
    if (!stage) return Error{stage.error()};
    for (Photographed& one : all) {
      const auto body = face_study::standing(one.ahead, 0.05 * one.ahead, 1.75);
      const auto& shot = stage->shoot({body});
      const Box head = place_of(*stage, body);
      const auto hits = detector->find_anywhere(shot.color());
      judge(hits, head, {}, one.cascade);
      judge(*detector->find_as_printed(shot.color(), shot.depth()), head, {}, one.algorithm);
      const auto faces = detector->find(shot.color(), shot.depth());
      judge(*faces, head, {}, one.search);
      one.tiles.push_back(tile_of(shot, head, one.ahead, hits, *faces));
    }
  }
  return all;
}

/// Photographed faces on the same bodies: what is found of them, by distance.
Status try_photographs(const ExperimentOptions& options, ResultSheet& sheet) {
  const auto portraits = face_study::read_portraits(options.data + "/faces", kLeastPortrait);
  if (!portraits) return Error{portraits.error()};
  const auto all = look_at_photographs(*portraits);
  if (!all) return Error{all.error()};
  Table table({"photographed faces at", "shown", "the cascade finds", "algorithm 6", "our search"});
  cv::Mat picture;
  double near = 0.0;
  for (const Photographed& one : *all) {
    table.add({format("%.2f m", one.ahead), std::to_string(portraits->size()),
               std::to_string(one.cascade.found), std::to_string(one.algorithm.found),
               std::to_string(one.search.found)});
    const double share = one.search.found / static_cast<double>(portraits->size());
    sheet.metrics["photographed_sensitivity_at_" + format("%.2f_m", one.ahead)] = share;
    if (one.ahead <= 2.0) near += share / 3.0;
    cv::Mat row;
    cv::hconcat(one.tiles, row);
    picture.push_back(row);
  }
  sheet.metrics["photographed_sensitivity_to_2_m"] = near;
  sheet.targets["photographed_sensitivity_to_2_m"] = {Bound::kAtLeast, 0.9};
  std::printf("%s\n", table.text().c_str());
  const std::string file = options.out + "/photographs.png";
  if (!cv::imwrite(file, picture)) return Error{"cannot write " + file};
  return write_file(options.out + "/photographs.md", table.markdown());
}

Status draw_roc(const std::vector<Judged>& all, double poses, const std::string& path) {
  constexpr std::array<std::array<int, 3>, 4> kColors{
      {{200, 60, 50}, {210, 150, 40}, {40, 100, 190}, {60, 150, 80}}};
  std::vector<Curve> curves;
  for (const Judged& one : all) {
    const auto& color = kColors[curves.size() % kColors.size()];
    const double x = static_cast<double>(one.features()) / kFeatures, y = one.found / poses;
    const double nan = std::nan("");
    constexpr double kWide = 0.008, kHigh = 0.015;  // a cross
    curves.push_back(
        {one.name,
         color[0],
         color[1],
         color[2],
         {{x - kWide, y}, {x + kWide, y}, {nan, nan}, {x, y - kHigh}, {x, y + kHigh}}});
  }
  curves.push_back({"", 255, 255, 255, {{1.0, 1.0}}});  // the whole axes
  return draw_plot(curves, "Experiment D, simulated: alt without and with depth models",
                   "1 - specificity: things ever taken for a face, of 11", "sensitivity", path);
}

}  // namespace

Result<ResultSheet> run_depth_model_experiment(const ExperimentOptions& options) {
  const auto only = only_of(options.only, {kPhotographs});
  if (!only) return Error{only.error()};
  auto empty = Stage::make(0, 1);
  auto stage = Stage::make(kFeatures, 2);
  auto anywhere = FaceDetector::make(face_detector::cascade_file("alt", ""), {});
  if (!empty || !stage) return Error{empty ? stage.error() : empty.error()};
  if (!anywhere) return Error{anywhere.error()};

  ResultSheet sheet;
  sheet.name = "depth-model";
  if (only->name == kPhotographs) {
    if (options.data.empty()) return Error{"USHER_TEST_DATA names no folder with faces/"};
    sheet.input = "a rendered room, people with photographed faces, alt";
    if (Status shown = try_photographs(options, sheet); !shown) return Error{shown.error()};
    return sheet;
  }
  show_progress("two people step back");
  const auto center = step_back(*anywhere, *empty, true);
  const auto side = step_back(*anywhere, *empty, false);
  if (!center || !side) return Error{center ? side.error() : center.error()};
  FaceDetectorConfig first, second;
  first.model = {center->model, center->model};
  second.model = {center->model, side->model};
  auto model_1 = FaceDetector::make(face_detector::cascade_file("alt", ""), first);
  auto model_2 = FaceDetector::make(face_detector::cascade_file("alt", ""), second);
  if (!model_1 || !model_2) return Error{model_1 ? model_2.error() : model_1.error()};

  std::vector<Box> features;
  for (const auto& feature : stage->features()) features.push_back(stage->pixel_of(feature));
  std::vector<Judged> all{{"no model"}, {"depth model 1"}, {"depth model 2"}, {"our search"}};
  std::string csv = "ahead,left,height,none,model_1,model_2,search\n";
  // Other places than the hundred by which the rules of the search were chosen (stream 4).
  Random random(stream_seed(5, "poses"));
  const int poses = kPoses * (options.seeds > 0 ? options.seeds : kSeeds);
  cv::Mat pictures;
  for (int pose = 0; pose < poses; ++pose) {
    show_progress(std::to_string(pose + 1) + " of " + std::to_string(poses));
    const double ahead = random.uniform(1.25, 3.3);
    const auto body = face_study::standing(ahead, ahead * random.uniform(-kHalfView, kHalfView),
                                           random.uniform(1.6, 1.85));
    const auto& shot = stage->shoot({body});
    const Box face = place_of(*stage, body);
    const std::array<int, 4> before{all[0].found, all[1].found, all[2].found, all[3].found};
    const auto hits = anywhere->find_anywhere(shot.color());
    judge(hits, face, features, all[0]);
    judge(*model_1->find_as_printed(shot.color(), shot.depth()), face, features, all[1]);
    judge(*model_2->find_as_printed(shot.color(), shot.depth()), face, features, all[2]);
    const auto found = model_2->find(shot.color(), shot.depth());
    judge(*found, face, features, all[3]);
    csv +=
        format("%.3f,", body.pose.x) + format("%.3f,", body.pose.y) + format("%.3f", body.height);
    for (std::size_t i = 0; i < all.size(); ++i) csv += all[i].found > before[i] ? ",1" : ",0";
    csv += "\n";
    if (pose < 4) pictures.push_back(drawn(shot, hits, *found));
  }
  show_progress("");

  sheet.input = "a rendered room, one person at " + std::to_string(poses) +
                " places, 11 things that cascades take for faces, alt";
  Table table({"", "found of " + std::to_string(poses), "false positives",
               "things ever taken for a face, of 11"});
  const std::array<const char*, 4> keys{"none", "model_1", "model_2", "search"};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string key = keys[i];
    table.add({all[i].name, std::to_string(all[i].found), std::to_string(all[i].false_positives),
               std::to_string(all[i].features())});
    sheet.metrics[key + "_sensitivity"] = all[i].found / static_cast<double>(poses);
    sheet.metrics[key + "_false_positives"] = all[i].false_positives;
    sheet.metrics[key + "_things_taken"] = all[i].features();
  }
  sheet.metrics["center_residual_percent"] = 100.0 * center->residual;
  sheet.metrics["side_residual_percent"] = 100.0 * side->residual;
  sheet.published["model_2_false_positives"] = 0;
  sheet.targets["search_false_positives"] = {Bound::kAtMost, 0};
  sheet.targets["search_sensitivity"] = {Bound::kAtLeast, sheet.metrics["none_sensitivity"]};
  sheet.flags["every_thing_is_taken_for_a_face_without_depth"] = all[0].features() == kFeatures;
  std::printf("%s\n", table.text().c_str());
  if (!options.data.empty()) {
    const Status shown = try_photographs(options, sheet);
    if (!shown) return Error{shown.error()};
  }
  Status saved = write_file(options.out + "/models.md", table.markdown());
  if (saved) saved = write_file(options.out + "/poses.csv", csv);
  if (saved) saved = draw_roc(all, poses, options.out + "/roc.png");
  if (saved && !cv::imwrite(options.out + "/poses.png", pictures))
    saved = Error{"cannot write " + options.out + "/poses.png"};
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
