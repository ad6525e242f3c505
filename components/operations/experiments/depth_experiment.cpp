#include <time.h>

#include <cmath>

#include "operations/experiments/depth_figures.hpp"
#include "operations/experiments/depth_rates.hpp"
#include "operations/experiments/depth_stage.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/scan_judgement.hpp"
#include "sensing/depth_pipeline/core/thesis_method.hpp"

namespace usher::operations {

namespace {

using depth_pipeline::DepthPipeline;
using depth_pipeline::ThesisMethod;
using geometry::radians;

/// The thesis' scan in the bearings of ours.
std::vector<float> in_bearings(const ThesisMethod::Scan& scan,
                               const depth_pipeline::ScanGeometry& geometry) {
  std::vector<float> ranges(geometry.count, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double step = (-scan.bearings[i] - geometry.angle_min) / geometry.increment;
    if (step < 0.0 || step >= static_cast<double>(geometry.count)) continue;
    float& range = ranges[static_cast<std::size_t>(step)];
    const bool nothing = scan.ranges[i] >= 0.99 * kThesisFar;
    const float found =
        nothing ? std::numeric_limits<float>::infinity() : static_cast<float>(scan.ranges[i]);
    if (!(range <= found)) range = found;
  }
  return ranges;
}

void judge_methods(DepthStage& stage, ResultSheet& sheet) {
  DepthPipeline ours = pipeline_of(stage, 1);
  ThesisMethod thesis({});
  ScanJudgement usher, published, blind;
  double processor = 0.0;
  int frames = 0;
  const std::vector<geometry::Pose2> places{{24.9, 1.6, 0.55}, {3.0, 5.0, 0.3},  {12.0, 10.0, 0.0},
                                            {27.9, 14.0, 1.6}, {14.0, 3.0, 1.2}, {30.0, 20.0, 0.4}};
  for (const auto& place : places) {
    for (int degrees = -10; degrees <= 10; degrees += 2) {
      show_progress("pitch " + std::to_string(degrees) + " deg");
      const auto image = stage.look(place, radians(degrees), 0.0);
      const auto truth = stage.nearest(ours.geometry());
      thesis.process(ThesisMethod::narrow(image, kThesisFar), stage.pose());
      published.take(truth, in_bearings(thesis.scan(), ours.geometry()));
      timespec before{}, after{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
      const auto view = ours.process(image, stage.pose()).value();
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
      processor += static_cast<double>(after.tv_sec - before.tv_sec) +
                   1e-9 * static_cast<double>(after.tv_nsec - before.tv_nsec);
      usher.take(truth, view.scan->ranges);
      auto upright = depth_pipeline::camera_pose({}, kCameraTilt, 0.0);
      const auto wrong = ours.process(image, upright).value();
      blind.take(truth, wrong.scan->ranges);
      ++frames;
    }
  }
  show_progress("");
  sheet.metrics["frames"] = frames;
  sheet.metrics["processor_ms_per_frame"] = 1e3 * processor / frames;
  sheet.metrics["missed_percent"] = 100.0 * usher.missed_share();
  sheet.metrics["unknown_percent"] = 100.0 * usher.unknown_share();
  sheet.metrics["false_percent"] = 100.0 * usher.false_share();
  sheet.metrics["range_error_m_median"] = usher.error(0.5);
  sheet.metrics["range_error_m_p95"] = usher.error(0.95);
  sheet.metrics["thesis_method_missed_percent"] = 100.0 * published.missed_share();
  sheet.metrics["thesis_method_unknown_percent"] = 100.0 * published.unknown_share();
  sheet.metrics["thesis_method_false_percent"] = 100.0 * published.false_share();
  sheet.metrics["thesis_method_range_error_m_p95"] = published.error(0.95);
  sheet.metrics["without_pitch_false_percent"] = 100.0 * blind.false_share();
  sheet.metrics["without_pitch_missed_percent"] = 100.0 * blind.missed_share();
  sheet.metrics["without_pitch_unknown_percent"] = 100.0 * blind.unknown_share();
  sheet.targets["missed_percent"] = {Bound::kAtMost, 2.0};
  sheet.targets["unknown_percent"] = {Bound::kAtMost, 1.0};
  sheet.targets["false_percent"] = {Bound::kAtMost, 0.5};
  sheet.targets["range_error_m_p95"] = {Bound::kAtMost, 0.06};
}

}  // namespace

Result<ResultSheet> run_depth_pipeline_experiment(const ExperimentOptions& options) {
  constexpr const char* kImages = "images";
  const auto only = only_of(options.only, {kImages});
  if (!only) return Error{only.error()};
  auto stage = DepthStage::make(options.installation.share + "/config/sites/office/world.yaml",
                                rendering::kinect_v2(), 1);
  if (!stage) return Error{stage.error()};
  ResultSheet sheet;
  sheet.name = "depth-pipeline";
  sheet.input = "Kinect v2 in the office, 6 places, pitch -10 to 10 deg; processes for table 4.2";
  if (const auto status = draw_depth_figures(*stage, options.out); !status)
    return Error{status.error()};
  judge_methods(*stage, sheet);
  if (only->name != kImages) {
    if (const auto status = measure_depth_rates(options, sheet); !status)
      return Error{status.error()};
  }
  return sheet;
}

}  // namespace usher::operations
