#include "navigation/explorer/core/share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace usher::explorer {

namespace {

constexpr std::uint8_t kNobody = 255;
constexpr int kStride = 4;        // [cells] between those that the parts are weighed by
constexpr int kRounds = 60;       // of weighing
constexpr double kCooling = 0.9;  // of the step, from round to round
constexpr std::array<grid::Cell, 4> kBeside = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Ways from each place to each cell [m], place by place.
using Ways = std::vector<std::vector<float>>;

std::uint8_t nearest(const Ways& ways, std::span<const double> head_start, std::size_t cell) {
  std::uint8_t best = kNobody;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double way = static_cast<double>(ways[i][cell]) + head_start[i];
    if (!(way < least)) continue;
    least = way;
    best = static_cast<std::uint8_t>(i);
  }
  return best;
}

/// [m] for each place, positive for those that would get too much.
std::vector<double> weigh(const Ways& ways, const SeenArea& area) {
  const grid::GridGeometry& g = area.geometry();
  std::vector<std::size_t> cells;
  double step = 0.0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const grid::Cell cell = g.cell(i);
    if (!area.wanted(i) || cell.x % kStride != 0 || cell.y % kStride != 0) continue;
    cells.push_back(i);
    for (const auto& way : ways) {
      if (std::isfinite(way[i])) step = std::max(step, static_cast<double>(way[i]));
    }
  }
  std::vector<double> head_start(ways.size(), 0.0), best = head_start;
  double least = std::numeric_limits<double>::infinity();
  const double fair = 1.0 / static_cast<double>(ways.size());
  for (int round = 0; round < kRounds && !cells.empty(); ++round, step *= kCooling) {
    std::vector<double> part(ways.size(), 0.0);
    for (const std::size_t cell : cells) {
      const std::uint8_t whose = nearest(ways, head_start, cell);
      if (whose != kNobody) part[whose] += 1.0 / static_cast<double>(cells.size());
    }
    double worst = 0.0;
    for (const double share : part) worst = std::max(worst, std::abs(share - fair));
    if (worst < least) least = worst, best = head_start;
    for (std::size_t i = 0; i < part.size(); ++i) head_start[i] += step * (part[i] - fair);
  }
  return best;
}

/// Cells where the robot cannot stand belong with the nearest one where it can.
void spread(const grid::GridGeometry& g, std::vector<std::uint8_t>& owner) {
  std::vector<std::uint32_t> queue;
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (owner[i] != kNobody) queue.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const grid::Cell cell = g.cell(queue[next]);
    for (const grid::Cell by : kBeside) {
      const grid::Cell neighbor{cell.x + by.x, cell.y + by.y};
      if (!g.contains(neighbor) || owner[g.index(neighbor)] != kNobody) continue;
      owner[g.index(neighbor)] = owner[queue[next]];
      queue.push_back(static_cast<std::uint32_t>(g.index(neighbor)));
    }
  }
}

}  // namespace

std::vector<std::uint8_t> divide(Ground& ground, const SeenArea& area,
                                 std::span<const Point2> places) {
  const grid::GridGeometry& g = area.geometry();
  Ways ways(places.size(), std::vector<float>(g.size(), std::numeric_limits<float>::infinity()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i].allFinite() || !ground.start_from(places[i])) continue;
    for (std::size_t cell = 0; cell < g.size(); ++cell) {
      if (area.wanted(cell))
        ways[i][cell] = static_cast<float>(ground.way_to(g.center(g.cell(cell))));
    }
  }
  const std::vector<double> head_start = weigh(ways, area);
  std::vector<std::uint8_t> owner(g.size(), kNobody);
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    if (area.wanted(cell)) owner[cell] = nearest(ways, head_start, cell);
  }
  spread(g, owner);
  return owner;
}

}  // namespace usher::explorer
