#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "simulation/rendering/core/light.hpp"
#include "simulation/world/core/base.hpp"
#include "simulation/world/core/crowd.hpp"
#include "simulation/world/core/pioneer.hpp"
#include "simulation/world/core/scene.hpp"
#include "simulation/world/core/segway.hpp"
#include "simulation/world/core/sensors.hpp"
#include "simulation/world/core/world_file.hpp"

namespace usher::world {

/// The robot as the world sees it; the defaults are MARVIN.
struct RobotConfig {
  enum class Kind { kSegway, kPioneer };
  Kind kind = Kind::kSegway;
  SegwayConfig segway;         ///< used by Kind::kSegway
  PioneerConfig pioneer;       ///< used by Kind::kPioneer
  double axle_height = 0.235;  ///< [m] of base_link above base_footprint
  double height = 1.8;         ///< [m] things above do not touch it
  /// In base_footprint, convex and counter-clockwise. MARVIN: the tilt limiters are the corners.
  std::vector<Point2> footprint = {{-0.33, -0.35}, {0.33, -0.35}, {0.33, 0.35}, {-0.33, 0.35}};
  std::vector<LaserConfig> lasers = {LaserConfig{}};
  SonarConfig sonar;
  WhiskerConfig whiskers;
};

/// What a judge wants to know. A *contact* is touching something while moving faster than 0.05 m/s
/// that had been visible for longer than the stopping time; all other touches are counted apart.
/// What is fixed is visible from the time it stands there; a person is while nothing opaque is
/// between laser and person, within `sight`.
struct GroundTruth {
  double clearance =
      std::numeric_limits<double>::infinity();  ///< [m] to the nearest thing or person within 2 m
  std::string nearest;                          ///< which; empty: none
  std::uint32_t contacts = 0;
  std::uint32_t touches = 0;
  std::string contact_with;  ///< the last thing touched
};

/// A robot that another world moves, as this one sees it.
struct OtherRobot {
  std::string name;
  Pose2 pose;
  std::vector<Point2> outline;  ///< in base_footprint, convex and counter-clockwise, 3 and more
  double height = 1.8;          ///< [m]
};

struct WorldConfig {
  RobotConfig robot;
  std::string name;          ///< of the robot, where there are several
  bool moves_people = true;  ///< else another world does
  CrowdConfig crowd;
  double stopping_time = 2.0;  ///< [s]
  double sight = 10.0;         ///< [m] farther people count as unseen
  double sight_angle = 2.0;    ///< [rad] to either side of ahead
};

/// A building (or a map of one), a robot and people, in steps of kStep. Everything random comes
/// from the seed: the same seed and the same calls give the same bytes. Knows no clock: whoever
/// owns it calls step() and reads its sensors at their rates. About 6 us a step and 20 us a scan
/// (usher bench world).
class World {
 public:
  World(const WorldConfig& config, Building building, std::span<const PersonPlan> people,
        const Pose2& robot, std::uint64_t seed);
  /// A world made from an occupancy map; all that is occupied is wall.
  World(const WorldConfig& config, grid::OccupancyGrid map, std::span<const PersonPlan> people,
        const Pose2& robot, std::uint64_t seed);

  void step();
  double time() const { return time_; }  ///< [s] since start

  Base& base() { return *base_; }
  const Base& base() const { return *base_; }
  /// Puts the robot elsewhere; an error when it would touch something there.
  Status place_robot(const Pose2& pose);

  /// One turn of a laser, numbered as in the configuration.
  void scan(std::size_t laser, std::vector<float>& ranges);
  void sonar(std::vector<float>& ranges);
  WhiskerContacts whiskers();

  std::span<const Person> people() const { return crowd_.people(); }
  /// `leader`: which robot is followed.
  Status send_person(const std::string& name, const Point2& goal, double speed, bool follow,
                     const std::string& leader = {});
  std::span<const Mover> bodies() const {
    return crowd_.movers();
  }  ///< of people(), in their order
  /// People whom another world moves, as they are now.
  void show_people(std::vector<Person> people, std::vector<Mover> bodies);

  /// The other robots as they are now, the same ones in the same order or more of them. They are in
  /// the way and people mind them as they mind this one.
  void show_robots(std::vector<OtherRobot> robots);
  /// What sensors meet of them: a few discs each, that together fill the outline.
  std::span<const Mover> robot_bodies() const { return robot_bodies_; }

  /// Doors have the names of the building; an unknown one is an error.
  Status set_door(const std::string& name, bool open);
  /// A thing that the building does not have; an error when the name is in use.
  Status add_thing(Thing thing);
  Status remove_thing(const std::string& name);

  const GroundTruth& truth() const { return truth_; }
  const rendering::Lighting& lighting() const { return lighting_; }
  const Scene& scene() const { return *scene_; }
  /// Grows when doors or things change.
  std::uint64_t scene_version() const { return scene_version_; }
  /// The map that the world was made from; null for a building.
  const grid::OccupancyGrid* map() const { return map_ ? &*map_ : nullptr; }
  geometry::Pose3 base_in_world() const;  ///< base_link, leaning
  const WorldConfig& config() const { return config_; }

 private:
  World(const WorldConfig& config, std::optional<Building> building,
        std::optional<grid::OccupancyGrid> map, std::span<const PersonPlan> people,
        const Pose2& robot, std::uint64_t seed);

  void rebuild();
  std::vector<Point2>& footprint_at(const Pose2& pose);
  std::vector<Mover> everybody() const;
  void watch_people();
  void judge_robots(const Pose2& before, double fastest);
  bool thing_long_visible(const std::string& name) const;
  void judge(const Pose2& before, const Twist2& speed);
  void count_touch(const std::string& what, bool seen, double speed);

  WorldConfig config_;
  std::optional<Building> building_;
  std::optional<grid::OccupancyGrid> map_;
  rendering::Lighting lighting_;
  std::vector<Thing> extra_;
  std::unique_ptr<Base> base_;
  std::unique_ptr<Scene> scene_;
  std::uint64_t scene_version_ = 0;
  Crowd crowd_;
  std::vector<Laser> lasers_;
  Sonar sonar_;
  Whiskers whiskers_;

  std::int64_t steps_ = 0;
  double time_ = 0.0;
  GroundTruth truth_;
  std::vector<Point2> footprint_;                          // in world
  std::vector<std::pair<std::string, double>> newcomers_;  // things and when they came
  std::vector<double> seen_since_;                         // of each person; infinity: unseen
  std::vector<std::string> touched_things_;                // while the contact lasts
  std::vector<bool> touched_people_;
  std::vector<OtherRobot> robots_;
  std::vector<std::vector<Point2>> robot_outlines_;  // in world
  std::vector<Mover> robot_bodies_;
  std::vector<double> robots_seen_since_;  // of each; infinity: unseen
  std::vector<bool> touched_robots_;
  Fan gaze_{0.0, 0.1, 1};
  RayCaster caster_;
  FanHits hits_;
};

}  // namespace usher::world
