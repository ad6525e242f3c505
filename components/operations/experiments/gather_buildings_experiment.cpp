// The meeting assistant in maps of real buildings: rooms, seats and people are put into them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/map_file.hpp"
#include "foundation/grid/way_lengths.hpp"
#include "foundation/random/random.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/building_map.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/meeting_run.hpp"
#include "operations/experiments/run_jobs.hpp"

namespace usher::operations {

namespace {

using geometry::Point2;

constexpr std::uint32_t kPersons = 2;
constexpr double kLimit = 3600.0;  // [s] four times the report's: buildings are larger than arenas
constexpr std::size_t kPlaces = 200;                 // that rooms and people are chosen from
constexpr double kHalfRoom = 1.6;                    // [m] half a side of a meeting room ...
constexpr double kRoomClearance = 1.2;               // [m] ... whose middle keeps this from walls
constexpr double kSeat = 0.9;                        // [m] from the middle, to both sides
constexpr double kStartFrom = 3.0, kStartTo = 12.0;  // [m] of way from the room to the start,
constexpr double kNearest = 4.0, kFarthest = 15.0;   // ... to people, as in the arena
constexpr double kFromWall = 0.4;                    // [m] people stand beside ways, not on them
constexpr double kPassage = 0.36;                    // [m] from obstacles, for the roadmap
constexpr double kLeastOpen = 1.1;                   // [m] round who stands, so that he bars no way
constexpr std::int8_t kOccupiedFrom = 65;

struct Trial {
  BuildingMap building;
  std::uint64_t seed = 0;
  std::string refused;  ///< why the map has no place for a meeting
  std::optional<MeetingRun> run;

  std::string name() const {
    std::string flat = building.name;
    std::replace(flat.begin(), flat.end(), '/', '-');
    return flat + "_" + std::to_string(seed);
  }
  bool complete() const {
    return run && run->status.mission().outcome() ==
                      usher_msgs::msg::MeetingStatus_Constants::OUTCOME_COMPLETE;
  }
  std::uint32_t wrongly_counted() const {
    const std::uint32_t brought = run->status.mission().brought();
    return brought - std::min(brought, run->present);
  }
};

/// Where a meeting is held in a building.
struct Venue {
  geometry::Pose2 start;
  std::vector<Point2> rooms;  ///< their middles, the nearer to the start first
  std::vector<Point2> people;
};

/// Within `half` a side of the middle of one of its rooms.
bool in_room(const Venue& venue, const Point2& at, double half) {
  return std::any_of(venue.rooms.begin(), venue.rooms.end(),
                     [&](const Point2& room) { return (at - room).cwiseAbs().maxCoeff() < half; });
}

/// Whether there are walls in nearly every direction: some maps hold what lies outside for free.
bool is_indoors(const grid::DistanceField& distances, const Point2& at) {
  constexpr int kDirections = 36;
  constexpr double kSight = 12.0;  // [m]
  int walls = 0;
  for (int i = 0; i < kDirections; ++i)
    walls += distances.cast_ray(at, 2.0 * geometry::kPi * i / kDirections, kSight).has_value();
  return walls >= kDirections - 3;
}

/// From the middle of a passage to beside its wall.
Point2 beside_wall(const grid::DistanceField& distances, Point2 at) {
  constexpr double kStep = 0.05;  // [m]
  for (int i = 0; i < 60; ++i) {
    const auto sample = distances.interpolated(at);
    if (sample.distance <= kFromWall || sample.gradient.norm() < 1e-6) break;
    at -= kStep * sample.gradient.normalized();
  }
  return at;
}

Result<Venue> choose_venue(const BuildingMap& building, const grid::OccupancyGrid& map,
                           std::uint64_t seed) {
  auto places = choose_places(building, map, kPlaces, seed);
  if (!places) return Error{places.error()};
  grid::DistanceField distances;
  distances.build(map, kRoomClearance + 2.0 * map.resolution(), kOccupiedFrom);
  std::erase_if(*places,
                [&](const Place& place) { return !is_indoors(distances, place.pose.position()); });
  grid::WayLengths ways;
  if (Status set = ways.set_map(map, kPassage); !set) return Error{set.error()};
  const auto is_roomy = [&](const Place& place) {
    return distances.interpolated(place.pose.position()).distance >= kRoomClearance;
  };
  for (const Place& first : *places) {
    if (!is_roomy(first) || !ways.start_from(first.pose.position())) continue;
    Venue venue;
    venue.rooms.push_back(first.pose.position());
    const auto second = std::find_if(places->begin(), places->end(), [&](const Place& place) {
      return is_roomy(place) && !in_room(venue, place.pose.position(), 2.0 * kHalfRoom) &&
             std::isfinite(ways.way_to(place.pose.position()));
    });
    if (second == places->end()) continue;
    venue.rooms.push_back(second->pose.position());
    std::optional<geometry::Pose2> start;
    for (const Place& place : *places) {
      const Point2 at = place.pose.position();
      const double way = ways.way_to(at);
      if (!std::isfinite(way) || in_room(venue, at, kHalfRoom + 0.5)) continue;
      if (!start && way >= kStartFrom && way <= kStartTo) {
        start = place.pose;
      } else if (venue.people.size() < kPersons && way >= kNearest && way <= kFarthest &&
                 distances.interpolated(at).distance >= 0.5 * kLeastOpen + kPassage) {
        const Point2 stands = beside_wall(distances, at);
        const bool alone = std::all_of(venue.people.begin(), venue.people.end(),
                                       [&](const Point2& p) { return (p - stands).norm() > 1.5; });
        if (alone && !in_room(venue, stands, kHalfRoom + 0.5)) venue.people.push_back(stands);
      }
    }
    if (!start || venue.people.size() < kPersons) continue;
    venue.start = *start;
    return venue;
  }
  return Error{building.name + ": no two rooms with a start and people within 15 m"};
}

/// `people`: the file that the run writes anew.
Status write_site(const std::string& path, const std::string& map, const std::string& people,
                  const Venue& venue) {
  const auto number = [](double value) { return format("%.3f", value); };
  std::string rooms = "meeting_rooms:\n", seats = "seats:\n", locations = "locations:\n";
  const auto place = [&](const std::string& name, const geometry::Pose2& pose) {
    locations += "  - {name: " + name + ", title: " + name + ", x: " + number(pose.x) +
                 ", y: " + number(pose.y) + ", yaw: " + number(pose.yaw) + "}\n";
  };
  place("start", venue.start);
  for (std::size_t i = 0; i < venue.rooms.size(); ++i) {
    const Point2& middle = venue.rooms[i];
    const std::string name = "meeting_room_" + std::to_string(i + 1);
    rooms += "  - {name: " + name + ", west: " + number(middle.x() - kHalfRoom) +
             ", south: " + number(middle.y() - kHalfRoom) +
             ", east: " + number(middle.x() + kHalfRoom) +
             ", north: " + number(middle.y() + kHalfRoom) + "}\n";
    for (const Point2& corner : {Point2(1, 1), Point2(-1, 1), Point2(-1, -1), Point2(1, -1)}) {
      seats += "  - {room: " + name + ", x: " + number(middle.x() + kSeat * corner.x()) +
               ", y: " + number(middle.y() + kSeat * corner.y()) + "}\n";
    }
    place(name, {middle.x(), middle.y(), 0.0});
  }
  return write_file(path, "map: " + map + "\npeople: " + people + "\ninitial_pose: [" +
                              number(venue.start.x) + ", " + number(venue.start.y) + ", " +
                              number(venue.start.yaw) + "]\n" + rooms + seats + locations);
}

/// The meeting assistant in the building; with a `title` the run's picture lies in the folder.
Result<MeetingRun> hold(const Trial& trial, const ExperimentOptions& options,
                        const grid::OccupancyGrid& map, const Venue& venue,
                        const std::string& title) {
  std::string map_file = std::filesystem::absolute(trial.building.file).string();
  if (trial.building.resolution > 0.0) {
    map_file = std::filesystem::absolute(options.out + "/" + trial.name() + "_map.yaml").string();
    if (Status saved = grid::save_map(map, map_file); !saved) return Error{saved.error()};
  }
  const std::string site = options.out + "/" + trial.name() + "_site.yaml";
  const std::string people =
      std::filesystem::absolute(options.out + "/" + trial.name() + "_people.yaml").string();
  Status saved = write_file(people, "people: []\n");
  if (saved) saved = write_site(site, map_file, people, venue);
  if (!saved) return Error{saved.error()};
  const auto deployment = meeting_deployment(options, "meeting-demo.yaml", site);
  if (!deployment) return Error{deployment.error()};
  MeetingCase one;
  one.start = venue.start;
  one.persons = kPersons;
  one.longest = options.minutes > 0.0 ? 60.0 * options.minutes : kLimit;
  const char* const names[] = {"ada", "boole"};
  for (std::size_t i = 0; i < venue.people.size(); ++i)
    one.people.push_back({names[i], venue.people[i], true});
  return run_meeting(*deployment, one, trial.seed, options.out, trial.name(), title);
}

}  // namespace

Result<ResultSheet> run_gather_buildings_experiment(const ExperimentOptions& options) {
  const auto buildings = choose_buildings(options.data, options.only);
  if (!buildings) return Error{buildings.error()};
  std::vector<Trial> trials;
  for (const BuildingMap& building : *buildings) {
    for (int seed = 1; seed <= std::max(1, options.seeds); ++seed)
      trials.push_back({building, static_cast<std::uint64_t>(seed), "", {}});
  }
  const Status done =
      run_jobs(trials.size(), "meetings", [&](std::size_t i) -> Result<std::string> {
        Trial& trial = trials[i];
        const auto map = load_building_map(trial.building);
        if (!map) return Error{map.error()};
        const auto venue = choose_venue(trial.building, *map, trial.seed);
        if (!venue) {
          trial.refused = venue.error();
          return std::string();
        }
        auto run = hold(trial, options, *map, *venue, trial.name());
        if (!run) return Error{trial.name() + ": " + run.error()};
        trial.run = std::move(run).value();
        return std::string();
      });
  if (!done) return Error{done.error()};

  ResultSheet sheet;
  sheet.name = "gather-buildings";
  sheet.input = "maps of real buildings with two rooms and two persons each, lock-step";
  Table table(
      {"building", "seed", "outcome", "brought", "s", "missed", "lost", "contacts", "error max m"});
  double held = 0, complete = 0, contacts = 0, wrong = 0, seconds = 0, missed = 0;
  for (const Trial& trial : trials) {
    if (!trial.run) {
      table.add({trial.building.name, std::to_string(trial.seed), trial.refused});
      continue;
    }
    const MeetingRun& run = *trial.run;
    const auto& m = run.status.mission();
    ++held;
    complete += trial.complete() ? 1 : 0;
    contacts += run.summary.contacts;
    wrong += trial.wrongly_counted();
    seconds += run.seconds;
    missed += run.missed;
    table.add({trial.building.name, std::to_string(trial.seed),
               trial.complete() ? "complete" : m.reason(), std::to_string(m.brought()),
               format("%.0f", run.seconds), std::to_string(run.missed), std::to_string(m.lost()),
               std::to_string(run.summary.contacts), format("%.2f", run.summary.localization_max)});
    if (!trial.complete() || run.summary.contacts > 0 || trial.wrongly_counted() > 0)
      std::printf("%s: %u brought, %u there (%s), %s, contacts %u %s\n%s", trial.name().c_str(),
                  m.brought(), run.present, run.whereabouts.c_str(), m.reason().c_str(),
                  run.summary.contacts, run.summary.contact_with.c_str(), run.complaints.c_str());
  }
  std::printf("%s\n", table.text().c_str());
  if (held == 0) return Error{"no map has a place for a meeting"};
  sheet.metrics = {{"meetings", held},         {"complete", complete},
                   {"contacts", contacts},     {"wrongly_counted", wrong},
                   {"mean_s", seconds / held}, {"missed", missed / held}};
  sheet.targets = {{"complete", {Bound::kAtLeast, held}},
                   {"contacts", {Bound::kAtMost, 0.0}},
                   {"wrongly_counted", {Bound::kAtMost, 0.0}},
                   {"missed", {Bound::kAtMost, 1.0}}};
  if (Status saved = write_file(options.out + "/meetings.md", table.markdown()); !saved)
    return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
