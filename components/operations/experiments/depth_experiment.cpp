#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "idl/topics.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/depth_pictures.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/scan_judgement.hpp"
#include "operations/launcher/launcher.hpp"
#include "runtime/dds/observer.hpp"
#include "simulation/world/core/depth_cameras.hpp"

namespace usher::operations {

namespace {

using depth_pipeline::DepthPipeline;
using depth_pipeline::ThesisMethod;
using geometry::radians;
using std::chrono::steady_clock;

constexpr double kFar = 12.0;            // [m] of the thesis' images
constexpr double kTilt = -0.0872664626;  // [rad] 5 deg below the horizon
constexpr std::uint32_t kDomain = 44;
constexpr auto kMeasured = std::chrono::seconds(20);

imaging::Intrinsics intrinsics_of(const rendering::Lens& lens) {
  return {lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy};
}

/// A Kinect in the office.
class Stage {
 public:
  static Result<Stage> make(const Installation& installation, std::uint64_t seed) {
    auto building = world::load_building(installation.share + "/config/sites/office/world.yaml");
    if (!building) return Error{building.error()};
    return Stage(std::move(building).value(), seed);
  }

  /// An image from a place with a pitch, as the camera says and as it is.
  imaging::DepthImage look(const geometry::Pose2& place, double pitch, double burst) {
    const world::Mount mount{.x = 0.2, .z = 0.665, .pitch = -kTilt};
    const geometry::Pose3 base{{place.x, place.y, 0.235},
                               geometry::from_roll_pitch_yaw(0.0, pitch, place.yaw)};
    sensor_.measure(renderer_, base * mount.base_T_sensor(), burst, millimeters_);
    pose_ = depth_pipeline::camera_pose({}, kTilt, pitch);
    const auto& lens = sensor_.config().lens;
    return {lens.width, lens.height, millimeters_};
  }
  const depth_pipeline::CameraPose& pose() const { return pose_; }
  const rendering::Hits& truth() const { return sensor_.truth(); }
  imaging::Intrinsics camera() const { return intrinsics_of(sensor_.config().lens); }

  /// The nearest thing between floor and 2 m of each bearing, without errors of the camera.
  std::vector<float> nearest(const depth_pipeline::ScanGeometry& geometry) const {
    std::vector<float> ranges(geometry.count, std::numeric_limits<float>::infinity());
    const auto lens = camera();
    const double sine = std::sin(pose_.down), cosine = std::cos(pose_.down);
    for (int row = 0; row < lens.height; ++row) {
      for (int column = 0; column < lens.width; ++column) {
        const auto z =
            static_cast<double>(truth().depth[static_cast<std::size_t>(row * lens.width + column)]);
        const double y = (row - lens.cy) / lens.fy;
        const double height = pose_.height - z * (sine + y * cosine);
        if (z < 0.5 || height < 0.05 || height > 1.95) continue;
        const double ahead = z * (cosine - y * sine) + pose_.forward - 0.2;
        const double left = z * (lens.cx - column) / lens.fx;
        const double step = (std::atan2(left, ahead) - geometry.angle_min) / geometry.increment;
        if (step < 0.0 || step >= static_cast<double>(geometry.count)) continue;
        float& range = ranges[static_cast<std::size_t>(step)];
        range = std::min(range, static_cast<float>(std::hypot(ahead, left)));
      }
    }
    return ranges;
  }

 private:
  Stage(world::Building building, std::uint64_t seed)
      : world_({}, std::move(building), people(), {3.0, 5.0, 0.0}, seed),
        renderer_(rendering::Renderer::make(world::model_of(world_.scene(), nullptr)).value()),
        sensor_(rendering::kinect_v2(), seed) {
    std::vector<rendering::Body> bodies;
    world::bodies_of(world_.people(), bodies);
    renderer_.place(bodies);
  }
  static std::vector<world::PersonPlan> people() {
    return {{.name = "a", .start = {27.8, 3.2}, .yaw = 2.4, .loop = {}},
            {.name = "b", .start = {5.6, 6.0}, .yaw = 3.0, .loop = {}}};
  }

  world::World world_;
  rendering::Renderer renderer_;
  rendering::DepthSensor sensor_;
  std::vector<std::uint16_t> millimeters_;
  depth_pipeline::CameraPose pose_;
};

/// The thesis' scan in the bearings of ours.
std::vector<float> in_bearings(const ThesisMethod::Scan& scan,
                               const depth_pipeline::ScanGeometry& geometry) {
  std::vector<float> ranges(geometry.count, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double step = (-scan.bearings[i] - geometry.angle_min) / geometry.increment;
    if (step < 0.0 || step >= static_cast<double>(geometry.count)) continue;
    float& range = ranges[static_cast<std::size_t>(step)];
    const bool nothing = scan.ranges[i] >= 0.99 * kFar;
    const float found =
        nothing ? std::numeric_limits<float>::infinity() : static_cast<float>(scan.ranges[i]);
    if (!(range <= found)) range = found;
  }
  return ranges;
}

DepthPipeline pipeline_for(const Stage& stage, int confidence_frames) {
  depth_pipeline::PipelineConfig config;
  config.confidence_frames = confidence_frames;
  return DepthPipeline::make(stage.camera(), config).value();
}

Status draw_figures(Stage& stage, const std::string& out) {
  const geometry::Pose2 place{24.9, 1.6, 0.55};
  const auto image = stage.look(place, 0.0, 0.0);
  DepthPipeline ours = pipeline_for(stage, 1);
  ThesisMethod thesis({});
  thesis.process(ThesisMethod::narrow(image, kFar), stage.pose());
  const auto view = ours.process(image, stage.pose()).value();
  std::vector<std::uint8_t> rgb;
  rendering::paint(stage.truth(), rgb);
  cv::Mat color(image.height, image.width, CV_8UC3, rgb.data());
  cv::cvtColor(color, color, cv::COLOR_RGB2BGR);

  Status status = save_row({{"4.11 raw depth image", gray_depth(image, kFar)},
                            {"4.12 after threshold and opening", thesis.opened()}},
                           out + "/fig_4_11_4_12.png");
  const cv::Mat association = thesis.associated();
  if (status)
    status = save_row({{"4.17a floor and ceiling", colored_planes(thesis.opened(), association)},
                       {"4.17b removed, as the thesis does", thesis.processed()},
                       {"removed, Usher (16 bit)",
                        gray_depth({image.width, image.height, view.processed}, kFar)}},
                      out + "/fig_4_17.png");
  const std::vector<DrawnScan> scans{
      {"what is there",
       {190, 190, 190},
       points_of(ours.geometry(), stage.nearest(ours.geometry()))},
      {"thesis", {80, 170, 240}, points_of(thesis.scan(), 0.99 * kFar)},
      {"Usher", {120, 230, 120}, points_of(ours.geometry(), view.scan->ranges)}};
  if (status)
    status =
        save_row({{"4.20a colour image", color}, {"4.20b scan", draw_scans(scans, "grid of 1 m")}},
                 out + "/fig_4_20.png");
  Curve curve{"threshold t(v) of the thesis' method", 200, 60, 40, {}};
  for (int v = 0; v < 256; ++v) curve.points.emplace_back(v, thesis.threshold(v));
  if (status)
    status = draw_plot({curve}, "4.16 distance dependent threshold (our values)", "pixel value",
                       "threshold [values]", out + "/fig_4_16.png");
  if (!status) return status;

  // 4.21: the pitch jumps; ten frames, the fourth and fifth are spoilt.
  DepthPipeline rated = pipeline_for(stage, 3), plain = pipeline_for(stage, 1);
  for (int frame = 0; frame < 6; ++frame) {
    const bool spoilt = frame >= 4;
    const auto burst = stage.look(place, spoilt ? 0.06 : 0.0, spoilt ? 1.0 : 0.0);
    const auto raw = plain.process(burst, stage.pose()).value();
    const auto filtered = rated.process(burst, stage.pose()).value();
    if (frame < 5) continue;
    const auto draw = [&](const char* title, const depth_pipeline::DepthView& shown) {
      return draw_scans({{"what is there",
                          {190, 190, 190},
                          points_of(ours.geometry(), stage.nearest(ours.geometry()))},
                         {"scan", {120, 230, 120}, points_of(ours.geometry(), shown.scan->ranges)}},
                        title);
    };
    status = save_row({{"4.21a without", draw("every measurement", raw)},
                       {"4.21b with the confidence filter", draw("confidence from 0.2", filtered)}},
                      out + "/fig_4_21.png");
  }
  return status;
}

void judge_methods(Stage& stage, ResultSheet& sheet) {
  DepthPipeline ours = pipeline_for(stage, 1);
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
      thesis.process(ThesisMethod::narrow(image, kFar), stage.pose());
      published.take(truth, in_bearings(thesis.scan(), ours.geometry()));
      timespec before{}, after{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
      const auto view = ours.process(image, stage.pose()).value();
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
      processor += static_cast<double>(after.tv_sec - before.tv_sec) +
                   1e-9 * static_cast<double>(after.tv_nsec - before.tv_nsec);
      usher.take(truth, view.scan->ranges);
      auto upright = depth_pipeline::camera_pose({}, kTilt, 0.0);
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

/// Arrivals of one topic.
struct Arrivals {
  std::mutex mutex;
  std::vector<double> times;  // [s]

  void note() {
    const std::lock_guard lock(mutex);
    times.push_back(std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count());
  }
  /// Frames per second and the deviation of the frame time, as table 4.2 counts them.
  void report(const std::string& key, ResultSheet& sheet) {
    const std::lock_guard lock(mutex);
    if (times.size() < 10) return;
    double sum = 0, squares = 0, low = 1e9, high = 0, periods = 0, period_squares = 0;
    const auto n = static_cast<double>(times.size() - 1);
    for (std::size_t i = 1; i < times.size(); ++i) {
      const double period = std::max(1e-4, times[i] - times[i - 1]);
      const double rate = 1.0 / period;
      sum += rate, squares += rate * rate;
      low = std::min(low, rate), high = std::max(high, rate);
      periods += period, period_squares += period * period;
    }
    const double mean = sum / n, period = periods / n;
    sheet.metrics[key + "_fps"] = 1.0 / period;
    sheet.metrics[key + "_fps_min"] = low;
    sheet.metrics[key + "_fps_max"] = high;
    sheet.metrics[key + "_fps_deviation"] = std::sqrt(std::max(0.0, squares / n - mean * mean));
    sheet.metrics[key + "_frame_time_ms_deviation"] =
        1e3 * std::sqrt(std::max(0.0, period_squares / n - period * period));
  }
};

/// What the depth pipeline reads, and itself, of a robot.
void leave_the_depth_camera(Deployment& deployment) {
  const auto belongs = [](const std::string& name) {
    return name == "world" || name == "segway_rmp" || name == "sensor_board" || name == "kinect" ||
           name == "depth_pipeline";
  };
  std::erase_if(deployment.files, [&](const auto& file) { return !belongs(file.name); });
  std::erase_if(deployment.manifest.components,
                [&](const auto& component) { return !belongs(component.name); });
}

/// Table 4.2: the rates of raw depth images and of scans over DDS processes, and what the pipeline
/// takes of a core; of the whole robot, or of its depth camera alone.
Status measure_processes(const ExperimentOptions& options, bool alone, ResultSheet& sheet) {
  auto deployment = load_deployment(options.installation.share + "/deploy/marvin-pixels.yaml",
                                    options.installation, {});
  if (!deployment) return Error{deployment.error()};
  if (alone) leave_the_depth_camera(*deployment);
  const std::string of = alone ? "alone_" : "";
  deployment->manifest.domain = kDomain;
  for (auto& file : deployment->files) file.domain = kDomain;
  auto launcher = Launcher::create(
      *deployment, {"", options.installation.programs, default_run_directory(kDomain, "")});
  if (!launcher) return Error{launcher.error()};
  auto observer = runtime::Observer::create({.name = "operator", .host = "nuc", .domain = kDomain});
  if (!observer) return Error{observer.error()};
  Arrivals images, scans;
  std::mutex mutex;
  std::vector<double> loads;
  auto image_reader =
      (*observer)->reader(topics::kKinectDepth, [&](const auto&, const auto&) { images.note(); });
  auto scan_reader =
      (*observer)->reader(topics::kKinectScan, [&](const auto&, const auto&) { scans.note(); });
  auto heartbeats = (*observer)->reader(topics::kHeartbeat, [&](const auto& beat, const auto&) {
    if (beat.component_name() != "depth_pipeline") return;
    const std::lock_guard lock(mutex);
    loads.push_back(static_cast<double>(beat.cpu_percent()));
  });
  if (!image_reader) return Error{image_reader.error()};
  if (!scan_reader) return Error{scan_reader.error()};
  if (!heartbeats) return Error{heartbeats.error()};
  const auto run = [&](steady_clock::duration length) {
    const auto until = steady_clock::now() + length;
    while (steady_clock::now() < until && !launcher->broken()) {
      launcher->poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  };
  run(std::chrono::seconds(8));
  for (Arrivals* arrivals : {&images, &scans}) {
    const std::lock_guard lock(arrivals->mutex);
    arrivals->times.clear();
  }
  {
    const std::lock_guard lock(mutex);
    loads.clear();
  }
  show_progress(alone ? "measuring frame rates alone" : "measuring frame rates");
  run(kMeasured);
  show_progress("");
  if (launcher->broken()) return Error{"a component cannot be kept running"};
  images.report(of + "no_filtering", sheet);
  scans.report(of + "depth_removal", sheet);
  const std::lock_guard lock(mutex);
  double sum = 0.0;
  for (const double load : loads) sum += load;
  if (!loads.empty())
    sheet.metrics[of + "depth_processes_load_percent"] = sum / static_cast<double>(loads.size());
  sheet.targets[of + "depth_removal_fps"] = {Bound::kAtLeast, 29.5};
  sheet.targets[of + "depth_removal_frame_time_ms_deviation"] = {Bound::kAtMost, 1.0};
  sheet.targets[of + "depth_processes_load_percent"] = {Bound::kAtMost, 15.0};
  return {};
}

}  // namespace

Result<ResultSheet> run_depth_pipeline_experiment(const ExperimentOptions& options) {
  constexpr const char* kImages = "images";
  const auto only = only_of(options.only, {kImages});
  if (!only) return Error{only.error()};
  auto stage = Stage::make(options.installation, 1);
  if (!stage) return Error{stage.error()};
  ResultSheet sheet;
  sheet.name = "depth-pipeline";
  sheet.input = "Kinect v2 in the office, 6 places, pitch -10 to 10 deg; processes for table 4.2";
  if (const auto status = draw_figures(*stage, options.out); !status) return Error{status.error()};
  judge_methods(*stage, sheet);
  if (only->name != kImages) {
    sheet.published["no_filtering_fps (thesis table 4.2)"] = 30.0;
    sheet.published["no_filtering_fps_deviation (thesis table 4.2)"] = 1.453;
    sheet.published["no_filtering_frame_time_ms_deviation (thesis, about)"] = 1.6;
    sheet.published["depth_removal_fps (thesis table 4.2)"] = 30.0;
    sheet.published["depth_removal_fps_deviation (thesis table 4.2)"] = 3.020;
    sheet.published["depth_removal_frame_time_ms_deviation (thesis, about)"] = 3.4;
    Status status = measure_processes(options, false, sheet);
    if (status) status = measure_processes(options, true, sheet);
    if (!status) return Error{status.error()};
  }
  return sheet;
}

}  // namespace usher::operations
