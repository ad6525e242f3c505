#include "interaction/tablet/core/place_names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "foundation/grid/grid.hpp"
#include "foundation/grid/wavefront.hpp"

namespace usher::tablet {

namespace {

using geometry::Point2;

// Of the size of text.
constexpr double kEdge = 0.3;      ///< from names to the picture's border
constexpr double kGap = 0.25;      ///< from a dot to its name: a robot that stands there is seen
constexpr double kFarthest = 1.5;  ///< from a dot to its name
constexpr double kStep = 0.25;     ///< from one position that is tried to the next
constexpr double kApart = 0.03;    ///< from name to name
constexpr double kSliver = 0.15;  ///< of its square: so much on the other side of a wall is nothing
/// [m] A way that is longer than the straight one by more leads round a wall, by less round a
/// table.
constexpr double kDetour = 1.2;
constexpr int kMostCells = grid::Wavefront::kLargestSide;

// What a position costs: crossing a wall outweighs all the rest.
constexpr double kCrossing = 1000.0;
constexpr double kForeign = 0.3;    ///< for a letter's square on foreign ground
constexpr double kCovered = 0.2;    ///< for a letter's square on furniture
constexpr double kOffCenter = 0.3;  ///< for a name that begins or ends at its dot
constexpr double kBeside = 0.1;
constexpr double kTwoLines = 0.2;

constexpr std::uint8_t kClosed = 1;

struct Candidate {
  NameBox name;
  double cost = 0.0;
};

/// Sums over rectangles of cells.
class AreaSums {
 public:
  AreaSums(int width, int height)
      : width_(width),
        height_(height),
        sums_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1), 0) {}
  /// Row by row, each from the left.
  void set(int x, int y, bool counts) {
    sums_[index(x + 1, y + 1)] =
        sums_[index(x, y + 1)] + sums_[index(x + 1, y)] - sums_[index(x, y)] + (counts ? 1 : 0);
  }
  /// Of the columns and rows from the first to before the second, as far as they exist.
  int of(grid::Cell from, grid::Cell to) const {
    const auto x = [&](int value) { return std::clamp(value, 0, width_); };
    const auto y = [&](int value) { return std::clamp(value, 0, height_); };
    return sums_[index(x(to.x), y(to.y))] - sums_[index(x(from.x), y(to.y))] -
           sums_[index(x(to.x), y(from.y))] + sums_[index(x(from.x), y(from.y))];
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
           static_cast<std::size_t>(x);
  }
  int width_, height_;
  std::vector<int> sums_;
};

/// The cells that the name of one place may lie on: which are furniture or walls, and which are
/// foreign, as a wall parts them from the place or nobody knows what they are.
class Surroundings {
 public:
  Surroundings(const FloorPlan& plan, const grid::Cell& place, int reach_x, int reach_y)
      : left_(std::clamp(place.x - std::min(reach_x, kMostCells / 2 - 1), 0, plan.width - 1)),
        top_(std::clamp(place.y - std::min(reach_y, kMostCells / 2 - 1), 0, plan.height - 1)),
        width_(
            std::clamp(place.x + reach_x + 1 - left_, 1, std::min(plan.width - left_, kMostCells))),
        height_(
            std::clamp(place.y + reach_y + 1 - top_, 1, std::min(plan.height - top_, kMostCells))),
        covered_(width_, height_),
        foreign_(width_, height_) {
    const grid::Cell from{std::clamp(place.x - left_, 0, width_ - 1),
                          std::clamp(place.y - top_, 0, height_ - 1)};
    grid::Grid<std::uint8_t> closed({width_, height_, plan.resolution, 0.0, 0.0});
    for (std::size_t i = 0; i < closed.size(); ++i) {
      const grid::Cell cell = closed.geometry().cell(i);
      closed[i] = plan.ground(left_ + cell.x, top_ + cell.y) == Ground::kFloor ? 0 : kClosed;
    }
    grid::Wavefront ways;
    std::vector<std::uint16_t> lengths;
    ways.set_obstacles(closed, kClosed, true);
    ways.spread(from, lengths);
    const double slack = kDetour / plan.resolution * grid::Wavefront::kUnitsPerCell;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const grid::Cell cell = closed.geometry().cell(i);
      const bool wall = plan.ground(left_ + cell.x, top_ + cell.y) == Ground::kWall;
      covered_.set(cell.x, cell.y, wall);
      foreign_.set(cell.x, cell.y, !wall && lengths[i] > straight(from, cell) + slack);
    }
  }
  int covered(const Box& box, double scale) const { return count(covered_, box, scale); }
  int foreign(const Box& box, double scale) const { return count(foreign_, box, scale); }

 private:
  /// As the wavefront measures.
  static int straight(const grid::Cell& a, const grid::Cell& b) {
    const int x = std::abs(a.x - b.x), y = std::abs(a.y - b.y);
    return 5 * std::max(x, y) + 2 * std::min(x, y);
  }
  int count(const AreaSums& sums, const Box& box, double scale) const {
    const auto cell = [&](double value, int first) {
      return static_cast<int>(std::floor(value / scale)) - first;
    };
    return sums.of({cell(box.min().x(), left_), cell(box.min().y(), top_)},
                   {cell(box.max().x(), left_) + 1, cell(box.max().y(), top_) + 1});
  }
  int left_, top_, width_, height_;
  AreaSums covered_, foreign_;
};

Box box_around(const Point2& middle, const Point2& size) {
  return {middle - 0.5 * size, middle + 0.5 * size};
}

/// All positions of a name, the best first.
class Positions {
 public:
  Positions(const FloorPlan& plan, double scale, double text_size, std::span<const PlaceName> names,
            std::size_t index)
      : scale_(scale),
        text_size_(text_size),
        picture_(Point2::Zero(), scale * Point2(plan.width, plan.height)),
        names_(names),
        index_(index),
        surroundings_(around(plan, scale, text_size, names[index])) {
    const PlaceName& name = names[index];
    try_all(name.one_line, false);
    if (name.two_lines != name.one_line) try_all(name.two_lines, true);
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  }
  std::vector<Candidate> sorted() && { return std::move(candidates_); }

 private:
  static Surroundings around(const FloorPlan& plan, double scale, double text_size,
                             const PlaceName& name) {
    const Point2 reach = (name.one_line.cwiseMax(name.two_lines) +
                          Point2::Constant(name.radius + kFarthest * text_size)) /
                         scale;
    const Point2 at = name.at / scale;
    return {plan,
            {static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))},
            static_cast<int>(std::ceil(reach.x())) + 1,
            static_cast<int>(std::ceil(reach.y())) + 1};
  }

  /// Below the place and above it, beside it on the right and the left; farther and farther away,
  /// and along the place.
  void try_all(const Point2& size, bool two_lines) {
    const double step = kStep * text_size_;
    const double radius = names_[index_].radius;
    for (double away = 0.0; away <= kFarthest * text_size_; away += step) {
      for (const bool beside : {false, true}) {
        const int along = beside ? 1 : 0, across = 1 - along;
        const int most = static_cast<int>(std::floor(0.5 * size[along] / step));
        for (int slid = -most; slid <= most; ++slid) {
          for (const double side : {1.0, -1.0}) {
            Point2 offset;
            offset[along] = slid * step;
            offset[across] = side * (radius + away + 0.5 * size[across]);
            const double off_center = std::abs(slid) / std::max(1.0, 1.0 * most);
            try_one(box_around(names_[index_].at + offset, size), two_lines,
                    std::abs(away / text_size_ - kGap) + kOffCenter * off_center +
                        (beside ? kBeside : 0.0) + (two_lines ? kTwoLines : 0.0));
          }
        }
      }
    }
  }

  void try_one(const Box& box, bool two_lines, double cost) {
    const Point2 edge = Point2::Constant(kEdge * text_size_);
    if (!Box(picture_.min() + edge, picture_.max() - edge).contains(box)) return;
    const double own = box.exteriorDistance(names_[index_].at);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (i != index_ && box.exteriorDistance(names_[i].at) <= own) return;
    }
    const double cells_of_square = text_size_ * text_size_ / (scale_ * scale_);
    const double foreign = surroundings_.foreign(box, scale_) / cells_of_square;
    const double covered = surroundings_.covered(box, scale_) / cells_of_square;
    const bool crosses = foreign > kSliver;
    cost += kForeign * foreign + kCovered * covered + (crosses ? kCrossing : 0.0);
    candidates_.push_back({{two_lines, box, crosses}, cost});
  }

  double scale_, text_size_;
  Box picture_;
  std::span<const PlaceName> names_;
  std::size_t index_;
  Surroundings surroundings_;
  std::vector<Candidate> candidates_;
};

double overlap(const Box& box, std::span<const Box> others) {
  double area = 0.0;
  for (const Box& other : others) {
    if (box.intersects(other)) area += box.intersection(other).volume();
  }
  return area;
}

/// The first name, then those with the fewest positions in their rooms.
std::vector<std::size_t> fewest_first(const std::vector<std::vector<Candidate>>& positions) {
  std::vector<std::pair<std::ptrdiff_t, std::size_t>> order;
  order.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto rooms = std::count_if(positions[i].begin(), positions[i].end(),
                                     [](const auto& each) { return !each.name.crosses_wall; });
    order.emplace_back(i == 0 ? -1 : rooms, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> indices;
  indices.reserve(order.size());
  for (const auto& each : order) indices.push_back(each.second);
  return indices;
}

}  // namespace

std::vector<std::optional<NameBox>> place_names(const FloorPlan& plan, double scale,
                                                double text_size, std::span<const PlaceName> names,
                                                std::span<const Box> kept_free) {
  std::vector<std::optional<NameBox>> placed(names.size());
  if (plan.empty() || !(scale > 0.0) || !(text_size > 0.0)) return placed;
  const Box picture(Point2::Zero(), scale * Point2(plan.width, plan.height));
  std::vector<std::vector<Candidate>> positions(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (picture.contains(names[i].at))
      positions[i] = Positions(plan, scale, text_size, names, i).sorted();
  }
  std::vector<Box> taken(kept_free.begin(), kept_free.end());
  // Who has to cross a wall takes nobody's room; who has few positions chooses before the others.
  for (const bool may_cross : {false, true}) {
    for (const std::size_t i : fewest_first(positions)) {
      if (placed[i]) continue;
      for (const Candidate& candidate : positions[i]) {
        if (candidate.name.crosses_wall && !may_cross && i > 0) break;
        const Point2 apart = Point2::Constant(kApart * text_size);
        const Box wide(candidate.name.box.min() - apart, candidate.name.box.max() + apart);
        if (overlap(wide, taken) > 0.0) continue;
        placed[i] = candidate.name;
        taken.push_back(candidate.name.box);
        break;
      }
    }
  }
  return placed;
}

Sign sign_beside(const Point2& robot, double distance, const Point2& size, const Point2& picture,
                 std::span<const Box> names, Side last) {
  constexpr std::array kSides{Side::kAbove, Side::kBelow, Side::kRight, Side::kLeft};
  const auto at = [&](Side side) {
    const Point2 off = Point2::Constant(distance) + 0.5 * size;
    const Point2 middle = robot + (side == Side::kAbove   ? Point2(0, -off.y())
                                   : side == Side::kBelow ? Point2(0, off.y())
                                   : side == Side::kRight ? Point2(off.x(), 0)
                                                          : Point2(-off.x(), 0));
    const Point2 most = (picture - 0.5 * size).cwiseMax(0.5 * size);
    return box_around(middle.cwiseMax(0.5 * size).cwiseMin(most), size);
  };
  const auto cost = [&](const Box& box) {
    const Box marker = box_around(robot, Point2::Constant(distance));
    return overlap(box, names) + overlap(box, std::span(&marker, 1)) * 10.0;
  };
  Sign best{last, at(last)};
  double least = cost(best.box);
  for (const Side side : kSides) {
    const Box box = at(side);
    if (cost(box) < least) {
      least = cost(box);
      best = {side, box};
    }
  }
  return best;
}

}  // namespace usher::tablet
