#include <array>
#include <cstdio>
#include <optional>

#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/meeting_run.hpp"
#include "operations/experiments/only.hpp"
#include "operations/experiments/run_jobs.hpp"

namespace usher::operations {

namespace {

constexpr int kSeeds = 10;

/// R IV-F: which rooms somebody is in, as seen from where the robot starts.
struct WorldState {
  const char* name;
  bool first, second;  ///< occupied
  double published;    ///< [s]
  double target;       ///< [s]
};
constexpr std::array<WorldState, 3> kStates{{{"both_free", false, false, 85.0, 60.0},
                                             {"first_occupied", true, false, 142.0, 105.0},
                                             {"both_occupied", true, true, 142.0, 90.0}}};
/// Opposite corners; the room that is nearest by the length of the way.
struct Start {
  const char* name;
  geometry::Pose2 pose;
  const char* nearest;
};
const std::array<Start, 2> kStarts{{{"south_west", {1.5, 1.5, 1.5708}, "meeting_room_1"},
                                    {"north_east", {14.8, 8.6, 3.1416}, "meeting_room_2"}}};
/// Where somebody may stand in a room.
const std::array<std::array<geometry::Point2, 4>, 2> kSpots{
    {{{{0.7, 8.8}, {0.7, 9.7}, {3.6, 11.2}, {1.0, 11.5}}},
     {{{15.2, 3.2}, {12.3, 0.7}, {13.6, 0.8}, {15.4, 2.6}}}}};

struct Trial {
  std::size_t world = 0, start = 0;
  std::uint64_t seed = 0;
  std::optional<MeetingRun> run;
  bool right() const {
    const auto& m = run->status.mission();
    const std::uint32_t occupied =
        (kStates[world].first ? 1U : 0U) + (kStates[world].second ? 1U : 0U);
    const bool found = occupied == 2 || !m.room().empty();
    return found && m.rooms_occupied() == occupied && run->first_room == kStarts[start].nearest &&
           run->summary.contacts == 0;
  }
};

MeetingCase case_of(const Trial& trial) {
  const WorldState& world = kStates[trial.world];
  MeetingCase one;
  one.start = kStarts[trial.start].pose;
  one.longest = 300.0;
  Random random(stream_seed(trial.seed, "find room"));
  const std::array<bool, 2> occupied{trial.start == 0 ? world.first : world.second,
                                     trial.start == 0 ? world.second : world.first};
  for (std::size_t room = 0; room < 2; ++room) {
    const auto spot = static_cast<std::size_t>(random.uniform() * 4.0);
    if (occupied[room])
      one.people.push_back({"sitter_" + std::to_string(room + 1), kSpots[room][spot], false});
  }
  const bool both = world.first && world.second;
  one.over = [both](const usher_msgs::msg::MeetingStatus& status) {
    return both ? status.mission().rooms_occupied() >= 2 : !status.mission().room().empty();
  };
  return one;
}

std::string name_of(const Trial& trial) {
  return std::string(kStates[trial.world].name) + "_" + kStarts[trial.start].name + "_" +
         std::to_string(trial.seed);
}

}  // namespace

Result<ResultSheet> run_find_room_experiment(const ExperimentOptions& options) {
  const auto only = only_of(options.only, names_of(kStates));
  if (!only) return Error{only.error()};
  const auto deployment = meeting_deployment(options);
  if (!deployment) return Error{deployment.error()};
  const int seeds = options.seeds > 0 ? options.seeds : kSeeds;
  std::vector<Trial> trials;
  for (std::size_t world = 0; world < kStates.size(); ++world) {
    if (!only->takes(kStates[world].name)) continue;
    for (std::size_t start = 0; start < kStarts.size(); ++start) {
      for (int seed = 1; seed <= seeds; ++seed)
        trials.push_back({world, start, static_cast<std::uint64_t>(seed), {}});
    }
  }
  const Status done =
      run_jobs(trials.size(), "searches", [&](std::size_t i) -> Result<std::string> {
        Trial& trial = trials[i];
        const std::string title = trial.seed == 1 ? name_of(trial) : "";
        auto run = run_meeting(*deployment, case_of(trial), trial.seed, options.out, name_of(trial),
                               title);
        if (!run) return Error{name_of(trial) + ": " + run.error()};
        trial.run = std::move(run).value();
        return std::string();
      });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = "find-room";
  sheet.input = "the arena, three world states, two starts, " + std::to_string(seeds) +
                " seeds each, 0.7 m/s and 0.4 rad/s, lock-step";
  Table table({"rooms", "start", "runs", "right", "nearest first", "mean", "longest", "R fig. IV-F",
               "faces checked", "contacts"});
  std::string csv = "world,start,seed,right,first_room,seconds,checked,refused,contacts\n";
  double wrong = 0.0, not_nearest = 0.0, contacts = 0.0, wall = 0.0, simulated = 0.0;
  for (std::size_t world = 0; world < kStates.size(); ++world) {
    double sum = 0.0, runs = 0.0;
    for (std::size_t start = 0; start < kStarts.size(); ++start) {
      double n = 0, right = 0, nearest = 0, mean = 0, longest = 0, checked = 0, touched = 0;
      for (const Trial& trial : trials) {
        if (trial.world != world || trial.start != start) continue;
        const MeetingRun& run = *trial.run;
        const auto& mission = run.status.mission();
        ++n;
        right += trial.right() ? 1 : 0;
        nearest += run.first_room == kStarts[start].nearest ? 1 : 0;
        mean += run.seconds;
        longest = std::max(longest, run.seconds);
        checked += mission.faces_checked();
        touched += run.summary.contacts;
        wall += run.wall, simulated += run.simulated;
        csv += std::string(kStates[world].name) + "," + kStarts[start].name + "," +
               std::to_string(trial.seed) + "," + (trial.right() ? "1" : "0") + "," +
               run.first_room + format(",%.1f,", run.seconds) +
               std::to_string(mission.faces_checked()) + "," +
               std::to_string(mission.faces_refused()) + "," +
               std::to_string(run.summary.contacts) + "\n";
        if (!trial.right())
          std::printf("%s: %s after %s, first %s, %u occupied, contacts %u %s\n%s",
                      name_of(trial).c_str(), mission.reason().c_str(),
                      minutes(run.seconds).c_str(), run.first_room.c_str(),
                      mission.rooms_occupied(), run.summary.contacts,
                      run.summary.contact_with.c_str(), run.complaints.c_str());
      }
      if (n == 0) continue;
      table.add({kStates[world].name, kStarts[start].name, format("%.0f", n), format("%.0f", right),
                 format("%.0f", nearest), minutes(mean / n), minutes(longest),
                 minutes(kStates[world].published), format("%.1f", checked / n),
                 format("%.0f", touched)});
      sum += mean, runs += n;
      wrong += n - right, not_nearest += n - nearest, contacts += touched;
    }
    if (runs == 0) continue;
    const std::string key = std::string("mean_s_") + kStates[world].name;
    sheet.metrics[key] = sum / runs;
    sheet.published[key] = kStates[world].published;
    sheet.targets[key] = {Bound::kAtMost, kStates[world].target};
  }
  sheet.metrics["wrong"] = wrong;
  sheet.metrics["not_nearest_first"] = not_nearest;
  sheet.metrics["contacts"] = contacts;
  sheet.metrics["simulated_s_per_wall_s_and_thread"] = wall > 0.0 ? simulated / wall : 0.0;
  for (const char* key : {"wrong", "not_nearest_first", "contacts"})
    sheet.targets[key] = {Bound::kAtMost, 0.0};
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/searches.md", table.markdown());
  if (saved) saved = write_file(options.out + "/searches.csv", csv);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
