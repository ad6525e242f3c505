#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "navigation/costmap/core/costmap.hpp"

namespace usher::costmap {

/// The costmap's definition written down as plainly as possible: cells by their absolute number in
/// a map, lines by integer division, inflation by looking at every obstacle. Slow on purpose.
class ReferenceCostmap {
 public:
  explicit ReferenceCostmap(CostmapConfig config)
      : config_(std::move(config)),
        footprint_(geometry::Footprint::make(config_.footprint).value()) {
    if (config_.rolling) {
      first_x_ = -config_.window.width / 2;
      first_y_ = -config_.window.height / 2;
    } else {
      anchor_x_ = config_.window.origin_x;
      anchor_y_ = config_.window.origin_y;
    }
  }

  void add_obstacle_layer(const ObstacleLayerConfig& layer) { layers_.push_back({layer, {}}); }
  void set_static_map(const grid::OccupancyGrid& map) { map_ = map; }
  void set_static_transform(const geometry::Pose2& map_T_window) { map_T_window_ = map_T_window; }

  void move_to(const geometry::Pose2& base) {
    base_ = base;
    if (!config_.rolling) return;
    first_x_ = number(base.x, anchor_x_) - config_.window.width / 2;
    first_y_ = number(base.y, anchor_y_) - config_.window.height / 2;
    for (Layer& layer : layers_) {
      std::erase_if(layer.cells, [&](const auto& entry) { return !in_window(entry.first); });
    }
  }

  void observe(std::size_t id, const RangeObservation& scan) {
    Layer& layer = layers_[id];
    const double scale = 1.0 / config_.window.resolution;
    const double c = std::cos(scan.sensor.yaw);
    const double s = std::sin(scan.sensor.yaw);
    const double x = (scan.sensor.x - anchor_x_) * scale;
    const double y = (scan.sensor.y - anchor_y_) * scale;
    const Key origin{static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))};
    const auto along = [&](std::size_t beam, double distance) -> Key {
      const double dx = c * scan.directions[beam].x() - s * scan.directions[beam].y();
      const double dy = s * scan.directions[beam].x() + c * scan.directions[beam].y();
      return {static_cast<int>(std::floor(x + distance * scale * dx)),
              static_cast<int>(std::floor(y + distance * scale * dy))};
    };
    const auto measures = [&](float range) { return range > 0.0F; };
    std::vector<std::pair<Key, Seen>> before;
    std::ranges::copy_if(layer.cells, std::back_inserter(before),
                         [](const auto& entry) { return entry.second.state == kSeenOccupied; });
    if (!layer.config.clears_only_what_all_beams_pass) before.clear();
    for (std::size_t i = 0; in_window(origin) && i < scan.ranges.size(); ++i) {
      if (!measures(scan.ranges[i])) continue;
      const bool through = scan.ranges[i] > layer.config.max_raytrace_range;
      const Key end = along(i, through ? layer.config.max_raytrace_range : scan.ranges[i]);
      clear(layer, origin, end, through);
    }
    for (const auto& [key, seen] : before) {
      const bool crossed = layer.cells.at(key).state == kSeenFree;
      if (crossed && !passed(scan, center_of(key), measures)) layer.cells[key] = seen;
    }
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const float range = scan.ranges[i];
      if (!measures(range)) continue;
      if (range > layer.config.max_obstacle_range) continue;
      const Key hit = along(i, range);
      if (in_window(hit)) layer.cells[hit] = {kSeenOccupied, scan.stamp};
    }
  }

  void replace(std::size_t id, const std::vector<geometry::Point2>& points, double stamp) {
    layers_[id].cells.clear();
    for (const geometry::Point2& point : points) {
      const Key key{number(point.x(), anchor_x_), number(point.y(), anchor_y_)};
      if (in_window(key)) layers_[id].cells[key] = {kSeenOccupied, stamp};
    }
  }

  void set_people(const std::vector<geometry::Point2>& people) { people_ = people; }

  grid::Grid<std::uint8_t> update(double now) {
    for (Layer& layer : layers_) {
      if (layer.config.persistence <= 0.0) continue;
      std::erase_if(layer.cells, [&](const auto& entry) {
        return entry.second.state == kSeenOccupied &&
               now - entry.second.stamp >= layer.config.persistence - 1e-9;
      });
    }
    const double resolution = config_.window.resolution;
    const int width = config_.window.width;
    const int height = config_.window.height;
    grid::Grid<std::uint8_t> master({width, height, resolution, anchor_x_ + first_x_ * resolution,
                                     anchor_y_ + first_y_ * resolution});
    if (base_) {
      PolygonRaster(footprint_.corners(), *base_, master.geometry())
          .for_each_span([&](const CellSpan& span) {
            for (int x = span.x0; x < span.x1; ++x) {
              if (!under_robot(master.geometry(), {x, span.y})) continue;
              for (Layer& layer : layers_) {
                if (layer.config.footprint_clearing)
                  layer.cells[{first_x_ + x, first_y_ + span.y}] = {kSeenFree, now};
              }
            }
          });
    }
    grid::Grid<std::uint8_t> states(master.geometry());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) states.at({x, y}) = combined({first_x_ + x, first_y_ + y});
    }
    const CostDecay decay{footprint_.inscribed_radius(), config_.inflation_radius,
                          config_.cost_scaling};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        master.at({x, y}) = std::max(cost(states, {x, y}, decay), social_cost({x, y}));
      }
    }
    return master;
  }

  static std::uint8_t cost(const grid::Grid<std::uint8_t>& states, grid::Cell cell,
                           const CostDecay& decay, Inflation::Unseen unseen) {
    const int reach = static_cast<int>(std::ceil(decay.inflation_radius / states.resolution()));
    int nearest = 1 << 30;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (states.value_or({cell.x + dx, cell.y + dy}, kUnseen) != kSeenOccupied) continue;
        nearest = std::min(nearest, dx * dx + dy * dy);
      }
    }
    const std::uint8_t cost =
        decay.at(states.resolution() * std::sqrt(static_cast<double>(nearest)));
    if (states.at(cell) != kUnseen || unseen == Inflation::Unseen::kFree) return cost;
    return cost >= (unseen == Inflation::Unseen::kUnknown ? kInscribedCost : 1) ? cost
                                                                                : kUnknownCost;
  }

 private:
  std::uint8_t social_cost(grid::Cell cell) const {
    const double resolution = config_.window.resolution;
    const geometry::Point2 center{anchor_x_ + (first_x_ + cell.x + 0.5) * resolution,
                                  anchor_y_ + (first_y_ + cell.y + 0.5) * resolution};
    const SocialConfig& social = config_.social;
    double highest = 0.0;
    for (const geometry::Point2& person : people_) {
      const double share = (center - person).norm() / social.radius;
      if (share < 1.0) highest = std::max(highest, social.cost * (1.0 - share));
    }
    return static_cast<std::uint8_t>(highest);
  }

  using Key = std::pair<int, int>;  // cell number in the endless raster
  struct Seen {
    std::uint8_t state;
    double stamp;
  };
  struct Layer {
    ObstacleLayerConfig config;
    std::map<Key, Seen> cells;
  };

  int number(double coordinate, double anchor) const {
    return static_cast<int>(std::floor((coordinate - anchor) * (1.0 / config_.window.resolution)));
  }
  bool in_window(Key key) const {
    return key.first >= first_x_ && key.second >= first_y_ &&
           key.first < first_x_ + config_.window.width &&
           key.second < first_y_ + config_.window.height;
  }

  geometry::Point2 center_of(Key key) const {
    const double resolution = config_.window.resolution;
    return {anchor_x_ + (key.first + 0.5) * resolution,
            anchor_y_ + (key.second + 0.5) * resolution};
  }

  // Whether the beam nearest to the place, those beside it, and all within 1 cm of the place end
  // behind it or so near before it that they hit something else there.
  template <class Measures>
  bool passed(const RangeObservation& scan, const geometry::Point2& place,
              Measures measures) const {
    const geometry::Point2 point = geometry::inverse(scan.sensor) * place;
    const auto count = static_cast<int>(scan.directions.size());
    const auto direction = [&](int i) { return scan.directions[static_cast<std::size_t>(i)]; };
    const auto near = [&](int beam) {
      const geometry::Point2 d = direction(beam);
      return std::abs(d.x() * point.y() - d.y() * point.x()) <= 0.01;
    };
    int nearest = 0;
    for (int beam = 1; beam < count; ++beam) {
      if (direction(beam).dot(point) > direction(nearest).dot(point)) nearest = beam;
    }
    int first = std::max(nearest - 1, 0), last = std::min(nearest + 1, count - 1);
    while (first > 0 && near(first - 1)) --first;
    while (last < count - 1 && near(last + 1)) ++last;
    for (int beam = first; beam <= last; ++beam) {
      const float range = scan.ranges[static_cast<std::size_t>(beam)];
      if (!measures(range) || range < point.norm() - 0.1) return false;
    }
    return true;
  }

  bool under_robot(const grid::GridGeometry& grid, grid::Cell cell) const {
    for (const int dx : {0, 1}) {
      for (const int dy : {0, 1}) {
        const geometry::Point2 corner(grid.origin_x + (cell.x + dx) * grid.resolution,
                                      grid.origin_y + (cell.y + dy) * grid.resolution);
        if (footprint_.distance(geometry::inverse(*base_) * corner) > 0.0) return false;
      }
    }
    return true;
  }

  void clear(Layer& layer, Key from, Key to, bool through) {
    const std::int64_t dx = to.first - from.first;
    const std::int64_t dy = to.second - from.second;
    const bool steep = std::abs(dy) > std::abs(dx);
    const std::int64_t major = steep ? std::abs(dy) : std::abs(dx);
    const std::int64_t minor = steep ? std::abs(dx) : std::abs(dy);
    for (std::int64_t i = 0; i <= major; ++i) {
      if (i == major && !through) break;
      const double share = major > 0 ? static_cast<double>(i) / static_cast<double>(major) : 0.0;
      const double length = std::hypot(dx, dy) * share * config_.window.resolution;
      if (length < layer.config.min_raytrace_range - 1e-9 ||
          (major == 0 && layer.config.min_raytrace_range > 0))
        continue;
      const std::int64_t side = major > 0 ? (2 * i * minor + major - 1) / (2 * major) : 0;
      const std::int64_t along_x = steep ? side : i;
      const std::int64_t along_y = steep ? i : side;
      const Key cell{from.first + static_cast<int>(dx < 0 ? -along_x : along_x),
                     from.second + static_cast<int>(dy < 0 ? -along_y : along_y)};
      if (!in_window(cell)) break;
      layer.cells[cell] = {kSeenFree, 0.0};
    }
  }

  std::uint8_t combined(Key key) const {
    std::uint8_t overruling = kUnseen;
    std::uint8_t others = kUnseen;
    for (const Layer& layer : layers_) {
      const auto found = layer.cells.find(key);
      if (found == layer.cells.end()) continue;
      std::uint8_t& highest = layer.config.overrules_static_map ? overruling : others;
      highest = std::max(highest, found->second.state);
    }
    if (overruling == kUnseen) overruling = mapped(key);
    return std::max(overruling, others);
  }

  std::uint8_t mapped(Key key) const {
    if (map_.empty()) return kUnseen;
    const double resolution = config_.window.resolution;
    const geometry::Point2 center{anchor_x_ + (key.first + 0.5) * resolution,
                                  anchor_y_ + (key.second + 0.5) * resolution};
    const grid::Cell at = map_.geometry().cell_at(map_T_window_ * center);
    const int around =
        static_cast<int>(std::ceil(0.5 * (resolution / map_.resolution() - 1.0) - 1e-6));
    if (!map_.geometry().contains(at)) return kUnseen;
    std::uint8_t state = kUnseen;
    for (int dy = -around; dy <= around; ++dy) {
      for (int dx = -around; dx <= around; ++dx) {
        const std::int8_t occupancy = map_.value_or({at.x + dx, at.y + dy}, grid::kUnknown);
        const std::uint8_t here = occupancy < 0                        ? kUnseen
                                  : occupancy >= config_.occupied_from ? kSeenOccupied
                                                                       : kSeenFree;
        state = std::max(state, here);
      }
    }
    return state;
  }

  std::uint8_t cost(const grid::Grid<std::uint8_t>& states, grid::Cell cell,
                    const CostDecay& decay) const {
    return cost(states, cell, decay, config_.unseen);
  }

  CostmapConfig config_;
  geometry::Footprint footprint_;
  double anchor_x_ = 0.0;
  double anchor_y_ = 0.0;
  int first_x_ = 0;
  int first_y_ = 0;
  std::vector<Layer> layers_;
  grid::OccupancyGrid map_;
  geometry::Pose2 map_T_window_;
  std::optional<geometry::Pose2> base_;
  std::vector<geometry::Point2> people_;
};

}  // namespace usher::costmap
