#pragma once

#include <cstdint>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/roadmap/core/free_space.hpp"

namespace usher::roadmap {

/// Where vertices are put.
enum class Sampling : std::uint8_t {
  kRandom,      ///< anywhere in the free space
  kGrid,        ///< on the crossings of a grid
  kCell,        ///< so many in each square of the map: narrow places get theirs
  kMedialAxis,  ///< as kCell, but in the middle between obstacles [geraerts2006sampling]
};

struct SamplingParameters {
  Sampling sampling = Sampling::kCell;
  double cell_size = 1.0;   ///< [m] of kCell and kMedialAxis
  int points_per_cell = 5;  ///< the same; fewer where a square has fewer free cells
  double grid_step = 1.0;   ///< [m] of kGrid
  int random_points = 400;  ///< of kRandom
};

/// Free points for a roadmap, in the order in which they were drawn. `points` is replaced; it stays
/// empty where nothing is free. `map` is what the space was built from; kMedialAxis measures in it.
void sample_vertices(const FreeSpace& space, const grid::OccupancyGrid& map,
                     const SamplingParameters& parameters, Random& random,
                     std::vector<Point2>& points);

}  // namespace usher::roadmap
