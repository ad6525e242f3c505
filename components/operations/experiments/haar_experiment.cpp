#include <array>
#include <ctime>

#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/face_study/annotated.hpp"

namespace usher::operations {

namespace {

using face_detector::FaceDetector;
using face_study::AnnotatedPicture;
using face_study::FaceScore;
using face_study::judge;

constexpr int kLargestThreshold = 12;

struct Color {
  int red, green, blue;
};
constexpr std::array<Color, 5> kColors{
    {{200, 60, 50}, {40, 100, 190}, {60, 150, 80}, {150, 90, 170}, {210, 150, 40}}};

struct CascadeFigures {
  FaceScore score;
  double milliseconds = 0.0;                      // of a picture, mean
  std::vector<std::pair<double, double>> points;  // false positives a picture, sensitivity
};

/// The hits that more than `threshold` windows agree on.
std::vector<face_detector::Hit> above(const std::vector<face_detector::Hit>& hits, int threshold) {
  std::vector<face_detector::Hit> rest;
  for (const auto& hit : hits) {
    if (hit.neighbors > threshold) rest.push_back(hit);
  }
  return rest;
}

Result<CascadeFigures> measure(const std::string& name,
                               const std::vector<AnnotatedPicture>& pictures) {
  auto usual = FaceDetector::make(face_detector::cascade_file(name, ""), {});
  face_detector::FaceDetectorConfig generous;
  generous.neighbors = 1;
  auto all = FaceDetector::make(face_detector::cascade_file(name, ""), generous);
  if (!usual || !all) return Error{usual ? all.error() : usual.error()};
  CascadeFigures figures;
  std::vector<FaceScore> scores(kLargestThreshold);
  for (const AnnotatedPicture& picture : pictures) {
    show_progress(name + ", " + picture.name);
    const std::clock_t start = std::clock();  // of the processor, whoever else works on it
    const auto hits = usual->find_anywhere(picture.view());
    const double took = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    figures.milliseconds += took / static_cast<double>(pictures.size());
    figures.score += judge(hits, picture.faces);
    const auto every = all->find_anywhere(picture.view());
    for (int i = 0; i < kLargestThreshold; ++i)
      scores[static_cast<std::size_t>(i)] += judge(above(every, i + 1), picture.faces);
  }
  for (const FaceScore& score : scores)
    figures.points.emplace_back(score.false_per_picture(), score.sensitivity());
  return figures;
}

/// What the meeting report found with its own pictures; 0 = no figure.
double published_sensitivity(const std::string& name) {
  if (name == "alt") return 0.744;
  if (name == "default") return 0.758;
  return 0.0;
}

}  // namespace

Result<ResultSheet> run_haar_experiment(const ExperimentOptions& options) {
  if (options.data.empty())
    return Error{"no pictures: USHER_TEST_DATA must name a folder with faces/"};
  const auto pictures = face_study::read_annotated(options.data + "/faces");
  if (!pictures) return Error{pictures.error()};

  ResultSheet sheet;
  sheet.name = "haar";
  Table table({"cascade", "found", "sensitivity", "the report's", "false positives", "a picture",
               "ms a picture"});
  std::string csv = "cascade,threshold,false_positives_per_picture,sensitivity\n";
  std::vector<Curve> curves;
  int faces = 0;
  for (const std::string& name : face_detector::cascade_names()) {
    const auto figures = measure(name, *pictures);
    if (!figures) return Error{figures.error()};
    const FaceScore& score = figures->score;
    faces = score.faces;
    const double published = published_sensitivity(name);
    table.add({name, std::to_string(score.found) + " of " + std::to_string(score.faces),
               format("%.3f", score.sensitivity()),
               published > 0.0 ? format("%.3f", published) : "",
               std::to_string(score.false_positives), format("%.2f", score.false_per_picture()),
               format("%.0f", figures->milliseconds)});
    sheet.metrics[name + "_sensitivity"] = score.sensitivity();
    sheet.metrics[name + "_false_positives"] = score.false_positives;
    sheet.metrics[name + "_ms"] = figures->milliseconds;
    if (published > 0.0) sheet.published[name + "_sensitivity"] = published;
    const Color& color = kColors[curves.size() % kColors.size()];
    curves.push_back({name, color.red, color.green, color.blue, figures->points});
    for (std::size_t i = 0; i < figures->points.size(); ++i) {
      csv += name + "," + std::to_string(i + 1) + format(",%.4f", figures->points[i].first) +
             format(",%.4f\n", figures->points[i].second);
    }
  }
  show_progress("");
  sheet.input = std::to_string(pictures->size()) + " annotated photographs, " +
                std::to_string(faces) + " faces, whole images, 3 neighbors, sizes 1.1 apart";
  sheet.targets["alt_sensitivity"] = {Bound::kAtLeast, 0.744};
  sheet.targets["default_sensitivity"] = {Bound::kAtLeast, 0.758};
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/cascades.md", table.markdown());
  if (saved) saved = write_file(options.out + "/roc.csv", csv);
  if (saved) {
    saved = draw_plot(curves,
                      "Cascades on annotated photographs; along a curve 2 to 13 windows must agree",
                      "false positives in a picture", "sensitivity", options.out + "/roc.png");
  }
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
