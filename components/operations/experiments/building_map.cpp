#include "operations/experiments/building_map.hpp"
#include "operations/experiments/only.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/map_file.hpp"
#include "foundation/random/random.hpp"

namespace usher::operations {

namespace fs = std::filesystem;

namespace {

constexpr double kGoalClearance = 0.85;  // [m] of a goal from obstacles: the whiskers can turn
constexpr double kTurnClearance = 0.45;  // [m] of the robot's corners from its middle
constexpr double kDoorClearance = 0.4;   // [m] half of the narrowest door that the robot passes
constexpr std::int8_t kOccupiedFrom = 65;
constexpr std::int8_t kFreeTo = 25;
constexpr const char* kNumberedPlace = "WayPoint";

/// What the files do not say; from the notes of those who collected them.
struct Remark {
  const char* file;
  double resolution;
  const char* named_places;
};
constexpr std::array kRemarks = {
    Remark{"intel_lab_bwi/intel.yaml", 0.05, ""},  // says 0.1, but the lab is 29 m wide
    Remark{"strands_aaf_hospital/aaf_deployment16-cropped.yaml", 0.0, "aaf_deployment16.tpl"},
    Remark{"strands_aaf_hospital/y4_aaf-cropped.yaml", 0.0, "aaf_y4.tpl"}};
constexpr std::array kNoBuildings = {"keepout", "speed", "nogo", "mask", "sandbox"};

bool is_building(const std::string& stem) {
  return std::none_of(kNoBuildings.begin(), kNoBuildings.end(),
                      [&](const char* word) { return stem.find(word) != std::string::npos; });
}

/// The largest set of cells with the clearance of a door that hang together by their sides.
std::vector<grid::Cell> roomy_cells(const grid::OccupancyGrid& map,
                                    const grid::DistanceField& field) {
  const auto& geometry = map.geometry();
  std::vector<std::uint8_t> open(geometry.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = map[i] >= grid::kFree && map[i] <= kFreeTo &&
              field.distance(geometry.cell(i)) >= kDoorClearance;
  }
  std::vector<grid::Cell> largest, part;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i]) continue;
    part.assign(1, geometry.cell(i));
    open[i] = 0;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const grid::Cell c = part[k];
      for (const grid::Cell next : {grid::Cell{c.x + 1, c.y}, grid::Cell{c.x - 1, c.y},
                                    grid::Cell{c.x, c.y + 1}, grid::Cell{c.x, c.y - 1}}) {
        if (!geometry.contains(next) || !open[geometry.index(next)]) continue;
        open[geometry.index(next)] = 0;
        part.push_back(next);
      }
    }
    if (part.size() > largest.size()) largest.swap(part);
  }
  return largest;
}

Result<std::vector<Place>> read_named_places(const std::string& path) {
  std::vector<Place> places;
  try {
    for (const auto& entry : YAML::LoadFile(path)) {
      const auto& node = entry["node"];
      const auto& position = node["pose"]["position"];
      const auto& q = node["pose"]["orientation"];
      const double z = q["z"].as<double>(), w = q["w"].as<double>();
      places.push_back(
          {node["name"].as<std::string>(),
           {position["x"].as<double>(), position["y"].as<double>(), 2.0 * std::atan2(z, w)}});
    }
  } catch (const YAML::Exception& e) {
    return Error{path + ": expected a list of nodes with name and pose: " + e.what()};
  }
  return places;
}

template <class T>
void shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

}  // namespace

Result<std::vector<BuildingMap>> find_building_maps(const std::string& folder) {
  std::map<std::string, std::vector<fs::path>> files;  // by folder
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".yaml" && is_building(path.stem().string()))
      files[path.parent_path().lexically_relative(folder).string()].push_back(path);
  }
  if (error) return Error{"cannot read " + folder + ": " + error.message()};
  std::vector<BuildingMap> buildings;
  for (auto& [name, paths] : files) {
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) {
      auto& building = buildings.emplace_back();
      building.name = paths.size() > 1 ? name + "/" + path.stem().string() : name;
      building.file = path.string();
      const std::string relative = path.lexically_relative(folder).string();
      for (const Remark& remark : kRemarks) {
        if (relative != remark.file) continue;
        building.resolution = remark.resolution;
        if (*remark.named_places != '\0')
          building.named_places = (path.parent_path() / remark.named_places).string();
      }
    }
  }
  if (buildings.empty()) return Error{"no map in " + folder};
  return buildings;
}

Result<std::vector<BuildingMap>> choose_buildings(const std::string& data,
                                                  const std::string& only) {
  if (data.empty()) return Error{"USHER_TEST_DATA names no folder with maps"};
  auto buildings = find_building_maps(data + "/maps");
  if (!buildings || only.empty()) return buildings;
  const auto names = names_of(*buildings);
  std::erase_if(*buildings, [&](const BuildingMap& building) {
    return building.name != only && !building.name.starts_with(only + "/") &&
           !building.name.ends_with("/" + only);
  });
  if (buildings->empty()) return wrong_only(only, names);
  return buildings;
}

Result<grid::OccupancyGrid> load_building_map(const BuildingMap& building) {
  auto map = grid::load_map(building.file);
  if (!map || building.resolution == 0.0) return map;
  grid::GridGeometry geometry = map->geometry();
  geometry.resolution = building.resolution;
  grid::OccupancyGrid corrected(geometry);
  corrected.values() = map->values();
  return corrected;
}

Result<std::vector<Place>> choose_places(const BuildingMap& building,
                                         const grid::OccupancyGrid& map, std::size_t goals,
                                         std::uint64_t seed) {
  grid::DistanceField field;
  field.build(map, kGoalClearance + 2 * map.resolution(), kOccupiedFrom);
  const auto cells = roomy_cells(map, field);
  const auto& geometry = map.geometry();
  Random random(stream_seed(seed, building.name.c_str()));

  std::vector<Place> places;
  if (!building.named_places.empty()) {
    auto named = read_named_places(building.named_places);
    if (!named) return Error{named.error()};
    std::vector<std::uint8_t> roomy(geometry.size());
    for (const auto& cell : cells) roomy[geometry.index(cell)] = 1;
    std::erase_if(*named, [&](const Place& place) {
      const grid::Cell cell = geometry.cell_at(place.pose.position());
      return !geometry.contains(cell) || !roomy[geometry.index(cell)] ||
             field.distance(cell) < kTurnClearance;
    });
    shuffle(*named, random);
    std::stable_partition(named->begin(), named->end(), [](const Place& place) {
      return !place.name.starts_with(kNumberedPlace);
    });
    places = std::move(named).value();
    if (places.size() > goals + 1) places.resize(goals + 1);
  } else {
    std::vector<grid::Cell> candidates;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(candidates),
                 [&](const grid::Cell& cell) { return field.distance(cell) >= kGoalClearance; });
    while (!candidates.empty() && places.size() < goals + 1) {
      const auto point = geometry.center(candidates[random.below(candidates.size())]);
      places.push_back(
          {places.empty() ? std::string("start") : "goal_" + std::to_string(places.size()),
           {point.x(), point.y(), random.uniform(-geometry::kPi, geometry::kPi)}});
    }
  }
  if (places.size() < 2)
    return Error{building.file + ": no two places that hang together and keep " +
                 std::to_string(kGoalClearance) + " m from obstacles"};
  return places;
}

}  // namespace usher::operations
