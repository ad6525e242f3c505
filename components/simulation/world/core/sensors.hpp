#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/geometry/pose3.hpp"
#include "foundation/random/random.hpp"
#include "simulation/world/core/ray_caster.hpp"

namespace usher::world {

/// Where a sensor sits on base_link (origin: the middle of the axle; leans with the body).
struct Mount {
  double x = 0.0;      ///< [m] forward
  double y = 0.0;      ///< [m] left
  double z = 0.0;      ///< [m] up
  double yaw = 0.0;    ///< [rad]
  double pitch = 0.0;  ///< [rad] positive looks down

  geometry::Pose3 base_T_sensor() const {
    return {{x, y, z}, geometry::from_roll_pitch_yaw(0.0, pitch, yaw)};
  }
};

/// A scanning range finder; the defaults are MARVIN's SICK LMS100, its plane 0.30 m above the
/// floor.
struct LaserConfig {
  std::string name = "lms100";
  Mount mount{.x = 0.28, .z = 0.065};
  double angle_min = -0.75 * geometry::kPi;  ///< [rad]
  double increment = geometry::kPi / 360.0;  ///< [rad]
  int count = 541;                           ///< beams
  double range_max = 20.0;                   ///< [m] beyond: no return
  double statistical_error = 0.012;          ///< [m] standard deviation
  double relative_error = 0.0;               ///< the same as share of the range, where that is more
  double systematic_error = 0.030;           ///< [m] bound; drawn once for the device
  double step = 0.001;                       ///< [m] resolution of a range
  double glass_share = 0.1;   ///< of the beams that meet glass at nearly a right angle return
  double mixed_share = 0.02;  ///< of the beams at an edge return from between both surfaces
  double self_angle = 2.0;    ///< [rad] beams beyond this on either side hit the robot's own body
  double self_range = 0.25;   ///< [m] there
};

/// One scanner: ranges of one turn, all taken at the same instant.
class Laser {
 public:
  Laser(const LaserConfig& config, std::uint64_t seed);

  const LaserConfig& config() const { return config_; }
  /// Writes `count` ranges [m]: +infinity where nothing returns. No allocation after the first
  /// call.
  void scan(const Scene& scene, std::span<const Mover> movers, const geometry::Pose3& world_T_base,
            std::vector<float>& ranges);

 private:
  float mixed(std::size_t beam) const;

  LaserConfig config_;
  Fan fan_;
  Random random_;
  std::vector<float> noise_;         // [m] normal, picked at random
  std::vector<float> systematic_;    // [m] by range
  std::vector<float> self_;          // [m] own body by beam; 0: free view
  std::vector<std::uint64_t> bits_;  // drawn for each beam of a scan
  std::vector<std::uint8_t> glass_;  // beams that see glass
  RayCaster caster_;
  FanHits hits_;
};

/// A ring of narrow ultrasonic sensors; the defaults are MARVIN's five around the front of its
/// plate.
struct SonarConfig {
  int count = 5;
  double spacing = geometry::kPi / 6.0;   ///< [rad] between neighbours, the middle one looks ahead
  double ring_radius = 0.30;              ///< [m] from base_link's z axis
  double z = 0.12;                        ///< [m]
  double cone = geometry::radians(16.0);  ///< [rad] full width
  double range_min = 0.1524;              ///< [m] nearer things read this
  double range_max = 6.0;                 ///< [m]
  double step = 0.0254;                   ///< [m] resolution
  double noise = 0.008;                   ///< [m] standard deviation
  double max_incidence = geometry::radians(50.0);  ///< [rad] beyond, the sound is thrown away

  /// Of sensor i, counted from the right.
  Mount mount(int i) const;
};

/// Nearest echo in a cone, glass or not.
class Sonar {
 public:
  Sonar(const SonarConfig& config, std::uint64_t seed);

  const SonarConfig& config() const { return config_; }
  /// Writes `count` ranges [m] from right to left: +infinity where there is no echo.
  void measure(const Scene& scene, std::span<const Mover> movers,
               const geometry::Pose3& world_T_base, std::vector<float>& ranges);

 private:
  float nearest_echo() const;

  SonarConfig config_;
  Fan fan_;
  Random random_;
  RayCaster caster_;
  FanHits hits_;
};

/// Four straight whiskers at the corners of a rectangular footprint.
struct WhiskerConfig {
  double x = 0.33;                           ///< [m] of the roots, in front of and behind the axle
  double y = 0.35;                           ///< [m] of the roots, left and right
  double z = 0.15;                           ///< [m] above the floor
  double length = 0.4;                       ///< [m]
  double outward = geometry::radians(20.0);  ///< [rad] from straight ahead or back
  /// [rad] by which it must be bent, inward along a wall or outward against one, before its switch
  /// closes: brushing along a door frame 7 cm beside the robot must not stop it.
  double trigger_bend = geometry::radians(17.0);
};

/// Which whiskers are bent.
struct WhiskerContacts {
  bool front_left = false;
  bool front_right = false;
  bool back_left = false;
  bool back_right = false;
};

/// A whisker is bent while anything crosses it.
class Whiskers {
 public:
  explicit Whiskers(const WhiskerConfig& config) : config_(config), beam_(0.0, 0.1, 1) {}

  const WhiskerConfig& config() const { return config_; }
  WhiskerContacts touch(const Scene& scene, std::span<const Mover> movers, const Pose2& robot);

 private:
  WhiskerConfig config_;
  Fan beam_;
  RayCaster caster_;
  FanHits hits_;
};

}  // namespace usher::world
