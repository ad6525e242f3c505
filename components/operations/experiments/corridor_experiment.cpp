#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "operations/command_line/table.hpp"
#include "operations/experiments/course_run.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/run_jobs.hpp"

namespace usher::operations {

namespace {

constexpr int kSeeds = 50;
constexpr double kStartJitter = 0.1;  // [m]
constexpr double kPaneJitter = 0.1;   // [m]
constexpr std::size_t kDrawn = 5;

struct Series {
  const char* name;
  bool ultrasonics;
  bool glass;
};

/// What was counted over the runs of a series.
struct Sums {
  double runs = 0, arrived = 0, contacts = 0, touched = 0, touches = 0, speed = 0, panes = 0,
         known = 0, seen = 0, seen_from = 0;
};

Result<Sums> drive(const ExperimentOptions& options, const Series& series, int seeds, Table& table,
                   std::string& csv, bool& repeats) {
  const auto deployment = load_deployment(
      options.installation.share + "/deploy/glass-corridor.yaml", options.installation, {});
  if (!deployment) return Error{deployment.error()};
  const std::string folder = options.out + "/" + series.name;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"cannot make " + folder + ": " + error.message()};
  const auto case_of = [&](std::size_t i) {
    return CourseCase{.seed = i + 1,
                      .start_jitter = kStartJitter,
                      .object_jitter = kPaneJitter,
                      .obstacles = series.glass,
                      .ultrasonics = series.ultrasonics,
                      .folder = folder,
                      .name = "world-" + std::to_string(i + 1)};
  };
  std::vector<CourseRun> runs(static_cast<std::size_t>(seeds));
  const Status done = run_jobs(runs.size(), series.name, [&](std::size_t i) -> Result<std::string> {
    auto run = run_course(*deployment, case_of(i));
    if (!run) return Error{run.error()};
    std::string said;
    if (series.ultrasonics && (!run->arrived || run->summary.contacts > 0)) {
      said = std::string(series.name) + "-" + std::to_string(i + 1) + ": " +
             (run->arrived ? "arrived" : run->outcome) + ", " +
             std::to_string(run->summary.contacts) + " contacts " + run->summary.contact_with +
             "\n" + (run->arrived ? "" : run->complaints);
      if (auto saved =
              write_file(folder + "/" + std::to_string(i + 1) + ".csv", run_csv(run->record));
          !saved)
        return Error{saved.error()};
    }
    if (i >= kDrawn) run->record = {};
    runs[i] = std::move(run).value();
    return said;
  });
  if (!done) return Error{done.error()};
  Sums sums;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const CourseRun& run = runs[i];
    ++sums.runs;
    sums.arrived += run.arrived ? 1 : 0;
    sums.contacts += run.summary.contacts;
    sums.touched += run.summary.contacts > 0 ? 1 : 0;
    sums.touches += run.summary.touches;
    sums.speed += run.summary.mean_speed;
    for (const auto& pane : run.objects) {
      ++sums.panes;
      sums.known += pane.in_time() ? 1 : 0;
      if (!pane.seen()) continue;
      ++sums.seen;
      sums.seen_from += pane.first_seen;
    }
    csv += std::string(series.name) + "," + std::to_string(i + 1) + "," +
           (run.arrived ? "1" : "0") + format(",%.2f", run.summary.seconds) +
           format(",%.2f", run.summary.path) + format(",%.3f", run.summary.mean_speed) + "," +
           std::to_string(run.summary.contacts) + "," + std::to_string(run.summary.touches) +
           format(",%.3f\n", run.summary.smallest_clearance);
  }
  table.add({series.name, format("%.0f", sums.runs), format("%.0f", sums.arrived),
             format("%.0f", sums.touched), format("%.0f", sums.contacts),
             format("%.2f", sums.speed / sums.runs), format("%.0f", sums.panes),
             format("%.0f", sums.known), figure("%.2f", sums.seen_from / sums.seen)});
  std::vector<const CourseRun*> drawn;
  drawn.reserve(kDrawn);
  for (const CourseRun& run : runs) {
    if (drawn.size() < kDrawn) drawn.push_back(&run);
  }
  if (auto saved = draw_course(*deployment, drawn, std::string("corridor, ") + series.name,
                               options.out + "/" + series.name + ".png");
      !saved)
    return Error{saved.error()};
  const auto again = run_course(*deployment, case_of(0));
  if (!again) return Error{again.error()};
  repeats = repeats && again->digest == runs.front().digest;
  return sums;
}

}  // namespace

Result<ResultSheet> run_corridor_experiment(const ExperimentOptions& options) {
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;
  ResultSheet sheet;
  sheet.name = "corridor";
  sheet.input = "a corridor of 2.6 x 14 m, " + std::to_string(seeds) + " seeds, lock-step" +
                (options.glass ? "; three glass panes that the map does not have" : "");
  Table table({"series", "runs", "arrived", "runs with contact", "contacts", "m/s", "panes",
               "in the costmap in time", "seen from, mean m"});
  std::string csv = "series,seed,arrived,seconds,path,speed,contacts,touches,clearance\n";
  bool repeats = true;
  std::vector<Series> all{{"ultrasonics", true, options.glass}};
  if (options.glass) all.push_back({"without-ultrasonics", false, true});
  for (const Series& series : all) {
    const auto sums = drive(options, series, seeds, table, csv, repeats);
    if (!sums) return Error{sums.error()};
    const std::string key = std::string("_") + (series.ultrasonics ? "with" : "without");
    sheet.metrics["arrived" + key] = sums->arrived;
    sheet.metrics["runs_with_contact" + key] = sums->touched;
    sheet.metrics["mean_speed_m_s" + key] = sums->speed / sums->runs;
    if (options.glass) sheet.metrics["panes_in_costmap_in_time" + key] = sums->known / sums->panes;
    if (!series.ultrasonics) continue;
    sheet.targets["arrived" + key] = {Bound::kAtLeast, sums->runs};
    sheet.targets["runs_with_contact" + key] = {Bound::kAtMost, 0.0};
  }
  sheet.flags["digest_repeats"] = repeats;
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/corridor.md", table.markdown());
  if (saved) saved = write_file(options.out + "/runs.csv", csv);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
