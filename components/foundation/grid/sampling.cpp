#include "foundation/grid/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace usher::grid {

namespace {

constexpr double kAxisRadius = 5.0;  // [m] the middle of wider places is not looked for
constexpr double kRidge = -0.3;      // [cells] second difference of the distance

Point2 anywhere_in(const GridGeometry& g, Cell cell, Random& random) {
  const double x = cell.x + random.uniform();
  const double y = cell.y + random.uniform();
  return {g.origin_x + x * g.resolution, g.origin_y + y * g.resolution};
}

void sample_random(const FreeSpace& space, int count, Random& random, std::vector<Point2>& points) {
  const auto& g = space.geometry();
  std::vector<std::uint32_t> cells;
  cells.reserve(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (space.free_at(i)) cells.push_back(static_cast<std::uint32_t>(i));
  }
  if (cells.empty()) return;
  for (int i = 0; i < count; ++i)
    points.push_back(anywhere_in(g, g.cell(cells[random.below(cells.size())]), random));
}

void sample_grid(const FreeSpace& space, double step, std::vector<Point2>& points) {
  const auto& g = space.geometry();
  const auto columns = static_cast<int>(g.width * g.resolution / step) + 1;
  const auto rows = static_cast<int>(g.height * g.resolution / step) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Point2 point(g.origin_x + (column + 0.5) * step, g.origin_y + (row + 0.5) * step);
      if (space.free(point)) points.push_back(point);
    }
  }
}

/// Calls `draw(cells)` with the free cells of each square in turn, in their order.
template <class Draw>
void for_each_square(const FreeSpace& space, double size, Draw&& draw) {
  const auto& g = space.geometry();
  const int side = std::max(1, static_cast<int>(std::lround(size / g.resolution)));
  std::vector<Cell> cells;
  cells.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int top = 0; top < g.height; top += side) {
    for (int left = 0; left < g.width; left += side) {
      cells.clear();
      for (int y = top; y < std::min(g.height, top + side); ++y) {
        const std::size_t row = g.index({0, y});
        for (int x = left; x < std::min(g.width, left + side); ++x) {
          if (space.free_at(row + static_cast<std::size_t>(x))) cells.push_back({x, y});
        }
      }
      if (!cells.empty()) draw(cells);
    }
  }
}

/// Draws without putting back, so that a square of three free cells gets three points.
void sample_square(const FreeSpace& space, std::vector<Cell>& cells, int count, Random& random,
                   std::vector<Point2>& points) {
  for (std::size_t i = 0; i < std::min(cells.size(), static_cast<std::size_t>(count)); ++i) {
    std::swap(cells[i], cells[i + random.below(cells.size() - i)]);
    points.push_back(anywhere_in(space.geometry(), cells[i], random));
  }
}

/// Whether the distance to the nearest obstacle has a ridge here: to both sides another obstacle is
/// nearer. Beside the axis it is as straight as the obstacle, or bent upward by a corner.
bool on_axis(const DistanceField& distances, Cell c) {
  const auto& squared = distances.squared_cells();
  if (c.x == 0 || c.y == 0 || c.x + 1 == squared.width() || c.y + 1 == squared.height())
    return false;
  const auto distance = [&](int dx, int dy) {
    return std::sqrt(static_cast<double>(squared.at({c.x + dx, c.y + dy})));
  };
  const double bend =
      distance(1, 0) + distance(-1, 0) + distance(0, 1) + distance(0, -1) - 4.0 * distance(0, 0);
  return bend < kRidge;
}

void sample_medial_axis(const FreeSpace& space, const OccupancyGrid& map,
                        const SamplingParameters& p, Random& random, std::vector<Point2>& points) {
  DistanceField distances;
  distances.build(map, std::min(kAxisRadius, DistanceField::kMaxRadius * map.resolution()));
  std::vector<Cell> axis;
  for_each_square(space, p.cell_size, [&](std::vector<Cell>& cells) {
    axis.clear();
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(axis),
                 [&](Cell c) { return on_axis(distances, c); });
    if (axis.empty()) {
      sample_square(space, cells, 1, random, points);  // in the open there is no middle
    } else {
      sample_square(space, axis, p.points_per_cell, random, points);
    }
  });
}

}  // namespace

void sample_points(const FreeSpace& space, const OccupancyGrid& map,
                   const SamplingParameters& parameters, Random& random,
                   std::vector<Point2>& points) {
  points.clear();
  switch (parameters.sampling) {
    case Sampling::kRandom:
      sample_random(space, parameters.random_points, random, points);
      break;
    case Sampling::kGrid:
      sample_grid(space, parameters.grid_step, points);
      break;
    case Sampling::kCell:
      for_each_square(space, parameters.cell_size, [&](std::vector<Cell>& cells) {
        sample_square(space, cells, parameters.points_per_cell, random, points);
      });
      break;
    case Sampling::kMedialAxis:
      sample_medial_axis(space, map, parameters, random, points);
      break;
  }
}

}  // namespace usher::grid
