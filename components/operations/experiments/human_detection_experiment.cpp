#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/people_pictures.hpp"
#include "operations/people_study/blob_baseline.hpp"
#include "operations/people_study/scoring.hpp"

namespace usher::operations {

namespace {

using people_detector::DepthDetector;
using people_detector::Sighting;
using people_study::BlobBaseline;
using people_study::Score;
using people_study::Studio;

constexpr int kScenes = 500;
constexpr std::uint64_t kNoise = 3;        // seed of the camera's noise in the thesis' cases
constexpr std::size_t kMistakes = 16;      // random scenes in the picture
constexpr const char* kBeyond = "beyond";  // cases that no figure of the thesis has
constexpr const char* kRandom = "random";

/// A way to find people.
struct Method {
  std::string key, title;
  std::function<std::vector<Sighting>(const Studio::Shot&)> find;
  std::map<std::string, Score> scores;  // by figure
};

/// "8.17" of "8.17 standing, from the front".
std::string figure_of(const std::string& scene) {
  const std::string first = scene.substr(0, scene.find(' '));
  return first.rfind("8.", 0) == 0 ? first : kBeyond;
}

std::string key_of(std::string figure) {
  std::replace(figure.begin(), figure.end(), '.', '_');
  return figure.rfind("8_", 0) == 0 ? "fig_" + figure : figure;
}

/// The thesis' blobs, each fix of 8.3.3 alone, all of them, and the shipped detector.
Result<std::vector<Method>> methods_for(const imaging::Intrinsics& camera) {
  std::vector<Method> methods;
  const auto add = [&](const char* key, const char* title, const BlobBaseline::Config& config) {
    auto blobs = std::make_shared<BlobBaseline>(camera, config);
    methods.push_back(
        {key,
         title,
         [blobs](const Studio::Shot& shot) { return blobs->find(shot.processed, shot.view); },
         {}});
  };
  add("thesis", "thesis", {});
  add("thesis_regions", "+ regions", {.regions = true});
  add("thesis_deviation", "+ deviation", {.deviation = true});
  add("thesis_area", "+ area by depth", {.area_by_depth = true});
  add("thesis_all", "+ all three", {.regions = true, .deviation = true, .area_by_depth = true});
  auto made = DepthDetector::make(camera, {});
  if (!made) return Error{made.error()};
  auto detector = std::make_shared<DepthDetector>(std::move(made).value());
  methods.push_back({"usher",
                     "Usher",
                     [detector](const Studio::Shot& shot) {
                       const auto found = detector->find(shot.processed, shot.view).value();
                       return std::vector<Sighting>(found.begin(), found.end());
                     },
                     {}});
  return methods;
}

/// "1 of 2, 1 false".
std::string in_words(const Score& score) {
  std::string text =
      std::to_string(score.found) + " of " + std::to_string(score.found + score.missed);
  if (score.false_alarms > 0) text += ", " + std::to_string(score.false_alarms) + " false";
  return text;
}

std::vector<std::string> header_of(const std::vector<Method>& methods, const char* first) {
  std::vector<std::string> header{first};
  for (const Method& method : methods) header.push_back(method.title);
  return header;
}

/// Every method on one scene; the findings of the first and of the last are drawn.
struct Judged {
  std::vector<Score> scores;
  cv::Mat picture;
};
Judged judge_scene(std::vector<Method>& methods, const Studio& studio, const Studio::Shot& shot,
                   const std::string& figure, const std::string& title) {
  Judged judged;
  std::vector<Sighting> thesis, usher;
  for (Method& method : methods) {
    const auto found = method.find(shot);
    judged.scores.push_back(people_study::judge(found, shot.truths));
    method.scores[figure] += judged.scores.back();
    if (&method == &methods.front()) thesis = found;
    usher = found;
  }
  judged.picture = draw_people(shot, studio.intrinsics(), {usher, thesis}, title);
  return judged;
}

Status save(const std::vector<cv::Mat>& pictures, const std::string& path) {
  if (pictures.empty()) return {};
  if (!cv::imwrite(path, tile(pictures, 4))) return Error{"cannot write " + path};
  return {};
}

/// The cases of the thesis' figures: one row each, one picture a figure.
Status judge_cases(std::vector<Method>& methods, Studio& studio, const std::string& out) {
  Table table(header_of(methods, "case"));
  std::map<std::string, std::vector<cv::Mat>> pictures;
  for (const auto& scene : people_study::thesis_scenes()) {
    const auto shot = studio.take(scene, kNoise);
    if (!shot) return Error{shot.error()};
    const std::string figure = figure_of(scene.name);
    const Judged judged = judge_scene(methods, studio, *shot, figure, scene.name);
    pictures[figure].push_back(judged.picture);
    std::vector<std::string> row{scene.name};
    for (const Score& score : judged.scores) row.push_back(in_words(score));
    table.add(row);
  }
  for (const auto& [figure, drawn] : pictures) {
    if (auto saved = save(drawn, out + "/" + key_of(figure) + ".png"); !saved) return saved;
  }
  return write_file(out + "/cases.md", table.markdown());
}

/// Random rooms; those in which the shipped detector errs are drawn.
Status judge_random(std::vector<Method>& methods, Studio& studio, int scenes,
                    const std::string& out) {
  std::vector<cv::Mat> mistakes;
  std::string csv = "seed,method,found,missed,false\n";
  for (int seed = 1; seed <= scenes; ++seed) {
    if (seed % 20 == 1) show_progress(std::to_string(seed - 1) + " of " + std::to_string(scenes));
    const auto random = static_cast<std::uint64_t>(seed);
    const auto shot = studio.take(people_study::random_scene(random), random);
    if (!shot) return Error{shot.error()};
    const Judged judged =
        judge_scene(methods, studio, *shot, kRandom, "random " + std::to_string(seed));
    const Score& usher = judged.scores.back();
    if (usher.missed + usher.false_alarms > 0 && mistakes.size() < kMistakes)
      mistakes.push_back(judged.picture);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const Score& score = judged.scores[i];
      csv += std::to_string(seed) + "," + methods[i].key + "," + std::to_string(score.found) + "," +
             std::to_string(score.missed) + "," + std::to_string(score.false_alarms) + "\n";
    }
  }
  show_progress("");
  if (auto saved = save(mistakes, out + "/random_mistakes.png"); !saved) return saved;
  return write_file(out + "/random.csv", csv);
}

/// Recall and precision by figure: a row each, and a metric each.
Status summarize(const std::vector<Method>& methods, const std::string& out, ResultSheet& sheet) {
  std::vector<std::string> header{"figure", "people"};
  for (const Method& method : methods) header.push_back(method.title + " recall / precision");
  Table table(header);
  for (const auto& [figure, usher] : methods.back().scores) {
    std::vector<std::string> row{figure, std::to_string(usher.found + usher.missed)};
    for (const Method& method : methods) {
      const Score& score = method.scores.at(figure);
      row.push_back(format("%.3f", score.recall()) + " / " + format("%.3f", score.precision()));
      const std::string key = method.key + "_" + key_of(figure);
      sheet.metrics[key + "_recall"] = score.recall();
      sheet.metrics[key + "_precision"] = score.precision();
    }
    table.add(row);
  }
  for (const Method& method : methods) {
    Score figures;
    for (const auto& [figure, score] : method.scores) {
      if (figure != kRandom) figures += score;
    }
    sheet.metrics[method.key + "_cases_recall"] = figures.recall();
    sheet.metrics[method.key + "_cases_precision"] = figures.precision();
  }
  for (const char* key : {"usher_cases_recall", "usher_cases_precision", "usher_random_recall",
                          "usher_random_precision"})
    sheet.targets[key] = {Bound::kAtLeast, 0.98};
  return write_file(out + "/figures.md", table.markdown());
}

}  // namespace

Result<ResultSheet> run_human_detection_experiment(const ExperimentOptions& options) {
  Studio studio;
  auto methods = methods_for(studio.intrinsics());
  if (!methods) return Error{methods.error()};
  const int scenes = options.seeds > 0 ? options.seeds : kScenes;
  ResultSheet sheet;
  sheet.name = "human-detection";
  sheet.input = "cases of thesis figures 8.16 to 8.21 and " + std::to_string(scenes) +
                " random rooms, rendered Kinect v2";
  if (auto status = judge_cases(*methods, studio, options.out); !status)
    return Error{status.error()};
  if (auto status = judge_random(*methods, studio, scenes, options.out); !status)
    return Error{status.error()};
  if (auto status = summarize(*methods, options.out, sheet); !status) return Error{status.error()};
  return sheet;
}

}  // namespace usher::operations
