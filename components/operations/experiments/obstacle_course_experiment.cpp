#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "foundation/geometry/angle.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/course_run.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"

namespace usher::operations {

namespace {

constexpr int kTrials = 5;
constexpr int kSeeds = 100;
constexpr double kStartJitter = 0.1;   // [m]; who drives back by hand hits the start no better
constexpr double kObjectJitter = 0.1;  // [m]
constexpr double kMostFalseBearings = 0.005;  // as the experiment depth-pipeline
constexpr const char* kBar = "3_extrusion";

/// What is driven how often.
struct Series {
  const char* name;
  const char* manifest;
  bool moved;  ///< the objects stand elsewhere with each seed
  bool pitch_hidden;
  bool judged = true;  ///< else only reported
};
constexpr std::array<Series, 3> kAll{
    {{"trials", "obstacle-course-pixels.yaml", false, false},
     {"seeds", "obstacle-course.yaml", true, false},
     {"no-pitch", "obstacle-course-pixels.yaml", false, true, false}}};

/// Sums over the runs of a series.
struct Sums {
  double runs = 0, arrived = 0, contacts = 0, touches = 0, speed = 0, squares = 0, path = 0,
         seconds = 0, steepest = 0, false_scans = 0, scans = 0, false_share = 0, false_costmaps = 0,
         costmaps = 0, in_time = 0, bar_in_time = 0, simulated = 0, wall = 0;

  void add(const CourseRun& run) {
    const auto& s = run.summary;
    ++runs;
    arrived += run.arrived ? 1 : 0;
    contacts += s.contacts, touches += s.touches;
    speed += s.mean_speed, squares += s.mean_speed * s.mean_speed;
    path += s.path, seconds += s.seconds;
    steepest = std::max(steepest, run.steepest);
    false_scans += static_cast<double>(run.false_scans);
    scans += static_cast<double>(run.scans);
    false_costmaps += static_cast<double>(run.false_costmaps);
    costmaps += static_cast<double>(run.costmaps);
    false_share += run.false_share;
    simulated += run.simulated, wall += run.wall;
    in_time += run.all_in_time() ? 1 : 0;
    for (const auto& object : run.objects)
      bar_in_time += object.name == kBar && object.in_time() ? 1 : 0;
  }
  double mean_speed() const { return speed / runs; }
  double deviation() const {
    return std::sqrt(std::max(0.0, squares / runs - mean_speed() * mean_speed()));
  }
};

/// One object over the runs of a series.
struct Seen {
  double runs = 0, in_time = 0, sum = 0, count = 0, least = INFINITY, closest = INFINITY,
         steepest = -INFINITY;
};

void add_objects(const std::string& series, const std::vector<CourseRun>& runs, Table& table) {
  if (runs.empty()) return;
  for (std::size_t i = 0; i < runs.front().objects.size(); ++i) {
    Seen seen;
    for (const CourseRun& run : runs) {
      const auto& object = run.objects[i];
      ++seen.runs;
      seen.in_time += object.in_time() ? 1 : 0;
      seen.closest = std::min(seen.closest, object.closest);
      if (!object.seen()) continue;
      ++seen.count;
      seen.sum += object.first_seen;
      seen.least = std::min(seen.least, object.first_seen);
      seen.steepest = std::max(seen.steepest, std::abs(object.first_pitch));
    }
    table.add({series, runs.front().objects[i].name, format("%.0f", seen.runs),
               format("%.0f", seen.in_time), figure("%.2f", seen.sum / seen.count),
               figure("%.2f", seen.least), figure("%.1f", geometry::degrees(seen.steepest)),
               figure("%.2f", seen.closest)});
  }
}

std::string report(const std::string& name, const CourseRun& run) {
  std::string text = name + ": " + (run.arrived ? "arrived" : run.outcome) +
                     format(", %.0f contacts ", run.summary.contacts) + run.summary.contact_with +
                     "\n";
  for (const auto& object : run.objects) {
    if (object.in_time()) continue;
    text += "  " + object.name +
            (object.seen() ? format(": first seen from %.2f m", object.first_seen)
                           : std::string(": never seen")) +
            format(", not in the costmap for %.2f s", object.too_late) +
            format(" and %.2f s later\n", object.forgotten);
  }
  return text + (run.arrived ? "" : run.complaints);
}

Status draw(const Deployment& deployment, const std::string& out, const std::string& series,
            const std::vector<CourseRun>& runs) {
  std::vector<const CourseRun*> drawn;
  std::vector<Curve> curves;
  drawn.reserve(kTrials);
  curves.reserve(kTrials);
  for (const CourseRun& run : runs) {
    if (drawn.size() == kTrials) break;
    const int shade = 40 * static_cast<int>(drawn.size());
    Curve curve{series + " " + std::to_string(drawn.size() + 1), 220 - shade, 40 + shade, 60, {}};
    curve.points.reserve(run.record.samples().size());
    for (const auto& sample : run.record.samples()) {
      curve.points.emplace_back(runtime::seconds(sample.stamp - run.record.samples().front().stamp),
                                sample.v);
    }
    curves.push_back(std::move(curve));
    drawn.push_back(&run);
  }
  const std::string title =
      "obstacle course, " + series + ": " + std::to_string(drawn.size()) + " runs";
  if (auto done = draw_course(deployment, drawn, title, out + "/" + series + ".png"); !done)
    return done;
  return draw_plot(curves, title, "time [s]", "velocity [m/s]", out + "/" + series + "-speed.png");
}

}  // namespace

Result<ResultSheet> run_obstacle_course_experiment(const ExperimentOptions& options) {
  const auto only = only_of(options.only, names_of(kAll));
  if (!only) return Error{only.error()};
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;
  ResultSheet sheet;
  sheet.name = "obstacle-course";
  sheet.input = "objects of table 8.2 in a room of 12 x 6 m, at most 0.6 m/s, lock-step; " +
                std::to_string(kTrials) + " trials with rendered images, " + std::to_string(seeds) +
                " seeds with the fitted depth model";
  Table drives({"series", "runs", "arrived", "contacts", "m", "s", "m/s", "std. dev.", "pitch deg",
                "all objects in time", "the bar", "false scans", "false costmaps", "x real time"});
  Table objects({"series", "object", "runs", "in time", "seen from, mean m", "least m",
                 "pitch then deg", "closest m"});
  std::string csv =
      "series,seed,arrived,seconds,path,speed,contacts,touches,clearance,steepest,false_scans,"
      "scans,"
      "false_bearings_share,false_costmaps,costmaps\n";
  for (const Series& series : kAll) {
    if (!only->takes(series.name)) continue;
    auto deployment = load_deployment(options.installation.share + "/deploy/" + series.manifest,
                                      options.installation, {});
    if (!deployment) return Error{deployment.error()};
    const auto case_of = [&](std::size_t i) {
      return CourseCase{.seed = i + 1,
                        .start_jitter = kStartJitter,
                        .object_jitter = series.moved ? kObjectJitter : 0.0,
                        .pitch_hidden = series.pitch_hidden,
                        .folder = options.out,
                        .name = "world-" + std::to_string(i + 1)};
    };
    std::vector<CourseRun> runs(static_cast<std::size_t>(series.moved ? seeds : kTrials));
    const Status done =
        run_jobs(runs.size(), series.name, [&](std::size_t i) -> Result<std::string> {
          auto run = run_course(*deployment, case_of(i));
          if (!run) return Error{run.error()};
          const std::string name = std::string(series.name) + "-" + std::to_string(i + 1);
          const bool fine = run->arrived && run->summary.contacts == 0 && run->all_in_time();
          if (!fine || i < kTrials) {
            if (auto saved = write_file(options.out + "/" + name + ".csv", run_csv(run->record));
                !saved)
              return Error{saved.error()};
          }
          if (i >= kTrials && fine) run->record = {};
          const std::string said = fine ? "" : report(name, *run);
          runs[i] = std::move(run).value();
          return said;
        });
    if (!done) return Error{done.error()};
    Sums sums;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const CourseRun& run = runs[i];
      sums.add(run);
      csv += std::string(series.name) + "," + std::to_string(i + 1) + "," +
             (run.arrived ? "1" : "0") + format(",%.2f", run.summary.seconds) +
             format(",%.2f", run.summary.path) + format(",%.3f", run.summary.mean_speed) +
             format(",%.0f", run.summary.contacts) + format(",%.0f", run.summary.touches) +
             format(",%.3f", run.summary.smallest_clearance) +
             format(",%.2f", geometry::degrees(run.steepest)) +
             format(",%.0f", static_cast<double>(run.false_scans)) +
             format(",%.0f", static_cast<double>(run.scans)) + format(",%.6f", run.false_share) +
             format(",%.0f", static_cast<double>(run.false_costmaps)) +
             format(",%.0f\n", static_cast<double>(run.costmaps));
    }
    add_objects(series.name, runs, objects);
    drives.add({series.name, format("%.0f", sums.runs), format("%.0f", sums.arrived),
                format("%.0f", sums.contacts), format("%.1f", sums.path / sums.runs),
                format("%.1f", sums.seconds / sums.runs), format("%.2f", sums.mean_speed()),
                format("%.2f", sums.deviation()), format("%.1f", geometry::degrees(sums.steepest)),
                format("%.0f", sums.in_time), format("%.0f", sums.bar_in_time),
                figure("%.4f", sums.false_scans / sums.scans),
                format("%.0f", sums.false_costmaps) + format(" of %.0f", sums.costmaps),
                format("%.1f", sums.simulated / sums.wall)});
    const std::string key = "_" + std::string(series.name);
    sheet.metrics["arrived" + key] = sums.arrived;
    sheet.metrics["contacts" + key] = sums.contacts;
    sheet.metrics["mean_speed_m_s" + key] = sums.mean_speed();
    sheet.metrics["steepest_pitch_deg" + key] = geometry::degrees(sums.steepest);
    sheet.metrics["all_objects_in_time" + key] = sums.in_time;
    sheet.metrics["bar_in_time" + key] = sums.bar_in_time;
    sheet.metrics["false_bearings_share" + key] = sums.false_share / sums.runs;
    sheet.metrics["false_costmaps" + key] = sums.false_costmaps;
    sheet.metrics["simulated_s_per_wall_s_and_thread" + key] = sums.simulated / sums.wall;
    if (series.judged) {
      sheet.targets["arrived" + key] = {Bound::kAtLeast, sums.runs};
      sheet.targets["contacts" + key] = {Bound::kAtMost, 0.0};
      sheet.targets["mean_speed_m_s" + key] = {Bound::kAtLeast, series.moved ? 0.37 : 0.39};
      sheet.published["mean_speed_m_s" + key] = series.moved ? 0.37 : 0.39;
      sheet.targets["all_objects_in_time" + key] = {Bound::kAtLeast, sums.runs};
      sheet.targets["false_costmaps" + key] = {Bound::kAtMost, 0.0};
      sheet.targets["false_bearings_share" + key] = {Bound::kAtMost, kMostFalseBearings};
      sheet.targets["bar_in_time" + key] = {Bound::kAtLeast, 0.95 * sums.runs};
    }
    if (auto drawn = draw(*deployment, options.out, series.name, runs); !drawn)
      return Error{drawn.error()};
    if (!series.moved) continue;
    const auto again = run_course(*deployment, case_of(0));
    if (!again) return Error{again.error()};
    sheet.flags["digest_repeats"] = again->digest == runs.front().digest;
  }
  std::printf("%s\n%s\n", drives.text().c_str(), objects.text().c_str());
  Status saved = write_file(options.out + "/drives.md", drives.markdown());
  if (saved) saved = write_file(options.out + "/objects.md", objects.markdown());
  if (saved) saved = write_file(options.out + "/runs.csv", csv);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
