#include "navigation/explorer/core/seen_area.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/ray_cast.hpp"
#include "foundation/result/bounds.hpp"

namespace usher::explorer {

namespace {

constexpr std::int8_t kFreeUpTo = 24;  // percent, as map_server's default threshold
// Neighboring rays are this many cells apart at the farthest distance: no cell slips between them.
constexpr double kRaySpacing = 0.7;

}  // namespace

Result<SeenArea> SeenArea::create(const Camera& camera) {
  const Status status = within({{"field_of_view", camera.field_of_view, 0.1, 3.0, "rad"},
                                {"nearest", camera.nearest, 0.0, 5.0, "m"},
                                {"farthest", camera.farthest, 0.5, 20.0, "m"},
                                {"ahead", camera.ahead, -1.0, 1.0, "m"}});
  if (!status) return Error{status.error()};
  if (camera.nearest >= camera.farthest) return Error{"nearest must be below farthest"};
  return SeenArea(camera);
}

void SeenArea::set_map(const grid::OccupancyGrid& map, std::span<const Rectangle> leave_out) {
  cells_ = grid::Grid<std::uint8_t>(map.geometry());
  counted_in_.assign(map.size(), 0);
  count_ = 0;
  wanted_ = seen_ = 0;
  has_aside_ = false;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] < 0 || map[i] > kFreeUpTo) {
      cells_[i] = kOpaque;
      continue;
    }
    const Point2 center = map.geometry().center(map.geometry().cell(i));
    const bool left_out = std::any_of(leave_out.begin(), leave_out.end(),
                                      [&](const Rectangle& r) { return r.contains(center); });
    if (left_out) continue;
    cells_[i] = kWanted;
    ++wanted_;
  }
  visible_.reserve(map.size());
  aim();
}

void SeenArea::aim() {
  const double reach = camera_.farthest / geometry().resolution;
  const auto rays =
      std::max(2, static_cast<int>(std::ceil(camera_.field_of_view * reach / kRaySpacing)) + 1);
  rays_.clear();
  for (int i = 0; i < rays; ++i) {
    const double angle = camera_.field_of_view * (static_cast<double>(i) / (rays - 1) - 0.5);
    rays_.emplace_back(std::cos(angle), std::sin(angle));
  }
  const int around = kDirections * kRaysPerDirection;
  circle_.clear();
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * geometry::kPi * (i + 0.5) / around;
    circle_.emplace_back(std::cos(angle), std::sin(angle));
  }
}

void SeenArea::forget() {
  for (auto& cell : cells_) cell = static_cast<std::uint8_t>(cell & ~kSeen);
  seen_ = 0;
}

void SeenArea::set_aside(std::span<const std::uint8_t> cells) {
  has_aside_ = false;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const bool aside = i < cells.size() && cells[i] != 0 && wanted(i);
    cells_[i] = static_cast<std::uint8_t>(aside ? cells_[i] | kAside : cells_[i] & ~kAside);
    has_aside_ = has_aside_ || aside;
  }
}

std::size_t SeenArea::most_in_view() const {
  // The sector, and the cells that its border only touches.
  const double reach = camera_.farthest / geometry().resolution + 2.0;
  return static_cast<std::size_t>(0.5 * camera_.field_of_view * reach * reach + 3.0 * reach);
}

std::uint32_t SeenArea::begin_count() {
  if (++count_ == 0) {  // after 2^32 counts
    std::fill(counted_in_.begin(), counted_in_.end(), 0);
    count_ = 1;
  }
  return count_;
}

/// Calls `visit(index)` for the cells in view along one ray; `from` in cells.
template <class Visit>
void SeenArea::cast(const Point2& from, double cosine, double sine, Visit&& visit) const {
  const grid::GridGeometry& g = geometry();
  const double nearest = camera_.nearest / g.resolution;
  const double farthest = camera_.farthest / g.resolution;
  grid::CellWalk walk(from.x(), from.y(), cosine, sine);
  while (walk.time() <= farthest && g.contains(walk.cell())) {
    const std::size_t index = g.index(walk.cell());
    if ((cells_[index] & kOpaque) != 0) return;
    if (walk.time() >= nearest) visit(index);
    walk.step();
  }
}

template <class Visit>
void SeenArea::cast_view(const Pose2& robot, Visit&& visit) const {
  const grid::GridGeometry& g = geometry();
  if (empty() || !robot.finite()) return;
  const Point2 camera = robot * Point2(camera_.ahead, 0.0);
  const Point2 from((camera.x() - g.origin_x) / g.resolution,
                    (camera.y() - g.origin_y) / g.resolution);
  if (!(from.x() >= 0.0 && from.y() >= 0.0 && from.x() < g.width && from.y() < g.height)) return;
  const double c = std::cos(robot.yaw), s = std::sin(robot.yaw);
  for (const Point2& ray : rays_)
    cast(from, c * ray.x() - s * ray.y(), s * ray.x() + c * ray.y(), visit);
}

std::span<const std::uint32_t> SeenArea::view(const Pose2& robot) {
  const std::uint32_t count = begin_count();
  visible_.clear();
  cast_view(robot, [&](std::size_t index) {
    if ((cells_[index] & kWanted) == 0 || counted_in_[index] == count) return;
    counted_in_[index] = count;
    visible_.push_back(static_cast<std::uint32_t>(index));
  });
  return visible_;
}

std::size_t SeenArea::look(const Pose2& robot) {
  const std::size_t before = seen_;
  cast_view(robot, [&](std::size_t index) {
    if (!unseen(index)) return;
    cells_[index] |= kSeen;
    ++seen_;
  });
  return seen_ - before;
}

std::size_t SeenArea::gain(std::span<const Pose2> poses) {
  const std::uint32_t count = begin_count();
  std::size_t gain = 0;
  for (const Pose2& pose : poses) {
    cast_view(pose, [&](std::size_t index) {
      if (!pending(index) || counted_in_[index] == count) return;
      counted_in_[index] = count;
      ++gain;
    });
  }
  return gain;
}

void SeenArea::gains(const Point2& position, Gains& gains) {
  gains.fill(0);
  const grid::GridGeometry& g = geometry();
  if (empty() || !position.allFinite()) return;
  const Point2 from((position.x() - g.origin_x) / g.resolution,
                    (position.y() - g.origin_y) / g.resolution);
  if (!(from.x() >= 0.0 && from.y() >= 0.0 && from.x() < g.width && from.y() < g.height)) return;
  const std::uint32_t count = begin_count();
  Gains sectors{};
  for (std::size_t ray = 0; ray < circle_.size(); ++ray) {
    std::uint32_t& sector = sectors[ray / kRaysPerDirection];
    cast(from, circle_[ray].x(), circle_[ray].y(), [&](std::size_t index) {
      if (!pending(index) || counted_in_[index] == count) return;
      counted_in_[index] = count;
      ++sector;
    });
  }
  // Direction d has the sectors [d - half, d + half) in view: sector d begins at its yaw.
  const int half = std::max(
      1, static_cast<int>(camera_.field_of_view / (2.0 * geometry::kPi) * kDirections / 2.0));
  const auto sector = [&](int d) {
    return sectors[static_cast<std::size_t>((d + 2 * kDirections) % kDirections)];
  };
  std::uint32_t sum = 0;
  for (int d = -half; d < half; ++d) sum += sector(d);
  for (int d = 0; d < kDirections; ++d) {
    gains[static_cast<std::size_t>(d)] = sum;
    sum = sum - sector(d - half) + sector(d + half);
  }
}

}  // namespace usher::explorer
