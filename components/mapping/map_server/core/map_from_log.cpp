#include "mapping/map_server/core/map_from_log.hpp"

#include <algorithm>
#include <string>

namespace usher::map_server {

Result<grid::OccupancyGrid> map_from_log(std::span<const CarmenScan> scans,
                                         std::span<const geometry::Pose2> reference,
                                         std::size_t every, MappingParameters parameters) {
  if (every == 0) return Error{"every must be at least 1, got 0"};
  if (scans.size() != reference.size())
    return Error{"expected a reference pose for each of the " + std::to_string(scans.size()) +
                 " scans, found " + std::to_string(reference.size())};
  parameters.max_range = std::min(parameters.max_range, kCarmenMaxRange);
  MapFromScans mapper(parameters);
  for (std::size_t i = 0; i < scans.size(); i += every) {
    const CarmenScan& scan = scans[i];
    const Status added =
        mapper.add({reference[i], scan.angle_min(), scan.angle_increment(), scan.ranges});
    if (!added) return Error{"line " + std::to_string(scan.line) + ": " + added.error()};
  }
  auto map = mapper.map();
  if (map.empty()) return Error{"no beam of the log saw anything"};
  return map;
}

}  // namespace usher::map_server
