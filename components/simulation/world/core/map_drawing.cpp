#include "simulation/world/core/map_drawing.hpp"

#include <cassert>
#include <cmath>
#include <vector>

#include "simulation/world/core/shapes.hpp"

namespace usher::world {
namespace {

using grid::Cell;
using grid::OccupancyGrid;

bool covers(const Thing& thing, const Point2& p, double half) {
  const double reach = half * std::sqrt(2.0);
  if (thing.outline.empty()) return (p - thing.center).norm() <= thing.radius + half;
  const shapes::Polygon outline(thing.outline);
  if (outline.distance_to(p) > reach) return false;
  const Point2 cell[] = {p + Point2(-half, -half), p + Point2(half, -half), p + Point2(half, half),
                         p + Point2(-half, half)};
  return shapes::Polygon(cell).gap_to_polygon(thing.outline).distance == 0.0;
}

void draw(const Thing& thing, OccupancyGrid& map) {
  Point2 lower = thing.center - Point2(thing.radius, thing.radius);
  Point2 upper = thing.center + Point2(thing.radius, thing.radius);
  if (!thing.outline.empty()) {
    lower = upper = thing.outline[0];
    for (const Point2& p : thing.outline) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  }
  const grid::GridGeometry& g = map.geometry();
  const Cell from = g.cell_at(lower - Point2(g.resolution, g.resolution));
  const Cell to = g.cell_at(upper + Point2(g.resolution, g.resolution));
  // A cell that a thing only touches with its border stays free: a door keeps its width.
  const double half = 0.5 * g.resolution - 1e-6;
  for (int y = from.y; y <= to.y; ++y) {
    for (int x = from.x; x <= to.x; ++x) {
      if (g.contains({x, y}) && covers(thing, g.center({x, y}), half)) {
        map.at({x, y}) = grid::kOccupied;
      }
    }
  }
}

void flood(OccupancyGrid& map, const Cell& start) {
  std::vector<Cell> open{start};
  while (!open.empty()) {
    const Cell c = open.back();
    open.pop_back();
    if (map.value_or(c, grid::kOccupied) != grid::kUnknown) continue;
    map.at(c) = grid::kFree;
    for (const Cell& next :
         {Cell{c.x + 1, c.y}, Cell{c.x - 1, c.y}, Cell{c.x, c.y + 1}, Cell{c.x, c.y - 1}}) {
      if (map.value_or(next, grid::kOccupied) == grid::kUnknown) open.push_back(next);
    }
  }
}

}  // namespace

OccupancyGrid draw_map(const Scene& scene, const MapDrawing& drawing) {
  assert(drawing.resolution > 0.0);
  const Point2 margin(drawing.margin, drawing.margin);
  // The origin lies on a whole number of cells, so that walls on round numbers fall on cell
  // borders.
  const Point2 lower =
      ((scene.lower() - margin) / drawing.resolution).array().floor() * drawing.resolution;
  const Point2 size = scene.upper() + margin - lower;
  OccupancyGrid map({.width = static_cast<int>(std::ceil(size.x() / drawing.resolution)),
                     .height = static_cast<int>(std::ceil(size.y() / drawing.resolution)),
                     .resolution = drawing.resolution,
                     .origin_x = lower.x(),
                     .origin_y = lower.y()},
                    grid::kUnknown);
  for (const Thing& thing : scene.things()) {
    if (thing.bottom <= drawing.height && thing.top >= drawing.height) draw(thing, map);
  }
  const Cell start = map.geometry().cell_at(drawing.start);
  if (map.geometry().contains(start)) flood(map, start);
  return map;
}

}  // namespace usher::world
