#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"

namespace usher::operations {

/// A map of a real building in map_server form.
struct BuildingMap {
  std::string name;          ///< folder, and file where the folder has several: "nav2/depot"
  std::string file;          ///< YAML
  double resolution = 0.0;   ///< [m] the true one where the file's is known to be wrong; else 0
  std::string named_places;  ///< topological map (YAML list of nodes); empty = none
};

/// Every map below a folder, in order of names. Masks and maps too small for the robot are left
/// out.
Result<std::vector<BuildingMap>> find_building_maps(const std::string& folder);

/// Those below `data`/maps that were asked for: a name, its folder, its file's stem; empty: all.
Result<std::vector<BuildingMap>> choose_buildings(const std::string& data, const std::string& only);

/// Reads the map, with the true resolution.
Result<grid::OccupancyGrid> load_building_map(const BuildingMap& building);

struct Place {
  std::string name;  ///< snake_case as a location's name, or as the building's people wrote it
  geometry::Pose2 pose;
};

/// A start and `goals` goals, chosen by the seed, all in the largest part of the known free space
/// that hangs together for the robot. Named places when there are such, those with names of their
/// own before numbered way points, where the robot can turn on the spot; otherwise cells 0.85 m
/// from obstacles. Fewer when there are not so many places; the error says that there is no room at
/// all.
Result<std::vector<Place>> choose_places(const BuildingMap& building,
                                         const grid::OccupancyGrid& map, std::size_t goals,
                                         std::uint64_t seed);

}  // namespace usher::operations
