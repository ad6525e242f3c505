#include "simulation/world/core/scene.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "simulation/world/core/shapes.hpp"

namespace usher::world {
namespace {

constexpr double kCell = 2.0;    // [m] small enough to hide much, large enough to be few
constexpr int kReachCells = 32;  // rays end after 64 m
constexpr std::int8_t kWallFrom = 65;

bool is_wall(const Thing& thing, double ceiling) {
  return !thing.outline.empty() && thing.bottom <= 0.0 && thing.top >= ceiling;
}

// The borders of the occupied cells as long segments, occupied on the left.
template <class Add>
void trace_borders(const grid::OccupancyGrid& map, Add&& add) {
  const grid::GridGeometry& g = map.geometry();
  const auto occupied = [&](int x, int y) { return map.value_or({x, y}, 0) >= kWallFrom; };
  const auto corner = [&](int x, int y) {
    return Point2(g.origin_x + x * g.resolution, g.origin_y + y * g.resolution);
  };
  // Along rows (a segment towards +x has the occupied cell on its left when that is above), then
  // along columns.
  for (int y = 0; y <= g.height; ++y) {
    for (const bool above : {true, false}) {
      int start = -1;
      for (int x = 0; x <= g.width; ++x) {
        const bool border =
            x < g.width && occupied(x, above ? y : y - 1) && !occupied(x, above ? y - 1 : y);
        if (border && start < 0) start = x;
        if (!border && start >= 0) {
          above ? add(corner(start, y), corner(x, y)) : add(corner(x, y), corner(start, y));
          start = -1;
        }
      }
    }
  }
  for (int x = 0; x <= g.width; ++x) {
    for (const bool left : {true, false}) {
      int start = -1;
      for (int y = 0; y <= g.height; ++y) {
        const bool border =
            y < g.height && occupied(left ? x - 1 : x, y) && !occupied(left ? x : x - 1, y);
        if (border && start < 0) start = y;
        if (!border && start >= 0) {
          left ? add(corner(x, start), corner(x, y)) : add(corner(x, y), corner(x, start));
          start = -1;
        }
      }
    }
  }
}

}  // namespace

Thing box(std::string name, const Pose2& center, double length, double width, double bottom,
          double top) {
  Thing thing;
  thing.name = std::move(name);
  thing.bottom = bottom;
  thing.top = top;
  const double l = 0.5 * length;
  const double w = 0.5 * width;
  for (const Point2& corner : {Point2(-l, -w), Point2(l, -w), Point2(l, w), Point2(-l, w)}) {
    thing.outline.push_back(center * corner);
  }
  return thing;
}

Thing wall(std::string name, const Point2& from, const Point2& to, double thickness, double top) {
  const Point2 along = to - from;
  const Point2 middle = 0.5 * (from + to);
  return box(std::move(name), {middle.x(), middle.y(), std::atan2(along.y(), along.x())},
             along.norm() + thickness, thickness, 0.0, top);
}

Thing disc(std::string name, const Point2& center, double radius, double bottom, double top) {
  Thing thing;
  thing.name = std::move(name);
  thing.bottom = bottom;
  thing.top = top;
  thing.center = center;
  thing.radius = radius;
  return thing;
}

Scene::Scene(std::vector<Thing> things, double ceiling, const grid::OccupancyGrid* map)
    : things_(std::move(things)), ceiling_(ceiling) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const Thing& thing = things_[i];
    const auto id = static_cast<std::int32_t>(i);
    assert(thing.outline.size() <= Thing::kMaxCorners);
    if (thing.outline.empty()) {
      prisms_.push_back({thing.center, thing.radius, id});
    } else if (is_wall(thing, ceiling_)) {
      for (std::size_t k = 0; k < thing.outline.size(); ++k) {
        segments.push_back({thing.outline[k], thing.outline[(k + 1) % thing.outline.size()], id});
      }
    } else {
      Point2 center = Point2::Zero();
      for (const Point2& p : thing.outline) center += p / static_cast<double>(thing.outline.size());
      double radius = 0.0;
      for (const Point2& p : thing.outline) radius = std::max(radius, (p - center).norm());
      prisms_.push_back({center, radius, id});
    }
  }
  if (map != nullptr) {
    const auto id = static_cast<std::int32_t>(things_.size());
    Thing& thing = things_.emplace_back();
    thing.name = "map";
    thing.top = ceiling;
    trace_borders(*map, [&](const Point2& a, const Point2& b) { segments.push_back({a, b, id}); });
  }
  index(segments);
}

void Scene::index(std::span<const Segment> segments) {
  bool any = false;
  const auto include = [&](const Point2& p, double margin) {
    const Point2 m(margin, margin);
    lower_ = any ? lower_.cwiseMin(p - m).eval() : (p - m).eval();
    upper_ = any ? upper_.cwiseMax(p + m).eval() : (p + m).eval();
    any = true;
  };
  for (const Segment& s : segments) include(s.a, 0.0), include(s.b, 0.0);
  for (const Thing& thing : things_) {
    for (const Point2& corner : thing.outline) include(corner, 0.0);
    if (thing.radius > 0.0) include(thing.center, thing.radius);
  }

  cells_ = {.width = static_cast<int>((upper_.x() - lower_.x()) / kCell) + 1,
            .height = static_cast<int>((upper_.y() - lower_.y()) / kCell) + 1,
            .resolution = kCell,
            .origin_x = lower_.x(),
            .origin_y = lower_.y()};
  const auto clamped_cell = [&](const Point2& p) {
    const grid::Cell cell = cells_.cell_at(p);
    return cells_.index(
        {std::clamp(cell.x, 0, cells_.width - 1), std::clamp(cell.y, 0, cells_.height - 1)});
  };

  // Cut every segment where it crosses a border of the cells; neighbouring pieces share their ends
  // bit by bit, so no ray slips between them.
  std::vector<std::pair<std::size_t, Piece>> cut;
  std::vector<double> cuts;
  for (const Segment& s : segments) {
    cuts = {0.0, 1.0};
    for (int axis = 0; axis < 2; ++axis) {
      const double from = (s.a[axis] - lower_[axis]) / kCell;
      const double to = (s.b[axis] - lower_[axis]) / kCell;
      for (double k = std::floor(std::min(from, to)) + 1.0; k < std::max(from, to); k += 1.0) {
        cuts.push_back((k - from) / (to - from));
      }
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const Point2 a = s.a + cuts[k] * (s.b - s.a);
      const Point2 b = s.a + cuts[k + 1] * (s.b - s.a);
      const bool glass = things_[static_cast<std::size_t>(s.thing)].material == Material::kGlass;
      cut.push_back({clamped_cell(0.5 * (a + b)),
                     {static_cast<float>(a.x()), static_cast<float>(a.y()),
                      static_cast<float>(b.x()), static_cast<float>(b.y()), s.thing, glass}});
    }
  }
  std::stable_sort(cut.begin(), cut.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  first_.assign(cells_.size() + 1, 0);
  pieces_.reserve(cut.size());
  for (const auto& [cell, piece] : cut) {
    ++first_[cell + 1];
    pieces_.push_back(piece);
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];

  for (int y = -kReachCells; y <= kReachCells; ++y) {
    for (int x = -kReachCells; x <= kReachCells; ++x) {
      const double dx = std::max(std::abs(x) - 1, 0) * kCell;
      const double dy = std::max(std::abs(y) - 1, 0) * kCell;
      offsets_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                          static_cast<float>(std::hypot(dx, dy))});
    }
  }
  std::stable_sort(offsets_.begin(), offsets_.end(),
                   [](const Offset& a, const Offset& b) { return a.reach < b.reach; });
}

Scene::Nearest Scene::nearest(std::span<const Point2> polygon, double height, double limit) const {
  Nearest best{.distance = limit};
  const shapes::Polygon shape(polygon);
  const auto offer = [&](const shapes::Gap& gap, int thing) {
    if (gap.distance < best.distance) best = {gap.distance, thing, gap.on_other};
  };
  for (const Bound& bound : prisms_) {
    const double reach = bound.radius + shape.radius() + best.distance;
    if ((bound.center - shape.center()).squaredNorm() >= reach * reach) continue;
    const Thing& thing = things_[static_cast<std::size_t>(bound.thing)];
    if (thing.bottom >= height) continue;
    offer(thing.outline.empty() ? shape.gap_to_disc(thing.center, thing.radius)
                                : shape.gap_to_polygon(thing.outline),
          bound.thing);
  }
  const double around = shape.radius() + best.distance;
  const Point2 reach(around, around);
  const grid::Cell from = cells_.cell_at((shape.center() - reach).cwiseMax(lower_));
  const grid::Cell to = cells_.cell_at((shape.center() + reach).cwiseMin(upper_));
  for (int y = from.y; y <= std::min(to.y, cells_.height - 1); ++y) {
    for (int x = from.x; x <= std::min(to.x, cells_.width - 1); ++x) {
      const std::size_t cell = cells_.index({x, y});
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        const Piece& p = pieces_[i];
        const Point2 a(p.ax, p.ay);
        const Point2 b(p.bx, p.by);
        if (shapes::distance(shape.center(), a, b) - shape.radius() >= best.distance) continue;
        offer(shape.gap_to_segment(a, b), p.thing);
      }
    }
  }
  if (best.thing < 0) best.distance = std::numeric_limits<double>::infinity();
  return best;
}

Scene::Nearest Scene::nearest(const Point2& point, double height, double limit) const {
  return nearest(std::span(&point, 1), height, limit);
}

}  // namespace usher::world
