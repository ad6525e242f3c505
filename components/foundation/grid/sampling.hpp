#pragma once

#include <cstdint>
#include <vector>

#include "foundation/grid/free_space.hpp"
#include "foundation/random/random.hpp"

namespace usher::grid {

/// Where points are put.
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

/// Free points, in the order in which they were drawn. `points` is replaced; it stays
/// empty where nothing is free. `map` is what the space was built from; kMedialAxis measures in it.
void sample_points(const FreeSpace& space, const OccupancyGrid& map,
                   const SamplingParameters& parameters, Random& random,
                   std::vector<Point2>& points);

}  // namespace usher::grid
