#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/geometry/pose3.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "ros2.h"
#include "runtime/api/time.hpp"
#include "usher_msgs.h"

/// Conversions between messages and the values that cores compute with. `to_message` cannot fail;
/// `from_message` refuses what no core shall ever see (non-finite numbers, rotations that are none,
/// sizes that do not fit) and says what it found.
namespace usher::wire {

using runtime::Time;

builtin_interfaces::msg::Time to_message(Time time);
/// Any second and nanosecond pair; nanoseconds beyond a second carry over.
Time from_message(const builtin_interfaces::msg::Time& message);

std_msgs::msg::Header header(Time stamp, std::string_view frame);

geometry_msgs::msg::Pose to_message(const geometry::Pose2& pose);
geometry_msgs::msg::Pose to_message(const geometry::Pose3& pose);
geometry_msgs::msg::Transform to_transform(const geometry::Pose3& pose);
Result<geometry::Pose3> from_message(const geometry_msgs::msg::Pose& message);
Result<geometry::Pose3> from_message(const geometry_msgs::msg::Transform& message);
/// Height and tilt are dropped.
Result<geometry::Pose2> to_planar(const geometry_msgs::msg::Pose& message);

geometry_msgs::msg::TransformStamped transform(Time stamp, std::string_view parent,
                                               std::string_view child,
                                               const geometry::Pose3& parent_T_child);

geometry_msgs::msg::TwistStamped to_message(Time stamp, const geometry::Twist2& twist);
Result<geometry::Twist2> from_message(const geometry_msgs::msg::Twist& message);

nav_msgs::msg::Path to_message(Time stamp, std::string_view frame,
                               std::span<const geometry::Pose2> path);
/// At most 100 000 poses.
Result<std::vector<geometry::Pose2>> from_message(const nav_msgs::msg::Path& message);

nav_msgs::msg::OccupancyGrid to_message(Time stamp, std::string_view frame,
                                        const grid::OccupancyGrid& grid);
/// Upright grids only (the origin without yaw), at most 100 million cells, values -1..100.
Result<grid::OccupancyGrid> from_message(const nav_msgs::msg::OccupancyGrid& message);

usher_msgs::msg::Costmap to_message(Time stamp, std::string_view frame,
                                    const grid::Grid<std::uint8_t>& costs);
/// At most 100 million cells.
Result<grid::Grid<std::uint8_t>> from_message(const usher_msgs::msg::Costmap& message);

/// Whether a scan is one: finite angles, a positive increment, as many ranges as the angles say (at
/// most 100 000), finite limits in order. The ranges themselves may be anything: NaN and infinity
/// have a meaning (REP 117).
Status check(const sensor_msgs::msg::LaserScan& scan);

/// Row-major 6 x 6 covariance of a planar pose: x, y and yaw of a 3 x 3 one.
std::array<double, 36> to_covariance(const Eigen::Matrix3d& planar);
/// The planar part; refused when it is not finite or a variance is negative.
Result<Eigen::Matrix3d> from_covariance(const std::array<double, 36>& covariance);

}  // namespace usher::wire
