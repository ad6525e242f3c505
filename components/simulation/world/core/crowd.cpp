#include "simulation/world/core/crowd.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/world/core/base.hpp"
#include "simulation/world/core/shapes.hpp"

namespace usher::world {
namespace {

constexpr double kArrived = 0.25;    // [m]
constexpr double kSway = 0.15;       // [m] a balancing robot that stands moves by less
constexpr double kStands = 2.0;      // [s] after which people believe that it stands
constexpr double kSqueeze = 0.05;    // [m] of gap that is enough past a robot that stands
constexpr double kRetreat = 6.0;     // [s] that somebody walks away who cannot pass it
constexpr double kTrailStep = 0.1;   // [m]
constexpr double kLookPeriod = 0.2;  // [s] between looks for the way to follow
constexpr std::size_t kTrailLength = 400;
constexpr double kStandsFirm = 0.5;   // [m/s^2] a weaker push does not make a standing person step
constexpr double kProgress = 0.3;     // [m] less than this within the patience is none
constexpr double kFastestTurn = 4.0;  // [rad/s] of the eyes

Point2 unit(const Point2& v) {
  const double length = v.norm();
  return length > 1e-9 ? Point2(v / length) : Point2(0.0, 0.0);
}

Point2 capped(const Point2& v, double length) {
  const double norm = v.norm();
  return norm > length ? Point2(v * (length / norm)) : v;
}

// Somewhere on the closed line, and the corner after it.
Point2 point_on_loop(const std::vector<Point2>& loop, double share, std::size_t& next) {
  const double whole = share * static_cast<double>(loop.size());
  const auto leg = std::min(static_cast<std::size_t>(whole), loop.size() - 1);
  next = (leg + 1) % loop.size();
  return loop[leg] + (whole - static_cast<double>(leg)) * (loop[next] - loop[leg]);
}

}  // namespace

Crowd::Crowd(const CrowdConfig& config, std::span<const PersonPlan> plans, const Point2& robot,
             std::uint64_t seed)
    : config_(config), random_(stream_seed(seed, "crowd")) {
  for (const PersonPlan& plan : plans) {
    Person person{
        .name = plan.name, .scripted = plan.loop.empty(), .position = plan.start, .yaw = plan.yaw};
    person.radius = config.radius;
    // Not from the stream of the walking, which heights shall not disturb.
    Random looks(stream_seed(seed, plan.name.c_str()));
    person.height =
        plan.height > 0.0 ? plan.height : std::clamp(looks.gaussian(1.72, 0.09), 1.5, 1.98);
    Random wardrobe(stream_seed(seed, (plan.name + "'s clothes").c_str()));
    person.clothes = rendering::draw_clothes(wardrobe);
    Mind mind{.at_rest = plan.posture,
              .watches = plan.watches,
              .speed = plan.speed,
              .loop = plan.loop,
              .pause = plan.pause};
    if (!plan.loop.empty()) {
      constexpr int kTries = 20;
      constexpr double kFarEnough = 2.0;  // [m]
      mind.speed *= std::max(0.5, random_.gaussian(1.0, config.speed_spread));
      for (int i = 0; i < kTries; ++i) {
        person.position = point_on_loop(mind.loop, random_.uniform(), mind.next);
        if ((person.position - robot).norm() > kFarEnough) break;
      }
    }
    mind.stuck_at = person.position;
    movers_.push_back({person.position, config.radius, config.top});
    hold(person, mind, movers_.back());
    people_.push_back(std::move(person));
    minds_.push_back(std::move(mind));
  }
}

Status Crowd::send(const std::string& name, const Point2& goal, double speed, bool follow,
                   const std::string& leader) {
  for (std::size_t i = 0; i < people_.size(); ++i) {
    if (people_[i].name != name) continue;
    if (!people_[i].scripted) return Error{"person '" + name + "' walks a loop, nobody sends it"};
    if (!(speed >= 0.0 && speed <= 2.5)) {
      return Error{"speed of person '" + name + "' must be in [0, 2.5] m/s, got " +
                   std::to_string(speed)};
    }
    if (!goal.allFinite()) return Error{"goal of person '" + name + "' must be finite"};
    minds_[i].goal = goal;
    minds_[i].speed = speed;
    minds_[i].follow = follow;
    minds_[i].leader = leader;
    minds_[i].has_goal = speed > 0.0;
    return {};
  }
  return Error{"no person is named '" + name + "'"};
}

void Crowd::show(std::vector<Person> people, std::vector<Mover> movers) {
  people_ = std::move(people);
  movers_ = std::move(movers);
  minds_.resize(people_.size());
}

void Crowd::step(const Scene& scene, std::span<const RobotView> robots) {
  remember_robots(robots);
  for (std::size_t i = 0; i < people_.size(); ++i) {
    Person& person = people_[i];
    Mind& mind = minds_[i];
    choose_goal(person, mind, scene);
    const RobotView& robot = robots_[nearest_robot(person.position)];
    const Point2 wanted = wanted_velocity(person, mind, robot);
    // Who follows and is near enough stands, and has to step out of the robot's way.
    const bool walks =
        mind.has_goal && mind.pause_left <= 0.0 && (mind.goal - person.position).norm() > 0.05;

    Point2 push = push_of_people(i) + push_of_robot(person, walks, robot);
    constexpr double kWallSight = 0.8;  // [m]
    const auto wall = scene.nearest(person.position, config_.top, person.radius + kWallSight);
    if (wall.thing >= 0) {
      push += config_.wall_push * std::exp((person.radius - wall.distance) / config_.wall_reach) *
              unit(person.position - wall.point);
    }
    const bool sits = mind.at_rest == rendering::Posture::kSitting;
    if (!walks && (sits || push.norm() < kStandsFirm)) push.setZero();
    const bool by_a_wall = wall.distance < person.radius + 0.1;
    turn_sideways(person, walks, robot);
    move(i, (wanted - person.velocity) / config_.relaxation + push, by_a_wall, scene, robot);
    watch(person, mind, walks, robots_[watched_robot(person, mind)]);
    lose_patience(person, mind, robot);
    hold(person, mind, movers_[i]);
  }
}

/// The one that spoke with him, while it is near; one that stands for long is no longer looked at
/// when another one comes.
std::size_t Crowd::watched_robot(const Person& person, const Mind& mind) const {
  constexpr double kBoring = 20.0, kDead = 60.0;  // [s]
  std::size_t nearest = robots_.size();
  double least = config_.watch_within;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const double distance = (robots_[i].pose.position() - person.position).norm();
    if (distance > config_.watch_within) continue;
    const bool leads = !mind.leader.empty() && robots_[i].name == mind.leader;
    if (leads && robots_[i].stands < kDead) return i;
    if (distance > least || robots_[i].stands > kBoring) continue;
    nearest = i;
    least = distance;
  }
  return nearest < robots_.size() ? nearest : nearest_robot(person.position);
}

/// Turns the face to a robot that is near.
void Crowd::watch(Person& person, const Mind& mind, bool walks, const RobotView& robot) const {
  if (!mind.watches || walks || robot.footprint.empty()) return;
  const Point2 to_robot = robot.pose.position() - person.position;
  if (to_robot.norm() > config_.watch_within) return;
  const double turn = geometry::shortest_turn(person.yaw, std::atan2(to_robot.y(), to_robot.x()));
  person.yaw = geometry::normalized(person.yaw +
                                    std::clamp(turn, -kFastestTurn * kStep, kFastestTurn * kStep));
}

/// Past a robot that stands people turn sideways, and back once they have room.
void Crowd::turn_sideways(Person& person, bool walks, const RobotView& robot) const {
  constexpr double kNear = 0.8;  // [m]
  constexpr double kRate = 0.3;  // [m/s]
  if (robot.footprint.empty()) return;
  const double gap =
      shapes::Polygon(robot.footprint).gap_to_disc(person.position, person.radius).distance;
  const bool squeezes = walks && robot.stands > kStands && gap < kNear;
  const double change = (squeezes ? config_.sideways : config_.radius) - person.radius;
  const double step = std::clamp(change, -kRate * kStep, kRate * kStep);
  if (step < gap - kSqueeze) person.radius += step;
}

/// Posture and height of the body; who walks, walks upright.
void Crowd::hold(Person& person, const Mind& mind, Mover& mover) const {
  using rendering::Posture;
  constexpr double kWalks = 0.15;       // [m/s]
  constexpr double kStepLength = 0.41;  // of one step, times the height
  const double speed = person.velocity.norm();
  person.posture = speed > kWalks ? Posture::kWalking : mind.at_rest;
  person.stride =
      std::remainder(person.stride + geometry::kPi * speed * kStep / (kStepLength * person.height),
                     2.0 * geometry::kPi);
  mover.top = rendering::top_of(person.posture, person.height);
}

void Crowd::remember_robots(std::span<const RobotView> robots) {
  robots_.assign(robots.begin(), robots.end());
  tracks_.resize(robots.size());
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    Track& track = tracks_[i];
    if (robots_[i].footprint.empty()) continue;
    const Point2 here = robots_[i].pose.position();
    track.stands += kStep;
    if ((here - track.stood_at).norm() > kSway) {
      track.stood_at = here;
      track.stands = 0.0;
    }
    robots_[i].stands = track.stands;
    if (!track.trail.empty() && (track.trail.back() - here).norm() < kTrailStep) continue;
    track.trail.push_back(here);
    if (track.trail.size() > kTrailLength) track.trail.pop_front();
  }
}

std::size_t Crowd::nearest_robot(const Point2& to) const {
  const auto nearest =
      std::min_element(robots_.begin(), robots_.end(), [&](const auto& a, const auto& b) {
        return (a.pose.position() - to).norm() < (b.pose.position() - to).norm();
      });
  return static_cast<std::size_t>(nearest - robots_.begin());
}

/// Whom somebody walks with, or round.
std::size_t Crowd::robot_for(const Person& person, const Mind& mind) const {
  if (!mind.follow) return nearest_robot(person.position);
  const auto leader = std::find_if(robots_.begin(), robots_.end(),
                                   [&](const auto& each) { return each.name == mind.leader; });
  return leader == robots_.end() ? 0 : static_cast<std::size_t>(leader - robots_.begin());
}

/// Along the robot's way, so that no wall comes between: the newest point of it that a straight
/// walk reaches, else a little on from the nearest.
Point2 Crowd::point_to_follow(const Point2& here, const Scene& scene,
                              const std::deque<Point2>& trail) const {
  constexpr double kSight = 6.0;    // [m]
  constexpr double kTested = 0.2;   // [m] between tested points of the straight walk
  constexpr std::size_t kSkip = 3;  // points of the trail
  const auto free = [&](const Point2& there) {
    const Point2 way = there - here;
    const int steps = static_cast<int>(way.norm() / kTested);
    for (int i = 1; i <= steps; ++i) {
      const Point2 point = here + way * (static_cast<double>(i) / steps);
      if (scene.nearest(point, config_.top, config_.radius).thing >= 0) return false;
    }
    return true;
  };
  constexpr std::size_t kAhead = 8;  // points of the trail
  std::size_t nearest = trail.size() - 1;
  for (std::size_t i = trail.size(); i > 0; i -= std::min(i, kSkip)) {
    const Point2& point = trail[i - 1];
    if ((point - here).norm() < kSight && free(point)) return point;
    if ((point - here).norm() < (trail[nearest] - here).norm()) nearest = i - 1;
  }
  return trail[std::min(nearest + kAhead, trail.size() - 1)];
}

void Crowd::choose_goal(Person& person, Mind& mind, const Scene& scene) {
  const std::size_t which = robot_for(person, mind);
  const RobotView& robot = robots_[which];
  const std::deque<Point2>& trail = tracks_[which].trail;
  if (mind.follow && mind.has_goal && !trail.empty()) {
    mind.look_left -= kStep;
    if (mind.look_left <= 0.0) {
      mind.look_left = kLookPeriod;
      mind.goal = point_to_follow(person.position, scene, trail);
    }
    // Near enough, or still in front of it: lets the robot pass first, and when it does not, walks
    // round it.
    const Point2 from_robot = person.position - robot.pose.position();
    const Point2 heading(std::cos(robot.pose.yaw), std::sin(robot.pose.yaw));
    constexpr double kInFront = 2.5;  // [m]
    constexpr double kTooNear = 0.7;  // of the distance kept
    const bool in_front = from_robot.norm() < kInFront && from_robot.dot(heading) > 0.0;
    if (in_front && robot.stands > config_.patience) {
      mind.goal = robot.pose.position() - config_.follow_distance * heading;
    } else if (!in_front && from_robot.norm() < kTooNear * config_.follow_distance) {
      mind.goal = person.position + 0.5 * unit(from_robot);  // it backs off: so does who follows
    } else if (in_front || from_robot.norm() < config_.follow_distance) {
      mind.goal = person.position;
    }
    return;
  }
  if (mind.loop.empty()) return;
  mind.pause_left = std::max(0.0, mind.pause_left - kStep);
  mind.goal = mind.loop[mind.next];
  mind.has_goal = true;
  mind.retreat_left = std::max(0.0, mind.retreat_left - kStep);
  if (mind.retreat_left > 0.0)
    mind.goal = person.position + 2.0 * unit(person.position - robot.pose.position());
  if ((mind.goal - person.position).norm() < kArrived) {
    const std::size_t count = mind.loop.size();
    mind.next = (mind.next + (mind.reversed ? count - 1 : 1)) % count;
    mind.pause_left = mind.pause;
  }
}

void Crowd::turn_round(Mind& mind) const {
  const std::size_t count = mind.loop.size();
  mind.reversed = !mind.reversed;
  mind.next = (mind.next + (mind.reversed ? count - 1 : 1)) % count;
}

void Crowd::lose_patience(Person& person, Mind& mind, const RobotView& robot) {
  if (mind.loop.empty() || mind.pause_left > 0.0) {
    mind.stuck = 0.0;
    return;
  }
  mind.stuck += kStep;
  if ((person.position - mind.stuck_at).norm() > kProgress) {
    mind.stuck = 0.0;
    mind.stuck_at = person.position;
  } else if (mind.stuck > config_.patience) {
    mind.stuck = 0.0;
    turn_round(mind);
    // Pushed off the loop, both ways along it may lead past the robot.
    const Point2 to_robot = robot.pose.position() - person.position;
    const bool met = !robot.footprint.empty() && to_robot.norm() < config_.robot_see;
    if (met && unit(to_robot).dot(unit(mind.loop[mind.next] - person.position)) > 0.5)
      mind.retreat_left = kRetreat;
  }
}

Point2 Crowd::wanted_velocity(const Person& person, const Mind& mind,
                              const RobotView& robot) const {
  if (!mind.has_goal || mind.pause_left > 0.0) return Point2::Zero();
  const Point2 way = mind.goal - person.position;
  const double left = way.norm();
  // Slows down in time for the end of the way; a corner of a loop is taken in full walk.
  const bool ends_here = mind.loop.empty() || mind.pause > 0.0;
  if (ends_here && left < 0.05) return Point2::Zero();
  const double speed = ends_here ? std::min(mind.speed, left / config_.relaxation) : mind.speed;
  const Point2 direction = unit(way);
  if (robot.footprint.empty()) return speed * direction;

  const shapes::Polygon body(robot.footprint);
  const double apart = (body.center() - person.position).norm();
  if (apart > body.radius() + person.radius + config_.robot_see) return speed * direction;
  const shapes::Gap gap = body.gap_to_disc(person.position, person.radius);
  const Point2 to_robot = unit(body.center() - person.position);
  const bool ahead = to_robot.dot(direction) > 0.5;
  if (!ahead) return speed * direction;
  const double stop = robot.stands > kStands ? kSqueeze : config_.robot_stop;
  if (gap.distance < stop) return Point2::Zero();
  const double caution = std::min(1.0, (gap.distance - stop) / (0.5 * config_.robot_see));
  return speed * (0.3 + 0.7 * caution) * direction;
}

Point2 Crowd::push_of_people(std::size_t index) const {
  const Point2 here = people_[index].position;
  const Point2 looking(std::cos(people_[index].yaw), std::sin(people_[index].yaw));
  Point2 push = Point2::Zero();
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const Point2 away = here - people_[i].position;
    const double distance = away.norm();
    if (i == index || distance > 3.0) continue;
    // What is behind matters less; of two who meet, both keep to the right.
    const Point2 out = distance > 1e-6 ? Point2(away / distance) : Point2(0.0, 1.0);
    const double ahead = -out.dot(looking);
    const double strength = config_.person_push * (0.35 + 0.65 * 0.5 * (1.0 + ahead)) *
                            std::exp((2.0 * config_.radius - distance) / config_.person_reach);
    push += strength * out;
    if (ahead > 0.7) push += 0.5 * strength * Point2(looking.y(), -looking.x());
  }
  return push;
}

Point2 Crowd::push_of_robot(const Person& person, bool walks, const RobotView& robot) const {
  if (robot.footprint.empty()) return Point2::Zero();
  const shapes::Polygon body(robot.footprint);
  const Point2 away = person.position - body.center();
  const double apart = away.norm();
  if (apart > body.radius() + person.radius + config_.robot_see) return Point2::Zero();
  const double gap = body.gap_to_disc(person.position, person.radius).distance;
  const bool stands = robot.stands > kStands;
  Point2 push = (stands ? 0.25 : 1.0) * config_.robot_push * std::exp(-gap / config_.robot_reach) *
                unit(away);

  const Point2 looking(std::cos(person.yaw), std::sin(person.yaw));
  const Point2 heading(std::cos(robot.pose.yaw), std::sin(robot.pose.yaw));
  if (walks && -unit(away).dot(looking) > 0.7) {
    // Meets the robot: passes on the right, unless already on its other side.
    constexpr double kBeside = 0.3;  // [m]
    const Point2 right(looking.y(), -looking.x());
    push += 1.5 * std::exp(-gap / 1.2) * (away.dot(right) < -kBeside ? Point2(-right) : right);
  } else if (!walks && unit(away).dot(heading) > 0.7 && gap < 0.8) {
    // Stands in its way: steps out of it, to the side where the person already is.
    const Point2 left(-heading.y(), heading.x());
    push += 1.5 * (away.dot(left) >= 0.0 ? left : Point2(-left));
  }
  return push;
}

void Crowd::move(std::size_t index, const Point2& acceleration, bool by_a_wall, const Scene& scene,
                 const RobotView& robot) {
  Person& person = people_[index];
  person.velocity += capped(acceleration, config_.max_acceleration) * kStep;
  person.velocity = capped(person.velocity, 1.3 * std::max(minds_[index].speed, 0.6));
  const Point2 before = person.position;
  person.position += person.velocity * kStep;

  const bool robot_here = !robot.footprint.empty();
  const auto robot_gap = [&] {
    return shapes::Polygon(robot.footprint).gap_to_disc(person.position, person.radius).distance;
  };
  constexpr double kSkin = 0.01;  // [m] nobody touches the robot by own will
  if (robot_here && robot_gap() < kSkin) {
    // Stays where it was; what still overlaps is the robot's doing and shoves the person away.
    person.position = before;
    person.velocity.setZero();
    const bool sits = person.posture == rendering::Posture::kSitting;
    if (!sits && robot_gap() < kSkin) {
      person.position += 1.5 * kStep * unit(before - shapes::Polygon(robot.footprint).center());
    }
  }
  const auto wall =
      by_a_wall ? scene.nearest(person.position, config_.top, person.radius) : Scene::Nearest{};
  if (wall.thing >= 0) {
    const Point2 out = unit(person.position - wall.point);
    person.position = wall.distance > 0.0
                          ? Point2(person.position + (person.radius - wall.distance) * out)
                          : before;
    const double into = person.velocity.dot(out);
    if (into < 0.0) person.velocity -= into * out;
  }
  if (person.velocity.norm() > 0.15) {
    const double turn =
        geometry::shortest_turn(person.yaw, std::atan2(person.velocity.y(), person.velocity.x()));
    person.yaw = geometry::normalized(
        person.yaw + std::clamp(turn, -kFastestTurn * kStep, kFastestTurn * kStep));
  }
  movers_[index].center = person.position;
  movers_[index].radius = person.radius;
}

}  // namespace usher::world
