// Whether the person follows who is guided.
#include <algorithm>
#include <cmath>

#include "tasks/meeting/core/meeting.hpp"

namespace usher::meeting {

namespace {
constexpr double kFollowerNear = 1.6;      // [m] from where it should be: a face
constexpr double kFollowerInRoom = 1.9;    // [m] from the robot: farther sit those who came before
constexpr double kStandsNear = 1.4;        // [m] the same: what the laser sees
constexpr double kNearest = 0.4;           // [m] nearer is the robot itself
constexpr std::ptrdiff_t kOfSomebody = 3;  // points of the laser
constexpr double kAnotherRobot = 0.7;      // [m] from its place: what the laser sees is the robot
constexpr double kInside = 0.5;            // [m] from its walls the robot is in a room
constexpr double kThrough = 0.3;           // [m] and somebody has come through its door
constexpr Time kStuck = std::chrono::seconds(4);  // it does not turn though it is told to
constexpr double kToTurn = 0.5;  // [rad] less to the follower is no turn that could be barred
constexpr double kTurned = 0.1;  // [rad]
}  // namespace

/// Nobody sees behind this robot: who follows is taken to walk where it drove.
void Meeting::trail_follower() {
  if (!robot_.pose) return;
  const Point2 here = robot_.pose->position();
  const Point2 behind = follower_ - here;
  if (behind.norm() > parameters_.follows)
    follower_ = here + parameters_.follows * behind.normalized();
}

/// A face where the follower should be; one far from there is somebody else's.
void Meeting::look_for_follower(const Faces& all, Time now) {
  Faces some = all;
  std::erase_if(some.faces, [&](const Face& face) {
    return (face.at - follower_).norm() > kFollowerNear ||
           (in_the_room_ && (face.range > kFollowerInRoom || !is_inside(face.at, kThrough) ||
                             cleared_.was_taken(face.at)));
  });
  if (track_.take(some)) {
    turn_ = Turn::kFace;
    face_to_ = track_.face().at;
  }
  if (track_.successive() < parameters_.notice) return;
  follower_ = track_.face().at;
  has_followed(now);
}

/// Whoever stands so near that the camera does not see the face is seen by the laser, where nobody
/// was when the robot came.
const Actions& Meeting::look(const Point2& from, std::span<const Point2> points, Time now) {
  actions_ = {};
  // Who comes in behind the robot is seen from within: he was not there before.
  if (state_ == State::kGuide && !is_inside(from, kInside)) cleared_.add(from, points);
  if (state_ != State::kLookBack || !robot_.pose) return finish(now);
  const Point2 here = robot_.pose->position();
  const auto count = std::count_if(points.begin(), points.end(), [&](const Point2& point) {
    return (point - here).norm() > kNearest && (point - follower_).norm() < kStandsNear &&
           !is_another_robot(point) && (!in_the_room_ || is_inside(point, kThrough)) &&
           cleared_.was_clear(point);
  });
  stands_there_ = count >= kOfSomebody ? stands_there_ + 1 : 0;
  if (stands_there_ >= parameters_.confirmations) has_followed(now);
  return finish(now);
}

void Meeting::has_followed(Time now) {
  waits_for_others_ = waits_for_others_ && others_count();
  if (in_the_room_ && (waits_for_others_ || now < others_settle_)) {  // it may be another's
    track_.forget();
    stands_there_ = 0;
    since_ = now;
    return;
  }
  tries_ = 0;
  enter(in_the_room_ ? State::kArrived : State::kGuide, Cause::kConfirmed, now);
}

/// In the room of this meeting, `by` [m] from its walls.
bool Meeting::is_inside(const Point2& point, double by) const {
  const Room* room = room_named(report_.room);
  return room != nullptr && room->contains(point, -by);
}

bool Meeting::others_count() const {
  const Room* room = room_named(report_.room);
  return room != nullptr && team_.counts_in(room->area.low, room->area.high);
}

bool Meeting::is_another_robot(const Point2& point) const {
  return std::any_of(robot_.team_at.begin(), robot_.team_at.end(), [&](const auto& each) {
    return (point - each.second).norm() < kAnotherRobot;
  });
}

bool Meeting::is_there() const {
  return is_inside(robot_.pose->position(), kInside) && is_inside(follower_, kThrough);
}

/// Something that the map does not have, or has a little farther off, bars its turn on the way: it
/// looks later.
bool Meeting::cannot_turn(Time now) {
  if (!robot_.pose) return false;
  const Point2 to = face_to_ - robot_.pose->position();
  const double off = geometry::shortest_turn(robot_.pose->yaw, std::atan2(to.y(), to.x()));
  const bool wants = turn_ == Turn::kSearch || std::abs(off) > kToTurn;
  const bool turns = std::abs(geometry::shortest_turn(turned_to_, robot_.pose->yaw)) > kTurned;
  if (turns || !wants || !motion_.may_turn(robot_)) {
    turned_to_ = robot_.pose->yaw;
    turned_at_ = now;
  }
  return !in_the_room_ && now - turned_at_ >= kStuck;
}

bool Meeting::calls(Time now) const { return now - since_ >= parameters_.call; }

}  // namespace usher::meeting
