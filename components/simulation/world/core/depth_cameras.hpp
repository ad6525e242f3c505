#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "simulation/rendering/core/depth_sensor.hpp"
#include "simulation/rendering/core/light.hpp"
#include "simulation/world/core/world.hpp"

namespace usher::world {

/// What stands still, for the rays of cameras: discs become polygons, occupied cells blocks.
rendering::Model model_of(const Scene& scene, const grid::OccupancyGrid* map);
/// The people as bodies, in the same order.
void bodies_of(std::span<const Person> people, std::vector<rendering::Body>& bodies);

/// Whether a point straight ahead is in the rows of an image.
/// @param forward [m] horizontally from the camera
/// @param rise [m] above it
/// @param down [rad] that the optical axis looks down
/// @param nearest [m] least depth
bool in_rows(const rendering::Lens& lens, double forward, double rise, double down, double nearest);

/// A depth camera on the body; the defaults are MARVIN's Kinect v2.
struct DepthCameraConfig {
  rendering::DepthSensorConfig sensor = rendering::kinect_v2();
  Mount mount{.x = 0.20, .z = 0.665};  ///< yaw 0 or pi; its pitch is what the servo turns from
  // What the tilt servo really does: angle = servo_gain * servo + servo_offset, positive up.
  double servo_gain = 1.0;
  double servo_offset = 0.0;  ///< [rad]
  double servo_speed = 1.0;   ///< [rad/s]
};

/// What an image that a camera takes at one moment depends on.
struct Exposure {
  geometry::Pose3 world_T_camera;  ///< x along the optical axis
  double burst = 0.0;              ///< {0..1} how much a jump of the pitch spoils it
};

/// One camera in a world: renders, adds the errors of the device, follows the tilt servo. A sudden
/// change of the pitch rate spoils images, as on the robot (thesis 4.21a). The color camera beside
/// it sees the same pixels.
class DepthCamera {
 public:
  DepthCamera(const DepthCameraConfig& config, std::uint64_t seed);

  const DepthCameraConfig& config() const { return config_; }
  /// Where the servo shall go [rad]; clipped to 20 deg, ignored when not finite.
  void set_tilt(double servo);
  double tilt() const { return servo_; }  ///< [rad] where the servo stands
  /// Advances by kStep: servo and body.
  void step(const BaseTruth& base);
  geometry::Pose3 pose(const World& world) const;  ///< in world, x along the optical axis
  double burst() const { return burst_; }          ///< {0..1} of the next image

  Exposure exposure(const World& world) const;  ///< now
  /// The image, in millimetres. Touches nothing that the others touch: it may be made beside them.
  void measure(const Exposure& exposure, rendering::Renderer& renderer,
               std::vector<std::uint16_t>& millimeters);
  /// What its color camera makes of the light at a place now.
  rendering::Gains gains(const World& world, const Point2& place) const;
  const rendering::Hits& truth() const { return sensor_.truth(); }

 private:
  DepthCameraConfig config_;
  rendering::DepthSensor sensor_;
  rendering::ColorCamera colors_;
  double wanted_ = 0.0;
  double servo_ = 0.0;
  std::optional<double> pitch_rate_;
  double burst_ = 0.0;
  std::uint64_t steps_ = 0;
};

/// The renderer of a world, kept up with its doors, things and people.
class WorldRenderer {
 public:
  /// What there is to see at one moment.
  struct Moment {
    std::optional<rendering::Model> scene;  ///< when it changed since the last look
    std::vector<rendering::Body> bodies;    ///< of the people
  };
  void look(const World& world, Moment& moment);
  /// Moments in the order of their looks; this may be done beside look().
  Status show(const Moment& moment);
  Status update(const World& world);  ///< both
  rendering::Renderer& renderer() { return *renderer_; }
  std::span<const rendering::Body> bodies() const { return moment_.bodies; }  ///< of update()

 private:
  std::optional<rendering::Renderer> renderer_;
  std::optional<std::uint64_t> version_;  ///< that was looked at last
  Moment moment_;
};

}  // namespace usher::world
