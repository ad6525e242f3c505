#include "navigation/costmap/core/social_layer.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/result/bounds.hpp"

namespace usher::costmap {

using geometry::Point2;

Status check(const SocialConfig& c) {
  return within({{"social radius", c.radius, 0.0, 3.0, "m"},
                 {"social cost", static_cast<double>(c.cost), 0.0, 252.0}});
}

std::uint8_t SocialLayer::at(double distance) const {
  if (distance >= config_.radius) return 0;
  return static_cast<std::uint8_t>(config_.cost * (1.0 - distance / config_.radius));
}

CellRect SocialLayer::cells_around(const Point2& person, const Raster& raster) const {
  const grid::Cell low = raster.cell_at(person.x() - config_.radius, person.y() - config_.radius);
  const grid::Cell high = raster.cell_at(person.x() + config_.radius, person.y() + config_.radius);
  return CellRect{low.x, low.y, high.x + 1, high.y + 1}.within(raster.all());
}

CellRect SocialLayer::cells_of_all(const Raster& raster) const {
  CellRect cells;
  for (const Point2& person : people_) {
    const CellRect around = cells_around(person, raster);
    if (!around.empty()) cells = cells.united(around);
  }
  return cells;
}

CellRect SocialLayer::set(std::span<const Point2> people, const Raster& raster) {
  CellRect cells = cells_of_all(raster);
  people_.clear();
  for (const Point2& person : people) {
    if (people_.size() == kMost || config_.radius <= 0.0) break;
    if (reachable(person.x(), person.y())) people_.push_back(person);
  }
  return cells.united(cells_of_all(raster));
}

void SocialLayer::paint(const Raster& raster, grid::Grid<std::uint8_t>& master) const {
  for (const Point2& person : people_) {
    const CellRect cells = cells_around(person, raster);
    for (int y = cells.y0; y < cells.y1; ++y) {
      for (int x = cells.x0; x < cells.x1; ++x) {
        std::uint8_t& cost = master.at({x, y});
        const Point2 center(raster.anchor_x + (raster.first_x + x + 0.5) * raster.resolution,
                            raster.anchor_y + (raster.first_y + y + 0.5) * raster.resolution);
        cost = std::max(cost, at((center - person).norm()));
      }
    }
  }
}

}  // namespace usher::costmap
