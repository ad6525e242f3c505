#include <array>
#include <cmath>
#include <limits>

#include "operations/command_line/table.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"

namespace usher::operations {

namespace {

constexpr int kSeeds = 10;
constexpr double kLongest = 180.0;  // [s] for one leg of the way
constexpr double kLost = 1.0;       // [m] whoever is farther off is lost
constexpr std::size_t kBins = 400;  // [s] that the plot shows

/// Through both ends of the arena and back, in the spirit of figure 5.
constexpr std::array<const char*, 4> kWay{"lounge", "meeting_room_2", "meeting_room_1", "start"};

struct Filter {
  const char* name;
  const char* key;
  int red, green, blue;
  std::vector<Override> overrides;
};

const std::vector<Filter>& filters() {
  static const std::vector<Filter> all = {
      {"AMCL with refinement on the scan", "amcl", 60, 140, 60, {}},
      {"AMCL without refinement", "amcl_plain", 40, 80, 200, {{"amcl", "refine_beams", "0"}}},
      // A fixed number of particles, no recovery, nothing but motion and sensor model.
      {"MCL of algorithm 2",
       "mcl",
       200,
       40,
       40,
       {{"amcl", "refine_beams", "0"},
        {"amcl", "min_particles", "1000"},
        {"amcl", "max_particles", "1000"},
        {"amcl", "recovery_slow", "0"},
        {"amcl", "recovery_fast", "0"}}}};
  return all;
}

struct Run {
  std::vector<RunRecord::Error> errors;
  RunRecord::Summary summary;
  bool arrived = true;
  std::string words;
  std::vector<geometry::Point2> way;
};

Result<Run> drive(const Deployment& deployment, std::uint64_t seed) {
  auto robot = lockstep_robot(deployment, seed);
  if (!robot) return Error{robot.error()};
  Run run;
  for (const char* place : kWay) {
    const auto arrival = (*robot)->send(place, kLongest);
    if (!arrival) return Error{arrival.error()};
    if (arrival->reported) continue;
    run.arrived = false;
    run.words = std::string(place) + ": " + arrival->reason + "\n" + (*robot)->complaints();
    break;
  }
  const RunRecord record = (*robot)->take_record();
  run.errors = record.localization_errors();
  run.summary = record.summary();
  for (const auto& sample : record.samples()) {
    if (run.way.empty() || (run.way.back() - sample.truth.position()).norm() > 0.05)
      run.way.push_back(sample.truth.position());
  }
  return run;
}

/// Of all estimates of all runs.
struct Score {
  double n = 0, sum = 0, squares = 0, worst = 0, lost = 0, missed = 0, contacts = 0;
  void add(const Run& run) {
    double farthest = 0.0;
    for (const auto& error : run.errors) {
      ++n;
      sum += error.distance;
      squares += error.distance * error.distance;
      farthest = std::max(farthest, error.distance);
    }
    worst = std::max(worst, farthest);
    lost += farthest > kLost ? 1 : 0;
    missed += run.arrived ? 0 : 1;
    contacts += run.summary.contacts;
  }
  double mean() const { return n > 0 ? sum / n : std::numeric_limits<double>::infinity(); }
  double deviation() const {
    return n > 0 ? std::sqrt(std::max(0.0, squares / n - mean() * mean())) : 0.0;
  }
};

/// The mean error of all runs in each second of the way.
Curve curve_of(const Filter& filter, const std::vector<std::optional<Run>>& runs) {
  std::array<double, kBins> sums{}, counts{};
  for (const auto& run : runs) {
    if (run->errors.empty()) continue;
    const auto begin = run->errors.front().stamp;
    for (const auto& error : run->errors) {
      const auto second = static_cast<std::size_t>(runtime::seconds(error.stamp - begin));
      if (second >= kBins) break;
      sums[second] += error.distance;
      ++counts[second];
    }
  }
  Curve curve{filter.name, filter.red, filter.green, filter.blue, {}};
  for (std::size_t i = 0; i < kBins; ++i) {
    if (counts[i] > 0.0) curve.points.emplace_back(static_cast<double>(i), sums[i] / counts[i]);
  }
  return curve;
}

Status draw_way(const Deployment& deployment, const Run& run, const std::string& path) {
  const auto map = site_map(deployment);
  if (!map) return Error{map.error()};
  return draw_ways({{"driven", 60, 140, 60, 2, run.way}}, *map, "the way of the first run", path);
}

}  // namespace

Result<ResultSheet> run_tracking_error_experiment(const ExperimentOptions& options) {
  std::vector<std::string> names;
  for (const Filter& filter : filters()) names.emplace_back(filter.key);
  const auto only = only_of(options.only, names);
  if (!only) return Error{only.error()};
  const auto seeds = static_cast<std::size_t>(options.seeds > 0 ? options.seeds : kSeeds);
  std::vector<Deployment> deployments;
  std::vector<const Filter*> chosen;
  for (const Filter& filter : filters()) {
    if (!only->takes(filter.key)) continue;
    auto deployment = load_deployment(options.installation.share + "/deploy/meeting-sim.yaml",
                                      options.installation, filter.overrides);
    if (!deployment) return Error{deployment.error()};
    deployments.push_back(std::move(deployment).value());
    chosen.push_back(&filter);
  }
  std::vector<std::vector<std::optional<Run>>> runs(chosen.size());
  for (auto& row : runs) row.resize(seeds);
  const Status done =
      run_jobs(chosen.size() * seeds, "rounds", [&](std::size_t i) -> Result<std::string> {
        const std::size_t filter = i % chosen.size(), seed = i / chosen.size();
        auto run = drive(deployments[filter], seed + 1);
        if (!run) return Error{run.error()};
        runs[filter][seed] = std::move(run).value();
        const Run& made = *runs[filter][seed];
        if (made.arrived) return std::string();
        return std::string(chosen[filter]->key) + ", seed " + std::to_string(seed + 1) +
               ", not at " + made.words;
      });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = "tracking-error";
  sheet.input = "a round of four legs through the arena, Pioneer with URG-04LX, " +
                std::to_string(seeds) + " seeds for each filter, lock-step";
  Table table(
      {"filter", "rounds", "mean m", "deviation m", "worst m", "lost", "not arrived", "contacts"});
  std::string csv = "filter,seed,mean_m,max_m,arrived,contacts\n";
  std::vector<Curve> curves;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    Score score;
    for (std::size_t seed = 0; seed < seeds; ++seed) {
      const Run& run = *runs[f][seed];
      score.add(run);
      csv += std::string(chosen[f]->key) + "," + std::to_string(seed + 1) +
             format(",%.4f", run.summary.localization_mean) +
             format(",%.4f,", run.summary.localization_max) + (run.arrived ? "1," : "0,") +
             std::to_string(run.summary.contacts) + "\n";
    }
    table.add({chosen[f]->name, std::to_string(seeds), format("%.4f", score.mean()),
               format("%.4f", score.deviation()), format("%.3f", score.worst),
               format("%.0f", score.lost), format("%.0f", score.missed),
               format("%.0f", score.contacts)});
    const std::string key = chosen[f]->key;
    sheet.metrics["mean_m_" + key] = score.mean();
    sheet.metrics["lost_" + key] = score.lost;
    curves.push_back(curve_of(*chosen[f], runs[f]));
    if (f != 0) continue;
    sheet.metrics["not_arrived"] = score.missed;
    sheet.metrics["contacts"] = score.contacts;
    sheet.targets["mean_m_" + key] = {Bound::kAtMost, 0.015};
    sheet.targets["lost_" + key] = {Bound::kAtMost, 0.0};
    sheet.targets["not_arrived"] = {Bound::kAtMost, 0.0};
    sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  }
  sheet.published = {
      {"mean_m_amcl", 0.019}, {"mean_m_mcl (Penny)", 0.071}, {"mean_m_mcl (Leslie)", 0.085}};
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/filters.md", table.markdown());
  if (saved) saved = write_file(options.out + "/rounds.csv", csv);
  if (saved)
    saved = draw_plot(curves, "tracking error, mean of all rounds", "time [s]", "error [m]",
                      options.out + "/errors.png");
  if (saved) saved = draw_way(deployments.front(), *runs.front().front(), options.out + "/way.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
