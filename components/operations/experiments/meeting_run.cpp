#include "operations/experiments/meeting_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>

#include "navigation/explorer/core/seen_area.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/results/result_sheet.hpp"
#include "tasks/meeting/core/mission.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
namespace state = usher_msgs::msg::MeetingStatus_Constants;

constexpr auto kLook = milliseconds(100);
constexpr auto kToSeats = std::chrono::seconds(4);
constexpr double kInView = 1.0;     // [s] somebody is missed who was in view for so long
constexpr double kOutOfView = 1.0;  // [s] and is no more
constexpr double kPatience = 60.0;  // [s] until the mission has begun
constexpr const char* kOperator = "operator";
constexpr const char* kTurnRate = "0.4";  // [rad/s] R IV-E

/// Who was in view of the exploring robot, and whom it passed by. Who is in a meeting room is there
/// already, and nobody is looked for there.
class MissJudge {
 public:
  MissJudge(const grid::OccupancyGrid& map, std::vector<SiteRoom> rooms, explorer::SeenArea seen)
      : seen_(std::move(seen)), rooms_(std::move(rooms)) {
    seen_.set_map(map, {});
  }
  std::uint32_t missed() const { return missed_; }

  void look(const RunRecord& record, const MeetingCase& one, std::uint8_t now_in) {
    const auto truth = record.truth();
    if (!truth) return;
    if (now_in != state::STATE_EXPLORE) {  // it checks, asks or guides somebody
      if (now_in != state::STATE_REVISIT) encounters_.clear();
      return;
    }
    const auto view = seen_.view(*truth);
    for (const MeetingPerson& person : one.people) {
      const auto at = record.person(person.name);
      if (!at || !person.comes || in_a_room(*at)) continue;
      const auto cell = seen_.geometry().cell_at(*at);
      const bool seen =
          seen_.geometry().contains(cell) &&
          std::find(view.begin(), view.end(), seen_.geometry().index(cell)) != view.end();
      Encounter& encounter = encounters_[person.name];
      if (seen) {
        encounter.seen += 0.1;
        encounter.gone = 0.0;
      } else if (encounter.seen > 0.0) {
        encounter.gone += 0.1;
        if (encounter.gone < kOutOfView) continue;
        missed_ += encounter.seen >= kInView ? 1 : 0;
        encounter = {};
      }
    }
  }

 private:
  struct Encounter {
    double seen = 0.0, gone = 0.0;  // [s]
  };
  bool in_a_room(const geometry::Point2& at) const {
    return std::any_of(rooms_.begin(), rooms_.end(),
                       [&](const SiteRoom& room) { return room.contains(at); });
  }

  explorer::SeenArea seen_;
  std::vector<SiteRoom> rooms_;
  std::map<std::string, Encounter> encounters_;
  std::uint32_t missed_ = 0;
};

Status put_people(Deployment& deployment, const MeetingCase& one, const std::string& path) {
  std::string file = "people:\n", come, stray;
  for (const MeetingPerson& person : one.people) {
    file += "  - {name: " + person.name + format(", at: [%.3f, ", person.at.x()) +
            format("%.3f], yaw: 0.0, watches: true}\n", person.at.y());
    std::string& names = person.strays ? stray : come;
    if (person.comes) names += (names.empty() ? "" : " ") + person.name;
  }
  if (one.people.empty()) file = "people: []\n";
  if (Status saved = write_file(path, file); !saved) return saved;
  set_site_value(deployment, "site.people", std::filesystem::absolute(path).string());
  set_value(deployment, "attendees", "come", come.empty() ? "\"\"" : come);
  set_value(deployment, "attendees", "stray", stray.empty() ? "\"\"" : stray);
  set_site_value(deployment, "site.initial_pose",
                 format("[%.3f, ", one.start.x) + format("%.3f, ", one.start.y) +
                     format("%.4f]", one.start.yaw));
  return {};
}

}  // namespace

std::string minutes(double seconds) {
  const long whole = std::lround(seconds);
  return std::to_string(whole / 60) + (whole % 60 < 10 ? ":0" : ":") + std::to_string(whole % 60);
}

Result<Deployment> meeting_deployment(const ExperimentOptions& options,
                                      const std::string& manifest) {
  return load_deployment(options.installation.share + "/deploy/" + manifest, options.installation,
                         {{"local_planner", "fastest_turn", kTurnRate},
                          {"local_planner", "spot_turn", kTurnRate},
                          {"local_planner", "recovery_turn_rate", kTurnRate},
                          {"explorer", "turn_rate", kTurnRate}});
}

Result<MeetingRun> run_meeting(Deployment deployment, const MeetingCase& one, std::uint64_t seed,
                               const std::string& folder, const std::string& name,
                               const std::string& title) {
  if (Status put = put_people(deployment, one, folder + "/" + name + "_people.yaml"); !put)
    return Error{put.error()};
  const auto map = site_map(deployment);
  if (!map) return Error{map.error()};
  auto rooms = site_meeting_rooms(deployment);
  if (!rooms) return Error{rooms.error()};
  auto seen = explorer::SeenArea::create({});
  if (!seen) return Error{seen.error()};
  MissJudge judge(*map, *rooms, std::move(seen).value());
  auto made = LockstepRun::create(deployment, seed);
  if (!made) return Error{made.error()};
  LockstepRun& run = **made;
  auto& world = run.world();

  MeetingRun result;
  std::string journal = "t,state,x,y,yaw,brought,invited,navigator\n";
  world.observe(topics::kMeetingStatus, [&](const auto& status, const auto&) {
    const bool changed = status.state() != result.status.state();
    result.status = status;
    const auto truth = run.record().truth();
    if (!changed || !truth) return;
    const auto& navigation = run.record().navigation();
    journal += format("%.1f,", runtime::seconds(world.elapsed())) +
               std::string(meeting::text(static_cast<meeting::State>(status.state()))) +
               format(",%.2f", truth->x) + format(",%.2f", truth->y) +
               format(",%.2f,", truth->yaw) + std::to_string(status.mission().brought()) + "," +
               std::to_string(status.mission().invited()) + "," +
               (navigation ? navigation->reason() : "") + "\n";
  });
  world.observe(topics::kNavigateGoal, [&](const auto& goal, const auto&) {
    if (result.first_room.empty()) result.first_room = goal.location();
  });
  const auto started = std::chrono::steady_clock::now();
  const auto active = [&] {
    return result.status.state() >= state::STATE_TO_ROOM &&
           result.status.state() <= state::STATE_ARRIVED;
  };
  // A request that is refused because not all is ready yet is made anew.
  for (std::uint64_t id = 1; !active() && runtime::seconds(world.elapsed()) < kPatience; ++id) {
    usher_msgs::msg::MeetingRequest request;
    request.id(id);
    request.client(kOperator);
    request.persons(one.persons);
    request.time_limit(static_cast<float>(one.longest));
    world.publish(topics::kMeetingRequest, request, kOperator);
    world.run_for(milliseconds(500));
  }
  if (!active())
    return Error{"the mission did not begin: " + result.status.reason() + "\n" + run.complaints()};
  const auto began = world.now();
  while (active() && !(one.over && one.over(result.status))) {
    world.run_for(kLook);
    judge.look(run.record(), one, result.status.state());
  }
  result.seconds = runtime::seconds(world.now() - began);
  result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  result.simulated = runtime::seconds(world.elapsed());
  result.missed = judge.missed();
  world.run_for(kToSeats);
  const auto room = std::find_if(rooms->begin(), rooms->end(), [&](const SiteRoom& each) {
    return each.name == result.status.mission().room();
  });
  for (const MeetingPerson& person : one.people) {
    const auto at = run.record().person(person.name);
    result.present += at && room != rooms->end() && room->contains(*at) ? 1U : 0U;
  }
  result.summary = run.record().summary();
  result.digest = world.digest();
  result.complaints = run.complaints();
  if (title.empty()) return result;
  Status saved = write_file(folder + "/" + name + ".csv", run_csv(run.record()));
  if (saved) saved = write_file(folder + "/" + name + "_states.csv", journal);
  if (saved) saved = draw_run(run.record(), *map, title, folder + "/" + name + ".png");
  if (!saved) return Error{saved.error()};
  return result;
}

}  // namespace usher::operations
