#include "tasks/meeting/core/meeting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace usher::meeting {

using service::AnswerResult;
using service::Supervisor;

namespace {

constexpr double kOneFace = 0.5;    // [m] around a face: nobody else's is there
constexpr double kRollsOut = 0.35;  // [m] until it stands
constexpr double kDeparted = 2.0;   // [m] whom the robot sees then is not the person it guides
constexpr std::size_t kMostClients = 16;
constexpr double kFarthestRoom = 1e4;  // [m] a room without a way counts as so far
constexpr Time kForever = Time::max();
constexpr Time kExploredWell = std::chrono::seconds(30);  // forgives failures before

bool sane(const Pose2& pose) {
  return pose.finite() && std::abs(pose.x) < 1e6 && std::abs(pose.y) < 1e6;
}

}  // namespace

Meeting::Meeting(const Parameters& parameters, std::vector<RoomArea> rooms,
                 phrases::PhraseBook phrases, std::size_t language, std::uint64_t first_id)
    : parameters_(parameters),
      phrases_(std::move(phrases)),
      language_(language),
      motion_({}, first_id),
      team_(parameters.robot, first_id),
      track_(parameters.field_of_view),
      passing_(parameters.field_of_view),
      next_screen_(first_id) {
  for (RoomArea& area : rooms) rooms_.push_back({std::move(area), {}, {}});
  screen_ = build({});
}

bool Meeting::Room::contains(const Point2& point, double margin) const {
  return (point.array() >= area.low.array() - margin).all() &&
         (point.array() <= area.high.array() + margin).all();
}

bool Meeting::in_a_room(const Point2& point) const {
  return std::any_of(rooms_.begin(), rooms_.end(), [&](const Room& room) {
    return room.contains(point, parameters_.room_margin);
  });
}

Status Meeting::set_map(const grid::OccupancyGrid& map) {
  Status taken = ways_.set_map(map, parameters_.passing_room);
  if (!taken) return taken;
  cleared_.set_extent(map.geometry());
  turning_.build(map, parameters_.turning_room);
  return taken;
}

void Meeting::set_places(const std::vector<Place>& places) {
  for (Room& room : rooms_) {
    if (!active(state_)) room.place.reset();  // a mission goes on with what it knew
    for (const Place& place : places) {
      if (place.name != room.area.name || !place.at.allFinite()) continue;
      room.place = place.at;
      room.title = place.title;
    }
  }
}

double Meeting::bearing() const {
  if (turn_ == Turn::kSearch || !robot_.pose) return 1.0;
  const Point2 way = inverse(*robot_.pose) * face_to_;
  return std::atan2(way.y(), way.x());
}

std::optional<Time> Meeting::time_left(Time now) const {
  if (!active(state_)) return std::nullopt;
  return std::max(Time{}, limit_ - now);
}

// --- Entries

Status Meeting::request(const MissionRequest& request, Time now) {
  if (request.id != 0 && request.id == last_request_ && request.client == last_client_) return {};
  const auto refuse = [&](const std::string& why) {
    reason_ = "request " + std::to_string(request.id) + " refused: " + why;
    return Error{reason_};
  };
  // The client's name is one line of what is kept for a restart.
  if (request.id == 0 || request.client.empty() || request.client.find('\n') != std::string::npos)
    return refuse("it names no id or no client");
  last_request_ = request.id;
  last_client_ = request.client;
  if (request.persons < 1 || request.persons > kMostPersons)
    return refuse("persons must be in [1, 100], got " + std::to_string(request.persons));
  if (!(request.time_limit >= 0.0 && request.time_limit <= kLongestMission))
    return refuse("time_limit must be in [0, 3600] s, got " + std::to_string(request.time_limit));
  if (state_ == State::kInitialise) return refuse("not ready: " + lacks());
  if (state_ != State::kIdle)
    return refuse("the meeting that '" + report_.client + "' called is not over, " +
                  std::to_string(report_.brought) + " of " + std::to_string(report_.wanted) +
                  " are there");
  begin(request,
        now + (request.time_limit > 0.0 ? std::chrono::duration_cast<Time>(
                                              std::chrono::duration<double>(request.time_limit))
                                        : parameters_.limit),
        now);
  return {};
}

void Meeting::begin(const MissionRequest& request, Time limit, Time now) {
  reason_.clear();
  report_ = {};
  report_.id = request.id;
  report_.client = request.client;
  report_.wanted = request.persons;
  began_ = now;
  limit_ = limit;
  people_.forget();
  team_.begin(request.id, request.client);
  place_.reset();
  order_.clear();
  stop_ = 0;
  second_pass_ = false;
  reached_ = 0;
  failures_ = 0;
  held_since_.reset();
  lost_since_.reset();
  blind_since_.reset();
  others_settle_ = {};
  choose_room();
  enter(State::kToRoom, Cause::kRequest, now);
}

const Actions& Meeting::cancel(std::uint64_t id, Time now) {
  actions_ = {};
  if (active(state_) && (id == 0 || id == report_.id))
    end(Outcome::kCancelled, Cause::kCancelled, "somebody gave it up", now);
  return finish(now);
}

const Actions& Meeting::answer(const service::Answer& answer, Time now) {
  actions_ = {};
  actions_.screen_changed = true;  // it names the answer
  if (!answer.client.empty() && answer.id != 0) {
    if (handled_.size() >= kMostClients && handled_.count(answer.client) == 0) handled_.clear();
    std::uint64_t& newest = handled_[answer.client];
    if (answer.id <= newest) return finish(now);
    newest = answer.id;
  }
  last_answer_ = answer;
  const auto& options = screen_.options;
  const bool offered = std::any_of(options.begin(), options.end(), [&](const auto& option) {
    return option.id == answer.option_id;
  });
  last_result_ = answer.screen_id != screen_.id ? AnswerResult::kLate
                 : offered                      ? AnswerResult::kDone
                                                : AnswerResult::kNotOffered;
  if (last_result_ != AnswerResult::kDone) {
    ++ignored_answers_;
    return finish(now);
  }
  if (answer.option_id == "yes") {
    ++report_.accepted;
    tries_ = 0;
    follower_ = person_;
    cleared_.forget();
    in_the_room_ = false;
    enter(State::kGuide, Cause::kYes, now);
  } else {
    ++report_.declined;
    // Who leaves on the way is where the robot is by then.
    const bool on_the_way = robot_.pose && state_ != State::kInvite &&
                            (follower_ - person_).norm() > parameters_.same_person;
    const Point2 at = on_the_way ? robot_.pose->position() : person_;
    people_.leave_alone(at, on_the_way ? parameters_.seen_again : kOneFace, kForever, now);
    met(Met::kDeclined, at, kForever);
    look_for_people(Cause::kNo, now);
  }
  return finish(now);
}

const Actions& Meeting::step(const Surroundings& robot, Time now) {
  actions_ = {};
  robot_ = robot;
  if (robot_.pose && !sane(*robot_.pose)) robot_.pose.reset();
  if (state_ == State::kInitialise && lacks().empty())
    enter(State::kIdle, Cause::kReady, now);
  else if (state_ == State::kIdle && !lacks().empty())
    enter(State::kInitialise, Cause::kNotReady, now);
  if (active(state_)) watch_robot(now);
  if (state_ == State::kGuide) trail_follower();
  if (!parameters_.robot.empty()) follow_team(now);
  follow_motion(now);
  if (state_ == State::kScanRoom) scan(now);
  pass_time(now);
  return finish(now);
}

const Actions& Meeting::finish(Time now) {
  actions_.motion = motion_.take_actions();
  service::Screen screen = build(now);
  const bool same = screen.id == screen_.id && screen.title == screen_.title &&
                    screen.text == screen_.text && screen.status == screen_.status &&
                    (screen.time_left == screen_.time_left ||
                     (std::isnan(screen.time_left) && std::isnan(screen_.time_left)));
  if (!same) actions_.screen_changed = true;
  screen_ = std::move(screen);
  return actions_;
}

// --- States

void Meeting::enter(State state, Cause cause, Time now) {
  const auto edge = std::find_if(kEdges.begin(), kEdges.end(), [&](const Edge& each) {
    return each.from == state_ && each.to == state && each.cause == cause;
  });
  assert(edge != kEdges.end());
  ++edges_taken_[static_cast<std::size_t>(edge - kEdges.begin())];
  state_ = state;
  since_ = now;
  reason_.clear();
  ++next_screen_;
  actions_.status_changed = true;
  arrive_in(state, now);
}

/// What each state begins with.
void Meeting::arrive_in(State state, Time now) {
  turn_ = Turn::kStand;
  if (state != State::kCheckRoom && state != State::kCheckFace) track_.forget();
  switch (state) {
    case State::kToRoom:
      passing_.forget();
      motion_.drive({0, rooms_[room_].area.name, {}}, now);
      return;
    case State::kScanRoom:
      turn_ = Turn::kSearch;
      yaw_.reset();
      break;
    case State::kCheckRoom:
    case State::kCheckFace:
      ++report_.faces_checked;
      turn_ = Turn::kFace;
      face_to_ = track_.face().at;
      face_seen_ = now;
      break;
    case State::kExplore:
      if (!place_ && robot_.pose) place_ = robot_.pose->position();
      passing_.forget();
      visiting_ = false;
      motion_.explore(std::exchange(anew_, false), now);
      return;
    case State::kRevisit:
    case State::kApproach:
      approach(now);
      return;
    case State::kInvite:
      ++report_.invited;
      turn_ = Turn::kFace;
      face_to_ = person_;
      break;
    case State::kGuide:
      passing_.forget();
      departed_ = false;
      break;
    case State::kLookBack:
      waits_for_others_ = in_the_room_ && others_count();
      stands_there_ = 0;
      turned_to_ = robot_.pose ? robot_.pose->yaw : 0.0;
      turned_at_ = now;
      turn_ = Turn::kFace;
      face_to_ = follower_;
      break;
    case State::kArrived:
      met(Met::kBrought, person_, kForever);
      report_.brought = team_.brought(report_.room);
      break;
    default:
      break;
  }
  motion_.rest();
}

void Meeting::end(Outcome outcome, Cause cause, const std::string& reason, Time now) {
  report_.outcome = outcome;
  report_.reason = reason;
  report_.duration = now - began_;
  enter(outcome == Outcome::kComplete ? State::kDone : State::kEnded, cause, now);
  actions_.report = report_;
}

std::string Meeting::lacks() const {
  if (rooms_.empty()) return "the site has no meeting rooms";
  if (ways_.empty()) return "no map";
  for (const Room& room : rooms_) {
    if (!room.place) return "no location '" + room.area.name + "'";
  }
  if (!robot_.pose) return "not localized";
  if (!robot_.navigation) return "no navigator";
  if (!robot_.exploration) return "no explorer";
  if (!robot_.sees) return "no face detector";
  switch (robot_.supervisor) {
    case Supervisor::kAvailable:
    case Supervisor::kInactive:
    case Supervisor::kNavigation:
      return {};
    case Supervisor::kManual:
      return "an operator drives";
    case Supervisor::kFault:
      return "a fault";
    default:
      return "no supervisor";
  }
}

void Meeting::watch_robot(Time now) {
  if (robot_.supervisor == Supervisor::kManual)
    return end(Outcome::kFailed, Cause::kFailure, "an operator has taken over", now);
  if (robot_.supervisor == Supervisor::kFault)
    return end(Outcome::kFailed, Cause::kFailure, "a fault: an operator must help", now);
  const bool held =
      robot_.supervisor != Supervisor::kAvailable && robot_.supervisor != Supervisor::kNavigation;
  if (!held) held_since_.reset();
  if (held && !held_since_) held_since_ = now;
  if (held && now - *held_since_ >= parameters_.recovery)
    return end(Outcome::kFailed, Cause::kFailure, "the robot may not move", now);
  if (robot_.pose) lost_since_.reset();
  if (!robot_.pose && !lost_since_) lost_since_ = now;
  if (lost_since_ && now - *lost_since_ >= parameters_.recovery)
    return end(Outcome::kFailed, Cause::kFailure, "the robot is not localized", now);
  if (robot_.sees) blind_since_.reset();
  if (!robot_.sees && !blind_since_) blind_since_ = now;
  if (blind_since_ && now - *blind_since_ >= parameters_.recovery)
    end(Outcome::kFailed, Cause::kFailure, "no face detector", now);
}

/// Journeys that came to their end.
void Meeting::follow_motion(Time now) {
  const Motion::Outcome outcome = motion_.step(robot_, now);
  if (outcome == Motion::Outcome::kBusy) return;
  if (outcome == Motion::Outcome::kFailed || state_ == State::kExplore) return drive_failed(now);
  switch (state_) {
    case State::kToRoom:
      ++reached_;
      turned_ = 0.0;
      enter(State::kScanRoom, Cause::kArrived, now);
      break;
    case State::kRevisit:
      arrived_at_ = now;
      turn_ = Turn::kFace;
      face_to_ = person_;
      break;
    case State::kApproach:
      enter(State::kInvite, Cause::kArrived, now);
      break;
    case State::kGuide:
      in_the_room_ = true;
      enter(State::kLookBack, Cause::kArrived, now);
      break;
    default:
      break;
  }
}

void Meeting::drive_failed(Time now) {
  switch (state_) {
    case State::kToRoom:
      leave_room(Cause::kNoWay, false, now);
      break;
    case State::kExplore:
      if (now - since_ >= kExploredWell) failures_ = 0;
      if (++failures_ >= parameters_.most_failures) {
        end(Outcome::kFailed, Cause::kFailure, "exploration: " + motion_.reason(), now);
      } else {
        anew_ = true;
        enter(State::kExplore, Cause::kNoWay, now);
      }
      break;
    case State::kRevisit:
      met(Met::kUnreached, person_, now + parameters_.ask_again);
      look_for_people(Cause::kNoWay, now);
      break;
    case State::kApproach:
      people_.leave_alone(person_, parameters_.same_person, now + parameters_.ask_again, now);
      met(Met::kUnreached, person_, now + parameters_.ask_again);
      look_for_people(Cause::kNoWay, now);
      break;
    case State::kGuide:
      if (tries_++ == 0) {
        enter(State::kGuide, Cause::kNoWay, now);
      } else {
        ++report_.lost;
        look_for_people(Cause::kNoWay, now);
      }
      break;
    default:
      break;
  }
}

void Meeting::pass_time(Time now) {
  const bool all_there = state_ == State::kArrived && report_.brought >= report_.wanted;
  if (active(state_) && now >= limit_ && !all_there)
    return end(Outcome::kTimeOver, Cause::kLimit, "the time is over", now);
  const Time passed = now - since_;
  switch (state_) {
    case State::kScanRoom:
      if (robot_.stopped) since_ = now;
      if (now - since_ >= parameters_.scan_most) leave_room(Cause::kNoWay, false, now);
      break;
    case State::kCheckRoom:
    case State::kCheckFace:
      if (is_blind()) face_seen_ = since_ = now;
      if (now - face_seen_ >= parameters_.check) {
        refuse_face(now);
      } else if (passed >= parameters_.check_most) {
        track_.successive() >= parameters_.confirmations ? confirm(now) : refuse_face(now);
      }
      break;
    case State::kRevisit:
      if (arrived_at_ && (is_blind() || robot_.stopped)) arrived_at_ = now;
      if (arrived_at_ && now - *arrived_at_ >= parameters_.nobody) {
        met(Met::kGone, person_, now + parameters_.refused);
        look_for_people(Cause::kLost, now);
      }
      break;
    case State::kInvite:
      if (passed >= parameters_.answer) {
        ++report_.unanswered;
        people_.leave_alone(person_, parameters_.same_person, now + parameters_.ask_again, now);
        met(Met::kUnanswered, person_, now + parameters_.ask_again);
        look_for_people(Cause::kTimeout, now);
      }
      break;
    case State::kGuide:
      pass_time_on_the_way(now);
      break;
    case State::kLookBack:
      pass_time_looking_back(now);
      break;
    case State::kArrived:
      if (passed < parameters_.arrived) break;
      if (all_there)
        end(Outcome::kComplete, Cause::kEnough, {}, now);
      else
        look_for_people(Cause::kMore, now);
      break;
    case State::kDone:
    case State::kEnded:
      if (passed >= parameters_.over) enter(State::kIdle, Cause::kDelay, now);
      break;
    default:
      break;
  }
}

void Meeting::pass_time_on_the_way(Time now) {
  const Time passed = now - since_;
  if (!departed_ && passed >= parameters_.tone) depart(now);
  if (passed < parameters_.unseen || !departed_ || !robot_.pose) return;
  // Who stands in its way is before it, and not behind; in the room the place is good enough.
  const Point2 here = robot_.pose->position();
  const bool may_turn = turning_.free(here) && turning_.free(*robot_.pose * Point2(kRollsOut, 0.0));
  if ((here - departure_).norm() < kDeparted || !may_turn) return;
  in_the_room_ = is_there();
  enter(State::kLookBack, Cause::kUnseen, now);
}

void Meeting::pass_time_looking_back(Time now) {
  if (!motion_.may_turn(robot_) || is_blind()) since_ = now;  // it cannot look meanwhile
  if (cannot_turn(now)) {
    enter(State::kGuide, Cause::kNoWay, now);
    reason_ = "no room to look back";
    return;
  }
  if (calls(now) && track_.successive() == 0) turn_ = Turn::kSearch;
  if (now - since_ < parameters_.look_back) return;
  ++report_.lost;
  look_for_people(Cause::kLost, now);
}

// --- Rooms

/// The nearest one that was not looked at, by the length of the way; after all of them, again from
/// the first.
void Meeting::choose_room() {
  if (!second_pass_) {
    if (robot_.pose) ways_.start_from(robot_.pose->position());
    double shortest = std::numeric_limits<double>::infinity();
    std::size_t best = kNone;
    for (std::size_t i = 0; i < rooms_.size(); ++i) {
      if (std::find(order_.begin(), order_.end(), i) != order_.end()) continue;
      const double way = ways_.way_to(*rooms_[i].place);
      if (best != kNone && !(way < shortest)) continue;
      best = i;
      shortest = way;
    }
    order_.push_back(best);
  }
  room_ = order_[second_pass_ ? stop_ : order_.size() - 1];
  if (robot_.pose) ways_.start_from(robot_.pose->position());
  // With the digits that the others hear, so that all compare the same numbers.
  room_way_ = static_cast<float>(std::min(ways_.way_to(*rooms_[room_].place), kFarthestRoom));
}

/// On to the next one.
void Meeting::leave_room(Cause cause, bool occupied, Time now) {
  if (occupied) ++report_.rooms_occupied;
  const bool pass_over = second_pass_ ? ++stop_ == order_.size() : order_.size() == rooms_.size();
  if (pass_over) {
    if (reached_ == 0)
      return end(Outcome::kFailed, Cause::kFailure,
                 "no meeting room can be reached: " + motion_.reason(), now);
    second_pass_ = true;
    stop_ = 0;
    reached_ = 0;
  }
  choose_room();
  enter(State::kToRoom, cause, now);
}

void Meeting::scan(Time now) {
  if (is_blind() || !motion_.may_turn(robot_)) {
    yaw_.reset();
    return;
  }
  if (yaw_) turned_ += geometry::shortest_turn(*yaw_, robot_.pose->yaw);
  yaw_ = robot_.pose->yaw;
  if (turned_ < 2.0 * geometry::kPi) return;
  ++report_.rooms_scanned;
  report_.room = rooms_[room_].area.name;
  report_.room_time = now - began_;
  anew_ = true;
  look_for_people(Cause::kScanned, now);
}

// --- Faces

const Actions& Meeting::see(Faces faces, Time now) {
  actions_ = {};
  rejected_faces_ += faces.place();
  switch (state_) {
    case State::kToRoom:
    case State::kGuide:
      remember_seen(faces, now);
      break;
    case State::kScanRoom:
    case State::kExplore:
    case State::kRevisit:
      notice(faces, now);
      break;
    case State::kCheckRoom:
    case State::kCheckFace:
      check(faces, now);
      break;
    case State::kLookBack:
      look_for_follower(faces, now);
      break;
    default:
      break;
  }
  return finish(now);
}

/// In a room that is looked round in: whoever is in it; else who is in no meeting room.
bool Meeting::may_be_asked(const Face& face, Time now) const {
  if (taken_care_of(face.at, now)) return false;
  if (state_ == State::kScanRoom || state_ == State::kCheckRoom)
    return rooms_[room_].contains(face.at, parameters_.room_margin);
  return !in_a_room(face.at);
}

void Meeting::notice(const Faces& all, Time now) {
  if (state_ == State::kExplore && !may_invite()) return remember_seen(all, now);
  Faces some = all;
  std::erase_if(some.faces, [&](const Face& face) { return !may_be_asked(face, now); });
  track_.take(some);
  if (state_ == State::kScanRoom) {
    if (track_.successive() > 0) enter(State::kCheckRoom, Cause::kFace, now);
  } else if (track_.successive() >= parameters_.notice) {
    failures_ = 0;
    enter(State::kCheckFace, Cause::kFace, now);
  }
}

void Meeting::check(const Faces& all, Time now) {
  Faces some = all;
  std::erase_if(some.faces, [&](const Face& face) { return !may_be_asked(face, now); });
  if (!track_.take(some)) return;
  face_seen_ = now;
  face_to_ = track_.face().at;
  const bool centered = state_ == State::kCheckRoom || !may_face() ||
                        std::abs(track_.face().bearing) <= parameters_.centered;
  if (centered && track_.successive() >= parameters_.confirmations) confirm(now);
}

void Meeting::confirm(Time now) {
  if (state_ == State::kCheckRoom) return leave_room(Cause::kConfirmed, true, now);
  person_ = track_.face().at;
  people_.forget_near(person_, parameters_.seen_again);
  if (track_.face().range <= parameters_.near)
    enter(State::kInvite, Cause::kNear, now);
  else
    enter(State::kApproach, Cause::kConfirmed, now);
}

void Meeting::refuse_face(Time now) {
  ++report_.faces_refused;
  people_.leave_alone(face_to_, kOneFace, now + parameters_.refused, now);
  if (visiting_) met(Met::kGone, person_, now + parameters_.refused);
  if (state_ == State::kCheckRoom)
    enter(State::kScanRoom, Cause::kLost, now);
  else
    look_for_people(Cause::kLost, now);
}

/// Whom the robot passes by on its way is visited before it looks for others.
void Meeting::remember_seen(const Faces& all, Time now) {
  const bool guides = state_ == State::kGuide;
  if (guides &&
      !(departed_ && robot_.pose && (robot_.pose->position() - departure_).norm() >= kDeparted))
    return;
  Faces some = all;
  std::erase_if(some.faces, [&](const Face& face) {
    return taken_care_of(face.at, now) || in_a_room(face.at);
  });
  passing_.take(some);
  if (passing_.successive() >= parameters_.confirmations)
    people_.remember(passing_.face().at, parameters_.seen_again);
}

// --- The way

void Meeting::look_for_people(Cause cause, Time now) {
  enter(State::kExplore, cause, now);
  visit_if_remembered(now);
}

/// The nearest of those to whom no other robot that has time is nearer.
void Meeting::visit_if_remembered(Time now) {
  if (!robot_.pose || !may_invite()) return;
  std::vector<Point2> all = people_.remembered();
  std::erase_if(all,
                [&](const Point2& at) { return team_.is_nearer(at, robot_.pose->position()); });
  if (all.empty()) return;
  ways_.start_from(robot_.pose->position());
  const Point2 nearest = *std::min_element(
      all.begin(), all.end(),
      [&](const Point2& a, const Point2& b) { return ways_.way_to(a) < ways_.way_to(b); });
  person_ = nearest;
  people_.forget_near(nearest, parameters_.same_person);
  visiting_ = true;
  enter(State::kRevisit, Cause::kSeenThen, now);
}

/// To just in front of the person: on the straight line to him where that is free, else on the way.
void Meeting::approach(Time now) {
  arrived_at_.reset();
  const Point2 goal = place_to_talk();
  const Point2 look = person_ - goal;
  motion_.drive({0, {}, {goal.x(), goal.y(), std::atan2(look.y(), look.x())}}, now);
}

/// Straight before the person, a little farther off where it could not turn round to guide him; or
/// where its way there comes so near.
Point2 Meeting::place_to_talk() {
  constexpr double kStep = 0.1;  // [m]
  const Point2 robot = robot_.pose ? robot_.pose->position() : person_ + Point2(1.0, 0.0);
  Point2 from = robot - person_;
  from = from.norm() > 0.01 ? Point2(from.normalized()) : Point2(1.0, 0.0);
  const auto straight = [&](double off) { return Point2(person_ + off * from); };
  if (ways_.passing().line_free(robot, straight(parameters_.stand_off))) {
    const auto steps = std::lround((parameters_.near - parameters_.stand_off) / kStep);
    for (long i = 0; i <= steps; ++i) {
      const double off = parameters_.stand_off + kStep * static_cast<double>(i);
      if (turning_.free(straight(off))) return straight(off);
    }
    return straight(parameters_.stand_off);
  }
  std::vector<Point2> way;
  if (ways_.start_from(robot)) ways_.trace(person_, way);
  const auto last = std::find_if(way.rbegin(), way.rend(), [&](const Point2& point) {
    return (point - person_).norm() >= parameters_.stand_off;
  });
  return last != way.rend() ? *last : straight(parameters_.stand_off);
}

void Meeting::depart(Time now) {
  departed_ = true;
  departure_ = robot_.pose ? robot_.pose->position() : person_;
  motion_.drive({0, report_.room, {}}, now);
}

}  // namespace usher::meeting
