#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "localization/amcl/core/amcl.hpp"
#include "mapping/map_server/core/map_from_log.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_record.hpp"

namespace usher::operations {

namespace fs = std::filesystem;

namespace {

constexpr int kSeeds = 5;
constexpr std::size_t kMapEvery = 2;
constexpr double kWrong = 0.5;      // [m] an estimate this wrong ...
constexpr double kLossTime = 2.0;   // [s] ... for so long is a loss
constexpr double kSigma = 0.5;      // [m] of the initial pose, as amcl's parameter has it
constexpr double kYawSigma = 0.25;  // [rad]
constexpr const char* kJudged = "freiburg-079";

struct Log {
  std::string name;
  std::vector<map_server::CarmenScan> scans;
  std::vector<geometry::Pose2> reference;
};

struct Sample {
  double time = 0.0;  ///< [s] since the first scan
  geometry::Pose2 estimate;
  double error = 0.0;           ///< [m] of the estimate
  double yaw_error = 0.0;       ///< [rad]
  double odometry_error = 0.0;  ///< [m] of raw odometry from the same start
  bool in_map = false;          ///< the map was made from this scan too
  amcl::Confidence confidence = amcl::Confidence::kLost;
};

/// What one run over a log found.
struct Track {
  std::vector<Sample> samples;
  double mean = 0.0, mean_unmapped = 0.0, rms = 0.0, p95 = 0.0, worst = 0.0;  ///< [m]
  double yaw_mean = 0.0;                                                      ///< [rad]
  double not_good = 0.0;  ///< [0, 1] share of scans at which it does not trust itself
  int losses = 0;         ///< times that it was wrong for long
};

std::vector<std::string> find_logs(const std::string& folder) {
  constexpr std::string_view kEnding = ".clf.gz";
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::string name = entry.path().filename().string();
    if (!name.ends_with(kEnding)) continue;
    name.resize(name.size() - kEnding.size());
    if (fs::exists(folder + "/" + name + ".ref.txt.gz")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<Log> read_log(const std::string& folder, const std::string& name) {
  auto scans = map_server::read_carmen_log(folder + "/" + name + ".clf.gz");
  if (!scans) return Error{scans.error()};
  auto reference = map_server::read_reference_poses(folder + "/" + name + ".ref.txt.gz");
  if (!reference) return Error{reference.error()};
  return Log{name, std::move(scans).value(), std::move(reference).value()};
}

void summarize(Track& track) {
  std::vector<double> errors;
  double unmapped = 0.0, squares = 0.0;
  std::size_t unmapped_count = 0;
  std::optional<double> wrong_since;
  bool lost = false;
  for (const Sample& sample : track.samples) {
    errors.push_back(sample.error);
    track.mean += sample.error;
    squares += sample.error * sample.error;
    track.yaw_mean += sample.yaw_error;
    track.not_good += sample.confidence == amcl::Confidence::kGood ? 0.0 : 1.0;
    if (!sample.in_map) unmapped += sample.error, ++unmapped_count;
    if (sample.error <= kWrong) {
      wrong_since.reset();
      lost = false;
    } else if (!wrong_since) {
      wrong_since = sample.time;
    } else if (!lost && sample.time - *wrong_since > kLossTime) {
      lost = true;
      ++track.losses;
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, errors.size()));
  track.mean /= count;
  track.rms = std::sqrt(squares / count);
  track.yaw_mean /= count;
  track.not_good /= count;
  track.mean_unmapped = unmapped / static_cast<double>(std::max<std::size_t>(1, unmapped_count));
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return;
  track.p95 = errors[errors.size() * 95 / 100];
  track.worst = errors.back();
}

/// Localizes on the whole log; what the rest of the robot would believe at each scan is compared
/// with the scan's reference pose. Odometry, estimate and reference are poses of the laser.
Result<Track> track(const Log& log, const grid::OccupancyGrid& map, std::uint64_t seed) {
  amcl::Amcl localization(amcl::AmclConfig{}, seed);
  if (auto set = localization.set_map(map); !set) return Error{log.name + ": " + set.error()};
  const Eigen::Matrix3d spread =
      Eigen::Vector3d(kSigma * kSigma, kSigma * kSigma, kYawSigma * kYawSigma).asDiagonal();
  if (auto set = localization.set_initial_pose(log.reference.front(), spread); !set)
    return Error{log.name + ": " + set.error()};
  Track track;
  const geometry::Pose2 map_T_odom0 =
      log.reference.front() * geometry::inverse(log.scans.front().odom_T_laser);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const auto& scan = log.scans[i];
    localization.update(scan.odom_T_laser, {{},
                                            scan.angle_min(),
                                            scan.angle_increment(),
                                            0.0,
                                            map_server::kCarmenMaxRange,
                                            scan.ranges});
    const auto& estimate = localization.estimate();
    if (!estimate) return Error{log.name + ": no estimate at line " + std::to_string(scan.line)};
    auto& sample = track.samples.emplace_back();
    sample.time = scan.time - log.scans.front().time;
    sample.estimate = estimate->map_T_odom() * scan.odom_T_laser;
    sample.error = geometry::distance(sample.estimate, log.reference[i]);
    sample.yaw_error = std::abs(geometry::shortest_turn(log.reference[i].yaw, sample.estimate.yaw));
    sample.odometry_error = geometry::distance(map_T_odom0 * scan.odom_T_laser, log.reference[i]);
    sample.in_map = i % kMapEvery == 0;
    sample.confidence = estimate->quality.confidence;
  }
  summarize(track);
  return track;
}

std::string track_csv(const Log& log, const Track& track) {
  std::string csv = "t,x,y,yaw,reference_x,reference_y,reference_yaw,error,odometry_error,in_map\n";
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    const Sample& s = track.samples[i];
    const auto& r = log.reference[i];
    csv += format("%.3f", s.time) + format(",%.4f", s.estimate.x) + format(",%.4f", s.estimate.y) +
           format(",%.4f", s.estimate.yaw) + format(",%.4f", r.x) + format(",%.4f", r.y) +
           format(",%.4f", r.yaw) + format(",%.4f", s.error) + format(",%.4f", s.odometry_error) +
           (s.in_map ? ",1\n" : ",0\n");
  }
  return csv;
}

Status draw(const Log& log, const grid::OccupancyGrid& map, const Track& track,
            const std::string& out) {
  Curve error{"estimate", 30, 110, 180, {}};
  DrawnWay reference{"reference", 60, 150, 60, 2, {}}, estimate{"estimate", 210, 60, 40, 1, {}};
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    error.points.emplace_back(track.samples[i].time, track.samples[i].error);
    reference.points.push_back(log.reference[i].position());
    estimate.points.push_back(track.samples[i].estimate.position());
  }
  const std::string title = log.name + ": mean error " + format("%.3f", track.mean) + " m, " +
                            std::to_string(log.scans.size()) + " scans";
  if (auto drawn = draw_plot({error}, title, "time [s]", "position error [m]",
                             out + "/" + log.name + "-error.png");
      !drawn)
    return drawn;
  return draw_ways({reference, estimate}, map, title, out + "/" + log.name + "-track.png");
}

std::string key(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

}  // namespace

Result<ResultSheet> run_tracking_log_experiment(const ExperimentOptions& options) {
  if (options.data.empty()) return Error{"USHER_TEST_DATA names no folder with logs"};
  const std::string folder = options.data + "/carmen/rawodom";
  auto names = find_logs(folder);
  if (names.empty()) return Error{"no log with reference poses in " + folder};
  const auto only = only_of(options.only, names);
  if (!only) return Error{only.error()};
  std::erase_if(names, [&](const auto& name) { return !only->takes(name); });
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;

  ResultSheet sheet;
  sheet.name = "tracking-log";
  sheet.input =
      "logs in carmen/rawodom, raw odometry and laser, map from every second reference "
      "scan, " +
      std::to_string(seeds) + " seeds";
  Table table({"log", "seed", "scans", "error mean m", "unmapped scans m", "rms m", "p95 m",
               "max m", "yaw mean deg", "not good", "losses"});
  for (const auto& name : names) {
    const auto log = read_log(folder, name);
    if (!log) return Error{log.error()};
    if (log->scans.empty()) return Error{name + ": no scans"};
    const auto map = map_server::map_from_log(log->scans, log->reference, kMapEvery);
    if (!map) return Error{name + ": " + map.error()};
    double mean = 0.0, worst = 0.0, losses = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      show_progress(name + ", seed " + std::to_string(seed) + " of " + std::to_string(seeds));
      const auto found = track(*log, *map, static_cast<std::uint64_t>(seed));
      if (!found) return Error{found.error()};
      mean += found->mean / seeds;
      worst = std::max(worst, found->worst);
      losses += found->losses;
      table.add({name, std::to_string(seed), std::to_string(log->scans.size()),
                 format("%.4f", found->mean), format("%.4f", found->mean_unmapped),
                 format("%.4f", found->rms), format("%.3f", found->p95),
                 format("%.3f", found->worst), format("%.2f", geometry::degrees(found->yaw_mean)),
                 format("%.1f %%", 100.0 * found->not_good), std::to_string(found->losses)});
      if (seed > 1) continue;
      Status saved = write_file(options.out + "/" + name + ".csv", track_csv(*log, *found));
      if (saved) saved = draw(*log, *map, *found, options.out);
      if (!saved) return Error{saved.error()};
    }
    sheet.metrics[key(name) + "_error_mean_m"] = mean;
    sheet.metrics[key(name) + "_error_max_m"] = worst;
    sheet.metrics[name == kJudged ? "losses" : key(name) + "_losses"] = losses;
  }
  show_progress("");
  if (std::find(names.begin(), names.end(), kJudged) != names.end()) {
    sheet.targets = {{key(kJudged) + "_error_mean_m", {Bound::kAtMost, 0.05}},
                     {"losses", {Bound::kAtMost, 0.0}}};
  }
  std::printf("%s\n", table.text().c_str());
  if (auto saved = write_file(options.out + "/logs.md", table.markdown()); !saved)
    return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
