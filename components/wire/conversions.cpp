#include "wire/conversions.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>

namespace usher::wire {

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kMaxPoses = 100'000;
constexpr std::size_t kMaxCells = 100'000'000;
constexpr std::size_t kMaxBeams = 100'000;
constexpr double kUnitTolerance = 1e-2;

struct Value {
  const char* name;
  double value;
};

/// "velocity must be finite, got angular.z = nan": the first of them that is not, which one is.
Error not_finite(const std::string& what, std::initializer_list<Value> values) {
  const auto* const found = std::find_if(
      values.begin(), values.end(), [](const Value& each) { return !std::isfinite(each.value); });
  assert(found != values.end());
  return {what + " must be finite, got " + found->name + " = " + std::to_string(found->value)};
}

Result<geometry::Pose3> checked_pose(double x, double y, double z,
                                     const geometry_msgs::msg::Quaternion& q) {
  geometry::Pose3 pose{{x, y, z}, Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z())};
  if (!pose.finite()) {
    return not_finite("pose", {{"x", x},
                               {"y", y},
                               {"z", z},
                               {"quaternion.x", q.x()},
                               {"quaternion.y", q.y()},
                               {"quaternion.z", q.z()},
                               {"quaternion.w", q.w()}});
  }
  const double norm = pose.rotation.norm();
  if (std::abs(norm - 1.0) > kUnitTolerance) {
    return Error{"quaternion must have unit length, got " + std::to_string(norm)};
  }
  pose.rotation.normalize();
  return pose;
}

geometry_msgs::msg::Quaternion to_message(const Eigen::Quaterniond& rotation) {
  geometry_msgs::msg::Quaternion q;
  q.x(rotation.x());
  q.y(rotation.y());
  q.z(rotation.z());
  q.w(rotation.w());
  return q;
}

/// The checks that every grid needs before a byte of it is looked at.
Result<grid::GridGeometry> checked_geometry(std::uint32_t width, std::uint32_t height,
                                            double resolution, double x, double y,
                                            std::size_t cells) {
  if (!std::isfinite(resolution) || resolution <= 0.0) {
    return Error{"resolution must be positive, got " + std::to_string(resolution)};
  }
  if (!std::isfinite(x) || !std::isfinite(y))
    return not_finite("grid origin", {{"x", x}, {"y", y}});
  const std::uint64_t wanted = std::uint64_t{width} * height;
  if (wanted == 0 || wanted > kMaxCells || wanted != cells) {
    return Error{"grid of " + std::to_string(width) + " x " + std::to_string(height) +
                 " cells carries " + std::to_string(cells)};
  }
  return grid::GridGeometry{static_cast<int>(width), static_cast<int>(height), resolution, x, y};
}

}  // namespace

builtin_interfaces::msg::Time to_message(Time time) {
  const std::int64_t total = time.time_since_epoch().count();
  std::int64_t second = total / kNanosecondsPerSecond;
  std::int64_t rest = total % kNanosecondsPerSecond;
  if (rest < 0) rest += kNanosecondsPerSecond, --second;
  builtin_interfaces::msg::Time message;
  message.sec(static_cast<std::int32_t>(second));
  message.nanosec(static_cast<std::uint32_t>(rest));
  return message;
}

Time from_message(const builtin_interfaces::msg::Time& message) {
  return Time(runtime::Duration(message.sec() * kNanosecondsPerSecond + message.nanosec()));
}

std_msgs::msg::Header header(Time stamp, std::string_view frame) {
  std_msgs::msg::Header message;
  message.stamp(to_message(stamp));
  message.frame_id(std::string(frame));
  return message;
}

geometry_msgs::msg::Pose to_message(const geometry::Pose3& pose) {
  geometry_msgs::msg::Pose message;
  message.position().x(pose.translation.x());
  message.position().y(pose.translation.y());
  message.position().z(pose.translation.z());
  message.orientation(to_message(pose.rotation));
  return message;
}

geometry_msgs::msg::Pose to_message(const geometry::Pose2& pose) {
  geometry_msgs::msg::Pose message;
  message.position().x(pose.x);
  message.position().y(pose.y);
  message.orientation().z(std::sin(0.5 * pose.yaw));
  message.orientation().w(std::cos(0.5 * pose.yaw));
  return message;
}

geometry_msgs::msg::Transform to_transform(const geometry::Pose3& pose) {
  geometry_msgs::msg::Transform message;
  message.translation().x(pose.translation.x());
  message.translation().y(pose.translation.y());
  message.translation().z(pose.translation.z());
  message.rotation(to_message(pose.rotation));
  return message;
}

Result<geometry::Pose3> from_message(const geometry_msgs::msg::Pose& message) {
  const auto& p = message.position();
  return checked_pose(p.x(), p.y(), p.z(), message.orientation());
}

Result<geometry::Pose3> from_message(const geometry_msgs::msg::Transform& message) {
  const auto& t = message.translation();
  return checked_pose(t.x(), t.y(), t.z(), message.rotation());
}

Result<geometry::Pose2> to_planar(const geometry_msgs::msg::Pose& message) {
  const auto pose = from_message(message);
  if (!pose) return Error{pose.error()};
  return geometry::to_plane(*pose);
}

geometry_msgs::msg::TransformStamped transform(Time stamp, std::string_view parent,
                                               std::string_view child,
                                               const geometry::Pose3& parent_T_child) {
  geometry_msgs::msg::TransformStamped message;
  message.header(header(stamp, parent));
  message.child_frame_id(std::string(child));
  message.transform(to_transform(parent_T_child));
  return message;
}

geometry_msgs::msg::TwistStamped to_message(Time stamp, const geometry::Twist2& twist) {
  geometry_msgs::msg::TwistStamped message;
  message.header(header(stamp, "base_footprint"));
  message.twist().linear().x(twist.v);
  message.twist().angular().z(twist.w);
  return message;
}

Result<geometry::Twist2> from_message(const geometry_msgs::msg::Twist& message) {
  const geometry::Twist2 twist{message.linear().x(), message.angular().z()};
  if (!twist.finite())
    return not_finite("velocity", {{"linear.x", twist.v}, {"angular.z", twist.w}});
  return twist;
}

nav_msgs::msg::Path to_message(Time stamp, std::string_view frame,
                               std::span<const geometry::Pose2> path) {
  nav_msgs::msg::Path message;
  message.header(header(stamp, frame));
  message.poses().reserve(path.size());
  for (const auto& pose : path) {
    auto& stamped = message.poses().emplace_back();
    stamped.header(message.header());
    stamped.pose(to_message(pose));
  }
  return message;
}

Result<std::vector<geometry::Pose2>> from_message(const nav_msgs::msg::Path& message) {
  if (message.poses().size() > kMaxPoses) {
    return Error{"path must have at most 100000 poses, got " +
                 std::to_string(message.poses().size())};
  }
  std::vector<geometry::Pose2> path;
  path.reserve(message.poses().size());
  for (const auto& stamped : message.poses()) {
    const auto pose = to_planar(stamped.pose());
    if (!pose)
      return Error{"pose " + std::to_string(path.size()) + " of the path: " + pose.error()};
    path.push_back(*pose);
  }
  return path;
}

nav_msgs::msg::OccupancyGrid to_message(Time stamp, std::string_view frame,
                                        const grid::OccupancyGrid& grid) {
  nav_msgs::msg::OccupancyGrid message;
  message.header(header(stamp, frame));
  auto& info = message.info();
  info.map_load_time(to_message(stamp));
  info.resolution(static_cast<float>(grid.resolution()));
  info.width(static_cast<std::uint32_t>(grid.width()));
  info.height(static_cast<std::uint32_t>(grid.height()));
  info.origin(to_message(geometry::Pose2{grid.geometry().origin_x, grid.geometry().origin_y, 0.0}));
  message.data().assign(grid.begin(), grid.end());
  return message;
}

Result<grid::OccupancyGrid> from_message(const nav_msgs::msg::OccupancyGrid& message) {
  const auto& info = message.info();
  const auto origin = to_planar(info.origin());
  if (!origin) return Error{"map origin: " + origin.error()};
  if (std::abs(origin->yaw) > 1e-6) {
    return Error{"map must be upright, got an origin yaw of " + std::to_string(origin->yaw) +
                 " rad"};
  }
  // The message has single precision: 0.05f is read as 0.05, not as 0.0500000007, or cells drift on
  // large maps.
  const double resolution = std::round(static_cast<double>(info.resolution()) * 1e6) / 1e6;
  const auto geometry = checked_geometry(info.width(), info.height(), resolution, origin->x,
                                         origin->y, message.data().size());
  if (!geometry) return Error{geometry.error()};
  grid::OccupancyGrid grid(*geometry);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::int8_t value = message.data()[i];
    if (value < -1 || value > 100)
      return Error{"map value must be -1..100, got " + std::to_string(value)};
    grid[i] = value;
  }
  return grid;
}

usher_msgs::msg::Costmap to_message(Time stamp, std::string_view frame,
                                    const grid::Grid<std::uint8_t>& costs) {
  usher_msgs::msg::Costmap message;
  message.header(header(stamp, frame));
  message.resolution(static_cast<float>(costs.resolution()));
  message.width(static_cast<std::uint32_t>(costs.width()));
  message.height(static_cast<std::uint32_t>(costs.height()));
  message.origin_x(costs.geometry().origin_x);
  message.origin_y(costs.geometry().origin_y);
  message.costs(costs.values());
  return message;
}

Result<grid::Grid<std::uint8_t>> from_message(const usher_msgs::msg::Costmap& message) {
  const double resolution = std::round(static_cast<double>(message.resolution()) * 1e6) / 1e6;
  const auto geometry =
      checked_geometry(message.width(), message.height(), resolution, message.origin_x(),
                       message.origin_y(), message.costs().size());
  if (!geometry) return Error{geometry.error()};
  grid::Grid<std::uint8_t> costs(*geometry);
  costs.values() = message.costs();
  return costs;
}

Status check(const sensor_msgs::msg::LaserScan& scan) {
  const std::size_t beams = scan.ranges().size();
  if (beams == 0 || beams > kMaxBeams)
    return Error{"scan must have 1..100000 ranges, got " + std::to_string(beams)};
  if (!std::isfinite(scan.angle_min()) || !std::isfinite(scan.angle_max()) ||
      !std::isfinite(scan.angle_increment())) {
    return not_finite("scan angles", {{"angle_min", scan.angle_min()},
                                      {"angle_max", scan.angle_max()},
                                      {"angle_increment", scan.angle_increment()}});
  }
  if (scan.angle_increment() <= 0.0F) {
    return Error{"scan increment must be positive, got " + std::to_string(scan.angle_increment())};
  }
  // Drivers disagree on whether angle_max belongs to the last beam or to the one after it.
  const double expected =
      (static_cast<double>(scan.angle_max()) - scan.angle_min()) / scan.angle_increment() + 1.0;
  if (std::abs(expected - static_cast<double>(beams)) > 1.5) {
    return Error{"scan must have about " + std::to_string(expected) +
                 " ranges by its angles, got " + std::to_string(beams)};
  }
  if (!std::isfinite(scan.range_min()) || !std::isfinite(scan.range_max()) ||
      scan.range_min() < 0.0F || scan.range_min() >= scan.range_max()) {
    return Error{"scan range limits must satisfy 0 <= min < max, got " +
                 std::to_string(scan.range_min()) + " and " + std::to_string(scan.range_max())};
  }
  if (!scan.intensities().empty() && scan.intensities().size() != beams) {
    return Error{"scan has " + std::to_string(beams) + " ranges and " +
                 std::to_string(scan.intensities().size()) + " intensities"};
  }
  return {};
}

std::array<double, 36> to_covariance(const Eigen::Matrix3d& planar) {
  constexpr std::array<std::size_t, 3> kAxis = {0, 1, 5};
  std::array<double, 36> covariance{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      covariance[6 * kAxis[static_cast<std::size_t>(row)] +
                 kAxis[static_cast<std::size_t>(column)]] = planar(row, column);
    }
  }
  return covariance;
}

Result<Eigen::Matrix3d> from_covariance(const std::array<double, 36>& covariance) {
  constexpr std::array<std::size_t, 3> kAxis = {0, 1, 5};
  Eigen::Matrix3d planar;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      planar(row, column) = covariance[6 * kAxis[static_cast<std::size_t>(row)] +
                                       kAxis[static_cast<std::size_t>(column)]];
    }
  }
  constexpr const char* kNames[] = {"x", "y", "yaw"};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (std::isfinite(planar(row, column))) continue;
      return Error{std::string("covariance of ") + kNames[row] + " and " + kNames[column] +
                   " must be finite, got " + std::to_string(planar(row, column))};
    }
    if (planar(row, row) < 0.0) {
      return Error{std::string("variance of ") + kNames[row] + " must not be negative, got " +
                   std::to_string(planar(row, row))};
    }
  }
  return planar;
}

}  // namespace usher::wire
