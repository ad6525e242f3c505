#pragma once

#include "foundation/grid/grid.hpp"
#include "simulation/world/core/scene.hpp"

namespace usher::world {

/// How a map is drawn from a scene.
struct MapDrawing {
  double resolution = 0.05;  ///< [m]
  double margin = 0.5;       ///< [m] around all things
  double height = 0.3;       ///< [m] what reaches through this height is drawn
  Point2 start =
      Point2::Zero();  ///< a free point; what cannot be seen or reached from it stays unknown
};

/// The map that a careful mapping run would make: cells that a thing covers at the height are
/// occupied, cells connected to the start are free, all others unknown. Glass is drawn too: a
/// scanner does not see it, but a mapping robot with ultrasonic sensors does, and a planner must
/// know it.
grid::OccupancyGrid draw_map(const Scene& scene, const MapDrawing& drawing);

}  // namespace usher::world
