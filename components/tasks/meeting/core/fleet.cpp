// What a mission shares with the other robots of a fleet.
#include <algorithm>
#include <cmath>
#include <utility>

#include "tasks/meeting/core/meeting.hpp"

namespace usher::meeting {

namespace {
constexpr Time kSettles = std::chrono::seconds(10);  // from being thanked to a seat
}

void Meeting::follow_team(Time now) {
  team_.hear(robot_.team);
  team_.place(robot_.team_at);
  if (state_ == State::kIdle) join(now);
  divide_work();
  if (!active(state_)) return;
  if (const std::string who = team_.cancelled_by(); !who.empty())
    return end(Outcome::kCancelled, Cause::kCancelled, "given up at " + who, now);
  if (follow_room(now)) return;
  const std::uint32_t brought = team_.brought(report_.room);
  if (brought > report_.brought) others_settle_ = now + kSettles;
  report_.brought = brought;
  // Whom it guides it brings to the end.
  const bool guides =
      state_ == State::kGuide || state_ == State::kLookBack || state_ == State::kArrived;
  if (report_.brought >= report_.wanted && !guides)
    return end(Outcome::kComplete, Cause::kEnough, {}, now);
  if (follow_person(now)) return;
  follow_sightings(now);
}

void Meeting::divide_work() {
  WorkShare share = active(state_) ? team_.share(place_) : WorkShare{};
  if (share == share_) return;
  share_ = share;
  actions_.share = std::move(share);
}

/// What others are on and this robot did not see the end of.
void Meeting::join(Time now) {
  const bool left = report_.outcome != Outcome::kOpen && report_.outcome != Outcome::kFailed;
  const TeamReport* call = team_.call(left ? report_.id : 0, left ? report_.client : "");
  if (call == nullptr || call->limit <= now) return;
  // What the others say is judged as what an operator asks for.
  const bool sound = call->wanted >= 1 && call->wanted <= kMostPersons &&
                     std::chrono::duration<double>(call->limit - now).count() <= kLongestMission &&
                     !call->client.empty() && call->client.find('\n') == std::string::npos;
  if (!sound) return;
  begin({call->id, call->client, call->wanted, 0.0}, call->limit, now);
}

const Meeting::Room* Meeting::room_named(const std::string& name) const {
  const auto room = std::find_if(rooms_.begin(), rooms_.end(),
                                 [&](const Room& each) { return each.area.name == name; });
  return room == rooms_.end() ? nullptr : &*room;
}

/// One robot looks for the room, the nearest one; the others have no room until it found one. True:
/// the state is another one.
bool Meeting::follow_room(Time now) {
  const bool seeks =
      state_ == State::kToRoom || state_ == State::kScanRoom || state_ == State::kCheckRoom;
  const std::string room = team_.agreed_room(report_.room);
  const bool counts = state_ == State::kArrived || (state_ == State::kLookBack && in_the_room_);
  if (room != report_.room && room_named(room) != nullptr && !counts) {
    adopt_room(room, now);
    if (!seeks) return false;
    anew_ = true;
    look_for_people(Cause::kElsewhere, now);
    return true;
  }
  if (seeks && team_.room_is_sought(room_way_)) {
    if (!second_pass_) order_.pop_back();  // nobody looked at it
    anew_ = true;
    enter(State::kExplore, Cause::kElsewhere, now);
    return true;
  }
  const bool waits = state_ == State::kExplore && report_.room.empty();
  if (!waits || team_.room_is_sought(std::numeric_limits<double>::infinity())) return false;
  if (!second_pass_ && order_.size() == rooms_.size()) {
    second_pass_ = true;
    stop_ = 0;
    reached_ = 0;
  }
  choose_room();
  enter(State::kToRoom, Cause::kElsewhere, now);
  return true;
}

void Meeting::adopt_room(const std::string& room, Time now) {
  if (report_.room.empty()) report_.room_time = now - began_;
  report_.room = room;
  if (state_ == State::kGuide && departed_) motion_.drive({0, room, {}}, now);
}

/// Where somebody is whom this robot goes to, asks or guides.
std::optional<Point2> Meeting::claimed() const {
  switch (state_) {
    case State::kCheckFace:
      return face_to_;
    case State::kRevisit:
    case State::kApproach:
    case State::kInvite:
      return person_;
    case State::kGuide:
    case State::kLookBack:
    case State::kArrived:
      return robot_.pose ? robot_.pose->position() : person_;
    default:
      return std::nullopt;
  }
}

/// There is a room, and more are wanted than others bring already.
bool Meeting::may_invite() const {
  return !report_.room.empty() && report_.brought + team_.underway() < report_.wanted;
}

/// Leaves somebody to another robot that is ahead, or has asked him. True: the state is another
/// one.
bool Meeting::follow_person(Time now) {
  const bool may_leave = state_ == State::kCheckFace || state_ == State::kRevisit ||
                         state_ == State::kApproach || state_ == State::kInvite;
  if (!may_leave) return false;
  const Point2 at = *claimed();
  const bool of_another = team_.is_ahead(at, state_) || team_.settled_by_another(at, now);
  if (!of_another && may_invite()) return false;
  if (!of_another) people_.remember(at, parameters_.seen_again);
  look_for_people(Cause::kElsewhere, now);
  return true;
}

void Meeting::follow_sightings(Time now) {
  std::vector<Point2> seen = team_.seen_by_others();
  for (const Point2& at : team_.take_left_behind()) seen.push_back(at);
  for (const Point2& at : seen) {
    if (!taken_care_of(at, now) && !in_a_room(at)) people_.remember(at, parameters_.seen_again);
  }
  const std::vector<Point2> remembered = people_.remembered();
  for (const Point2& at : remembered) {
    if (team_.visited_by_another(at, now)) people_.forget_near(at, Team::kSamePerson);
  }
  if (state_ == State::kExplore) visit_if_remembered(now);
}

TeamReport Meeting::tell(Time now) const {
  TeamReport report;
  report.state = state_;
  report.outcome = report_.outcome;
  report.id = report_.id;
  report.client = report_.client;
  report.wanted = report_.wanted;
  report.limit = limit_;
  if (active(state_)) report.room = report_.room;
  if (state_ == State::kToRoom || state_ == State::kScanRoom || state_ == State::kCheckRoom)
    report.room_way = room_way_;
  report.place = place_;
  report.people = team_.facts(now);
  if (const auto at = claimed()) report.people.push_back({Met::kClaimed, team_.robot(), 0, *at});
  if (!active(state_)) return report;
  for (const Point2& at : people_.remembered())
    report.people.push_back({Met::kSeen, team_.robot(), 0, at});
  constexpr std::size_t kMostPeople = 256;
  if (report.people.size() > kMostPeople) report.people.resize(kMostPeople);
  return report;
}

}  // namespace usher::meeting
