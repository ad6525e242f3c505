#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::world {

using geometry::Point2;
using geometry::Pose2;

enum class Material : std::uint8_t { kSolid, kGlass };

/// A rigid upright thing: an outline from `bottom` to `top`. All lengths in metres, in world. One
/// whose top is 0 and whose bottom lies below is a pit in the floor.
struct Thing {
  std::string name;
  Material material = Material::kSolid;
  double bottom = 0.0;
  double top = 0.0;
  std::vector<Point2> outline;  ///< convex, counter-clockwise, 3..kMaxCorners points; empty: a disc
  Point2 center = Point2::Zero();  ///< of a disc
  double radius = 0.0;             ///< of a disc

  static constexpr std::size_t kMaxCorners = 12;
};

/// A box with its length along the pose's x axis.
Thing box(std::string name, const Pose2& center, double length, double width, double bottom,
          double top);
/// A straight wall of a thickness: both ends are extended by half of it, so that corners close.
Thing wall(std::string name, const Point2& from, const Point2& to, double thickness, double top);
Thing disc(std::string name, const Point2& center, double radius, double bottom, double top);

/// Something round that moves: a person.
struct Mover {
  Point2 center = Point2::Zero();
  double radius = 0.25;  ///< [m]
  double top = 1.7;      ///< [m] it stands on the floor
};

/// What stands still in the world, indexed for rays and distances. Immutable: when a door moves,
/// make a new one (about a millisecond for a floor).
class Scene {
 public:
  /// Above the floor at height 0 and below a flat ceiling. Things may overlap; a thing that reaches
  /// from floor to ceiling counts as a wall (fast), all others as prisms. Cells of the map that are
  /// occupied by 65 % and more are walls too, together the last thing, named "map"; unknown is
  /// free.
  Scene(std::vector<Thing> things, double ceiling, const grid::OccupancyGrid* map = nullptr);

  std::span<const Thing> things() const { return things_; }
  double ceiling() const { return ceiling_; }
  /// Lower left and upper right corner of all things; both (0, 0) when there are none.
  const Point2& lower() const { return lower_; }
  const Point2& upper() const { return upper_; }

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< [m] 0 when touching or inside
    int thing = -1;                                             ///< index into things(); -1: none
    Point2 point = Point2::Zero();                              ///< the thing's nearest point
  };
  /// The nearest thing that reaches below `height`, when it is nearer than `limit` [m]: to a convex
  /// polygon (counter-clockwise) or to a point. Glass counts. Walls and map know only
  /// their border: a polygon wholly inside one is as far from it as from the border.
  Nearest nearest(std::span<const Point2> polygon, double height, double limit) const;
  Nearest nearest(const Point2& point, double height, double limit) const;

 private:
  friend class RayCaster;

  // A piece of a wall's outline, the solid on its left; cut at the borders of the cells.
  struct Piece {
    float ax, ay, bx, by;
    std::int32_t thing;
    bool glass;
  };
  struct Bound {  // around a prism or disc
    Point2 center;
    double radius;
    std::int32_t thing;
  };
  struct Segment {
    Point2 a, b;
    std::int32_t thing;
  };
  struct Offset {
    std::int16_t x, y;
    float reach;  // no point of that cell is nearer to any point of cell (0, 0) [m]
  };

  void index(std::span<const Segment> segments);

  std::vector<Thing> things_;
  double ceiling_ = 0.0;
  Point2 lower_ = Point2::Zero();
  Point2 upper_ = Point2::Zero();
  grid::GridGeometry cells_;
  std::vector<std::uint32_t> first_;  // of each cell in pieces_, and the end
  std::vector<Piece> pieces_;
  std::vector<Bound> prisms_;
  std::vector<Offset> offsets_;  // by rising reach
};

}  // namespace usher::world
