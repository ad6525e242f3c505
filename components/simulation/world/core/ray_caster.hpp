#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose3.hpp"
#include "simulation/world/core/scene.hpp"

namespace usher::world {

/// Beams in one plane at equal angles; the widest fan is shorter than a full turn.
class Fan {
 public:
  /// Angles in [rad] about the sensor's z axis, the first and the step; `count` at least 1.
  Fan(double angle_min, double increment, int count);

  int count() const { return static_cast<int>(cos_.size()); }
  double angle_min() const { return angle_min_; }
  double increment() const { return increment_; }
  double angle(int beam) const { return angle_min_ + beam * increment_; }
  std::span<const float> cosines() const { return cos_; }
  std::span<const float> sines() const { return sin_; }

 private:
  double angle_min_;
  double increment_;
  std::vector<float> cos_;
  std::vector<float> sin_;
};

/// What a beam hit, beside an index into Scene::things(). The index of mover k is things().size() +
/// k.
inline constexpr std::int32_t kNothing = -1;
inline constexpr std::int32_t kFloor = -2;
inline constexpr std::int32_t kCeiling = -3;

/// The nearest surface along each beam of a fan.
struct FanHits {
  std::vector<float> range;        ///< [m] along the beam; the maximum range when there is none
  std::vector<std::int32_t> what;  ///< thing, mover, kFloor, kCeiling or kNothing
};

struct RayOptions {
  double max_range = 20.0;  ///< [m] at most 60
  /// Empty: glass is as solid as a wall. Else one flag a beam: glass is invisible, but a beam whose
  /// flag is set sees it where it meets it nearly at a right angle (cosine above glass_cosine).
  std::span<const std::uint8_t> glass_flags = {};
  double glass_cosine = 0.98;
};

/// Casts fans through a scene. Not a ray at a time: the fan's plane is mapped so that the beams of
/// a leaning sensor lie at equal angles again, and every piece of wall is written into the beams
/// that it spans, near cells of the scene first; cells that lie behind what was already hit are
/// passed over. Exact for every beam, walls, prisms, discs, floor and ceiling; about 10 us for 541
/// beams in an office (usher bench world). A depth image is a fan a row.
class RayCaster {
 public:
  /// `world_T_sensor`: x axis along beam angle 0; the fan's plane may lean in any direction but not
  /// stand upright (its normal at least 5 deg above the horizon). A sensor inside a solid does not
  /// see that solid.
  void cast(const Scene& scene, const Fan& fan, const geometry::Pose3& world_T_sensor,
            const RayOptions& options, std::span<const Mover> movers, FanHits& hits);

 private:
  struct Interval {
    int first, last;  // beams, inclusive; empty when first > last
  };
  struct Intervals {
    Interval part[2];  // the second when the shape spans the back of the circle
  };

  Intervals beams_between(float low, float high) const;
  Intervals beams_around(const Eigen::Vector2f& center, float radius) const;
  bool hidden(const Intervals& beams, float distance) const;
  void refresh(const Intervals& beams);
  void cast_background(const Scene& scene);
  void cast_prisms(const Scene& scene, std::span<const Mover> movers);
  void cast_outline(const Thing& thing, std::int32_t id, const Eigen::Vector2f& center);
  void cast_disc(const Point2& center, double radius, double bottom, double top, bool glass,
                 std::int32_t id, const Intervals& beams);
  void cast_walls(const Scene& scene);
  void cast_piece(const Scene::Piece& piece);
  void offer(int beam, float enter, float leave, float bottom, float top, std::int32_t id);
  bool passes_glass(int beam, float cosine) const;

  // Of the cast that runs.
  const Fan* fan_ = nullptr;
  const RayOptions* options_ = nullptr;
  FanHits* hits_ = nullptr;
  Eigen::Vector3f origin_;
  Eigen::Matrix2f plane_;        // beam coordinates (t cos, t sin) to world x, y
  Eigen::Matrix2f unplane_;      // and back
  float stretch_ = 1.0f;         // largest factor of unplane_
  float slope_x_ = 0.0f;         // rise of the beam at angle 0
  float slope_y_ = 0.0f;         // and at +90 degrees
  std::vector<float> farthest_;  // over each block of beams
};

}  // namespace usher::world
