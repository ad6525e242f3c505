#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "navigation/explorer/core/ground.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using explorer::SeenArea;
using std::chrono::milliseconds;

constexpr int kSeeds = 3;
constexpr double kMinutes = 8.0;
constexpr auto kLook = milliseconds(100);  // between two looks of the judge
constexpr auto kAskEvery = milliseconds(1000);
constexpr auto kPatience = milliseconds(60000);  // until the exploration has begun
constexpr double kTurnRate = 0.4;                // [rad/s] and 0.7 m/s, the robot's pace: R IV-E
constexpr std::string_view kChosen = "information_gain";

/// A row of figure 12, or one of ours.
struct Variant {
  const char* strategy;
  const char* levels;  ///< "[4, 2, 1]"; empty = none
  double published;    ///< [%] figure 12; 0 = not in it
  int red, green, blue;
  std::string key() const {
    std::string key = strategy;
    for (const char* c = levels; *c != '\0'; ++c) {
      if (*c >= '0' && *c <= '9') key += std::string("_") + *c;
    }
    return key;
  }
};
constexpr std::array<Variant, 10> kVariants = {{{"information_gain", "", 0.0, 200, 40, 40},
                                                {"frontier", "", 0.0, 60, 140, 60},
                                                {"cell", "[2, 1]", 91.3, 150, 170, 230},
                                                {"cell", "[4, 2, 1]", 94.0, 40, 80, 200},
                                                {"cell", "[6, 4, 2]", 93.5, 110, 140, 220},
                                                {"cell", "[8, 6, 4]", 93.7, 80, 110, 210},
                                                {"grid", "[2, 1]", 89.4, 220, 150, 40},
                                                {"grid", "[4, 2, 1]", 86.4, 230, 180, 90},
                                                {"grid", "[6, 4, 2]", 83.5, 235, 200, 130},
                                                {"grid", "[8, 6, 4]", 82.8, 240, 215, 165}}};

struct Site {
  grid::OccupancyGrid map;
  std::vector<explorer::Rectangle> rooms;
};

/// What the robot was given.
Result<Site> site_of(const Deployment& deployment) {
  auto map = site_map(deployment);
  if (!map) return Error{map.error()};
  const auto rooms = site_meeting_rooms(deployment);
  if (!rooms) return Error{rooms.error()};
  Site site{std::move(map).value(), {}};
  for (const SiteRoom& room : *rooms) site.rooms.push_back({room.low, room.high});
  return site;
}

struct Exploration {
  std::vector<double> coverage;     ///< [%] each second, from 0 on
  grid::Grid<std::uint32_t> looks;  ///< of the judge, per cell
  std::vector<geometry::Point2> way;
  RunRecord::Summary summary;
  usher_msgs::msg::ExploreStatus status;
  std::string complaints;
};

/// The judge: what the camera saw by the true pose, each cell that a ray passes (R IV-E-2).
class Judge {
 public:
  Judge(const Site& site, SeenArea seen) : seen_(std::move(seen)) {
    seen_.set_map(site.map, site.rooms);
    result_.looks = grid::Grid<std::uint32_t>(site.map.geometry(), 0);
  }
  void look(const geometry::Pose2& truth) {
    for (const std::uint32_t cell : seen_.view(truth)) ++result_.looks[cell];
    seen_.look(truth);
    if (looks_++ % 10 == 0) result_.coverage.push_back(100.0 * seen_.coverage());
    result_.way.push_back(truth.position());
  }
  Exploration& result() { return result_; }

 private:
  SeenArea seen_;
  Exploration result_;
  std::uint64_t looks_ = 0;
};

Result<Exploration> explore(const Deployment& deployment, const Site& site, std::uint64_t seed,
                            double minutes) {
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  auto& world = (*run)->world();
  auto seen = SeenArea::create({});
  if (!seen) return Error{seen.error()};
  Judge judge(site, std::move(seen).value());
  Exploration& result = judge.result();

  constexpr std::uint64_t kId = 1000;
  usher_msgs::msg::ExploreGoal goal;
  goal.client(Errand::kClient);
  goal.anew(true);
  const auto ask = [&] { world.publish(topics::kExploreGoal, goal, Errand::kClient); };
  const auto tell = [&](const usher_msgs::msg::NavigateGoal& start) {
    goal.id(start.id());
    ask();
  };
  Errand errand("exploration", kId,
                {[&](const auto& request) {
                   world.publish(topics::kSupervisorRequest, request, Errand::kClient);
                 },
                 tell});
  world.observe(topics::kSupervisorStatus,
                [&](const auto& status, const auto&) { errand.take(status); });
  world.observe(topics::kExploreStatus,
                [&](const auto& status, const auto&) { result.status = status; });
  const auto begun = [&] { return goal.id() != 0 && result.status.id() == goal.id(); };
  while (!begun() && world.elapsed() < kPatience && !errand.over()) {
    errand.step();
    world.run_for(milliseconds(200));
  }
  if (!begun())
    return Error{"the exploration did not begin: " + errand.reason() + "\n" + (*run)->complaints()};
  const auto until = world.now() + runtime::from_seconds(60.0 * minutes);
  for (auto ask_at = world.now(); world.now() < until;) {
    if (world.now() >= ask_at) {  // the explorer ends when nobody asks any more
      ask();
      ask_at += kAskEvery;
    }
    if (const auto truth = (*run)->record().truth()) judge.look(*truth);
    world.run_for(kLook);
  }
  result.summary = (*run)->record().summary();
  result.complaints = (*run)->complaints();
  return result;
}

/// [%] of what is to be looked at that can be seen from anywhere that the robot can stand.
double visible_at_all(const Site& site) {
  auto seen = SeenArea::create({});
  explorer::Ground ground;
  if (!seen || !ground.set_map(site.map, site.rooms, 0.24, 0.30)) return 0.0;
  seen->set_map(site.map, site.rooms);
  const auto& g = site.map.geometry();
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!ground.standing().free_at(i)) continue;
    const auto place = g.center(g.cell(i));
    for (int d = 0; d < 8; ++d) seen->look({place.x(), place.y(), d * geometry::kPi / 4.0});
  }
  return 100.0 * seen->coverage();
}

std::string name_of(const Variant& variant) {
  std::string name = variant.strategy;
  if (*variant.levels != '\0') name += std::string(" ") + variant.levels;
  return name;
}

struct Row {
  const Variant* variant = nullptr;
  std::vector<std::optional<Exploration>> runs;  ///< by seed
  double mean() const {
    double sum = 0.0;
    for (const auto& run : runs) sum += run->coverage.back();
    return sum / static_cast<double>(runs.size());
  }
  const Exploration& best() const {
    return **std::max_element(runs.begin(), runs.end(), [](const auto& a, const auto& b) {
      return a->coverage.back() < b->coverage.back();
    });
  }
};

std::string coverage_csv(const std::vector<Row>& rows) {
  std::string csv = "t";
  std::size_t seconds = 0;
  for (const Row& row : rows) {
    for (std::size_t seed = 0; seed < row.runs.size(); ++seed) {
      csv += "," + row.variant->key() + "_seed_" + std::to_string(seed + 1);
      seconds = std::max(seconds, row.runs[seed]->coverage.size());
    }
  }
  csv += "\n";
  for (std::size_t t = 0; t < seconds; ++t) {
    csv += std::to_string(t);
    for (const Row& row : rows) {
      for (const auto& run : row.runs)
        csv += format(",%.3f", t < run->coverage.size() ? run->coverage[t] : run->coverage.back());
    }
    csv += "\n";
  }
  return csv;
}

Status draw(const std::vector<Row>& rows, const Site& site, const std::string& out) {
  std::vector<Curve> curves;
  const auto best_of = [&](std::string_view strategy) {
    const Row* best = nullptr;
    for (const Row& row : rows) {
      if (row.variant->strategy == strategy && (best == nullptr || row.mean() > best->mean()))
        best = &row;
    }
    return best;
  };
  for (const char* strategy : {"information_gain", "frontier", "cell", "grid"}) {
    const Row* row = best_of(strategy);
    if (row == nullptr) continue;
    const Variant& v = *row->variant;
    auto& curve = curves.emplace_back(Curve{name_of(v), v.red, v.green, v.blue, {}});
    const auto& coverage = row->best().coverage;
    for (std::size_t t = 0; t < coverage.size(); ++t)
      curve.points.emplace_back(static_cast<double>(t), coverage[t]);
    if (Status saved = draw_heat_map(site.map, row->best().looks, row->best().way,
                                     name_of(v) + format(": %.1f %% seen", coverage.back()),
                                     out + "/heat_" + strategy + ".png");
        !saved)
      return saved;
  }
  return draw_plot(curves, "coverage, the best run of the best variant of each strategy",
                   "time [s]", "seen [%]", out + "/coverage.png");
}

}  // namespace

Result<ResultSheet> run_coverage_experiment(const ExperimentOptions& options) {
  std::vector<std::string> names;
  for (const Variant& variant : kVariants) {
    for (const std::string& name : {std::string(variant.strategy), variant.key()}) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  const auto only = only_of(options.only, names);
  if (!only) return Error{only.error()};
  const double minutes = options.minutes > 0.0 ? options.minutes : kMinutes;
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;
  std::vector<Row> rows;
  std::vector<Deployment> deployments;
  for (const Variant& variant : kVariants) {
    if (!only->takes(variant.key()) && !only->takes(variant.strategy)) continue;
    std::vector<Override> overrides = {
        {"local_planner", "fastest_turn", format("%g", kTurnRate)},
        {"local_planner", "spot_turn", format("%g", kTurnRate)},
        {"local_planner", "recovery_turn_rate", format("%g", kTurnRate)},
        {"explorer", "turn_rate", format("%g", kTurnRate)},
        {"explorer", "strategy", variant.strategy}};
    if (*variant.levels != '\0') overrides.push_back({"explorer", "levels", variant.levels});
    auto deployment = load_deployment(options.installation.share + "/deploy/meeting-sim.yaml",
                                      options.installation, overrides);
    if (!deployment) return Error{deployment.error()};
    deployments.push_back(std::move(deployment).value());
    rows.push_back(
        {&variant, std::vector<std::optional<Exploration>>(static_cast<std::size_t>(seeds))});
  }
  const auto site = site_of(deployments.front());
  if (!site) return Error{site.error()};

  const std::size_t jobs = rows.size() * static_cast<std::size_t>(seeds);
  const Status done = run_jobs(jobs, "explorations", [&](std::size_t i) -> Result<std::string> {
    const std::size_t row = i % rows.size(), seed = i / rows.size();
    const std::string key = rows[row].variant->key();
    auto result = explore(deployments[row], *site, seed + 1, minutes);
    if (!result) return Error{key + ": " + result.error()};
    const bool explores =
        result->status.state() <= usher_msgs::msg::GoalStatus_Constants::STATE_WAITING;
    std::string said;
    if (result->summary.contacts > 0 || !result->status.reason().empty() || !explores) {
      said = key + ", seed " + std::to_string(seed + 1) + ": " +
             std::to_string(result->summary.contacts) + " contacts " +
             result->summary.contact_with + ", " + (explores ? "" : "ended: ") +
             result->status.reason() + "\n" + result->complaints;
    }
    rows[row].runs[seed] = std::move(result).value();
    return said;
  });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = "coverage";
  sheet.input = "the arena without its meeting rooms, " + format("%g minutes, ", minutes) +
                std::to_string(seeds) + " seeds, lock-step";
  Table table({"strategy", "seen %", "worst %", "fig. 12 %", "at 2 min", "at 4 min", "views",
               "given up", "rounds", "m driven", "contacts"});
  std::uint32_t contacts = 0;
  for (const Row& row : rows) {
    double worst = 100.0, two = 0.0, four = 0.0, driven = 0.0, views = 0.0, given_up = 0.0,
           rounds = 0.0;
    std::uint32_t touched = 0;
    const auto n = static_cast<double>(row.runs.size());
    for (const auto& run : row.runs) {
      const auto at = [&](std::size_t t) {
        return run->coverage[std::min(t, run->coverage.size() - 1)] / n;
      };
      worst = std::min(worst, run->coverage.back());
      two += at(120), four += at(240);
      driven += run->summary.path / n;
      views += run->status.views() / n;
      given_up += run->status.given_up() / n;
      rounds += run->status.round() / n;
      touched += run->summary.contacts;
    }
    contacts += touched;
    const Variant& v = *row.variant;
    table.add({name_of(v), format("%.1f", row.mean()), format("%.1f", worst),
               v.published > 0.0 ? format("%.1f", v.published) : "", format("%.1f", two),
               format("%.1f", four), format("%.0f", views), format("%.1f", given_up),
               format("%.1f", rounds), format("%.0f", driven), std::to_string(touched)});
    sheet.metrics["coverage_percent_" + v.key()] = row.mean();
    if (v.published > 0.0) sheet.published["coverage_percent_" + v.key()] = v.published;
    if (std::string_view(v.strategy) != kChosen) continue;
    sheet.metrics["coverage_percent_worst"] = worst;
    sheet.targets["coverage_percent_" + v.key()] = {Bound::kAtLeast, 98.0};
    sheet.published["coverage_percent_" + v.key()] = 94.0;
  }
  sheet.metrics["visible_percent"] = visible_at_all(*site);
  sheet.metrics["contacts"] = contacts;
  sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/strategies.md", table.markdown());
  if (saved) saved = write_file(options.out + "/coverage.csv", coverage_csv(rows));
  if (saved) saved = draw(rows, *site, options.out);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
