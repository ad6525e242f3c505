#include "mapping/map_server/shell/component.hpp"

#include "foundation/grid/map_file.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::map_server {

MapServerComponent::MapServerComponent(runtime::Host& host) : map_(host.output(topics::kMap)) {
  const std::string file =
      host.parameters().file("site.map", "", "YAML of the site's map, in map_server form.");
  if (file.empty()) {
    host.health().set(runtime::HealthState::kDegraded, "no map is set (site.map)");
    return;
  }
  const auto map = grid::load_map(file);
  if (!map) host.fault(map.error());
  map_.publish(wire::to_message(host.now(), frames::kMap, *map));
  host.health().set(runtime::HealthState::kOk);
}

}  // namespace usher::map_server
