#include "navigation/explorer/core/frontier.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace usher::explorer {

namespace {

constexpr double kStandOff = 1.5;  // [m] from the middle of a border to a place to stand
constexpr std::array<grid::Cell, 4> kBeside = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// The direction in which most is unseen; nothing when that is not worth a view.
std::optional<double> best_direction(SeenArea& seen, const Point2& point, std::size_t least) {
  SeenArea::Gains gains;
  seen.gains(point, gains);
  const auto best = std::max_element(gains.begin(), gains.end());
  if (*best < least) return std::nullopt;
  return 2.0 * geometry::kPi * static_cast<double>(best - gains.begin()) / SeenArea::kDirections;
}

}  // namespace

void Frontier::mark_border(const SeenArea& seen) {
  const grid::GridGeometry& g = seen.geometry();
  border_.assign(g.size(), 0);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!seen.seen(i)) continue;
    const grid::Cell cell = g.cell(i);
    border_[i] = std::any_of(kBeside.begin(), kBeside.end(), [&](grid::Cell by) {
      const grid::Cell neighbor{cell.x + by.x, cell.y + by.y};
      return g.contains(neighbor) && seen.pending(g.index(neighbor));
    });
  }
}

/// Moves everything that hangs together with `first` from border_ to piece_.
void Frontier::take_piece(const SeenArea& seen, std::size_t first) {
  const grid::GridGeometry& g = seen.geometry();
  piece_.assign(1, static_cast<std::uint32_t>(first));
  border_[first] = 0;
  for (std::size_t done = 0; done < piece_.size(); ++done) {
    const grid::Cell cell = g.cell(piece_[done]);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const grid::Cell neighbor{cell.x + dx, cell.y + dy};
        if (!g.contains(neighbor) || border_[g.index(neighbor)] == 0) continue;
        border_[g.index(neighbor)] = 0;
        piece_.push_back(static_cast<std::uint32_t>(g.index(neighbor)));
      }
    }
  }
}

/// A place near the middle of the piece, looking to where most is unseen.
std::optional<Pose2> Frontier::view_of_piece(const Outlook& outlook) const {
  const grid::GridGeometry& g = outlook.seen.geometry();
  Point2 mean = Point2::Zero();
  for (const std::uint32_t index : piece_) mean += g.center(g.cell(index));
  mean /= static_cast<double>(piece_.size());
  Point2 middle = mean;
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t index : piece_) {
    const Point2 center = g.center(g.cell(index));
    const double distance = (center - mean).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    middle = center;
  }
  const auto place = outlook.ground.standing().nearest_free(middle, kStandOff);
  if (!place || is_given_up(outlook, *place, config_.give_up_radius)) return std::nullopt;
  if (!std::isfinite(outlook.ground.way_to(*place))) return std::nullopt;
  const auto yaw = best_direction(outlook.seen, *place, cells_of(outlook.seen, config_.least_gain));
  if (!yaw) return std::nullopt;
  const Pose2 view{place->x(), place->y(), geometry::normalized(*yaw)};
  const std::size_t gain = outlook.seen.gain({&view, 1});
  if (gain < cells_of(outlook.seen, config_.least_gain)) return std::nullopt;
  return view;
}

std::optional<Pose2> Frontier::next(const Outlook& outlook) {
  mark_border(outlook.seen);
  std::optional<Pose2> best;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < border_.size(); ++i) {
    if (border_[i] == 0) continue;
    take_piece(outlook.seen, i);
    const auto view = view_of_piece(outlook);
    if (!view) continue;
    const double way = outlook.ground.way_to(view->position());
    if (way >= shortest) continue;
    shortest = way;
    best = view;
  }
  if (best || outlook.seen.seen_cells() > 0) return best;
  // Nothing was seen yet: the robot looks from a place that is left out, or at a wall.
  const grid::GridGeometry& g = outlook.seen.geometry();
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!outlook.ground.standing().free_at(i)) continue;
    const Point2 place = g.center(g.cell(i));
    const double way = outlook.ground.way_to(place);
    if (way >= shortest || is_given_up(outlook, place, config_.give_up_radius)) continue;
    shortest = way;
    best = Pose2{place.x(), place.y(), 0.0};
  }
  if (best) {
    const auto yaw = best_direction(outlook.seen, best->position(), 0);
    best->yaw = geometry::normalized(yaw.value_or(0.0));
  }
  return best;
}

bool Frontier::worth(const Pose2& view, SeenArea& seen) {
  return seen.gain({&view, 1}) >= cells_of(seen, config_.least_gain);
}

}  // namespace usher::explorer
