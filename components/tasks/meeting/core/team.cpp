#include "tasks/meeting/core/team.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace usher::meeting {

namespace {

bool is_fact(Met kind) { return kind != Met::kSeen && kind != Met::kClaimed; }

/// How far a robot is with somebody whom it claims.
int progress(State state) {
  switch (state) {
    case State::kGuide:
    case State::kLookBack:
    case State::kArrived:
      return 3;
    case State::kInvite:
      return 2;
    case State::kApproach:
      return 1;
    default:
      return 0;
  }
}

bool sound(const TeamReport& report) {
  constexpr double kFarthest = 1e6;  // [m]
  constexpr std::size_t kMostPeople = 256;
  const auto near = [](const Point2& at) {
    return at.allFinite() && at.cwiseAbs().maxCoeff() < kFarthest;
  };
  return !report.robot.empty() && report.sequence != 0 && report.people.size() <= kMostPeople &&
         !std::isnan(report.room_way) && (!report.place || near(*report.place)) &&
         std::all_of(report.people.begin(), report.people.end(), [&](const Encounter& each) {
           return near(each.at) && each.kind <= Met::kBrought && !each.robot.empty();
         });
}

}  // namespace

void Team::begin(std::uint64_t id, const std::string& client) {
  id_ = id;
  client_ = client;
  facts_.clear();
  left_behind_.clear();
  for (const auto& [robot, report] : newest_) learn(report);
}

bool Team::take(const TeamReport& report) {
  if (robot_.empty() || report.robot == robot_ || !sound(report)) return false;
  const auto known = newest_.find(report.robot);
  if (known != newest_.end() && report.sequence <= known->second.sequence) return false;
  if (known == newest_.end() && newest_.size() == kMostRobots) return false;
  const bool fails = report.outcome != Outcome::kComplete && !active(report.state);
  if (fails && known != newest_.end() && active(known->second.state) &&
      of_this_mission(known->second))
    leave_behind(known->second);
  learn(newest_[report.robot] = report);
  return true;
}

void Team::learn(const TeamReport& report) {
  if (!of_this_mission(report)) return;
  for (const Encounter& each : report.people) {
    if (is_fact(each.kind) && each.id != 0) put(each);
  }
}

/// Who was brought is never forgotten for somebody who was not.
void Team::put(const Encounter& fact) {
  const std::pair key(fact.robot, fact.id);
  if (facts_.count(key) == 0 && facts_.size() == kMostFacts) {
    const auto other = std::find_if(facts_.begin(), facts_.end(), [](const auto& entry) {
      return entry.second.kind != Met::kBrought;
    });
    if (other == facts_.end()) return;
    facts_.erase(other);
  }
  facts_.emplace(key, fact);
}

void Team::hear(std::vector<std::string> robots) {
  for (const TeamReport* mate : mates()) {
    if (std::find(robots.begin(), robots.end(), mate->robot) == robots.end()) leave_behind(*mate);
  }
  heard_ = std::move(robots);
}

void Team::leave_behind(const TeamReport& report) {
  for (const Encounter& each : report.people) {
    if (each.kind == Met::kSeen || each.kind == Met::kClaimed) left_behind_.push_back(each.at);
  }
}

bool Team::is_heard(const std::string& robot) const {
  return std::find(heard_.begin(), heard_.end(), robot) != heard_.end();
}

/// Robots that are heard and on this mission, by name.
std::vector<const TeamReport*> Team::mates() const {
  std::vector<const TeamReport*> mates;
  for (const auto& [robot, report] : newest_) {
    if (is_heard(robot) && active(report.state) && of_this_mission(report))
      mates.push_back(&report);
  }
  return mates;
}

const TeamReport* Team::call(std::uint64_t except_id, const std::string& except_client) const {
  for (const auto& [robot, report] : newest_) {
    const bool other = report.id != except_id || report.client != except_client;
    if (is_heard(robot) && active(report.state) && report.id != 0 && other) return &report;
  }
  return nullptr;
}

std::string Team::cancelled_by() const {
  for (const auto& [robot, report] : newest_) {
    if (is_heard(robot) && of_this_mission(report) && report.outcome == Outcome::kCancelled)
      return robot;
  }
  return {};
}

// --- Rooms

std::string Team::agreed_room(const std::string& own) const {
  std::vector<std::pair<std::string, std::string>> named;  // robot, room
  if (!own.empty()) named.emplace_back(robot_, own);
  for (const TeamReport* mate : mates()) {
    if (!mate->room.empty()) named.emplace_back(mate->robot, mate->room);
  }
  if (named.empty()) return {};
  return std::min_element(named.begin(), named.end(),
                          [this](const auto& a, const auto& b) {
                            const std::uint32_t there_a = brought(a.second);
                            const std::uint32_t there_b = brought(b.second);
                            return there_a != there_b ? there_a > there_b : a.first < b.first;
                          })
      ->second;
}

bool Team::room_is_sought(double own_way) const {
  const auto all = mates();
  return std::any_of(all.begin(), all.end(), [&](const TeamReport* mate) {
    return std::isfinite(mate->room_way) &&
           std::tie(mate->room_way, mate->robot) < std::tie(own_way, robot_);
  });
}

// --- People

void Team::add(Met kind, const Point2& at, Time until, const std::string& room) {
  put({kind, robot_, ++next_id_, at, until, room});
}

bool Team::is_settled(const Encounter& fact, const Point2& at, Time now) {
  // Beside somebody who has gone with a robot another one may stand.
  return fact.kind != Met::kBrought && now < fact.until && (fact.at - at).norm() < kSamePerson;
}

bool Team::left_alone(const Point2& at, Time now) const {
  if (robot_.empty()) return false;
  return std::any_of(facts_.begin(), facts_.end(),
                     [&](const auto& entry) { return is_settled(entry.second, at, now); }) ||
         is_ahead(at, State::kExplore);
}

bool Team::settled_by_another(const Point2& at, Time now) const {
  return std::any_of(facts_.begin(), facts_.end(), [&](const auto& entry) {
    return entry.second.robot != robot_ && is_settled(entry.second, at, now);
  });
}

bool Team::is_nearer(const Point2& to, const Point2& own) const {
  const double own_way = (to - own).norm();
  const auto all = mates();
  return std::any_of(all.begin(), all.end(), [&](const TeamReport* mate) {
    const auto at = places_.find(mate->robot);
    if (mate->state != State::kExplore || at == places_.end()) return false;
    const double way = (to - at->second).norm();
    return std::tie(way, mate->robot) < std::tie(own_way, robot_);
  });
}

bool Team::visited_by_another(const Point2& at, Time now) const {
  const auto all = mates();
  const bool claimed = std::any_of(all.begin(), all.end(), [&](const TeamReport* mate) {
    return progress(mate->state) < progress(State::kGuide) &&
           std::any_of(mate->people.begin(), mate->people.end(), [&](const Encounter& each) {
             return each.kind == Met::kClaimed && (each.at - at).norm() < kSamePerson;
           });
  });
  return claimed || settled_by_another(at, now);
}

bool Team::is_ahead(const Point2& at, State state) const {
  const bool has_none = state == State::kExplore;
  for (const TeamReport* mate : mates()) {
    for (const Encounter& each : mate->people) {
      const int theirs = progress(mate->state);
      const double reach = theirs == progress(State::kGuide) ? kFollower : kSamePerson;
      if (each.kind != Met::kClaimed || (each.at - at).norm() >= reach) continue;
      const int ours = progress(state);
      if (has_none || theirs > ours || (theirs == ours && mate->robot < robot_)) return true;
    }
  }
  return false;
}

std::uint32_t Team::brought(const std::string& room) const {
  std::vector<const Encounter*> counted;
  for (const auto& entry : facts_) {
    const Encounter& fact = entry.second;
    if (fact.kind != Met::kBrought || fact.room != room) continue;
    const bool again = std::any_of(counted.begin(), counted.end(), [&](const Encounter* other) {
      return other->robot != fact.robot && (other->at - fact.at).norm() < kSamePerson;
    });
    if (!again) counted.push_back(&fact);
  }
  return static_cast<std::uint32_t>(counted.size());
}

bool Team::counts_in(const Point2& low, const Point2& high) const {
  const auto all = mates();
  return std::any_of(all.begin(), all.end(), [&](const TeamReport* mate) {
    const auto place = places_.find(mate->robot);
    return (mate->state == State::kLookBack || mate->state == State::kArrived) &&
           place != places_.end() && (place->second.array() >= low.array()).all() &&
           (place->second.array() <= high.array()).all();
  });
}

std::uint32_t Team::underway() const {
  const auto all = mates();
  return static_cast<std::uint32_t>(
      std::count_if(all.begin(), all.end(), [](const TeamReport* mate) {
        return mate->state == State::kGuide || mate->state == State::kLookBack;
      }));
}

std::vector<Point2> Team::seen_by_others() const {
  std::vector<Point2> seen;
  for (const TeamReport* mate : mates()) {
    for (const Encounter& each : mate->people) {
      if (each.kind == Met::kSeen) seen.push_back(each.at);
    }
  }
  return seen;
}

std::vector<Encounter> Team::facts(Time now) const {
  std::vector<Encounter> facts;
  facts.reserve(facts_.size());
  for (const auto& [key, fact] : facts_) {
    if (now < fact.until) facts.push_back(fact);
  }
  return facts;
}

WorkShare Team::share(const std::optional<Point2>& place) const {
  std::map<std::string, Point2> places;
  if (place) places[robot_] = *place;
  for (const TeamReport* mate : mates()) {
    if (mate->place) places[mate->robot] = *mate->place;
  }
  WorkShare share;
  if (!place || places.size() < 2) return share;
  for (const auto& [robot, at] : places) {
    if (robot == robot_) share.own = share.places.size();
    share.places.push_back(at);
  }
  return share;
}

}  // namespace usher::meeting
