#include "operations/experiments/site_facts.hpp"

#include <cstdlib>

#include "foundation/grid/map_file.hpp"
#include "operations/manifest/tree.hpp"

namespace usher::operations {

namespace {

Result<runtime::ParameterValue> fact(const Deployment& deployment, const std::string& name) {
  for (const auto& file : deployment.files) {
    for (const auto& value : file.values) {
      if (value.name == name) return value;
    }
  }
  return Error{"no component of " + deployment.manifest.path + " is given " + name};
}

Result<Tree> list(const Deployment& deployment, const std::string& name) {
  const auto value = fact(deployment, name);
  if (!value) return Error{value.error()};
  return parse_tree(value->yaml, value->origin);
}

}  // namespace

Result<grid::OccupancyGrid> site_map(const Deployment& deployment) {
  const auto path = fact(deployment, "site.map");
  if (!path) return Error{path.error()};
  return grid::load_map(path->yaml);
}

Result<std::vector<std::string>> site_locations(const Deployment& deployment) {
  const auto locations = list(deployment, "site.locations");
  if (!locations) return Error{locations.error()};
  std::vector<std::string> names;
  for (const Tree& location : locations->items) {
    if (const Tree* name = location.find("name")) names.push_back(name->scalar);
  }
  if (names.empty()) return Error{"the site has no locations"};
  return names;
}

Result<std::vector<SiteRoom>> site_meeting_rooms(const Deployment& deployment) {
  const auto records = list(deployment, "site.meeting_rooms");
  if (!records) return Error{records.error()};
  std::vector<SiteRoom> rooms;
  for (const Tree& record : records->items) {
    const auto wall = [&](const char* side) {  // judged by the component that asks for it
      const Tree* at = record.find(side);
      return at == nullptr ? 0.0 : std::strtod(at->scalar.c_str(), nullptr);
    };
    const Tree* name = record.find("name");
    rooms.push_back({name == nullptr ? "" : name->scalar,
                     {wall("west"), wall("south")},
                     {wall("east"), wall("north")}});
  }
  if (rooms.empty()) return Error{"the site has no meeting rooms"};
  return rooms;
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
