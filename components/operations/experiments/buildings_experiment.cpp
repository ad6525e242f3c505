#include <algorithm>
#include <cmath>
#include <filesystem>

#include "foundation/grid/map_file.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/building_map.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/run_jobs.hpp"

namespace usher::operations {

namespace {

constexpr std::size_t kGoals = 10;
constexpr double kLongest = 1200.0;     // [s] of the robot's time for one goal
constexpr double kArrival = 0.4;        // [m]
constexpr double kPaceTolerance = 0.5;  // [s] that a simulation of processes may fall behind
constexpr const char* kDdsBuilding = "pal_office";

/// Makes a robot run.
using Start = std::function<Result<std::unique_ptr<CommandedRobot>>(const Deployment&)>;

/// One way between two places.
struct Leg {
  std::string from, to;
  bool arrived = false;
  std::string outcome;  ///< empty when it arrived
  RunRecord record;
  RunRecord::Summary summary;
  std::uint32_t contacts = 0, touches = 0;  ///< on this leg
};

struct Tour {
  std::string building;
  std::uint64_t seed = 1;
  double side_x = 0.0, side_y = 0.0;  ///< [m] of the map
  std::vector<Leg> legs;
  double simulated = 0.0, processor = 0.0;  ///< [s]
  double worst_lag = 0.0;                   ///< [s]

  std::size_t arrivals() const {
    return static_cast<std::size_t>(
        std::count_if(legs.begin(), legs.end(), [](const Leg& leg) { return leg.arrived; }));
  }
};

std::string flat(std::string name) {
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

/// The site's file for a robot that starts at `start`.
Status write_site(const std::string& path, const std::string& map, const geometry::Pose2& start,
                  const std::vector<Place>& places) {
  const auto number = [](double value) { return format("%.6f", value); };
  std::string text = "map: " + map + "\ninitial_pose: [" + number(start.x) + ", " +
                     number(start.y) + ", " + number(start.yaw) + "]\nlocations:\n";
  for (const auto& place : places) {
    text += "  - {name: " + place.name + ", title: " + place.name + ", x: " + number(place.pose.x) +
            ", y: " + number(place.pose.y) + ", yaw: " + number(place.pose.yaw) + "}\n";
  }
  return write_file(path, text);
}

/// The robot's deployment in a building, standing at a place.
Result<Deployment> deploy(const ExperimentOptions& options, const std::string& site) {
  auto deployment = load_deployment(options.installation.share + "/deploy/marvin-sim.yaml",
                                    options.installation, {}, {}, site);
  if (!deployment) return deployment;
  if (!deployment->findings.empty()) {
    const auto& first = deployment->findings.front();
    return Error{to_string(first.verdict) + ": " + first.text + " (" + first.origin + ")"};
  }
  return deployment;
}

/// Drives to one place and judges.
Result<Leg> drive(CommandedRobot& robot, const Place& from, const Place& to,
                  RunRecord::Summary& before) {
  const auto sent = robot.send(to.name, kLongest);
  if (!sent) return Error{sent.error()};
  Leg leg{.from = from.name, .to = to.name, .outcome = sent->reason, .record = robot.take_record()};
  leg.summary = leg.record.summary();
  leg.contacts = leg.summary.contacts - before.contacts;
  leg.touches = leg.summary.touches - before.touches;
  before = leg.summary;
  const auto truth = leg.record.truth();
  if (!sent->reported || !truth) return leg;
  const double off = (truth->position() - to.pose.position()).norm();
  leg.arrived = off < kArrival;
  leg.outcome =
      leg.arrived ? "" : "reports its arrival " + format("%.2f", off) + " m from the goal";
  return leg;
}

/// All goals in sequence; after a failure a new robot stands where the last one should have
/// arrived, so that every leg is judged.
Result<Tour> tour(const ExperimentOptions& options, const BuildingMap& building, std::uint64_t seed,
                  const Start& start) {
  const auto map = load_building_map(building);
  if (!map) return Error{map.error()};
  const auto places = choose_places(building, *map, kGoals, seed);
  if (!places) return Error{places.error()};
  const std::string folder = options.out + "/" + flat(building.name);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"cannot make " + folder + ": " + error.message()};
  std::string map_file = std::filesystem::absolute(building.file).string();
  if (building.resolution > 0.0) {
    map_file = std::filesystem::absolute(folder + "/map.yaml").string();
    if (auto saved = grid::save_map(*map, map_file); !saved) return Error{saved.error()};
  }

  Tour tour{.building = building.name, .seed = seed};
  tour.side_x = map->width() * map->resolution();
  tour.side_y = map->height() * map->resolution();
  std::unique_ptr<CommandedRobot> robot;
  RunRecord::Summary before;
  const auto account = [&] {
    if (robot == nullptr) return;
    tour.simulated += robot->elapsed();
    tour.processor += robot->processor_time();
    robot.reset();
  };
  for (std::size_t i = 1; i < places->size(); ++i) {
    const Place& from = (*places)[i - 1];
    if (robot == nullptr) {
      const std::string site = folder + "/site-" + std::to_string(seed) + ".yaml";
      if (auto saved = write_site(site, map_file, from.pose, *places); !saved)
        return Error{saved.error()};
      const auto deployment = deploy(options, site);
      if (!deployment) return Error{deployment.error()};
      auto made = start(*deployment);
      if (!made) return Error{made.error()};
      robot = std::move(made).value();
      before = {};
    }
    auto leg = drive(*robot, from, (*places)[i], before);
    if (!leg) return Error{leg.error()};
    tour.worst_lag = std::max(tour.worst_lag, leg->summary.worst_lag);
    if (!leg->arrived || leg->contacts > 0) {
      show_progress("");
      std::printf("%s, seed %d, %s -> %s (%.2f, %.2f): %s%s\n%s", tour.building.c_str(),
                  static_cast<int>(seed), from.name.c_str(), (*places)[i].name.c_str(),
                  (*places)[i].pose.x, (*places)[i].pose.y,
                  leg->arrived ? "arrived" : leg->outcome.c_str(),
                  leg->contacts > 0 ? (", contact with " + leg->summary.contact_with).c_str() : "",
                  robot->complaints().c_str());
      std::fflush(stdout);
    }
    if (!leg->arrived) {
      const std::string name = folder + "/leg-" + std::to_string(seed) + "-" + std::to_string(i);
      Status saved = write_file(name + ".csv", run_csv(leg->record));
      if (saved) saved = draw_run(leg->record, *map, leg->outcome, name + ".png");
      if (!saved) return Error{saved.error()};
      account();
    }
    tour.legs.push_back(std::move(leg).value());
    show_progress(tour.building + ": " + std::to_string(i) + " of " +
                  std::to_string(places->size() - 1));
  }
  account();
  std::vector<RunRecord> records;
  for (const auto& leg : tour.legs) records.push_back(leg.record);
  const std::string title = building.name + ": " + std::to_string(tour.arrivals()) + " of " +
                            std::to_string(tour.legs.size()) + " goals reached";
  const std::string picture = options.out + "/" + flat(building.name) +
                              (seed > 1 ? "-" + std::to_string(seed) : "") + ".png";
  if (auto drawn = draw_runs(records, *map, title, picture); !drawn) return Error{drawn.error()};
  for (auto& leg : tour.legs) leg.record = {};
  return tour;
}

/// Sums over legs.
struct Sums {
  double goals = 0, arrivals = 0, contacts = 0, touches = 0, path = 0, seconds = 0;
  double error = 0, estimates = 0, worst_error = 0, simulated = 0, processor = 0;
  double clearance = INFINITY;

  void add(const Leg& leg) {
    const auto& s = leg.summary;
    goals += 1;
    arrivals += leg.arrived ? 1 : 0;
    contacts += leg.contacts;
    touches += leg.touches;
    path += s.path;
    seconds += s.seconds;
    error += s.localization_mean * static_cast<double>(s.estimates);
    estimates += static_cast<double>(s.estimates);
    worst_error = std::max(worst_error, s.localization_max);
    clearance = std::min(clearance, s.smallest_clearance);
  }
  double mean_error() const { return estimates > 0 ? error / estimates : NAN; }
  double mean_speed() const { return seconds > 0 ? path / seconds : NAN; }
  double factor() const { return processor > 0 ? simulated / processor : NAN; }
};

std::string legs_csv(const std::vector<Tour>& tours) {
  std::string csv =
      "building,seed,from,to,arrived,seconds,path,speed,clearance,error_mean,error_max,contacts,"
      "touches,outcome\n";
  for (const auto& tour : tours) {
    for (const auto& leg : tour.legs) {
      const auto& s = leg.summary;
      csv += tour.building + "," + std::to_string(tour.seed) + "," + leg.from + "," + leg.to + "," +
             (leg.arrived ? "1" : "0") + format(",%.2f", s.seconds) + format(",%.2f", s.path) +
             format(",%.3f", s.mean_speed) + format(",%.3f", s.smallest_clearance) +
             format(",%.4f", s.localization_mean) + format(",%.4f", s.localization_max) + "," +
             std::to_string(leg.contacts) + "," + std::to_string(leg.touches) + ",\"" +
             leg.outcome + "\"\n";
    }
  }
  return csv;
}

Result<ResultSheet> report(const ExperimentOptions& options, const std::vector<Tour>& tours,
                           bool in_process) {
  ResultSheet sheet;
  Sums all;
  Table table({"building", "m x m", "goals", "arrivals", "contacts", "touches", "path m", "m/s",
               "clearance m", "error mean m", "error max m", "x real time"});
  for (const auto& tour : tours) {
    Sums sums;
    for (const auto& leg : tour.legs) {
      sums.add(leg);
      all.add(leg);
    }
    sums.simulated = tour.simulated;
    sums.processor = tour.processor;
    all.simulated += tour.simulated;
    all.processor += tour.processor;
    table.add({tour.building, format("%.0f", tour.side_x) + " x " + format("%.0f", tour.side_y),
               format("%.0f", sums.goals), format("%.0f", sums.arrivals),
               format("%.0f", sums.contacts), format("%.0f", sums.touches),
               format("%.0f", sums.path), format("%.2f", sums.mean_speed()),
               format("%.2f", sums.clearance), format("%.3f", sums.mean_error()),
               format("%.3f", sums.worst_error),
               in_process ? format("%.1f", sums.factor()) : std::string("1")});
  }
  sheet.metrics = {{"buildings", static_cast<double>(tours.size())},
                   {"goals", all.goals},
                   {"arrivals", all.arrivals},
                   {"contacts", all.contacts},
                   {"touches", all.touches},
                   {"localization_error_mean_m", all.mean_error()},
                   {"localization_error_max_m", all.worst_error},
                   {"mean_speed_m_s", all.mean_speed()},
                   {"path_m", all.path}};
  if (in_process) {
    sheet.metrics["realtime_factor"] = all.factor();
  } else {
    sheet.flags["kept_pace"] = std::all_of(tours.begin(), tours.end(), [](const Tour& tour) {
      return tour.worst_lag < kPaceTolerance;
    });
  }
  sheet.targets = {{"arrivals", {Bound::kAtLeast, all.goals}}, {"contacts", {Bound::kAtMost, 0.0}}};
  std::printf("\n%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/legs.csv", legs_csv(tours));
  if (saved) saved = write_file(options.out + "/buildings.md", table.markdown());
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace

Result<ResultSheet> run_buildings_experiment(const ExperimentOptions& options) {
  const auto buildings = choose_buildings(options.data, options.only);
  if (!buildings) return Error{buildings.error()};
  const auto seeds = static_cast<std::size_t>(std::max(1, options.seeds));
  std::vector<std::optional<Tour>> tours(buildings->size() * seeds);
  const Status toured = run_jobs(tours.size(), "tours", [&](std::size_t i) -> Result<std::string> {
    const std::uint64_t seed = i % seeds + 1;
    auto result = tour(options, (*buildings)[i / seeds], seed, [&](const Deployment& deployment) {
      return lockstep_robot(deployment, seed);
    });
    if (!result) return Error{result.error()};
    tours[i] = std::move(result).value();
    return std::string();
  });
  if (!toured) return Error{toured.error()};
  std::vector<Tour> done;
  done.reserve(tours.size());
  for (auto& tour : tours) done.push_back(std::move(*tour));
  auto sheet = report(options, done, true);
  if (!sheet) return sheet;
  sheet->name = "buildings";
  sheet->input = "maps of real buildings, ten goals each, deploy/marvin-sim.yaml in lock-step";
  return sheet;
}

Result<ResultSheet> run_buildings_dds_experiment(const ExperimentOptions& options) {
  const auto buildings =
      choose_buildings(options.data, options.only.empty() ? kDdsBuilding : options.only);
  if (!buildings) return Error{buildings.error()};
  std::vector<Tour> tours;
  for (const auto& building : *buildings) {
    auto result = tour(options, building, 1, [&](const Deployment& deployment) {
      return process_robot(deployment, 1, options.installation, options.domain,
                           options.out + "/run");
    });
    if (!result) return Error{result.error()};
    tours.push_back(std::move(result).value());
  }
  auto sheet = report(options, tours, false);
  if (!sheet) return sheet;
  sheet->name = "buildings-dds";
  sheet->input = "ten goals in a real building, deploy/marvin-sim.yaml as DDS processes";
  return sheet;
}

}  // namespace usher::operations
