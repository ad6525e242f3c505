#pragma once

#include <optional>

#include "foundation/geometry/pose2.hpp"

namespace usher::visitor {

/// Where a visitor walks who wants to stand before the robot's screen, `range` [m] from its middle;
/// round the robot when he is behind it. Nothing when he stands there. Both in map.
std::optional<geometry::Point2> step_up(const geometry::Pose2& robot,
                                        const geometry::Point2& visitor, double range);

}  // namespace usher::visitor
