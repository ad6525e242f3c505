#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"

namespace usher::explorer {

using geometry::Point2;
using geometry::Pose2;

/// The camera that looks for people, seen from above. It turns with the robot.
struct Camera {
  double field_of_view = 0.9948;  ///< [rad] 57 deg; [0.1, 3]
  double nearest = 0.3;           ///< [m] [0, 5]
  double farthest = 3.5;          ///< [m] effective, of what looks for people; [0.5, 20]
  double ahead = 0.0;             ///< [m] of the robot's middle; [-1, 1]
};

/// A part of the map [m].
struct Rectangle {
  Point2 low, high;
  bool contains(const Point2& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
};

/// Which cells of a map the camera has seen, by casting rays through its field of view: a cell
/// counts when a ray passes through it between the nearest and the farthest distance, before
/// anything that is not free (section IV-E of the meeting report). To be looked at are the free
/// cells outside of the places that are left out. Allocates when the map changes only.
class SeenArea {
 public:
  static constexpr int kDirections = 64;
  /// Pending cells that the camera would see from one place, by direction: entry d is the yaw
  /// 2 pi d / kDirections.
  using Gains = std::array<std::uint32_t, kDirections>;

  /// The error names the value that is out of its range.
  static Result<SeenArea> create(const Camera& camera);

  /// Takes a map (free: 0 to 24, as map_server's default) with nothing seen.
  void set_map(const grid::OccupancyGrid& map, std::span<const Rectangle> leave_out);
  /// Nothing is seen.
  void forget();
  /// Cells that are not zero are looked at when nothing else is left: no view is chosen for them;
  /// what is seen of them counts as before. Empty: none are.
  void set_aside(std::span<const std::uint8_t> cells);
  bool has_aside() const { return has_aside_; }

  const grid::GridGeometry& geometry() const { return cells_.geometry(); }
  bool empty() const { return cells_.empty(); }
  std::size_t wanted_cells() const { return wanted_; }
  std::size_t seen_cells() const { return seen_; }
  /// No view shows more cells.
  std::size_t most_in_view() const;
  /// [m2] of one cell.
  double cell_area() const { return geometry().resolution * geometry().resolution; }
  /// Share of what is to be looked at, 0..1; 0 without a map.
  double coverage() const {
    return wanted_ == 0 ? 0.0 : static_cast<double>(seen_) / static_cast<double>(wanted_);
  }
  bool wanted(std::size_t index) const { return (cells_[index] & kWanted) != 0; }
  bool unseen(std::size_t index) const { return (cells_[index] & (kWanted | kSeen)) == kWanted; }
  /// Unseen and not set aside: what views are chosen for.
  bool pending(std::size_t index) const {
    return (cells_[index] & (kWanted | kSeen | kAside)) == kWanted;
  }
  bool aside(const Point2& point) const {
    const grid::Cell cell = geometry().cell_at(point);
    return geometry().contains(cell) && (cells_[geometry().index(cell)] & kAside) != 0;
  }
  bool seen(std::size_t index) const {
    return (cells_[index] & (kWanted | kSeen)) == (kWanted | kSeen);
  }

  /// The cells to be looked at that the camera sees from a pose of the robot, each once, whether
  /// seen before or not; valid until the next call. None for a pose that is not finite or off the
  /// map. A look costs about 10,000 steps from cell to cell at 0.05 m.
  std::span<const std::uint32_t> view(const Pose2& robot);
  /// The camera looks: marks what it sees, returns how many cells are new.
  std::size_t look(const Pose2& robot);
  /// Pending cells that the camera would see from at least one of the poses.
  std::size_t gain(std::span<const Pose2> poses);
  /// What a turn at one place would show, by direction; each cell counts for the directions that
  /// have the ray in view that meets it first.
  void gains(const Point2& position, Gains& gains);

 private:
  static constexpr std::uint8_t kOpaque = 1, kWanted = 2, kSeen = 4, kAside = 8;
  static constexpr int kRaysPerDirection = 6;

  explicit SeenArea(const Camera& camera) : camera_(camera) {}
  void aim();
  std::uint32_t begin_count();
  template <class Visit>
  void cast(const Point2& from, double cosine, double sine, Visit&& visit) const;
  template <class Visit>
  void cast_view(const Pose2& robot, Visit&& visit) const;

  Camera camera_;
  grid::Grid<std::uint8_t> cells_;
  std::size_t wanted_ = 0, seen_ = 0;
  bool has_aside_ = false;
  std::vector<Point2> rays_;               // unit vectors across the field of view
  std::vector<Point2> circle_;             // all around, kRaysPerDirection a direction
  std::vector<std::uint32_t> counted_in_;  // per cell: the count that it was counted in last
  std::uint32_t count_ = 0;
  std::vector<std::uint32_t> visible_;
};

}  // namespace usher::explorer
