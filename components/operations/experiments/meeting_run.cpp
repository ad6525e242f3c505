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
constexpr double kWithRobot = 2.5;  // [m] who is nearer to a robot that is busy is with it
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

  /// `others`: robots that are busy with somebody, who is not missed then. Without a room nobody is
  /// asked yet.
  void look(const RunRecord& record, const MeetingCase& one,
            const usher_msgs::msg::MeetingStatus& status,
            const std::vector<geometry::Point2>& others) {
    const auto truth = record.truth();
    const std::uint8_t now_in = status.state();
    if (!truth || status.mission().room().empty()) return;
    if (now_in != state::STATE_EXPLORE) {  // it checks, asks or guides somebody
      if (now_in != state::STATE_REVISIT) encounters_.clear();
      return;
    }
    const auto view = seen_.view(*truth);
    for (const MeetingPerson& person : one.people) {
      const auto at = record.person(person.name);
      const bool with_another =
          at && std::any_of(others.begin(), others.end(), [&](const geometry::Point2& other) {
            return (other - *at).norm() < kWithRobot;
          });
      if (!at || !person.comes || with_another || in_a_room(*at)) continue;
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

/// Of the robot with that number in its fleet.
Status put_people(Deployment& deployment, const MeetingCase& one, std::size_t robot,
                  const std::string& path) {
  const geometry::Pose2& start = robot == 0 ? one.start : one.starts_of_others.at(robot - 1);
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
  set_site_value(
      deployment, "site.initial_pose",
      format("[%.3f, ", start.x) + format("%.3f, ", start.y) + format("%.4f]", start.yaw));
  return {};
}

bool is_active(std::uint8_t now_in) {
  return now_in >= state::STATE_TO_ROOM && now_in <= state::STATE_ARRIVED;
}

/// A robot of the run, with who judges it.
struct Watched {
  std::string name;
  MissJudge judge;
  std::string journal = "t,state,x,y,yaw,brought,invited,navigator\n";
  bool lost = false;         ///< it is dead now
  bool suffers = false;      ///< its loss goes on now
  double state_since = 0.0;  ///< [s]
  std::uint32_t contacts = 0, touches = 0;
};

void watch(Watched& robot, LockstepRun& run, MeetingRun& result) {
  auto& world = run.world();
  const auto take_status = [&robot, &run, &result](const auto& status, const auto&) {
    auto& last = result.statuses[robot.name];
    const bool changed = status.state() != last.state();
    const double time = runtime::seconds(run.world().elapsed());
    const bool seen = status.state() == state::STATE_ARRIVED ||
                      (status.state() == state::STATE_GUIDE && status.reason().empty());
    if (changed && last.state() == state::STATE_LOOK_BACK && seen)
      result.look_backs.push_back(time - robot.state_since);
    if (changed) robot.state_since = time;
    last = status;
    const RunRecord& record = run.record(robot.name);
    const auto truth = record.truth();
    if (!changed || !truth) return;
    const auto& navigation = record.navigation();
    robot.journal += format("%.1f,", time) +
                     std::string(meeting::text(static_cast<meeting::State>(status.state()))) +
                     format(",%.2f", truth->x) + format(",%.2f", truth->y) +
                     format(",%.2f,", truth->yaw) + std::to_string(status.mission().brought()) +
                     "," + std::to_string(status.mission().invited()) + "," +
                     (navigation ? navigation->reason() : "") + "\n";
  };
  const auto take_goal = [&result](const auto& goal, const auto&) {
    if (result.first_room.empty()) result.first_room = goal.location();
  };
  const auto take_truth = [&robot, &result](const auto& truth, const auto&) {
    // Whom it touches last is known each time that a count grows.
    const bool other = result.statuses.count(truth.contact_with()) > 0;
    if (other) result.robot_contacts += truth.contacts() - robot.contacts;
    if (other) result.robot_touches += truth.touches() - robot.touches;
    robot.contacts = truth.contacts();
    robot.touches = truth.touches();
  };
  result.statuses[robot.name];
  world.observe(topics::kMeetingStatus, take_status, robot.name);
  world.observe(topics::kNavigateGoal, take_goal, robot.name);
  if (!robot.name.empty()) world.observe(topics::kSimGroundTruth, take_truth, robot.name);
}

/// Where other robots are that check, ask or guide somebody.
std::vector<geometry::Point2> others_of(const Watched& one, const std::vector<Watched>& robots,
                                        const LockstepRun& run, const MeetingRun& result) {
  std::vector<geometry::Point2> busy;
  for (const Watched& robot : robots) {
    const std::uint8_t now_in = result.statuses.at(robot.name).state();
    const auto truth = run.record(robot.name).truth();
    if (robot.name != one.name && truth && now_in >= state::STATE_CHECK_FACE && is_active(now_in))
      busy.push_back(truth->position());
  }
  return busy;
}

/// One component, or everything of the robot but what stands for its body and for people.
void lose(const MeetingLoss& loss, double elapsed, std::vector<Watched>& robots,
          runtime::LockstepWorld& world) {
  const auto robot = std::find_if(robots.begin(), robots.end(),
                                  [&](const Watched& each) { return each.name == loss.robot; });
  const bool lost = elapsed >= loss.after && (loss.back <= 0.0 || elapsed < loss.after + loss.back);
  if (robot == robots.end() || robot->suffers == lost) return;
  robot->suffers = lost;
  robot->lost = lost && loss.component.empty();
  const std::string prefix = loss.robot.empty() ? "" : loss.robot + "/";
  for (const std::string& component : world.components()) {
    const bool concerned = loss.component.empty()
                               ? component.starts_with(prefix) && !component.ends_with("world") &&
                                     !component.ends_with("attendees")
                               : component == prefix + loss.component;
    if (concerned) lost ? world.stop(component) : world.start(component);
  }
}

}  // namespace

std::string minutes(double seconds) {
  const long whole = std::lround(seconds);
  return std::to_string(whole / 60) + (whole % 60 < 10 ? ":0" : ":") + std::to_string(whole % 60);
}

Result<Deployment> meeting_deployment(const ExperimentOptions& options, const std::string& manifest,
                                      const std::string& site) {
  return load_deployment(options.installation.share + "/deploy/" + manifest, options.installation,
                         {{"local_planner", "fastest_turn", kTurnRate},
                          {"local_planner", "spot_turn", kTurnRate},
                          {"local_planner", "recovery_turn_rate", kTurnRate},
                          {"explorer", "turn_rate", kTurnRate}},
                         {}, site);
}

Result<std::vector<Deployment>> meeting_fleet(const ExperimentOptions& options) {
  std::vector<Deployment> fleet;
  for (const char* manifest : {"meeting-fleet-iris.yaml", "meeting-fleet-otto.yaml"}) {
    auto deployment = meeting_deployment(options, manifest);
    if (!deployment) return Error{deployment.error()};
    fleet.push_back(std::move(deployment).value());
  }
  return fleet;
}

Result<MeetingRun> run_meeting(std::vector<Deployment> fleet, const MeetingCase& one,
                               std::uint64_t seed, const std::string& folder,
                               const std::string& name, const std::string& title) {
  const std::string stem = folder + "/" + name;
  for (std::size_t i = 0; i < fleet.size(); ++i) {
    if (Status put = put_people(fleet[i], one, i, stem + "_people.yaml"); !put)
      return Error{put.error()};
  }
  const auto map = site_map(fleet.front());
  if (!map) return Error{map.error()};
  const auto rooms = site_meeting_rooms(fleet.front());
  if (!rooms) return Error{rooms.error()};
  const auto seen = explorer::SeenArea::create({});
  if (!seen) return Error{seen.error()};
  auto made = LockstepRun::create(fleet, seed);
  if (!made) return Error{made.error()};
  LockstepRun& run = **made;
  auto& world = run.world();

  MeetingRun result;
  std::vector<Watched> robots;
  robots.reserve(fleet.size());  // observers refer to them
  for (const Deployment& deployment : fleet) {
    robots.push_back({deployment.manifest.fleet.robot, MissJudge(*map, *rooms, *seen)});
    watch(robots.back(), run, result);
  }
  const auto started = std::chrono::steady_clock::now();
  const auto active = [&] {
    return std::any_of(robots.begin(), robots.end(), [&](const Watched& robot) {
      return !robot.lost && is_active(result.statuses[robot.name].state());
    });
  };
  const std::string& first = robots.front().name;
  // A request that is refused because not all is ready yet is made anew.
  for (std::uint64_t id = 1; !active() && runtime::seconds(world.elapsed()) < kPatience; ++id) {
    usher_msgs::msg::MeetingRequest request;
    request.id(id);
    request.client(kOperator);
    request.persons(one.persons);
    request.time_limit(static_cast<float>(one.longest));
    world.publish(topics::kMeetingRequest, request, kOperator, {}, first);
    world.run_for(milliseconds(500));
  }
  if (!active())
    return Error{"the mission did not begin: " + result.statuses[first].reason() + "\n" +
                 run.complaints()};
  const auto began = world.now();
  while (active() && !(one.over && one.over(result.statuses[first]))) {
    if (one.loss) lose(*one.loss, runtime::seconds(world.now() - began), robots, world);
    world.run_for(kLook);
    for (Watched& robot : robots) {
      const auto others = others_of(robot, robots, run, result);
      robot.judge.look(run.record(robot.name), one, result.statuses[robot.name], others);
    }
  }
  result.seconds = runtime::seconds(world.now() - began);
  result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  result.simulated = runtime::seconds(world.elapsed());
  const auto judged =
      std::find_if(robots.begin(), robots.end(), [](const Watched& robot) { return !robot.lost; });
  const std::string& teller = judged == robots.end() ? first : judged->name;
  result.status = result.statuses[teller];
  for (const Watched& robot : robots) result.missed += robot.judge.missed();
  world.run_for(kToSeats);
  const auto room = std::find_if(rooms->begin(), rooms->end(), [&](const SiteRoom& each) {
    return each.name == result.status.mission().room();
  });
  for (const MeetingPerson& person : one.people) {
    const auto at = run.record(first).person(person.name);
    result.present += at && room != rooms->end() && room->contains(*at) ? 1U : 0U;
    if (!at) continue;
    result.whereabouts += result.whereabouts.empty() ? "" : "; ";
    result.whereabouts += person.name + format(" %.1f", at->x()) + format(" %.1f", at->y());
  }
  result.summary = run.record(first).summary();
  for (const Watched& robot : robots) {
    if (robot.name == first) continue;
    const auto summary = run.record(robot.name).summary();
    result.summary.contacts += summary.contacts;
    result.summary.touches += summary.touches;
    if (summary.contacts > 0) result.summary.contact_with = summary.contact_with;
  }
  result.digest = world.digest();
  result.complaints = run.complaints();
  if (title.empty()) return result;
  for (const Watched& robot : robots) {
    const RunRecord& record = run.record(robot.name);
    std::string path = stem;
    if (!robot.name.empty()) (path += '_') += robot.name;
    Status saved = write_file(path + ".csv", run_csv(record));
    if (saved) saved = write_file(path + "_states.csv", robot.journal);
    if (saved) saved = draw_run(record, *map, title, path + ".png");
    if (!saved) return Error{saved.error()};
  }
  return result;
}

}  // namespace usher::operations
