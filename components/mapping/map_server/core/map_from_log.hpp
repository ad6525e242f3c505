#pragma once

#include <cstddef>
#include <span>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "mapping/map_server/core/carmen_log.hpp"
#include "mapping/map_server/core/map_from_scans.hpp"

namespace usher::map_server {

/// A map of the scans 0, every, 2 every, ... of a log, each taken from its reference pose of the
/// laser. Fails when there is not exactly one reference pose a scan, `every` is 0, or a scan is
/// refused; the error names its line.
Result<grid::OccupancyGrid> map_from_log(std::span<const CarmenScan> scans,
                                         std::span<const geometry::Pose2> reference,
                                         std::size_t every = 1, MappingParameters parameters = {});

}  // namespace usher::map_server
