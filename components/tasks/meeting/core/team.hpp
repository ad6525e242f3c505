#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tasks/meeting/core/faces.hpp"
#include "tasks/meeting/core/mission.hpp"

namespace usher::meeting {

/// What is known of somebody whom a robot met, or saw. The numbers are those on the wire.
enum class Met : std::uint8_t {
  kSeen = 0,        ///< stands there and is still to be asked
  kClaimed = 1,     ///< the robot goes there, asks or guides
  kGone = 2,        ///< was to be visited, and nobody was there
  kDeclined = 3,    ///< does not come
  kUnanswered = 4,  ///< said nothing
  kUnreached = 5,   ///< cannot be reached
  kBrought = 6,     ///< is in the room now, and was met there
};

struct Encounter {
  Met kind = Met::kSeen;
  std::string robot;     ///< who found it out
  std::uint64_t id = 0;  ///< grows per robot, over restarts; 0 for kSeen and kClaimed
  Point2 at{0, 0};       ///< [m] in map; of the guiding robot itself while it guides
  Time until = Time::max();
  std::string room;  ///< of kBrought: where to
};

/// All that a robot says to the others. It is the state, not a change of it: the newest one of each
/// robot counts, what comes late or twice changes nothing, and one that is lost is made good by the
/// next.
struct TeamReport {
  std::string robot;
  std::uint64_t sequence = 0;
  State state = State::kInitialise;
  Outcome outcome = Outcome::kOpen;
  std::uint64_t id = 0;  ///< of the mission; 0: none yet
  std::string client;
  std::uint32_t wanted = 0;
  Time limit{};      ///< of the mission, on the clock of this robot
  std::string room;  ///< empty: none found
  double room_way = std::numeric_limits<double>::infinity();  ///< [m] finite: looks for a room
  std::optional<Point2> place;  ///< [m] in map, where it began to look for people
  std::vector<Encounter> people;
};

/// Who looks at what first: the places of all who look for people, in the order of their names.
struct WorkShare {
  std::vector<Point2> places;  ///< [m] in map; fewer than two: all is this robot's
  std::size_t own = 0;
  bool operator==(const WorkShare&) const = default;
};

/// What this robot knows of a meeting that several robots call together. There is no master: each
/// decides by itself from what it and the others said, and where two could decide alike, the same
/// rule gives the same answer on both; ties go to the name that comes first. A robot in no fleet
/// has an empty name and hears nobody.
class Team {
 public:
  static constexpr std::size_t kMostFacts = 200;  ///< more people are not told of
  static constexpr std::size_t kMostRobots = 16;  ///< further ones are not listened to
  static constexpr double kSamePerson = 1.0;      ///< [m] met by two robots: one person
  static constexpr double kFollower = 2.5;        ///< [m] who is so near to a guide follows it

  /// Ids of facts count up from `first_id`, which is above all of a life before.
  Team(std::string robot, std::uint64_t first_id) : robot_(std::move(robot)), next_id_(first_id) {}

  const std::string& robot() const { return robot_; }

  /// A mission begins; what others have already found out for it is taken over.
  void begin(std::uint64_t id, const std::string& client);
  /// A report of another robot. False: it is late, a repetition, our own or none.
  bool take(const TeamReport& report);
  /// Who is heard now. Others are taken for lost, as those whose mission failed: what they claimed
  /// is free, and somebody to visit; what they found out stays.
  void hear(std::vector<std::string> robots);
  /// Where robots are now [m] in map, as far as that is known.
  void place(std::map<std::string, Point2> robots) { places_ = std::move(robots); }

  /// A mission that somebody is on, other than the one that is named, for a robot that has none.
  const TeamReport* call(std::uint64_t except_id, const std::string& except_client) const;
  /// Who gave this mission up for all; empty: nobody did.
  std::string cancelled_by() const;

  // --- Rooms
  /// Where the meeting is: where most persons are, then that of the robot whose name comes first.
  std::string agreed_room(const std::string& own) const;
  /// Somebody else looks for a room and has the shorter way to it.
  bool room_is_sought(double own_way) const;

  // --- People
  void add(Met kind, const Point2& at, Time until, const std::string& room = {});
  /// Whether somebody there need not be asked: another robot is at it, or has found out.
  bool left_alone(const Point2& at, Time now) const;
  /// Whether another robot goes to somebody seen there, or has been: who only stands beside the way
  /// of a guide is still to be visited.
  bool visited_by_another(const Point2& at, Time now) const;
  /// Whether another robot that explores, and so has time, is nearer than `own` to a point.
  bool is_nearer(const Point2& to, const Point2& own) const;
  /// Whether another robot has found out that nobody there need be asked.
  bool settled_by_another(const Point2& at, Time now) const;
  /// Whether another robot is nearer to asking the person there than this one, that is in `state`.
  bool is_ahead(const Point2& at, State state) const;
  /// Persons who were brought to a room. Two robots that met somebody at the same place met the
  /// same person.
  std::uint32_t brought(const std::string& room) const;
  /// Whether another robot stands in that area and looks whether whom it brought has come in.
  bool counts_in(const Point2& low, const Point2& high) const;
  /// Whom others bring now.
  std::uint32_t underway() const;
  /// What the others still want to visit.
  std::vector<Point2> seen_by_others() const;
  /// Whom robots wanted to visit, asked or guided that were lost since the last call.
  std::vector<Point2> take_left_behind() { return std::exchange(left_behind_, {}); }
  /// Everything found out by anybody that still holds.
  std::vector<Encounter> facts(Time now) const;

  /// With the robots that look for people; `place`: where this one began to.
  WorkShare share(const std::optional<Point2>& place) const;

 private:
  std::vector<const TeamReport*> mates() const;
  bool of_this_mission(const TeamReport& report) const {
    return id_ != 0 && report.id == id_ && report.client == client_;
  }
  bool is_heard(const std::string& robot) const;
  void learn(const TeamReport& report);
  void leave_behind(const TeamReport& report);
  void put(const Encounter& fact);
  static bool is_settled(const Encounter& fact, const Point2& at, Time now);

  std::string robot_;
  std::uint64_t next_id_;
  std::uint64_t id_ = 0;
  std::string client_;
  std::vector<std::string> heard_;
  std::vector<Point2> left_behind_;
  std::map<std::string, Point2> places_;
  std::map<std::string, TeamReport> newest_;                          // of the others
  std::map<std::pair<std::string, std::uint64_t>, Encounter> facts_;  // by robot and id
};

}  // namespace usher::meeting
