#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "control/interaction_control/core/companion.hpp"
#include "control/interaction_control/core/eyes.hpp"
#include "control/interaction_control/core/pose_motion.hpp"
#include "control/interaction_control/core/zones.hpp"

namespace usher::interaction_control {

/// What the robot is about, as far as its pose depends on it.
enum class Occasion : std::uint8_t {
  kHold,      ///< it may not pose: the torso holds still
  kDrive,     ///< it drives: the torso goes to rest
  kInteract,  ///< it poses for whom it talks to
};

/// How joints and eyes answer to where a person is (the thesis, section 6.2 and figures 7.4, 7.5).
class Posing {
 public:
  struct Parameters {
    std::string rest;         ///< zone whose pose is taken for nobody; empty = the last one stays
    double rest_after = 4.0;  ///< [s] {>= 0} without anybody in a zone
    double margin = 0.4;      ///< [m] another person must be nearer by so much
    PoseMotion::Parameters motion;
    Eyes::Parameters eyes;
  };
  struct Moment {
    Occasion occasion = Occasion::kHold;
    std::span<const Sighting> people;            ///< who is seen now
    std::optional<kinematics::TorsoPose> torso;  ///< measured; nothing: it does not obey
    bool listens = false;                        ///< it holds still so that it hears
    double level = 0.0;                          ///< {0..1} of the robot's voice
  };

  Posing(const Parameters& parameters, Zones zones)
      : parameters_(parameters),
        zones_(std::move(zones)),
        companion_(parameters.margin),
        motion_(parameters.motion),
        eyes_(parameters.eyes) {}
  Posing(const Posing&) = delete;
  Posing& operator=(const Posing&) = delete;

  void step(const Moment& moment, double seconds);

  bool has_zones() const { return !zones_.empty(); }
  const std::optional<Sighting>& person() const { return person_; }
  const Zone* zone() const { return zone_; }  ///< that the person is in; null: none
  const Zone* pose() const { return pose_; }  ///< that the torso goes to or stands in; null: none
  /// The base shall turn to face the person.
  bool tracks() const { return zone_ != nullptr && zone_->tracking; }
  /// The torso has been told all the way to its pose.
  bool posed() const { return known_ && pose_ != nullptr && motion_.arrived(); }
  /// It has something to show: not without zones, nor while it is not known where the torso stands.
  bool shows() const { return known_ && has_zones(); }
  const kinematics::TorsoPose& joints() const { return motion_.pose(); }
  const Eyes& eyes() const { return eyes_; }

 private:
  const Zone* chosen(Occasion occasion) const;

  Parameters parameters_;
  Zones zones_;
  Companion companion_;
  PoseMotion motion_;
  Eyes eyes_;
  std::optional<Sighting> person_;
  const Zone* zone_ = nullptr;
  const Zone* pose_ = nullptr;
  double alone_ = 0.0;  ///< [s] nobody in a zone
  bool known_ = false;  ///< where the torso stands
};

}  // namespace usher::interaction_control
