#include "operations/experiments/depth_rates.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <set>
#include <thread>

#include "idl/topics.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/launcher/precedence.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

namespace {

using std::chrono::steady_clock;

constexpr auto kSettling = std::chrono::seconds(8);
constexpr auto kMeasured = std::chrono::seconds(20);
constexpr std::size_t kFewest = 10;  // arrivals that are a rate

/// One row of table 4.2; its frame time's deviation follows from the others.
struct Layer {
  const char* key;
  const char* name;
  double average, least, most, deviation, milliseconds;  // [frames/s], the last one [ms]
};
constexpr Layer kImages{"no_filtering", "No Filtering", 30.00, 23.72, 40.92, 1.453, 1.6};
constexpr Layer kScans{"depth_removal", "Depth Removal", 30.00, 21.74, 46.50, 3.020, 3.4};
constexpr Layer kPeople{
    "human_detection", "Depth Removal & Human Detection", 30.00, 19.13, 58.23, 3.617, 4.0};

/// What runs.
struct Setup {
  const char* prefix;          ///< of the keys
  const char* name;            ///< in the table
  std::set<std::string> only;  ///< components; empty = all
  bool rear_camera = true;     ///< beside the Kinect
};

/// Frames per second and the deviation of the frame time, as table 4.2 counts them.
struct Rates {
  double average = 0.0, least = 0.0, most = 0.0, deviation = 0.0;  // [frames/s]
  double milliseconds = 0.0;                                       // deviation of the frame time
};

/// Arrivals of one topic.
class Arrivals {
 public:
  void note() {
    const std::lock_guard lock(mutex_);
    times_.push_back(std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count());
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    times_.clear();
  }
  std::optional<Rates> rates() const {
    const std::lock_guard lock(mutex_);
    if (times_.size() < kFewest) return std::nullopt;
    double sum = 0, squares = 0, low = 1e9, high = 0, periods = 0, period_squares = 0;
    const auto n = static_cast<double>(times_.size() - 1);
    for (std::size_t i = 1; i < times_.size(); ++i) {
      const double period = std::max(1e-4, times_[i] - times_[i - 1]);
      const double rate = 1.0 / period;
      sum += rate, squares += rate * rate;
      low = std::min(low, rate), high = std::max(high, rate);
      periods += period, period_squares += period * period;
    }
    const double mean = sum / n, period = periods / n;
    return Rates{
        .average = 1.0 / period,
        .least = low,
        .most = high,
        .deviation = std::sqrt(std::max(0.0, squares / n - mean * mean)),
        .milliseconds = 1e3 * std::sqrt(std::max(0.0, period_squares / n - period * period))};
  }

 private:
  mutable std::mutex mutex_;
  std::vector<double> times_;  // [s]
};

/// Share of a core that a component's process takes, by its heartbeats.
class Load {
 public:
  void note(double percent) {
    const std::lock_guard lock(mutex_);
    sum_ += percent;
    ++count_;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    sum_ = 0.0, count_ = 0;
  }
  std::optional<double> percent() const {
    const std::lock_guard lock(mutex_);
    if (count_ == 0) return std::nullopt;
    return sum_ / count_;
  }

 private:
  mutable std::mutex mutex_;
  double sum_ = 0.0;
  int count_ = 0;
};

/// What one setup did.
struct Measured {
  Arrivals images, scans, people;
  Load pipeline, detector;

  void clear() {
    for (Arrivals* arrivals : {&images, &scans, &people}) arrivals->clear();
    for (Load* load : {&pipeline, &detector}) load->clear();
  }
};

void keep_only(const std::set<std::string>& names, Deployment& deployment) {
  if (names.empty()) return;
  std::erase_if(deployment.files, [&](const auto& file) { return !names.contains(file.name); });
  std::erase_if(deployment.manifest.components,
                [&](const auto& component) { return !names.contains(component.name); });
}

Status run(const ExperimentOptions& options, const Setup& setup, Measured& measured) {
  auto deployment = load_deployment(options.installation.share + "/deploy/marvin-pixels.yaml",
                                    options.installation, {});
  if (!deployment) return Error{deployment.error()};
  keep_only(setup.only, *deployment);
  if (!setup.rear_camera) {
    for (const char* one : {"world", "depth_pipeline"})
      set_value(*deployment, one, "robot.rear_camera.fitted", "false");
  }
  deployment->manifest.domain = options.domain;
  for (auto& file : deployment->files) file.domain = options.domain;
  auto launcher =
      Launcher::create(*deployment, {"", options.installation.programs, options.out + "/run"});
  if (!launcher) return Error{launcher.error()};
  const auto observer = made_before_all([&] {
    return runtime::Observer::create({.name = "operator", .host = "nuc", .domain = options.domain});
  });
  if (!observer) return Error{observer.error()};
  const auto images = (*observer)->reader(
      topics::kKinectDepth, [&](const auto&, const auto&) { measured.images.note(); });
  const auto scans = (*observer)->reader(topics::kKinectScan,
                                         [&](const auto&, const auto&) { measured.scans.note(); });
  const auto people = (*observer)->reader(
      topics::kPeople, [&](const auto&, const auto&) { measured.people.note(); });
  const auto beats = (*observer)->reader(topics::kHeartbeat, [&](const auto& beat, const auto&) {
    const auto percent = static_cast<double>(beat.cpu_percent());
    if (beat.component_name() == "depth_pipeline") measured.pipeline.note(percent);
    if (beat.component_name() == "people_detector") measured.detector.note(percent);
  });
  if (!images) return Error{images.error()};
  if (!scans) return Error{scans.error()};
  if (!people) return Error{people.error()};
  if (!beats) return Error{beats.error()};
  const auto wait = [&](steady_clock::duration length) {
    const auto until = steady_clock::now() + length;
    while (steady_clock::now() < until && !launcher->broken()) {
      launcher->poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  };
  wait(kSettling);
  measured.clear();
  show_progress(std::string("measuring frame rates: ") + setup.name);
  wait(kMeasured);
  show_progress("");
  if (launcher->broken()) return Error{"a component cannot be kept running"};
  return {};
}

void report(const Setup& setup, const Layer& layer, const Arrivals& arrivals, Table& table,
            ResultSheet& sheet) {
  const auto found = arrivals.rates();
  const std::string key = std::string(setup.prefix) + layer.key;
  const auto number = [](double value) { return format("%.2f", value); };
  if (found) {
    sheet.metrics[key + "_fps"] = found->average;
    sheet.metrics[key + "_fps_min"] = found->least;
    sheet.metrics[key + "_fps_max"] = found->most;
    sheet.metrics[key + "_fps_deviation"] = found->deviation;
    sheet.metrics[key + "_frame_time_ms_deviation"] = found->milliseconds;
  }
  const Rates ours = found.value_or(Rates{});
  table.add({layer.name, setup.name, number(ours.average), number(ours.least), number(ours.most),
             format("%.3f", ours.deviation), format("%.1f", ours.milliseconds),
             number(layer.average), number(layer.least), number(layer.most),
             format("%.3f", layer.deviation), format("%.1f", layer.milliseconds)});
}

void publish(const Layer& layer, ResultSheet& sheet) {
  const std::string key = layer.key;
  sheet.published[key + "_fps (thesis table 4.2)"] = layer.average;
  sheet.published[key + "_fps_deviation (thesis table 4.2)"] = layer.deviation;
  sheet.published[key + "_frame_time_ms_deviation (thesis, about)"] = layer.milliseconds;
}

void judge_scans(const std::string& prefix, ResultSheet& sheet) {
  sheet.targets[prefix + "depth_removal_fps"] = {Bound::kAtLeast, 29.5};
  sheet.targets[prefix + "depth_removal_frame_time_ms_deviation"] = {Bound::kAtMost, 1.0};
  sheet.targets[prefix + "depth_processes_load_percent"] = {Bound::kAtMost, 15.0};
}

void judge_people(const std::string& prefix, ResultSheet& sheet) {
  // It looks at every second image, so that half of the thesis' rate is all of ours.
  sheet.targets[prefix + "human_detection_fps"] = {Bound::kAtLeast, 14.75};
  sheet.targets[prefix + "human_detection_frame_time_ms_deviation"] = {Bound::kAtMost,
                                                                       kPeople.milliseconds};
}

}  // namespace

Status measure_depth_rates(const ExperimentOptions& options, ResultSheet& sheet) {
  const std::set<std::string> camera{"world", "segway_rmp", "sensor_board", "kinect",
                                     "depth_pipeline"};
  std::set<std::string> with_people = camera;
  with_people.insert("people_detector");
  // People are told of whenever laser or rear camera looked, too: only where there is neither, each
  // message stands for an image of the Kinect.
  const Setup robot{"", "whole robot", {}}, alone{"alone_", "cameras alone", camera},
      detecting{"alone_", "Kinect alone", with_people, false};
  for (const Layer& layer : {kImages, kScans, kPeople}) publish(layer, sheet);

  Table table({"processing", "of", "ave.", "min", "max", "std. dev.", "frame time ms dev.",
               "thesis ave.", "min", "max", "std. dev.", "about ms"});
  Measured of_robot, of_camera, of_detection;
  Status status = run(options, robot, of_robot);
  if (status) status = run(options, alone, of_camera);
  if (status) status = run(options, detecting, of_detection);
  if (!status) return status;
  report(robot, kImages, of_robot.images, table, sheet);
  report(robot, kScans, of_robot.scans, table, sheet);
  report(alone, kImages, of_camera.images, table, sheet);
  report(alone, kScans, of_camera.scans, table, sheet);
  report(detecting, kPeople, of_detection.people, table, sheet);
  const auto load = [&](const std::string& key, const Load& found) {
    if (const auto percent = found.percent()) sheet.metrics[key + "_load_percent"] = *percent;
  };
  load("depth_processes", of_robot.pipeline);
  load("alone_depth_processes", of_camera.pipeline);
  load("human_detection", of_robot.detector);
  load("alone_human_detection", of_detection.detector);
  for (const Setup* setup : {&robot, &alone}) judge_scans(setup->prefix, sheet);
  judge_people(detecting.prefix, sheet);
  std::printf("%s\n", table.text().c_str());
  return write_file(options.out + "/table-4.2.md", table.markdown());
}

}  // namespace usher::operations
