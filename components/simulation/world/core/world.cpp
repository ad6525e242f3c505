#include "simulation/world/core/world.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/world/core/shapes.hpp"

namespace usher::world {
namespace {

constexpr double kCeilingOfMaps = 2.7;   // [m]
constexpr double kClearanceReach = 2.0;  // [m] farther is not measured
constexpr double kApart = 0.02;          // [m] a contact ends when the gap is larger
constexpr double kContactSpeed = 0.05;   // [m/s]
constexpr int kWatchEvery = 10;          // [steps]
constexpr double kNever = std::numeric_limits<double>::infinity();

std::unique_ptr<Base> make_base(const RobotConfig& robot, std::uint64_t seed) {
  if (robot.kind == RobotConfig::Kind::kPioneer) {
    return std::make_unique<Pioneer>(robot.pioneer, seed);
  }
  return std::make_unique<Segway>(robot.segway, seed);
}

/// Discs along the longer side of an outline's box, as wide as the shorter one.
void add_bodies(const OtherRobot& robot, std::vector<Mover>& bodies) {
  Point2 low = robot.outline.front(), high = low;
  for (const Point2& corner : robot.outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const Point2 half = 0.5 * (high - low);
  const double radius = half.minCoeff();
  const double reach = half.maxCoeff() - radius;
  const Point2 along = half.x() > half.y() ? Point2(reach, 0.0) : Point2(0.0, reach);
  const int gaps = static_cast<int>(std::ceil(2.0 * reach / std::max(radius, 0.01)));
  for (int i = 0; i <= gaps; ++i) {
    const double share = gaps == 0 ? 0.0 : 2.0 * i / gaps - 1.0;
    bodies.push_back(
        {robot.pose * Point2(0.5 * (low + high) + share * along), radius, robot.height});
  }
}

}  // namespace

World::World(const WorldConfig& config, Building building, std::span<const PersonPlan> people,
             const Pose2& robot, std::uint64_t seed)
    : World(config, std::optional(std::move(building)), std::nullopt, people, robot, seed) {}

World::World(const WorldConfig& config, grid::OccupancyGrid map, std::span<const PersonPlan> people,
             const Pose2& robot, std::uint64_t seed)
    : World(config, std::nullopt, std::optional(std::move(map)), people, robot, seed) {}

World::World(const WorldConfig& config, std::optional<Building> building,
             std::optional<grid::OccupancyGrid> map, std::span<const PersonPlan> people,
             const Pose2& robot, std::uint64_t seed)
    : config_(config),
      building_(std::move(building)),
      map_(std::move(map)),
      lighting_(seed),
      base_(make_base(config.robot, seed)),
      crowd_(config.crowd, people, robot.position(), seed),
      sonar_(config.robot.sonar, seed),
      whiskers_(config.robot.whiskers),
      footprint_(config.robot.footprint),
      seen_since_(people.size(), kNever),
      touched_people_(people.size(), false) {
  for (const LaserConfig& laser : config.robot.lasers) lasers_.emplace_back(laser, seed);
  rebuild();
  base_->place(robot);
  judge(robot, {});
}

void World::rebuild() {
  ++scene_version_;
  std::vector<Thing> things = building_ ? construct(*building_) : std::vector<Thing>{};
  things.insert(things.end(), extra_.begin(), extra_.end());
  scene_ = std::make_unique<Scene>(
      std::move(things), building_ ? building_->ceiling : kCeilingOfMaps, map_ ? &*map_ : nullptr);
}

void World::step() {
  const Pose2 before = base_->truth().pose;
  base_->step();
  const Twist2 speed = base_->truth().twist;
  judge(before, speed);
  if (config_.moves_people) {
    std::vector<RobotView> robots{
        {base_->truth().pose, footprint_at(base_->truth().pose), config_.name}};
    robots.reserve(1 + robots_.size());
    for (std::size_t i = 0; i < robots_.size(); ++i)
      robots.push_back({robots_[i].pose, robot_outlines_[i], robots_[i].name});
    crowd_.step(*scene_, robots);
  }
  ++steps_;
  time_ = static_cast<double>(steps_) * kStep;
  if (steps_ % kWatchEvery == 0) watch_people();
}

Status World::place_robot(const Pose2& pose) {
  if (!pose.finite()) return Error{"pose of the robot must be finite"};
  const auto& footprint = footprint_at(pose);
  const auto near = scene_->nearest(footprint, config_.robot.height, kApart);
  if (near.thing >= 0) {
    return Error{"the robot would touch '" +
                 scene_->things()[static_cast<std::size_t>(near.thing)].name + "' there"};
  }
  for (const Person& person : crowd_.people()) {
    const auto gap = shapes::Polygon(footprint).gap_to_disc(person.position, person.radius);
    if (gap.distance < kApart) return Error{"the robot would touch '" + person.name + "' there"};
  }
  base_->place(pose);
  judge(pose, {});
  return {};
}

geometry::Pose3 World::base_in_world() const {
  const BaseTruth& truth = base_->truth();
  return {{truth.pose.x, truth.pose.y, config_.robot.axle_height},
          geometry::from_roll_pitch_yaw(0.0, truth.pitch, truth.pose.yaw)};
}

std::vector<Point2>& World::footprint_at(const Pose2& pose) {
  for (std::size_t i = 0; i < footprint_.size(); ++i) {
    footprint_[i] = pose * config_.robot.footprint[i];
  }
  return footprint_;
}

void World::scan(std::size_t laser, std::vector<float>& ranges) {
  lasers_.at(laser).scan(*scene_, everybody(), base_in_world(), ranges);
}

void World::sonar(std::vector<float>& ranges) {
  sonar_.measure(*scene_, everybody(), base_in_world(), ranges);
}

WhiskerContacts World::whiskers() {
  return whiskers_.touch(*scene_, everybody(), base_->truth().pose);
}

Status World::send_person(const std::string& name, const Point2& goal, double speed, bool follow,
                          const std::string& leader) {
  return crowd_.send(name, goal, speed, follow, leader);
}

void World::show_people(std::vector<Person> people, std::vector<Mover> bodies) {
  seen_since_.resize(people.size(), kNever);
  touched_people_.resize(people.size(), false);
  crowd_.show(std::move(people), std::move(bodies));
}

void World::show_robots(std::vector<OtherRobot> robots) {
  robots_ = std::move(robots);
  robots_seen_since_.resize(robots_.size(), kNever);
  touched_robots_.resize(robots_.size(), false);
  robot_outlines_.resize(robots_.size());
  robot_bodies_.clear();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    robot_outlines_[i].clear();
    for (const Point2& corner : robots_[i].outline)
      robot_outlines_[i].push_back(robots_[i].pose * corner);
    add_bodies(robots_[i], robot_bodies_);
  }
}

std::vector<Mover> World::everybody() const {
  const auto people = crowd_.movers();
  std::vector<Mover> all(people.begin(), people.end());
  all.insert(all.end(), robot_bodies_.begin(), robot_bodies_.end());
  return all;
}

Status World::set_door(const std::string& name, bool open) {
  if (building_) {
    for (Gap& gap : building_->gaps) {
      if (!gap.door || gap.name != name) continue;
      gap.open = open;
      newcomers_.emplace_back("door " + name, time_);
      rebuild();
      return {};
    }
  }
  return Error{"no door is named '" + name + "'"};
}

Status World::add_thing(Thing thing) {
  for (const Thing& other : scene_->things()) {
    if (other.name == thing.name) return Error{"a thing is already named '" + thing.name + "'"};
  }
  newcomers_.emplace_back(thing.name, time_);
  extra_.push_back(std::move(thing));
  rebuild();
  return {};
}

Status World::remove_thing(const std::string& name) {
  const auto found = std::find_if(extra_.begin(), extra_.end(),
                                  [&](const Thing& thing) { return thing.name == name; });
  if (found == extra_.end()) return Error{"no added thing is named '" + name + "'"};
  extra_.erase(found);
  rebuild();
  return {};
}

void World::watch_people() {
  const BaseTruth& robot = base_->truth();
  const auto watch = [&](const Mover& mover, double& seen_since) {
    const Point2 to = inverse(robot.pose) * mover.center;
    const double distance = to.norm();
    const double bearing = std::atan2(to.y(), to.x());
    bool seen = distance < config_.sight && std::abs(bearing) < config_.sight_angle;
    if (seen && distance > mover.radius + 0.1) {
      caster_.cast(*scene_, gaze_,
                   {{robot.pose.x, robot.pose.y, 1.0},
                    geometry::to_space({0.0, 0.0, robot.pose.yaw + bearing}).rotation},
                   {.max_range = distance}, {&mover, 1}, hits_);
      seen = hits_.what[0] >= static_cast<std::int32_t>(scene_->things().size());
    }
    if (!seen) {
      seen_since = kNever;
    } else if (seen_since == kNever) {
      seen_since = time_;
    }
  };
  const std::span<const Mover> movers = crowd_.movers();
  for (std::size_t i = 0; i < movers.size(); ++i) watch(movers[i], seen_since_[i]);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const shapes::Polygon outline(robot_outlines_[i]);
    watch({outline.center(), outline.radius(), robots_[i].height}, robots_seen_since_[i]);
  }
}

/// Two robots that meet stop each other, as walls do; who only moves away, or turns, is let go.
void World::judge_robots(const Pose2& before, double fastest) {
  if (robots_.empty()) return;
  std::vector<Point2> earlier;
  earlier.reserve(config_.robot.footprint.size());
  for (const Point2& corner : config_.robot.footprint) earlier.push_back(before * corner);
  const Pose2 now = base_->truth().pose;
  const shapes::Polygon body(footprint_at(now));
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const double gap = body.gap_to_polygon(robot_outlines_[i]).distance;
    if (gap < truth_.clearance) truth_.clearance = gap, truth_.nearest = robots_[i].name;
    if (gap <= 0.0 && !touched_robots_[i]) {
      count_touch(robots_[i].name, time_ - robots_seen_since_[i] > config_.stopping_time, fastest);
    }
    touched_robots_[i] = gap <= (touched_robots_[i] ? kApart : 0.0);
    if (gap > 0.0) continue;
    const Point2 other = robots_[i].pose.position();
    const bool came = shapes::Polygon(earlier).gap_to_polygon(robot_outlines_[i]).distance > 0.0;
    const bool comes = (now.position() - other).norm() < (before.position() - other).norm();
    if (came || comes) base_->obstruct(before);
  }
}

bool World::thing_long_visible(const std::string& name) const {
  return std::none_of(newcomers_.begin(), newcomers_.end(), [&](const auto& newcomer) {
    return newcomer.first == name && time_ - newcomer.second <= config_.stopping_time;
  });
}

void World::judge(const Pose2& before, const Twist2& speed) {
  const auto& footprint = footprint_at(base_->truth().pose);
  const shapes::Polygon body(footprint);
  const double fastest = std::abs(speed.v) + std::abs(speed.w) * body.radius();

  const auto near = scene_->nearest(footprint, config_.robot.height, kClearanceReach);
  truth_.clearance = near.distance;
  truth_.nearest =
      near.thing < 0 ? "" : scene_->things()[static_cast<std::size_t>(near.thing)].name;
  if (near.distance > kApart) touched_things_.clear();
  if (near.distance <= 0.0) {
    const auto& touched = touched_things_;
    if (std::find(touched.begin(), touched.end(), truth_.nearest) == touched.end()) {
      touched_things_.push_back(truth_.nearest);
      count_touch(truth_.nearest, thing_long_visible(truth_.nearest), fastest);
    }
    base_->obstruct(before);
  }
  for (std::size_t i = 0; i < crowd_.people().size(); ++i) {
    const Person& person = crowd_.people()[i];
    const double gap = body.gap_to_disc(person.position, person.radius).distance;
    if (gap < truth_.clearance) truth_.clearance = gap, truth_.nearest = person.name;
    if (gap <= 0.0 && !touched_people_[i]) {
      count_touch(person.name, time_ - seen_since_[i] > config_.stopping_time, fastest);
    }
    touched_people_[i] = gap <= (touched_people_[i] ? kApart : 0.0);
  }
  judge_robots(before, fastest);
}

void World::count_touch(const std::string& what, bool seen, double speed) {
  truth_.contact_with = what;
  ++(seen && speed > kContactSpeed ? truth_.contacts : truth_.touches);
}

}  // namespace usher::world
