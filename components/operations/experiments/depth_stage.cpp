#include "operations/experiments/depth_stage.hpp"

#include <algorithm>
#include <cmath>

namespace usher::operations {

namespace {

constexpr double kAxle = 0.235;  // [m] above the floor

std::vector<world::PersonPlan> people() {
  return {{.name = "a", .start = {27.8, 3.2}, .yaw = 2.4, .loop = {}},
          {.name = "b", .start = {5.6, 6.0}, .yaw = 3.0, .loop = {}}};
}

geometry::Pose3 base_at(const geometry::Pose2& place, double pitch) {
  return {{place.x, place.y, kAxle}, geometry::from_roll_pitch_yaw(0.0, pitch, place.yaw)};
}

}  // namespace

Result<DepthStage> DepthStage::make(const std::string& world_file,
                                    const rendering::DepthSensorConfig& camera,
                                    std::uint64_t seed) {
  auto building = world::load_building(world_file);
  if (!building) return Error{building.error()};
  return DepthStage(std::move(building).value(), camera, seed);
}

DepthStage::DepthStage(world::Building building, const rendering::DepthSensorConfig& camera,
                       std::uint64_t seed)
    : seed_(seed),
      world_({}, std::move(building), people(), {3.0, 5.0, 0.0}, seed),
      renderer_(rendering::Renderer::make(world::model_of(world_.scene(), nullptr)).value()),
      sensor_(camera, seed) {
  std::vector<rendering::Body> bodies;
  world::bodies_of(world_.people(), bodies);
  renderer_.place(bodies);
}

imaging::Intrinsics DepthStage::camera() const {
  return rendering::intrinsics_of(sensor_.config().lens);
}

imaging::DepthImage DepthStage::look(const geometry::Pose2& place, double pitch, double burst) {
  const world::Mount mount{.x = 0.2, .z = 0.665, .pitch = -kCameraTilt};
  world_T_camera_ = base_at(place, pitch) * mount.base_T_sensor();
  sensor_.measure(renderer_, world_T_camera_, burst, millimeters_);
  pose_ = depth_pipeline::camera_pose({}, kCameraTilt, pitch);
  const auto& lens = sensor_.config().lens;
  return {lens.width, lens.height, millimeters_};
}

std::vector<float> DepthStage::nearest(const depth_pipeline::ScanGeometry& geometry) const {
  std::vector<float> ranges(geometry.count, std::numeric_limits<float>::infinity());
  const auto lens = camera();
  const double sine = std::sin(pose_.down), cosine = std::cos(pose_.down);
  for (int row = 0; row < lens.height; ++row) {
    for (int column = 0; column < lens.width; ++column) {
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width) +
                         static_cast<std::size_t>(column);
      const auto z = static_cast<double>(truth().depth[pixel]);
      const double y = (row - lens.cy) / lens.fy;
      const double height = pose_.height - z * (sine + y * cosine);
      if (z < sensor_.config().least || height < 0.05 || height > 1.95) continue;
      const double ahead = z * (cosine - y * sine) + pose_.forward - kScanOrigin;
      const double left = z * (lens.cx - column) / lens.fx;
      const double step = (std::atan2(left, ahead) - geometry.angle_min) / geometry.increment;
      if (step < 0.0 || step >= static_cast<double>(geometry.count)) continue;
      float& range = ranges[static_cast<std::size_t>(step)];
      range = std::min(range, static_cast<float>(std::hypot(ahead, left)));
    }
  }
  return ranges;
}

std::vector<cv::Point2d> DepthStage::laser(const geometry::Pose2& place) const {
  const world::LaserConfig config;
  world::Laser laser(config, seed_);
  std::vector<float> ranges;
  laser.scan(world_.scene(), world_.bodies(), base_at(place, 0.0), ranges);
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double bearing = config.angle_min + config.increment * static_cast<double>(i);
    const auto range = static_cast<double>(ranges[i]);
    if (!std::isfinite(range) || std::abs(bearing) > config.self_angle) continue;
    points.emplace_back(config.mount.x - kScanOrigin + range * std::cos(bearing),
                        range * std::sin(bearing));
  }
  return points;
}

std::optional<cv::Point2d> DepthStage::pixel(const Eigen::Vector3d& in_world) const {
  const Eigen::Vector3d point = geometry::inverse(world_T_camera_) * in_world;
  if (point.x() <= 0.0) return std::nullopt;
  const auto lens = camera();
  return cv::Point2d(lens.cx - lens.fx * point.y() / point.x(),
                     lens.cy - lens.fy * point.z() / point.x());
}

}  // namespace usher::operations
