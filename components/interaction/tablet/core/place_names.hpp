#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "interaction/tablet/core/floor_plan.hpp"

namespace usher::tablet {

using Box = Eigen::AlignedBox2d;  ///< [px] of the picture as it is drawn, y down

/// A name that is to be written on a floor plan. Sizes are width and height [px].
struct PlaceName {
  geometry::Point2 at{0, 0};  ///< [px] the place
  double radius = 0.0;        ///< [px] of its dot
  geometry::Point2 one_line{0, 0};
  geometry::Point2 two_lines{0, 0};  ///< as one_line for a name that cannot be parted
};

struct NameBox {
  bool two_lines = false;
  Box box;
  bool crosses_wall = false;  ///< more than a sliver of it lies on other ground than its place
};

/// Where names stand beside their places, at most 1.5 times a letter's height away: within the
/// picture, on no other name or place and not on what is `kept_free`, nearer to their own place
/// than to another. A name keeps to the floor around its place, furniture included, and crosses a
/// wall only where no other position is left to it; none: there is no room for it. The first name
/// has its choice before the others.
///
/// Depends on what is given alone, so names stand still while the robot moves. `scale` is the
/// picture's pixels for one of the plan's, `text_size` [px] the height of letters. Takes 1 ms a
/// name; to be asked when the view of the map changes, not for a frame.
std::vector<std::optional<NameBox>> place_names(const FloorPlan& plan, double scale,
                                                double text_size, std::span<const PlaceName> names,
                                                std::span<const Box> kept_free);

enum class Side : std::uint8_t { kAbove, kBelow, kRight, kLeft };

struct Sign {
  Side side = Side::kAbove;
  Box box;
};

/// Where a sign of `size` stands that goes with the robot: `distance` from it, within the picture,
/// on no name, or on as little of them as can be. It stays on the side where it was (`last`) while
/// there is room.
Sign sign_beside(const geometry::Point2& robot, double distance, const geometry::Point2& size,
                 const geometry::Point2& picture, std::span<const Box> names, Side last);

}  // namespace usher::tablet
