#include "navigation/costmap/core/costmap.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace usher::costmap {

namespace {

Raster make_raster(const CostmapConfig& config) {
  Raster raster;
  raster.resolution = config.window.resolution;
  raster.cells_per_meter = 1.0 / config.window.resolution;
  raster.width = config.window.width;
  raster.height = config.window.height;
  if (config.rolling) {
    raster.first_x = -raster.width / 2;
    raster.first_y = -raster.height / 2;
  } else {
    raster.anchor_x = config.window.origin_x;
    raster.anchor_y = config.window.origin_y;
  }
  return raster;
}

grid::GridGeometry window_geometry(const Raster& raster) {
  return {raster.width, raster.height, raster.resolution,
          raster.anchor_x + raster.first_x * raster.resolution,
          raster.anchor_y + raster.first_y * raster.resolution};
}

Status check(const CostmapConfig& config, const geometry::Footprint& footprint) {
  constexpr int kMaxSide = 1 << 20;
  constexpr std::size_t kMaxCells = std::size_t{1} << 28;
  const grid::GridGeometry& window = config.window;
  if (!(window.resolution >= kFinestResolution && window.resolution <= 10.0)) {
    return Error{"costmap resolution must be in [0.001, 10] m, got " +
                 std::to_string(window.resolution) + " m"};
  }
  if (window.width <= 0 || window.height <= 0 || window.width > kMaxSide ||
      window.height > kMaxSide || window.size() > kMaxCells) {
    return Error{"costmap must have 1 to 2^28 cells, got " + std::to_string(window.width) + " x " +
                 std::to_string(window.height)};
  }
  if (!config.rolling && !reachable(window.origin_x, window.origin_y)) {
    return Error{"costmap origin must be within 1e5 m, got (" + std::to_string(window.origin_x) +
                 ", " + std::to_string(window.origin_y) + ") m"};
  }
  const double widest = Inflation::kMaxReach * window.resolution;
  if (!(config.inflation_radius >= footprint.inscribed_radius() &&
        config.inflation_radius <= widest)) {
    return Error{"inflation_radius must be in [" + std::to_string(footprint.inscribed_radius()) +
                 ", " + std::to_string(widest) + "] m (inscribed radius to 120 cells), got " +
                 std::to_string(config.inflation_radius) + " m"};
  }
  if (!(config.cost_scaling >= 0.0) || !std::isfinite(config.cost_scaling)) {
    return Error{"cost_scaling must be finite and not negative, got " +
                 std::to_string(config.cost_scaling) + " 1/m"};
  }
  if (config.occupied_from < 1 || config.occupied_from > 100) {
    return Error{"occupied_from must be in [1, 100] %, got " +
                 std::to_string(config.occupied_from) + " %"};
  }
  return check(config.social);
}

bool has_obstacle(const grid::Grid<std::uint8_t>& states, const CellRect& cells) {
  for (int y = cells.y0; y < cells.y1; ++y) {
    const std::uint8_t* const row = states.row(y);
    if (std::find(row + cells.x0, row + cells.x1, kSeenOccupied) != row + cells.x1) return true;
  }
  return false;
}

constexpr int kLeastCells = 2;  // of a thing: a single one may be left of what has gone

void raise_to(const std::uint8_t* __restrict states, int count, std::uint8_t* __restrict combined) {
  for (int x = 0; x < count; ++x) combined[x] = combined[x] < states[x] ? states[x] : combined[x];
}

void fill_unseen(const std::uint8_t* __restrict states, int count,
                 std::uint8_t* __restrict combined) {
  static_assert(kUnseen == 0);  // then a mask does it without a branch
  for (int x = 0; x < count; ++x) {
    const auto unseen = static_cast<std::uint8_t>(combined[x] == kUnseen ? 0xff : 0);
    combined[x] = static_cast<std::uint8_t>(combined[x] | (states[x] & unseen));
  }
}

}  // namespace

Result<Costmap> Costmap::make(CostmapConfig config) {
  Result<geometry::Footprint> footprint = geometry::Footprint::make(config.footprint);
  if (!footprint.ok()) return Error{footprint.error()};
  if (Status status = check(config, *footprint); !status.ok()) return Error{status.error()};
  return Costmap(std::move(config), std::move(footprint).value());
}

Costmap::Costmap(CostmapConfig config, geometry::Footprint footprint)
    : config_(std::move(config)),
      footprint_(std::move(footprint)),
      raster_(make_raster(config_)),
      static_layer_(config_.simd),
      static_states_(window_geometry(raster_), kUnseen),
      inflation_(raster_.width, raster_.height, raster_.resolution,
                 {footprint_.inscribed_radius(), config_.inflation_radius, config_.cost_scaling},
                 config_.unseen, config_.simd),
      social_(config_.social),
      master_(window_geometry(raster_), kUnknownCost) {
  invalidate();
}

Result<Costmap::LayerId> Costmap::add_obstacle_layer(ObstacleLayerConfig config) {
  if (Status status = ObstacleLayer::check(config, raster_.resolution); !status.ok())
    return Error{status.error()};
  layers_.emplace_back(std::move(config), raster_);
  return layers_.size() - 1;
}

Status Costmap::set_static_map(const grid::OccupancyGrid& map) {
  if (Status status = static_layer_.set_map(map, config_.occupied_from, raster_.resolution);
      !status.ok()) {
    return status;
  }
  static_stale_ = true;
  return {};
}

Status Costmap::set_static_transform(const geometry::Pose2& map_T_window) {
  if (!map_T_window.finite() || !reachable(map_T_window.x, map_T_window.y)) {
    return Error{"the static map's transform must be finite and within 1e5 m, got (" +
                 std::to_string(map_T_window.x) + ", " + std::to_string(map_T_window.y) + ", " +
                 std::to_string(map_T_window.yaw) + ")"};
  }
  if (map_T_window == map_T_window_) return {};
  map_T_window_ = map_T_window;
  static_stale_ = true;
  return {};
}

Status Costmap::move_to(const geometry::Pose2& base) {
  if (!base.finite() || !reachable(base.x, base.y)) {
    return Error{"the robot's pose must be finite and within 1e5 m, got (" +
                 std::to_string(base.x) + ", " + std::to_string(base.y) + ", " +
                 std::to_string(base.yaw) + ")"};
  }
  base_ = base;
  if (!config_.rolling) return {};
  const grid::Cell cell = raster_.cell_at(base.x, base.y);
  const int dx = cell.x - raster_.width / 2;
  const int dy = cell.y - raster_.height / 2;
  if (dx == 0 && dy == 0) return {};
  for (ObstacleLayer& layer : layers_) layer.shift(dx, dy);
  raster_.first_x += dx;
  raster_.first_y += dy;
  const grid::GridGeometry geometry = window_geometry(raster_);
  static_states_.set_origin(geometry.origin_x, geometry.origin_y);
  shift_cells(static_states_.values(), raster_.width, raster_.height, dx, dy, kUnseen);
  if (!static_stale_) sample_entered(dx, dy);
  dirty_ = raster_.all();
  return {};
}

/// Samples the static map in the strips that came into the window.
void Costmap::sample_entered(int dx, int dy) {
  const int width = raster_.width;
  const int height = raster_.height;
  const CellRect columns =
      dx > 0 ? CellRect{width - dx, 0, width, height} : CellRect{0, 0, -dx, height};
  const CellRect rows =
      dy > 0 ? CellRect{0, height - dy, width, height} : CellRect{0, 0, width, -dy};
  static_layer_.sample(map_T_window_, raster_, columns, static_states_);
  static_layer_.sample(map_T_window_, raster_, rows, static_states_);
}

Status Costmap::observe(LayerId layer, const RangeObservation& observation) {
  assert(layer < layers_.size());
  const Result<CellRect> touched = layers_[layer].observe(observation, raster_);
  if (!touched.ok()) return Error{touched.error()};
  touch(*touched);
  return {};
}

Status Costmap::replace(LayerId layer, std::span<const geometry::Point2> points, double stamp) {
  assert(layer < layers_.size());
  const Result<CellRect> touched = layers_[layer].replace(points, stamp, raster_);
  if (!touched.ok()) return Error{touched.error()};
  touch(*touched);
  return {};
}

void Costmap::set_people(std::span<const geometry::Point2> people) {
  touch(social_.set(people, raster_));
}

void Costmap::forget() {
  for (ObstacleLayer& layer : layers_) {
    const double range = layer.config().kept_range;
    if (std::isinf(range)) continue;
    CellRect kept;
    if (base_ && range > 0.0) {
      const grid::Cell low = raster_.cell_at(base_->x - range, base_->y - range);
      const grid::Cell high = raster_.cell_at(base_->x + range, base_->y + range);
      kept = {low.x, low.y, high.x + 1, high.y + 1};
    }
    touch(layer.forget(kept));
  }
}

bool Costmap::unmapped_beside(LayerId layer, const geometry::Point2& point, double reach) const {
  assert(layer < layers_.size());
  if (!reachable(point.x(), point.y())) return false;
  return unmapped_beside(layers_[layer], raster_.cell_at(point.x(), point.y()), reach);
}

/// Cells within so many meters, in x and y.
CellRect Costmap::around(grid::Cell cell, double reach) const {
  const auto cells = static_cast<int>(std::lround(reach * raster_.cells_per_meter));
  return CellRect{cell.x, cell.y, cell.x + 1, cell.y + 1}.grown(cells).within(raster_.all());
}

bool Costmap::beside(LayerId layer, const geometry::Point2& point, double reach) const {
  assert(layer < layers_.size());
  if (!reachable(point.x(), point.y())) return false;
  const ObstacleLayer& one = layers_[layer];
  const CellRect near = around(raster_.cell_at(point.x(), point.y()), reach).within(one.seen());
  return has_obstacle(one.states(), near);
}

bool Costmap::seen_free(LayerId layer, const geometry::Point2& point) const {
  assert(layer < layers_.size());
  if (!reachable(point.x(), point.y())) return false;
  const ObstacleLayer& one = layers_[layer];
  const grid::Cell cell = raster_.cell_at(point.x(), point.y());
  const CellRect at = CellRect{cell.x, cell.y, cell.x + 1, cell.y + 1}.within(one.seen());
  return !at.empty() && one.states().row(cell.y)[cell.x] == kSeenFree;
}

bool Costmap::unmapped_beside(const ObstacleLayer& layer, grid::Cell cell, double reach) const {
  const CellRect near = around(cell, reach).within(layer.seen());
  int found = 0;
  for (int y = near.y0; y < near.y1; ++y) {
    for (int x = near.x0; x < near.x1; ++x) {
      const bool unmapped = layer.states().row(y)[x] == kSeenOccupied &&
                            !has_obstacle(static_states_, around({x, y}, kMapped));
      if (unmapped && ++found == kLeastCells) return true;
    }
  }
  return false;
}

void Costmap::keep_beside(LayerId layer, LayerId other, double reach) {
  assert(layer < layers_.size() && other < layers_.size());
  touch(layers_[layer].keep(
      [&](grid::Cell cell) { return unmapped_beside(layers_[other], cell, reach); }));
}

void Costmap::forget_passed(LayerId layer, const RangeObservation& observation,
                            std::span<const geometry::Point2> places, double reach) {
  assert(layer < layers_.size());
  touch(layers_[layer].forget_passed(observation, places, reach, raster_));
}

void Costmap::forget_since(LayerId layer, double since, std::span<const geometry::Point2> places,
                           double reach) {
  assert(layer < layers_.size());
  touch(layers_[layer].forget_since(since, places, reach, raster_));
}

void Costmap::invalidate() {
  static_stale_ = true;
  dirty_ = raster_.all();
}

const grid::Grid<std::uint8_t>& Costmap::update(double now) {
  for (ObstacleLayer& layer : layers_) touch(layer.expire(now));
  clear_footprint();
  if (std::exchange(static_stale_, false)) {
    static_layer_.sample(map_T_window_, raster_, raster_.all(), static_states_);
    touch(raster_.all());
  }
  for (int y = dirty_.y0; y < dirty_.y1; ++y) combine_row(y, dirty_.x0, dirty_.x1);
  changed_ = inflation_.update(dirty_, master_);
  const grid::GridGeometry geometry = window_geometry(raster_);
  master_.set_origin(geometry.origin_x, geometry.origin_y);
  social_.paint(raster_, master_);
  dirty_ = {};
  return master_;
}

void Costmap::clear_footprint() {
  if (!base_) return;
  const PolygonRaster footprint(footprint_.corners(), *base_, window_geometry(raster_));
  footprint.for_each_inner_span([&](const CellSpan& span) {
    for (ObstacleLayer& layer : layers_) {
      if (!layer.config().footprint_clearing) continue;
      layer.set_free(span.y, span.x0, span.x1);
      touch({span.x0, span.y, span.x1, span.y + 1});
    }
  });
}

void Costmap::combine_row(int y, int x0, int x1) {
  std::uint8_t* combined = inflation_.state_row(y);
  std::memset(combined + x0, kUnseen, static_cast<std::size_t>(x1 - x0));
  const auto raise_by = [&](bool overrules) {
    for (const ObstacleLayer& layer : layers_) {
      if (layer.config().overrules_static_map != overrules) continue;
      const CellRect cells = layer.seen().within({x0, y, x1, y + 1});
      if (cells.empty()) continue;
      raise_to(layer.states().row(y) + cells.x0, cells.x1 - cells.x0, combined + cells.x0);
    }
  };
  raise_by(true);
  if (static_layer_.has_map()) fill_unseen(static_states_.row(y) + x0, x1 - x0, combined + x0);
  raise_by(false);
}

std::optional<std::uint8_t> Costmap::cost_at(const geometry::Point2& point) const {
  if (!reachable(point.x(), point.y())) return std::nullopt;
  const grid::Cell cell = master_.geometry().cell_at(point);
  if (!master_.geometry().contains(cell)) return std::nullopt;
  return master_.at(cell);
}

}  // namespace usher::costmap
