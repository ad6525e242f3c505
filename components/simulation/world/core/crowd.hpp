#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"
#include "simulation/world/core/scene.hpp"
#include "simulation/world/core/world_file.hpp"

namespace usher::world {

/// What people see of a robot.
struct RobotView {
  Pose2 pose;
  std::span<const Point2> footprint;  ///< corners in world, counter-clockwise; empty: no robot
  std::string name{};                 ///< where there are several
  double stands = 0.0;                ///< [s] since it moved; the crowd fills it in
};

/// Somebody in the world.
struct Person {
  std::string name;
  bool scripted = false;             ///< goes where it is told, not round a loop
  Point2 position = Point2::Zero();  ///< [m]
  Point2 velocity = Point2::Zero();  ///< [m/s]
  double yaw = 0.0;                  ///< [rad] where the person looks
  double radius = 0.25;              ///< [m] of the room that the body takes now
  double height = 1.75;              ///< [m] when standing upright
  rendering::Posture posture = rendering::Posture::kStanding;
  double stride = 0.0;  ///< [rad] phase of walking
  rendering::Clothes clothes{};
};

/// Constants of the people; accelerations are those of a person of unit mass.
struct CrowdConfig {
  double radius = 0.25;           ///< [m] half the breadth of the shoulders
  double sideways = 0.17;         ///< [m] half the depth of the body [fruin1971]
  double top = 1.7;               ///< [m]
  double relaxation = 0.5;        ///< [s] to reach the wanted velocity
  double speed_spread = 0.12;     ///< relative, between people
  double max_acceleration = 3.0;  ///< [m/s^2]
  double person_push = 2.5;       ///< [m/s^2] of another person in touch
  double person_reach = 0.3;      ///< [m] in which that fades by e
  double wall_push = 2.5;         ///< [m/s^2]
  double wall_reach = 0.1;        ///< [m]
  double robot_push = 4.0;        ///< [m/s^2]
  double robot_reach = 0.35;      ///< [m]
  double robot_stop = 0.45;       ///< [m] gap to a robot ahead at which a person stops
  double robot_see = 2.5;         ///< [m] gap to a robot ahead at which a person begins to pass
  double patience = 4.0;          ///< [s] without getting on until a walker turns round
  double follow_distance = 1.1;   ///< [m] from the robot's middle, along its way
  double watch_within = 6.0;      ///< [m] who watches turns to a robot nearer than this
};

/// People who walk between points and mind each other, walls and the robot: the social force model
/// [helbing1995social] with habits on top. Who meets the robot keeps to the right; who is blocked
/// stops, waits and in the end turns round, or walks away from a robot that bars both ways; past
/// one that stands still people squeeze, sideways. Nobody walks into a wall or, by own will, into
/// the robot. Of several robots everybody minds the nearest, follows the one that invited him, and
/// watches that one while it is near, else the nearest.
/// Deterministic for the seed.
class Crowd {
 public:
  /// Walkers start somewhere on their loop, at least 2 m from `robot` when they find such a place.
  Crowd(const CrowdConfig& config, std::span<const PersonPlan> plans, const Point2& robot,
        std::uint64_t seed);

  const CrowdConfig& config() const { return config_; }
  std::span<const Person> people() const { return people_; }
  /// The same people as bodies, in the same order.
  std::span<const Mover> movers() const { return movers_; }

  /// Sends a scripted person straight to a point, or (follow) behind the robot `leader` wherever
  /// that goes. Speed in [0, 2.5] m/s; 0 stands. Unknown names, walkers and values out of range are
  /// errors; a robot that is not there is the first one.
  Status send(const std::string& name, const Point2& goal, double speed, bool follow,
              const std::string& leader = {});

  /// Advances by kStep. The same robots each time, in the same order, at least one.
  void step(const Scene& scene, std::span<const RobotView> robots);
  void step(const Scene& scene, const RobotView& robot) { step(scene, {&robot, 1}); }

  /// People whom another world moves, as they are now, one mover each; step() is not called then.
  void show(std::vector<Person> people, std::vector<Mover> movers);

 private:
  struct Mind {
    rendering::Posture at_rest = rendering::Posture::kStanding;
    bool watches = false;
    double speed = 0.0;  // wanted
    Point2 goal = Point2::Zero();
    bool has_goal = false;
    bool follow = false;
    std::string leader;
    double look_left = 0.0;  // s, to the next look for the way to follow
    std::vector<Point2> loop;
    std::size_t next = 0;
    bool reversed = false;
    double pause = 0.0;
    double pause_left = 0.0;
    double stuck = 0.0;         // s
    double retreat_left = 0.0;  // s, of walking away from a robot that cannot be passed
    Point2 stuck_at = Point2::Zero();
  };

  /// Where a robot was.
  struct Track {
    std::deque<Point2> trail;  // newest last
    Point2 stood_at = Point2::Zero();
    double stands = 0.0;  // s
  };

  void remember_robots(std::span<const RobotView> robots);
  std::size_t nearest_robot(const Point2& to) const;
  std::size_t watched_robot(const Person& person, const Mind& mind) const;
  std::size_t robot_for(const Person& person, const Mind& mind) const;
  Point2 point_to_follow(const Point2& here, const Scene& scene,
                         const std::deque<Point2>& trail) const;
  void choose_goal(Person& person, Mind& mind, const Scene& scene);
  void turn_round(Mind& mind) const;
  void lose_patience(Person& person, Mind& mind, const RobotView& robot);
  void watch(Person& person, const Mind& mind, bool walks, const RobotView& robot) const;
  void turn_sideways(Person& person, bool walks, const RobotView& robot) const;
  void hold(Person& person, const Mind& mind, Mover& mover) const;
  Point2 wanted_velocity(const Person& person, const Mind& mind, const RobotView& robot) const;
  Point2 push_of_people(std::size_t index) const;
  Point2 push_of_robot(const Person& person, bool walks, const RobotView& robot) const;
  void move(std::size_t index, const Point2& acceleration, bool by_a_wall, const Scene& scene,
            const RobotView& robot);

  CrowdConfig config_;
  Random random_;
  std::vector<Person> people_;
  std::vector<Mind> minds_;
  std::vector<Mover> movers_;
  std::vector<RobotView> robots_;  // of the step that runs
  std::vector<Track> tracks_;      // likewise
};

}  // namespace usher::world
