#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"
#include "operations/experiments/site_facts.hpp"

namespace usher::operations {

namespace {

using std::chrono::seconds;

constexpr auto kLongest = seconds(600);
constexpr double kArrival = 0.4;  // [m]
constexpr double kVisitor = 3.5;  // [m]

struct Setup {
  const char* name;
  const char* manifest;
  int seeds;
};
constexpr Setup kModelled{"guide", "demo.yaml", 100};
constexpr Setup kRendered{"guide-pixels", "demo-pixels.yaml", 5};

struct Visit {
  std::string destination;
  bool arrived = false;
  std::string outcome, complaints;
  double simulated = 0.0, wall = 0.0;  // [s]
  RunRecord::Summary summary;
  std::uint64_t digest = 0;
  std::uint64_t held_back = 0;  ///< times that movement_control's guard held back the navigation
};

Result<Visit> visit(Deployment deployment, const std::string& place, std::uint64_t seed,
                    const std::string& trace, const grid::OccupancyGrid* map) {
  set_value(deployment, "visitor", "destination", place);
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  Visit visit;
  visit.destination = place;
  const auto start = std::chrono::steady_clock::now();
  auto& world = (*run)->world();
  const auto& record = (*run)->record();
  const auto over = [&] {
    return !record.dialogue().empty() &&
           (record.dialogue().back() == "end" || record.dialogue().back() == "guide_error");
  };
  while (world.elapsed() < kLongest && !over()) world.run_for(std::chrono::milliseconds(500));
  visit.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  visit.simulated = runtime::seconds(world.elapsed());
  visit.summary = record.summary();
  visit.digest = world.digest();
  visit.complaints = (*run)->complaints();
  visit.held_back = (*run)->counter("movement_control", "guard: held back the navigation");
  const auto truth = record.truth();
  const auto person = record.person("visitor");
  const bool served = std::find(record.dialogue().begin(), record.dialogue().end(),
                                "guide_success") != record.dialogue().end();
  if (truth && person && record.navigation()) {
    const auto& goal = record.navigation()->goal().pose().position();
    visit.arrived = served && std::hypot(truth->x - goal.x(), truth->y - goal.y()) < kArrival &&
                    (truth->position() - *person).norm() < kVisitor;
  }
  visit.outcome = record.dialogue().empty() ? "no dialogue" : record.dialogue().back();
  if (record.navigation() && !record.navigation()->reason().empty())
    visit.outcome += ": " + record.navigation()->reason();
  if (!trace.empty() && map != nullptr) {
    Status saved = write_file(trace + ".csv", run_csv(record));
    if (saved)
      saved = draw_run(record, *map, "seed " + std::to_string(seed) + ": " + place, trace + ".png");
    if (!saved) return Error{saved.error()};
  }
  return visit;
}

Result<ResultSheet> run_guide(const Setup& setup, const ExperimentOptions& options) {
  const auto given = only_seed(options.only);
  if (!given) return Error{given.error()};
  const auto deployment = load_deployment(options.installation.share + "/deploy/" + setup.manifest,
                                          options.installation, {});
  if (!deployment) return Error{deployment.error()};
  const auto names = site_locations(*deployment);
  if (!names) return Error{names.error()};
  const int only = static_cast<int>(*given);
  const int seeds = std::max(only, options.seeds > 0 ? options.seeds : setup.seeds);

  std::vector<std::optional<Visit>> visits(static_cast<std::size_t>(seeds));
  const auto run_seed = [&](std::size_t i) -> Result<std::string> {
    // Every place gets its turn; the first one is where the robot stands.
    const auto& place = (*names)[1 + i % (names->size() - 1)];
    auto result = visit(*deployment, place, i + 1, "", nullptr);
    if (!result) return Error{result.error()};
    std::string said;
    if (!result->arrived || result->summary.contacts > 0) {
      const std::string seed = std::to_string(i + 1);
      said = "seed " + seed + " to " + place + ": " +
             (result->arrived ? "arrived" : result->outcome) + ", " +
             std::to_string(result->summary.contacts) + " contacts " +
             result->summary.contact_with + " (replay: usher experiment " + setup.name +
             " --only " + seed + ")\n" + result->complaints;
    }
    visits[i] = std::move(result).value();
    return said;
  };
  const std::size_t first = only > 0 ? static_cast<std::size_t>(only - 1) : 0;
  const Status done = run_jobs(only > 0 ? 1 : visits.size(), "visits",
                               [&](std::size_t i) { return run_seed(first + i); });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = setup.name;
  sheet.input = std::to_string(seeds) + " seeded visits in the office, lock-step";
  Table table({"seed", "to", "arrived", "s", "m", "m/s", "clearance m", "error mean m",
               "error max m", "contacts", "touches", "held back", "outcome"});
  std::string csv =
      "seed,destination,arrived,seconds,path,speed,clearance,error_mean,error_max,contacts,"
      "touches,held_back\n";
  double arrivals = 0, contacts = 0, touches = 0, held_back = 0, error_sum = 0, estimates = 0,
         worst_error = 0, simulated = 0, wall = 0, path = 0, time = 0;
  double clearance = 1e9;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (!visits[i]) continue;
    const Visit& v = *visits[i];
    const auto& s = v.summary;
    arrivals += v.arrived ? 1 : 0;
    contacts += s.contacts;
    touches += s.touches;
    held_back += static_cast<double>(v.held_back);
    error_sum += s.localization_mean * static_cast<double>(s.estimates);
    estimates += static_cast<double>(s.estimates);
    worst_error = std::max(worst_error, s.localization_max);
    simulated += v.simulated;
    wall += v.wall;
    path += s.path;
    time += s.seconds;
    clearance = std::min(clearance, s.smallest_clearance);
    table.add({std::to_string(i + 1), v.destination, v.arrived ? "yes" : "no",
               format("%.0f", s.seconds), format("%.1f", s.path), format("%.2f", s.mean_speed),
               format("%.2f", s.smallest_clearance), format("%.3f", s.localization_mean),
               format("%.3f", s.localization_max), std::to_string(s.contacts),
               std::to_string(s.touches), std::to_string(v.held_back), v.outcome});
    csv += std::to_string(i + 1) + "," + v.destination + "," + (v.arrived ? "1" : "0") +
           format(",%.2f", s.seconds) + format(",%.2f", s.path) + format(",%.3f", s.mean_speed) +
           format(",%.3f", s.smallest_clearance) + format(",%.4f", s.localization_mean) +
           format(",%.4f", s.localization_max) + "," + std::to_string(s.contacts) + "," +
           std::to_string(s.touches) + "," + std::to_string(v.held_back) + "\n";
  }
  sheet.metrics = {{"arrivals", arrivals},
                   {"contacts", contacts},
                   {"touches", touches},
                   {"held_back_by_the_guard", held_back},
                   {"localization_error_mean_m", estimates > 0 ? error_sum / estimates : NAN},
                   {"localization_error_max_m", worst_error},
                   {"smallest_clearance_m", clearance},
                   {"mean_speed_m_s", time > 0 ? path / time : 0.0},
                   {"simulated_s_per_wall_s_and_thread", wall > 0 ? simulated / wall : 0.0}};
  sheet.published = {{"localization_error_mean_m", 0.019}, {"mean_speed_m_s", 0.72}};
  sheet.targets = {{"arrivals", {Bound::kAtLeast, only > 0 ? 1.0 : static_cast<double>(seeds)}},
                   {"contacts", {Bound::kAtMost, 0.0}},
                   {"localization_error_mean_m", {Bound::kAtMost, 0.019}}};
  // The first seed once more, with picture and trace: the same bytes.
  const auto map = site_map(*deployment);
  const auto again = visit(*deployment, visits[first]->destination, first + 1, options.out + "/run",
                           map ? &*map : nullptr);
  if (!again) return Error{again.error()};
  sheet.flags["digest_repeats"] = again->digest == visits[first]->digest;
  if (auto saved = write_file(options.out + "/visits.csv", csv); !saved)
    return Error{saved.error()};
  if (auto saved = write_file(options.out + "/visits.md", table.markdown()); !saved)
    return Error{saved.error()};
  return sheet;
}

}  // namespace

Result<ResultSheet> run_guide_experiment(const ExperimentOptions& options) {
  return run_guide(kModelled, options);
}

Result<ResultSheet> run_guide_pixels_experiment(const ExperimentOptions& options) {
  return run_guide(kRendered, options);
}

}  // namespace usher::operations
