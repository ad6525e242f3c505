#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/kinematics/torso.hpp"
#include "foundation/result/result.hpp"

namespace usher::interaction_control {

/// Where somebody is, seen from the robot (equation 6.1).
struct Polar {
  double range = 0.0;    ///< [m] {>= 0}
  double bearing = 0.0;  ///< [rad] {-pi..pi, positive left}
};

/// What the robot does for a person who stands there (the thesis, section 6.2).
struct Zone {
  std::string name;
  bool enabled = true;  ///< false: nobody enters it; its pose may still be the one of rest
  double range_min = 0.0, range_max = 0.0;      ///< [m]
  double bearing_min = 0.0, bearing_max = 0.0;  ///< [rad] counter-clockwise from min to max
  bool tracking = false;                        ///< the base turns to face the person
  bool voice = true;                            ///< the eyes follow the robot's voice
  kinematics::TorsoPose pose{};
  kinematics::EyeColor left_eye{}, right_eye{};

  /// Within its limits, moved outward by these margins (inward where they are negative).
  bool holds(const Polar& person, double range_margin = 0.0, double bearing_margin = 0.0) const;
};

/// "#20c040"; nothing for any other text.
std::optional<kinematics::EyeColor> color_from(std::string_view text);

/// Which zone a person is in: the first one that holds them, as listed. Whoever is in a zone leaves
/// it only beyond its border by the thresholds, and is called into one that is listed before it
/// only within that one's border by as much: a person on a border is in one zone all the time.
class Zones {
 public:
  struct Thresholds {
    double range = 0.15;    ///< [m] {>= 0}
    double bearing = 0.12;  ///< [rad] {>= 0}
  };

  Zones() = default;
  /// The error names the zone whose limits make no sense, whose pose no joint can take, or whose
  /// name is in use.
  static Result<Zones> make(std::vector<Zone> zones, const Thresholds& thresholds,
                            const kinematics::TorsoLimits& limits);

  bool empty() const { return zones_.empty(); }
  std::span<const Zone> all() const { return zones_; }  ///< as listed
  /// Null when there is none of this name.
  const Zone* find(std::string_view name) const;
  /// Some zone holds whoever is there.
  bool reaches(const Polar& person) const;

  /// The zone that the person is in now; null: outside of all of them, or nobody is there.
  const Zone* update(const std::optional<Polar>& person);

 private:
  const Zone* choose(const Polar& person) const;

  std::vector<Zone> zones_;
  Thresholds thresholds_;
  std::optional<std::size_t> current_;
};

}  // namespace usher::interaction_control
