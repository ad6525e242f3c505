#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/people_pictures.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/people_study/blob_baseline.hpp"
#include "operations/people_study/leg_scans.hpp"
#include "operations/people_study/masked_frames.hpp"
#include "operations/people_study/scoring.hpp"

namespace usher::operations {

namespace {

using geometry::Point2;
using people_study::LegRecording;
using people_study::MarkedScan;
using people_study::MaskedFrame;
using people_study::Score;

constexpr double kFarthest = 7.0;       // [m]
constexpr double kSameLeg = 0.15;       // [m] from a mark to the middle of a leg
constexpr double kSamePerson = 0.5;     // [m] to the middle of a person, as detectors are judged
constexpr double kBodyDepth = 0.1;      // [m] from the visible surface to the body's middle
constexpr double kCameraHeight = 1.45;  // [m] at which who stands there is 1.7 m tall
constexpr std::array kHeights{1.1, 1.25, kCameraHeight, 1.65};  // the lowest: as trained
constexpr double kOfTheWall = 0.15;  // [m] what is nearer to something on the map is a part of it

/// How well one way to find legs does on the recordings.
struct LegScore {
  std::size_t scans = 0, marks = 0, found = 0;  ///< of scans with marks
  std::size_t right = 0, others = 0;            ///< findings at a mark, and elsewhere
  std::size_t empty_scans = 0, false_ones = 0;  ///< where nobody was

  double recall() const { return static_cast<double>(found) / static_cast<double>(marks); }
  double false_a_scan() const {
    return empty_scans > 0 ? static_cast<double>(false_ones) / static_cast<double>(empty_scans)
                           : NAN;
  }
  double others_a_scan() const { return static_cast<double>(others) / static_cast<double>(scans); }
  /// As if every scan with marks had as many false findings as one without people.
  double precision() const {
    const double each = static_cast<double>(right) / static_cast<double>(scans);
    return each / (each + false_a_scan());
  }
  /// As if whatever has no mark were nobody.
  double least_precision() const {
    return static_cast<double>(right) / static_cast<double>(right + others);
  }
};

/// Findings of one scan in the laser's frame.
using FindLegs = std::function<std::vector<Point2>(const LegRecording&, const MarkedScan&)>;

void judge_scan(const std::vector<Point2>& findings, const std::vector<Point2>& legs, double same,
                LegScore& score) {
  const auto near = [same](const std::vector<Point2>& points, const Point2& point) {
    return std::any_of(points.begin(), points.end(),
                       [&](const Point2& other) { return (other - point).norm() <= same; });
  };
  ++score.scans;
  score.marks += legs.size();
  for (const Point2& leg : legs) score.found += near(findings, leg);
  for (const Point2& finding : findings) ++(near(legs, finding) ? score.right : score.others);
}

bool has_nobody(const LegRecording& recording) { return recording.name.starts_with("negative"); }
bool is_marked(const LegRecording& recording) {
  return std::any_of(recording.scans.begin(), recording.scans.end(),
                     [](const MarkedScan& scan) { return !scan.legs.empty(); });
}

LegScore judge_legs(const std::vector<LegRecording>& recordings, double same, bool with_negatives,
                    const std::function<FindLegs(const LegRecording&)>& make) {
  LegScore score;
  for (const LegRecording& recording : recordings) {
    const bool marked = is_marked(recording);
    if (!marked && !(with_negatives && has_nobody(recording))) continue;
    const FindLegs find = make(recording);
    for (const MarkedScan& scan : recording.scans) {
      const auto findings = find(recording, scan);
      if (marked) {
        if (!scan.legs.empty()) judge_scan(findings, scan.legs, same, score);
      } else {
        ++score.empty_scans;
        score.false_ones += findings.size();
      }
    }
  }
  return score;
}

people_detector::LegFinder finder(const grid::OccupancyGrid& map) {
  auto legs = people_detector::LegFinder::make({.farthest = kFarthest}).value();
  legs.set_map(map);
  return legs;
}

grid::OccupancyGrid empty_map() {
  return grid::OccupancyGrid({400, 400, 0.05, -10.0, -10.0}, grid::kFree);
}

FindLegs by_finder(const grid::OccupancyGrid& map) {
  return [legs = std::make_shared<people_detector::LegFinder>(finder(map))](
             const LegRecording& recording, const MarkedScan& scan) {
    std::vector<Point2> places;
    for (const auto& one : legs->find(recording.view(scan), {}, {})) places.push_back(one.position);
    return places;
  };
}

using Ways = std::map<std::uint64_t, std::vector<Point2>>;

/// Only who walked: what the robot takes for people by its laser alone. It stands.
FindLegs by_tracker(const grid::OccupancyGrid& map, Ways& ways) {
  return [legs = std::make_shared<people_detector::LegFinder>(finder(map)),
          tracker = std::make_shared<people_detector::Tracker>(people_detector::TrackerConfig{}),
          &ways](const LegRecording& recording, const MarkedScan& scan) {
    tracker->update(scan.time, people_detector::Source::kLaser,
                    legs->find(recording.view(scan), {}, {}));
    std::vector<Point2> places;
    for (const auto& track : tracker->people()) {
      if (track.last_seen() < scan.time) continue;
      places.push_back(track.position());
      ways[track.id].push_back(track.position());
    }
    return places;
  };
}

std::string share(double value) { return std::isfinite(value) ? format("%.3f", value) : ""; }

void add_row(const char* name, const LegScore& score, Table& table) {
  table.add({name, std::to_string(score.found) + " of " + std::to_string(score.marks),
             share(score.recall()), share(score.false_a_scan()), share(score.precision()),
             format("%.2f", score.others_a_scan()), share(score.least_precision())});
}

/// Marks and ways over the map that one recording's scans give.
Status draw_legs(const LegRecording& recording, const grid::OccupancyGrid& map, const Ways& ways,
                 const std::string& path) {
  std::vector<DrawnWay> drawn;
  for (const MarkedScan& scan : recording.scans) {
    for (const Point2& leg : scan.legs)
      drawn.push_back(
          {drawn.empty() ? "marked legs" : "", 120, 120, 120, 3, {leg, leg + Point2(0.01, 0.0)}});
  }
  std::size_t next = 0;
  for (const auto& [id, way] : ways) {
    drawn.push_back({.label = "person " + std::to_string(id), .points = way});
    drawn.back().paint(next++);
  }
  return draw_ways(drawn, map, recording.name + ": who the laser alone takes for people", path);
}

Status judge_laser(const ExperimentOptions& options, ResultSheet& sheet) {
  const auto recordings = people_study::read_leg_recordings(options.data + "/laser_people");
  if (!recordings) return Error{recordings.error()};
  if (std::none_of(recordings->begin(), recordings->end(), is_marked) ||
      std::none_of(recordings->begin(), recordings->end(), has_nobody))
    return Error{options.data + "/laser_people: expected recordings with marks and without people"};
  show_progress("legs in " + std::to_string(recordings->size()) + " recordings of a laser");

  const LegScore width = judge_legs(*recordings, kSameLeg, true, [](const LegRecording&) {
    return [](const LegRecording& recording, const MarkedScan& scan) {
      return people_study::legs_by_width(recording.view(scan), kFarthest);
    };
  });
  const LegScore anywhere = judge_legs(*recordings, kSamePerson, true,
                                       [](const LegRecording&) { return by_finder(empty_map()); });
  const LegScore mapped = judge_legs(
      *recordings, kSamePerson, false,
      [](const LegRecording& recording) { return by_finder(map_of(recording, kFarthest)); });
  std::map<std::string, Ways> ways;
  const LegScore walked =
      judge_legs(*recordings, kSamePerson, false, [&](const LegRecording& recording) {
        return by_tracker(map_of(recording, kFarthest), ways[recording.name]);
      });

  Table table({"legs in a laser's scan", "marks found", "recall", "false a scan without people",
               "precision", "unmarked a scan", "precision at least"});
  add_row("things as wide as a leg", width, table);
  add_row("LegFinder without a map", anywhere, table);
  add_row("LegFinder, the room mapped", mapped, table);
  add_row("who walked 0.5 m, the room mapped", walked, table);
  std::printf("%s\n", table.text().c_str());

  sheet.metrics["width_rule_recall"] = width.recall();
  sheet.metrics["width_rule_precision"] = width.precision();
  sheet.metrics["legs_recall"] = anywhere.recall();
  sheet.metrics["legs_precision"] = anywhere.precision();
  sheet.metrics["legs_mapped_recall"] = mapped.recall();
  sheet.metrics["legs_mapped_precision_at_least"] = mapped.least_precision();
  sheet.metrics["legs_walked_recall"] = walked.recall();
  sheet.metrics["legs_walked_precision_at_least"] = walked.least_precision();
  // The rule's published figures, on scans of another laser; a robot has a map and believes who
  // walks, so that is what they are asked of.
  for (const char* key : {"width_rule_", "legs_", "legs_walked_"}) {
    const std::string name(key);
    sheet.published[name + "recall"] = 0.841;
    sheet.published[name + (name == "legs_walked_" ? "precision_at_least" : "precision")] = 0.125;
  }
  sheet.targets["legs_walked_recall"] = {Bound::kAtLeast, 0.841};
  sheet.targets["legs_walked_precision_at_least"] = {Bound::kAtLeast, 0.125};
  Status saved = write_file(options.out + "/legs.md", table.markdown());
  for (const LegRecording& recording : *recordings) {
    if (!saved || !is_marked(recording)) continue;
    saved = draw_legs(recording, map_of(recording, kFarthest), ways[recording.name],
                      options.out + "/" + recording.name + ".png");
  }
  return saved;
}

/// Where a frame's person is, by the median of its pixels; must be found, however little shows.
people_study::Truth truth_of(const MaskedFrame& frame) {
  std::vector<double> forward, left;
  people_study::Truth truth{.area = people_study::kVisible};
  for (std::size_t i = 0; i < frame.mask.size(); ++i) {
    const double depth = 1e-3 * frame.millimeters[i];
    if (frame.mask[i] == 0 || depth <= 0.0) continue;
    const auto column = static_cast<double>(i % static_cast<std::size_t>(frame.camera.width));
    forward.push_back(depth);
    left.push_back(depth * (frame.camera.cx - column) / frame.camera.fx);
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return values.empty() ? 0.0 : *middle;
  };
  truth.forward = median(forward) + kBodyDepth;
  truth.left = median(left);
  return truth;
}

/// Where the wall behind is, by the median of the other pixels [m].
double wall_of(const MaskedFrame& frame) {
  std::vector<std::uint16_t> depths;
  for (std::size_t i = 0; i < frame.mask.size(); ++i)
    if (frame.mask[i] == 0 && frame.millimeters[i] > 0) depths.push_back(frame.millimeters[i]);
  if (depths.empty()) return 0.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return 1e-3 * *middle;
}

struct MaskedRun {
  Score score, blobs;
  Score mapped;  ///< the same without what belongs to the wall behind, as a robot knows by its map
  std::string csv;
  std::vector<cv::Mat> pictures;
};

Result<MaskedRun> judge_masked(const std::vector<MaskedFrame>& frames, double height) {
  const imaging::Intrinsics& camera = frames.front().camera;
  auto pipeline = depth_pipeline::DepthPipeline::make(camera, {.origin = 0.0});
  auto detector = people_detector::DepthDetector::make(camera, {});
  if (!pipeline || !detector) return Error{pipeline ? detector.error() : pipeline.error()};
  people_study::BlobBaseline blobs(camera, {});
  MaskedRun run;
  for (const MaskedFrame& frame : frames) {
    if (!(frame.camera == camera)) return Error{frame.name + ": another camera"};
    const auto view = pipeline->process(frame.image(), {.height = height, .forward = 0.0});
    if (!view) return Error{frame.name + ": " + view.error()};
    people_study::Studio::Shot shot{frame.image(),
                                    {camera.width, camera.height, view->processed},
                                    {height, 0.0, 0.0},
                                    {truth_of(frame)}};
    const auto found = detector->find(shot.processed, shot.view);
    if (!found) return Error{frame.name + ": " + found.error()};
    const Score score = people_study::judge(*found, shot.truths);
    run.score += score;
    auto off_the_wall = std::vector(found->begin(), found->end());
    const double wall = wall_of(frame);
    std::erase_if(off_the_wall, [wall](const auto& one) {
      return std::abs(one.forward - kBodyDepth - wall) < kOfTheWall;
    });
    run.mapped += people_study::judge(off_the_wall, shot.truths);
    const auto blob = blobs.find(shot.processed, shot.view);
    run.blobs += people_study::judge(blob, shot.truths);
    run.csv += frame.name + format(",%.2f", height) + "," + std::to_string(score.found) + "," +
               std::to_string(score.false_alarms) + format(",%.2f", shot.truths[0].forward) +
               format(",%.2f", shot.truths[0].left) +
               format(",%.3f\n", score.found > 0 ? score.error : NAN);
    if (run.pictures.size() < 6 && (&frame - frames.data()) % 8 == 0)
      run.pictures.push_back(draw_people(shot, camera, {*found, blob}, frame.name));
  }
  return run;
}

Status judge_frames(const ExperimentOptions& options, ResultSheet& sheet) {
  const auto frames = people_study::read_masked_frames(options.data + "/depth/uva_person");
  if (!frames) return Error{frames.error()};
  Table table({"a person at 0.9 m, cut off below the chest", "camera m", "found", "recall", "false",
               "precision", "mean error m"});
  std::string csv = "frame,camera_height,found,false_alarms,forward,left,error\n";
  std::vector<cv::Mat> pictures;
  for (const double height : kHeights) {
    show_progress(std::to_string(frames->size()) + " frames, the camera " + format("%.2f", height) +
                  " m high");
    const auto run = judge_masked(*frames, height);
    if (!run) return Error{run.error()};
    csv += run->csv;
    const auto add = [&](const char* name, const Score& score) {
      table.add({name, format("%.2f", height),
                 std::to_string(score.found) + " of " + std::to_string(score.found + score.missed),
                 format("%.3f", score.recall()), std::to_string(score.false_alarms),
                 score.found > 0 ? format("%.3f", score.precision()) : "",
                 score.found > 0 ? format("%.2f", score.error / score.found) : ""});
    };
    add("Usher", run->score);
    add("... the wall behind mapped", run->mapped);
    add("blobs as in the thesis", run->blobs);
    if (height != kCameraHeight) continue;
    sheet.metrics["close_person_recall"] = run->score.recall();
    sheet.metrics["close_person_precision"] = run->score.precision();
    sheet.metrics["close_person_mapped_precision"] = run->mapped.precision();
    sheet.metrics["close_person_blobs_recall"] = run->blobs.recall();
    pictures = run->pictures;
  }
  sheet.targets["close_person_recall"] = {Bound::kAtLeast, 0.98};
  sheet.targets["close_person_precision"] = {Bound::kAtLeast, 0.98};
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/frames.md", table.markdown());
  if (saved) saved = write_file(options.out + "/frames.csv", csv);
  if (saved && !cv::imwrite(options.out + "/frames.png", tile(pictures, 3)))
    saved = Error{options.out + "/frames.png: cannot be written"};
  return saved;
}

}  // namespace

Result<ResultSheet> run_people_data_experiment(const ExperimentOptions& options) {
  const auto only = only_of(options.only, {"laser", "frames"});
  if (!only) return Error{only.error()};
  if (options.data.empty())
    return Error{
        "no recordings: USHER_TEST_DATA must name a folder with laser_people/ and "
        "depth/uva_person/"};
  ResultSheet sheet;
  sheet.name = "people-data";
  sheet.input =
      "recordings of others: marked legs in a laser's scans and scans without people, a person "
      "before a depth camera with its mask";
  Status done;
  if (only->takes("laser")) done = judge_laser(options, sheet);
  if (done && only->takes("frames")) done = judge_frames(options, sheet);
  show_progress("");
  if (!done) return Error{done.error()};
  return sheet;
}

}  // namespace usher::operations
