#include "operations/experiments/site_facts.hpp"

#include <yaml-cpp/yaml.h>

#include "foundation/grid/map_file.hpp"

namespace usher::operations {

namespace {

/// As it was resolved: it has all fields of its contract.
Result<runtime::ParameterValue> fact(const Deployment& deployment, const std::string& name) {
  for (const auto& file : deployment.files) {
    for (const auto& value : file.values) {
      if (value.name == name) return value;
    }
  }
  return Error{"no component of " + deployment.manifest.path + " is given " + name};
}

}  // namespace

Result<grid::OccupancyGrid> site_map(const Deployment& deployment) {
  const auto path = fact(deployment, "site.map");
  if (!path) return Error{path.error()};
  return grid::load_map(path->yaml);
}

Result<std::vector<SitePlace>> site_places(const Deployment& deployment) {
  const auto locations = fact(deployment, "site.locations");
  if (!locations) return Error{locations.error()};
  std::vector<SitePlace> places;
  for (const auto& location : YAML::Load(locations->yaml)) {
    places.push_back(
        {location["name"].as<std::string>(),
         {location["x"].as<double>(), location["y"].as<double>(), location["yaw"].as<double>()}});
  }
  if (places.empty()) return Error{"the site has no locations"};
  return places;
}

Result<std::vector<std::string>> site_locations(const Deployment& deployment) {
  const auto places = site_places(deployment);
  if (!places) return Error{places.error()};
  std::vector<std::string> names;
  names.reserve(places->size());
  for (const auto& place : *places) names.push_back(place.name);
  return names;
}

Result<std::vector<SiteRoom>> site_meeting_rooms(const Deployment& deployment) {
  const auto records = fact(deployment, "site.meeting_rooms");
  if (!records) return Error{records.error()};
  std::vector<SiteRoom> rooms;
  for (const auto& room : YAML::Load(records->yaml)) {
    rooms.push_back({room["name"].as<std::string>(),
                     {room["west"].as<double>(), room["south"].as<double>()},
                     {room["east"].as<double>(), room["north"].as<double>()}});
  }
  if (rooms.empty()) return Error{"the site has no meeting rooms"};
  return rooms;
}

Result<std::vector<geometry::Point2>> robot_footprint(const Deployment& deployment) {
  const auto footprint = fact(deployment, "robot.footprint");
  if (!footprint) return Error{footprint.error()};
  const auto numbers = YAML::Load(footprint->yaml).as<std::vector<double>>();
  std::vector<geometry::Point2> corners;
  corners.reserve(numbers.size() / 2);
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
    corners.emplace_back(numbers[i], numbers[i + 1]);
  return corners;
}

Result<std::string> site_world(const Deployment& deployment) {
  const auto path = fact(deployment, "site.world");
  if (!path) return Error{path.error()};
  return YAML::Load(path->yaml).as<std::string>();
}

void set_site_value(Deployment& deployment, const std::string& name, const std::string& yaml) {
  for (auto& file : deployment.files) {
    for (auto& value : file.values) {
      if (value.name == name) value.yaml = yaml;
    }
  }
}

void set_value(Deployment& deployment, const std::string& component, const std::string& name,
               const std::string& yaml) {
  for (auto& file : deployment.files) {
    if (file.component != component) continue;
    std::erase_if(file.values, [&](const auto& value) { return value.name == name; });
    file.values.push_back({name, yaml, "experiment"});
  }
}

}  // namespace usher::operations
