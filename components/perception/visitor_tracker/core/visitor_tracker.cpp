#include "perception/visitor_tracker/core/visitor_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace usher::visitor_tracker {

namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr double kLongestStep = 1.0;   // [s] after a longer one nothing is known of in between
constexpr double kJump = 0.5;          // [m] that no robot drives between two updates
constexpr double kStep = 0.1;          // [m] of the remembered way
constexpr double kMoves = 0.25;        // [m/s]
constexpr double kWalks = 0.3;         // [m/s]
constexpr double kAlong = 0.3;         // cosine: heads for the robot, with room for corners
constexpr double kAhead = 0.5;         // [m] who is farther ahead does not follow
constexpr double kFollowWithin = 6.0;  // [m]
constexpr double kWaitsWithin =
    2.0;  // [m] who stands so near behind a robot that stands, waits for it
constexpr double kBlindWithin = 2.5;   // [m] farther somebody would have been seen on the way there
constexpr double kWaits = 3.0;         // [s] so long, for a visitor who was lost near the robot
constexpr double kWaitsLong = 5.0;     // [s] elsewhere: longer than somebody who cannot pass
constexpr double kWaitsAlike = 1.0;    // [s] who wears the visitor's clothes
constexpr double kAlikeFollows = 0.5;  // of the time that others must follow, likewise
constexpr double kStrangerWaits = 6.0;  // [s] who came from ahead or was seen beside the visitor
constexpr double kStaysPut = 0.6;       // [m]
constexpr double kCameraEnds = 0.6;  // [rad] to either side: from here on only who walks is noticed
constexpr double kStepsAside = 0.4;  // [m/s] by which somebody moves about where nobody looks
constexpr double kAside = 0.3;       // [m] at once
constexpr double kFarAside = 1.0;    // [m] at most
constexpr double kWalksOff = 0.6;    // [m/s] away from the robot
constexpr double kUnlike = 0.5;      // [s] a number whose person looks like another one is not his
constexpr double kAdapts = 10.0;     // [s] of being seen until other light is the usual one
constexpr double kHidden = 0.7;      // [s] a number that shows up elsewhere after that ...
constexpr double kElsewhere = 1.5;   // [m] ... is not his
constexpr std::uint64_t kLost = std::numeric_limits<std::uint64_t>::max();  // nobody's number
constexpr double kRecognised = 0.7;   // [s] in the visitor's clothes
constexpr double kSighted = 0.15;     // [s] an older sighting is none
constexpr double kGoneAhead = 1.0;    // [m] who is there and does not follow was never the visitor
constexpr double kMostFollows = 1.5;  // [s]
constexpr double kNearer = 0.4;       // [m] another one must be, to be served instead
constexpr double kLeave = 0.5;        // [m] beyond the border until who stood before the robot left
constexpr double kLeaveBearing = 0.35;  // [rad] likewise
constexpr double kLeavesAt = 1.0;       // [m/s]
constexpr double kReach = 0.8;          // [m] from where the visitor was last seen
constexpr double kWalk = 1.5;           // [m/s] by which that grows
constexpr double kMistaken = 1.7;       // times as long must follow who is to take somebody's place
constexpr double kSamePlace = 0.7;      // [m]
constexpr double kSameVelocity = 0.7;   // [m/s]
constexpr double kSameHeight = 0.12;    // [m]
constexpr double kMayHaveBent = 8.0;    // [s]
constexpr double kSameFor = 1.5;        // [s]
constexpr double kForesees = 0.8;       // [s] of walking on
constexpr double kAgeError = 0.5;       // [s]
constexpr double kLeaderForesees = 1.5;  // [s] of walking on
constexpr double kLeaderHidden = 4.0;    // [s] whoever turns up later is another one
constexpr double kStrays = 0.3;          // [m/s] by which the place is less certain
constexpr double kStops = 0.5;           // [m/s] who is slower may have stopped meanwhile
constexpr double kReturnsWithin = 2.0;   // [m]
constexpr double kComes = 0.8;           // [m] walked since, by who was there beside the visitor

bool finite(const Person& person) {
  return person.id != 0 && person.position.allFinite() && person.velocity.allFinite() &&
         person.unseen >= 0.0;
}

}  // namespace

const Estimate& VisitorTracker::lose() {
  estimate_ = {};
  estimate_.person = held_ == kLost ? 0 : held_;
  return estimate_;
}

const Estimate& VisitorTracker::update(const Moment& moment) {
  if (!std::isfinite(moment.time) || !moment.odom_T_base.finite()) return lose();
  const double passed = moment.time - time_;
  const bool broke = !(passed >= 0.0 && passed <= kLongestStep);
  if (broke) {
    habits_.clear();
    way_.clear();
  }
  // A visitor of another time would have walked any distance since then.
  if (broke && passed < 0.0) last_.time = moment.time;
  time_ = moment.time;
  const bool other = moment.service != service_;
  service_ = moment.service;
  if (other && on_the_way()) first_ = held_, last_of_first_ = last_;
  remember_way(moment);
  forget_other_people(moment);
  observe(moment, broke ? 0.0 : passed);
  switch (service_) {
    case Service::kNobody:
      choose_to_serve();
      break;
    case Service::kTalks:
      keep_served();
      break;
    case Service::kGuides:
      keep_follower(moment.odom_T_base);
      note_others(0.0);
      break;
    case Service::kFollows:
      keep_leader(broke ? 0.0 : passed);
      break;
  }
  report(moment, broke ? 0.0 : passed);
  return estimate_;
}

/// The people tracker was restarted when it has given the visitor's number to somebody younger.
void VisitorTracker::forget_other_people(const Moment& moment) {
  const bool given_again = std::ranges::any_of(moment.people, [&](const Person& person) {
    return person.id == held_ && person.age + kAgeError < moment.time - held_since_;
  });
  if (held_ == 0 || !given_again) return;
  held_ = first_ = measured_ = 0;
  habits_.clear();
}

void VisitorTracker::remember_way(const Moment& moment) {
  const Point2 here = moment.odom_T_base.position();
  if (!way_.empty() && (way_.back().second - here).norm() > kJump) {
    way_.clear();
    habits_.clear();
  }
  if (!way_.empty() && (way_.back().second - here).norm() < kStep) return;
  way_.emplace_back(moment.time, here);
  if (static_cast<double>(way_.size()) * kStep > kMostTrail) way_.pop_front();
}

/// The robot drove in the last second.
bool VisitorTracker::moves(double time) const {
  constexpr double kSpan = 1.0;  // [s]
  std::size_t steps = 0;
  for (auto it = way_.rbegin(); it != way_.rend() && time - it->first <= kSpan; ++it) ++steps;
  return way_.size() > 1 && static_cast<double>(steps) * kStep >= kMoves * kSpan;
}

VisitorTracker::Look VisitorTracker::look_at(const Person& person, const Pose2& base_T_odom) const {
  Look look;
  look.person = &person;
  look.place = base_T_odom * person.position;
  look.range = look.place.norm();
  look.speed = person.velocity.norm();
  const Point2 to_robot = inverse(base_T_odom).position() - person.position;
  // How near the line of the walk comes to the robot's middle.
  const double miss =
      look.speed > 0.0
          ? std::abs(to_robot.x() * person.velocity.y() - to_robot.y() * person.velocity.x()) /
                look.speed
          : look.range;
  look.heads_here = to_robot.dot(person.velocity) > 0.0 && miss <= config_.passes_at;
  return look;
}

void VisitorTracker::observe(const Moment& moment, double passed) {
  const Pose2 base_T_odom = inverse(moment.odom_T_base);
  const bool drives = moves(moment.time);
  looks_.clear();
  for (const Person& person : moment.people) {
    if (finite(person)) looks_.push_back(look_at(person, base_T_odom));
  }
  std::sort(looks_.begin(), looks_.end(),
            [](const Look& a, const Look& b) { return a.person->id < b.person->id; });
  std::erase_if(habits_, [&](const auto& habit) { return find(habit.first) == nullptr; });
  for (Look& look : looks_) {
    Habit& habit = habits_
                       .try_emplace(look.person->id, Habit{.since = time_,
                                                           .from = look.person->position,
                                                           .from_ahead = look.place.x() > kAhead})
                       .first->second;
    const bool near = seen(&look) && !drives && look.range <= kWaitsWithin &&
                      look.place.x() <= kAhead &&
                      (look.person->position - habit.anchor).norm() <= kStaysPut;
    habit.stays = near ? habit.stays + passed : 0.0;
    if (!near) habit.anchor = look.person->position;
    if (seen(&look)) {
      habit.before = before(look) ? habit.before + passed : 0.0;
      habit.follows = std::clamp(
          habit.follows + following(look, moment.odom_T_base, drives) * passed, 0.0, kMostFollows);
    } else {
      habit.before = 0.0;
    }
    const bool sighted = look.person->unseen <= kSighted;
    habit.unlike =
        !on_the_way() || !is_another(*look.person) ? 0.0 : habit.unlike + (sighted ? passed : 0.0);
    habit.alike = !looks_like_him(*look.person) ? 0.0 : habit.alike + (sighted ? passed : 0.0);
    look.habit = habit;
  }
}

/// Beside the robot, at bearings from `from` on, nothing looks; somewhere within `around` [m] of
/// the place that is so. Who left it would have been seen, and a robot that drives on leaves it
/// behind.
bool VisitorTracker::blind_at(const Point2& place, double from, double around) const {
  const double bearing = std::abs(std::atan2(place.y(), place.x()));
  const double off = std::max({0.0, from - bearing, bearing - config_.blind_to});
  return place.norm() <= kBlindWithin &&
         place.norm() * std::sin(std::min(off, geometry::kPi / 2)) <= around;
}

/// Seen now, or gone where nothing looks.
bool VisitorTracker::seen(const Look* look) const {
  if (look == nullptr) return false;
  if (service_ == Service::kFollows && look->range > config_.farthest) return false;
  return look->person->unseen <= config_.unseen ||
         (on_the_way() && look->person->unseen <= config_.blind_for &&
          blind_at(look->place, config_.blind_from, 0.0));
}

/// The visitor can be so tall. Who was seen bent only may be taller, but for a while nobody else is
/// believed to be he.
bool VisitorTracker::as_tall(const Look& look) const {
  const double height = look.person->height;
  if (!(height > 0.0) || height_ <= 0.0) return true;
  if (height < height_ - kSameHeight) return false;
  return height < height_ + kSameHeight || time_ - last_.time > kMayHaveBent;
}

/// Clothes of clearly other colors than the visitor's. A camera that has not seen the visitor must
/// show what the other did: whoever gets his number comes with his look to that one.
bool VisitorTracker::is_another(const Person& person) const {
  const auto differs = [&](const imaging::Appearances& seen) {
    const auto unlike = imaging::unlikeness(worn_, seen);
    return unlike && *unlike > imaging::kAnother;
  };
  if (differs(person.appearances)) return true;
  for (std::size_t camera = 0; camera < worn_.size(); ++camera) {
    if (worn_[camera].known() || !person.appearances[camera].known()) continue;
    imaging::Appearances alone;
    alone[camera] = person.appearances[camera];
    if (differs(alone)) return true;
  }
  return false;
}

/// By height and clothes.
bool VisitorTracker::may_be(const Look& look) const {
  return as_tall(look) && !is_another(*look.person);
}

/// Shirt and trousers are both like the visitor's: few others' are.
bool VisitorTracker::looks_like_him(const Person& person) const {
  const auto whole = [](const imaging::Appearance& seen) {
    return seen.upper.known() && seen.legs.known();
  };
  const auto unlike = imaging::unlikeness(worn_, person.appearances);
  return unlike && *unlike < imaging::kAlike && std::ranges::any_of(worn_, whole) &&
         std::ranges::any_of(person.appearances, whole);
}

/// What the visitor wears: before a journey as he is seen there, on it slowly, as the light
/// changes, and never from somebody who may be another one.
void VisitorTracker::learn(const Person& person, double passed) {
  const auto unlike = imaging::unlikeness(worn_, person.appearances);
  if (on_the_way() && ((unlike && *unlike > imaging::kAlike) || is_another(person))) return;
  const double share = on_the_way() ? std::min(1.0, passed / kAdapts) : 1.0;
  for (std::size_t camera = 0; camera < worn_.size(); ++camera)
    imaging::blend(worn_[camera], person.appearances[camera], share);
}

bool VisitorTracker::before(const Look& look) const {
  return look.range <= config_.within &&
         std::abs(std::atan2(look.place.y(), look.place.x())) <= config_.bearing &&
         (look.speed < config_.stands_below || look.heads_here);
}

/// How much this moment speaks for that somebody follows the robot {-1..1}.
double VisitorTracker::following(const Look& look, const Pose2& odom_T_base, bool moves) const {
  if (look.range > kFollowWithin || look.place.x() > kAhead) return -1.0;
  const Point2 to_robot = odom_T_base.position() - look.person->position;
  const bool by_the_way = to_robot.norm() <= config_.trail ||
                          std::any_of(way_.begin(), way_.end(), [&](const auto& point) {
                            return (point.second - look.person->position).norm() <= config_.trail;
                          });
  if (!by_the_way) return -1.0;
  const bool comes = look.speed >= kWalks &&
                     to_robot.dot(look.person->velocity) >= kAlong * look.speed * to_robot.norm();
  // Behind a robot that stands whoever passes comes near.
  if (moves) return comes ? 1.0 : -1.0;
  return comes || look.range <= kWaitsWithin ? 0.0 : -1.0;
}

const VisitorTracker::Look* VisitorTracker::find(std::uint64_t id) const {
  const auto found =
      std::lower_bound(looks_.begin(), looks_.end(), id,
                       [](const Look& look, std::uint64_t each) { return look.person->id < each; });
  return found != looks_.end() && found->person->id == id ? &*found : nullptr;
}

const VisitorTracker::Look* VisitorTracker::nearest_before() const {
  const Look* nearest = nullptr;
  for (const Look& look : looks_) {
    if (look.habit.before < config_.dwell) continue;
    if (!nearest || look.range < nearest->range) nearest = &look;
  }
  return nearest;
}

void VisitorTracker::hold(const Look& look, double time) {
  if (held_ != look.person->id) held_since_ = time;
  held_ = look.person->id;
}

/// Nobody is served: the nearest who stands there, until another one is nearer or this one leaves.
void VisitorTracker::choose_to_serve() {
  const Look* held = find(held_);
  const bool stays =
      seen(held) && held->range <= config_.within + kLeave &&
      std::abs(std::atan2(held->place.y(), held->place.x())) <= config_.bearing + kLeaveBearing &&
      (held->speed < kLeavesAt || held->heads_here);
  if (held && seen(held) && !stays) held_ = 0;
  const Look* nearest = nearest_before();
  if (nearest && (!stays || nearest->range < held->range - kNearer)) hold(*nearest, time_);
}

/// In a visit: the same one, until somebody else stands before the robot and this one does not.
void VisitorTracker::keep_served() {
  const Look* held = find(held_);
  if (seen(held) && held->range <= config_.within) return;
  if (const Look* nearest = nearest_before()) hold(*nearest, time_);
}

/// The people tracker gave the number of the visitor, who stands where nothing looks, to somebody
/// who came along elsewhere: it is nobody's any more.
void VisitorTracker::distrust(const Pose2& odom_T_base) {
  const bool hidden = out_of_view(odom_T_base);
  for (const Look& look : looks_) {
    const auto id = look.person->id;
    if (!hidden || (id != first_ && id != held_) || look.person->unseen > kSighted) continue;
    const double gone = time_ - look.person->unseen - last_.time;
    if (gone < kHidden || (look.person->position - last_.place).norm() <= kElsewhere) continue;
    take_from(look);
  }
}

/// Whoever has the visitor's number, or is taken for him, wears something else: another one.
void VisitorTracker::distrust_clothes() {
  for (const Look& look : looks_) {
    const auto id = look.person->id;
    if ((id == first_ || id == held_) && look.habit.unlike >= kUnlike) take_from(look);
  }
}

/// Somebody is not the visitor, who is where he himself was last seen.
void VisitorTracker::take_from(const Look& look) {
  const auto id = look.person->id;
  habits_[id].beside = look.person->position;
  if (id == held_ && id != first_) last_ = last_of_first_;
  if (id == first_) first_ = kLost;
  if (id == held_) held_ = first_;
}

void VisitorTracker::keep_follower(const Pose2& odom_T_base) {
  distrust_clothes();
  distrust(odom_T_base);
  if (const Look* first = find(first_); seen(first)) return hold(*first, time_);
  if (const Look* held = find(held_); seen(held)) {
    // Somebody took the visitor's place who does not follow: it was another one.
    if (held->habit.follows > 0.0) return;
    const Look* other = follower(kMistaken * config_.follows, kFollowWithin, true);
    if (other && other->range < held->range) return hold(*other, time_);
    if (held->place.x() > kGoneAhead && held_ != first_) {
      take_from(*held);
    }
    return;
  }
  if (held_ == 0) {
    // Who began the journey was not seen.
    if (const Look* nearest = nearest_before(); nearest && !moves(time_))
      return hold(*nearest, time_);
  }
  const Look* found = same_place(odom_T_base);
  if (!found && !out_of_view(odom_T_base)) {
    const double reach = kReach + kWalk * (time_ - last_.time);
    found = follower(config_.follows, held_ == 0 ? kFollowWithin : reach, false);
  }
  if (!found) found = waits(odom_T_base);
  if (found) hold(*found, time_);
}

/// Who has stayed behind or beside the robot that stands, the nearest.
const VisitorTracker::Look* VisitorTracker::waits(const Pose2& odom_T_base) const {
  const bool near = (last_.place - odom_T_base.position()).norm() <= kBlindWithin;
  const double least = near ? kWaits : kWaitsLong;
  const Look* best = nullptr;
  for (const Look& look : looks_) {
    const bool stranger = look.habit.beside || look.habit.from_ahead;
    const double needed = stranger                       ? kStrangerWaits
                          : looks_like_him(*look.person) ? kWaitsAlike
                                                         : least;
    if (look.habit.stays < needed || !may_be(look)) continue;
    if (!best || look.range < best->range) best = &look;
  }
  return best;
}

/// The robot follows: the same one, else who took the place or came back.
void VisitorTracker::keep_leader(double passed) {
  distrust_clothes();
  if (const Look* first = find(first_); seen(first)) hold(*first, time_);
  if (!seen(find(held_))) {
    const Look* found = held_ == 0 ? nearest_before() : come_from_there();
    if (!found) found = come_back();
    if (!found) found = recognised();
    if (found) hold(*found, time_);
  }
  note_others(passed);
}

/// Who is there beside the visitor is not the one who turns up when he is hidden.
void VisitorTracker::note_others(double passed) {
  const Look* held = find(held_);
  const bool leads = seen(held);
  for (const Look& look : looks_) {
    Habit& habit = habits_[look.person->id];
    const bool here = seen(&look) && before(look) && look.range <= kReturnsWithin &&
                      look.speed < config_.stands_below;
    habit.stands = here ? habit.stands + passed : 0.0;
    if (leads && (look.person->position - held->person->position).norm() > kSamePlace)
      habit.beside = look.person->position;
  }
}

/// Where the visitor was going to be, so long after the last sighting.
Point2 VisitorTracker::expected(double gone) const {
  const double foresees = service_ == Service::kFollows ? kLeaderForesees : kForesees;
  return last_.place + std::min(gone, foresees) * last_.velocity;
}

/// Who first turned up where the visitor was going to be then, and walks on or has stopped.
const VisitorTracker::Look* VisitorTracker::come_from_there() const {
  const Look* best = nullptr;
  double least = 1.0;
  for (const Look& look : looks_) {
    const bool new_here = look.habit.since > last_.time;
    const double gone = (new_here ? look.habit.since : time_) - last_.time;
    if (!seen(&look) || look.habit.beside || gone > kLeaderHidden || !may_be(look)) continue;
    const bool likewise =
        look.speed < kStops || (look.person->velocity - last_.velocity).norm() <= kSameVelocity;
    const Point2 place = new_here ? look.habit.from : look.person->position;
    const double off = (place - expected(gone)).norm() / (kSamePlace + kStrays * gone);
    if (!likewise || off > least) continue;
    best = &look;
    least = off;
  }
  return best;
}

/// Who came and has stood at the robot for a while, the nearest.
const VisitorTracker::Look* VisitorTracker::come_back() const {
  const Look* best = nullptr;
  for (const Look& look : looks_) {
    const bool stood_there =
        look.habit.beside && (look.person->position - *look.habit.beside).norm() < kComes;
    if (look.habit.stands < config_.returns || stood_there || !may_be(look)) continue;
    if (!best || look.range < best->range) best = &look;
  }
  return best;
}

/// Who wears the visitor's clothes, no farther from where he was last seen than he can have walked,
/// the nearest to there.
const VisitorTracker::Look* VisitorTracker::recognised() const {
  const Look* best = nullptr;
  double least = kReach + kWalk * (time_ - last_.time);
  for (const Look& look : looks_) {
    const double off = (look.person->position - last_.place).norm();
    if (!seen(&look) || look.habit.beside || look.habit.alike < kRecognised || off > least)
      continue;
    if (!may_be(look)) continue;
    best = &look;
    least = off;
  }
  return best;
}

/// Somebody who turned up where the visitor was going to be, walking likewise.
const VisitorTracker::Look* VisitorTracker::same_place(const Pose2& odom_T_base) const {
  const double gone = time_ - last_.time;
  const bool hidden = out_of_view(odom_T_base);
  if (held_ == 0 || (gone > kSameFor && !hidden)) return nullptr;
  const Point2 there = hidden ? last_.place : expected(gone);
  const Look* best = nullptr;
  double least = hidden ? kFarAside : kSamePlace;
  for (const Look& look : looks_) {
    const double off = (look.person->position - there).norm();
    if (!seen(&look) || look.habit.beside || off > least || !may_be(look)) continue;
    if ((look.person->velocity - last_.velocity).norm() > kSameVelocity) continue;
    best = &look;
    least = off;
  }
  return best;
}

/// Who has followed for so long [s], nearest to where the visitor was last seen and no farther from
/// there than `nearest` [m]. Who was seen beside the visitor only if `any`.
const VisitorTracker::Look* VisitorTracker::follower(double least, double nearest, bool any) const {
  const bool drives = moves(time_);
  const Look* best = nullptr;
  for (const Look& look : looks_) {
    const double off = held_ == 0 ? look.range : (look.person->position - last_.place).norm();
    const bool passes = !drives && look.place.x() > 0.0;
    const bool new_one =
        look.person->id != held_ && seen(&look) && !passes && (any || !look.habit.beside);
    const double needed = looks_like_him(*look.person) ? kAlikeFollows * least : least;
    if (!new_one || look.habit.follows < needed || off > nearest || !may_be(look)) continue;
    best = &look;
    nearest = off;
  }
  return best;
}

/// The visitor was last seen, not walking off, where nothing looks now, or nearly so. While the
/// robot stands he may have stepped aside, and only a camera notices somebody who stands.
bool VisitorTracker::out_of_view(const Pose2& odom_T_base) const {
  const double gone = time_ - last_.time;
  if (!on_the_way() || held_ == 0 || gone > config_.blind_for) return false;
  const Point2 place = inverse(odom_T_base) * last_.place;
  const Point2 away = last_.place - odom_T_base.position();
  const bool stays = service_ == Service::kGuides && !moves(time_) &&
                     last_.velocity.dot(away) <= kWalksOff * away.norm();
  const double aside = service_ == Service::kGuides ? kAside : 0.0;
  if (!stays) return blind_at(place, config_.blind_from, aside);
  return blind_at(place, kCameraEnds, std::min(kAside + kStepsAside * gone, kFarAside));
}

/// A camera looks to where the visitor was last seen, if the robot follows; else ahead.
bool VisitorTracker::looks_there(const Moment& moment) const {
  const bool behind = service_ == Service::kFollows && held_ != 0 &&
                      (inverse(moment.odom_T_base) * last_.place).x() < 0.0;
  return behind ? moment.looks_behind : moment.looks_ahead;
}

void VisitorTracker::report(const Moment& moment, double passed) {
  estimate_ = {};
  estimate_.person = held_ == kLost ? 0 : held_;
  const Look* held = find(held_);
  const bool guides = service_ == Service::kGuides;
  if (held && held->person->unseen <= kSighted && held->habit.unlike == 0.0) {
    last_ = {moment.time - held->person->unseen, held->person->position, held->person->velocity};
    if (held_ == first_) last_of_first_ = last_;
    if (!on_the_way() && held_ != measured_) measured_ = held_, height_ = 0.0, worn_ = {};
    if (held_ == measured_ && held->person->height > 0.0)
      height_ = std::max(height_, held->person->height);
    learn(*held->person, passed);
  }
  // Ahead, the laser shows who follows only now and then: without eyes behind nothing is known.
  if (guides && !moment.looks_behind) return;
  if (seen(held)) {
    estimate_ = {Presence::kSeen, held_, held->place, held->speed};
  } else if (out_of_view(moment.odom_T_base)) {
    estimate_.presence = Presence::kSeen;
    estimate_.place = inverse(moment.odom_T_base) * last_.place;
  } else if (guides || looks_there(moment)) {
    estimate_.presence = Presence::kNobody;
  }
}

}  // namespace usher::visitor_tracker
