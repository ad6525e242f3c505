#pragma once

#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/angle.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "simulation/world/core/depth_cameras.hpp"

namespace usher::operations {

/// [rad] Of the Kinect on the body while the robot navigates, positive up (the thesis' 5 deg below
/// the horizon).
inline constexpr double kCameraTilt = geometry::radians(-5.0);
/// [m] Ahead of the axle: where scans of the depth pipeline begin.
inline constexpr double kScanOrigin = 0.2;

/// MARVIN in the office, with two people: its Kinect, of whichever kind, and its laser.
class DepthStage {
 public:
  /// `world_file`: the office's.
  static Result<DepthStage> make(const std::string& world_file,
                                 const rendering::DepthSensorConfig& camera, std::uint64_t seed);

  /// An image from a place with a pitch, as the camera says and as it is.
  imaging::DepthImage look(const geometry::Pose2& place, double pitch, double burst);
  const depth_pipeline::CameraPose& pose() const { return pose_; }
  const rendering::Hits& truth() const { return sensor_.truth(); }
  imaging::Intrinsics camera() const;

  /// Of the last image: the nearest thing between floor and 2 m of each bearing, without errors of
  /// the camera.
  std::vector<float> nearest(const depth_pipeline::ScanGeometry& geometry) const;
  /// What the laser of an upright robot sees from there [m], ahead and left of where scans of the
  /// depth pipeline begin.
  std::vector<cv::Point2d> laser(const geometry::Pose2& place) const;
  /// A point in world as the last image shows it, in pixels; empty behind the camera.
  std::optional<cv::Point2d> pixel(const Eigen::Vector3d& in_world) const;

 private:
  DepthStage(world::Building building, const rendering::DepthSensorConfig& camera,
             std::uint64_t seed);

  std::uint64_t seed_;
  world::World world_;
  rendering::Renderer renderer_;
  rendering::DepthSensor sensor_;
  std::vector<std::uint16_t> millimeters_;
  depth_pipeline::CameraPose pose_;
  geometry::Pose3 world_T_camera_;
};

}  // namespace usher::operations
