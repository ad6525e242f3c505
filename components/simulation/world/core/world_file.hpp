#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "simulation/rendering/core/body.hpp"
#include "simulation/world/core/scene.hpp"

namespace usher::world {

/// A named place of the building; says nothing about what stands there.
struct Room {
  std::string name;
  std::string title;
  Point2 lower = Point2::Zero();  ///< [m] corners of a rectangle around it
  Point2 upper = Point2::Zero();  ///< [m]
};

/// A wall by its middle line.
struct WallLine {
  std::string name;
  Material material = Material::kSolid;
  double thickness = 0.1;  ///< [m]
  std::vector<Point2> points;
};

/// A gap in every wall whose middle line runs through `at`; with a leaf it is a door.
struct Gap {
  std::string name;
  Point2 at = Point2::Zero();
  double width = 0.8;  ///< [m] clear
  bool door = false;   ///< has a leaf and a lintel at kDoorHeight
  bool open = true;    ///< an open leaf is out of the way
};

inline constexpr double kDoorHeight = 2.1;  ///< [m] lower side of the lintel

/// A building as its world.yaml describes it.
struct Building {
  std::string name;
  double ceiling = 2.7;  ///< [m]
  std::vector<Room> rooms;
  std::vector<WallLine> walls;
  std::vector<Gap> gaps;
  std::vector<Thing> furniture;
  std::vector<Thing> obstacles;  ///< like furniture, but set up after the map was made
};

/// Reads a world.yaml (its format: README.md). Strict: an unknown or missing key, a value out of
/// range, a name that is used twice or a gap that lies on no wall is an error with file and line.
Result<Building> load_building(const std::string& path);
Result<Building> parse_building(const std::string& text, const std::string& file);

/// The things of a building with its doors as they are: walls cut at gaps, lintels, closed leaves,
/// furniture, obstacles.
std::vector<Thing> construct(const Building& building);

/// Somebody who walks, as people.yaml describes it.
struct PersonPlan {
  std::string name;
  Point2 start = Point2::Zero();  ///< where the person stands first
  double yaw = 0.0;               ///< [rad]
  double speed = 1.2;             ///< [m/s] preferred
  double pause = 0.0;             ///< [s] at each end of a leg
  std::vector<Point2> loop;       ///< walked round and round; empty: stands until told where to go
  double height = 0.0;            ///< [m] {1.2..2.1} 0: drawn from the world's seed
  /// While it does not walk; a sitting person needs a seat of its own.
  rendering::Posture posture = rendering::Posture::kStanding;
  bool watches = false;  ///< turns to a robot that is near, while it does not walk
};

Result<std::vector<PersonPlan>> load_people(const std::string& path);
Result<std::vector<PersonPlan>> parse_people(const std::string& text, const std::string& file);

}  // namespace usher::world
