#pragma once

#include <Eigen/Core>
#include <span>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/distance_field.hpp"
#include "localization/amcl/core/laser_beams.hpp"

namespace usher::amcl {

struct RefinementParameters {
  double sigma = 0.1;       ///< [m] how far a beam that belongs to the map ends from it
  double max_shift = 0.25;  ///< [m] a better pose farther away is not believed
  double max_turn = 0.15;   ///< [rad]
  int iterations = 8;

  bool operator==(const RefinementParameters&) const = default;
};

struct Refinement {
  geometry::Pose2 pose;   ///< the better pose, or the start
  bool accepted = false;  ///< whether the cost fell and the pose stayed within the bounds
};

/// Shifts a pose so that the beams end on the map's obstacles: a few Gauss-Newton steps on the
/// interpolated distance, each beam under the Geman-McClure kernel of width sigma (people and moved
/// furniture lose their pull), held to the start by `prior` (information matrix of the start, x, y
/// [m], yaw [rad]) where the scan says nothing, as along a corridor. O(iterations x beams).
Refinement refine(const grid::DistanceField& field, std::span<const Beam> beams,
                  const geometry::Pose2& start, const Eigen::Matrix3d& prior,
                  const RefinementParameters& parameters);

/// By how much [m] all beams of a scan should be longer to end on the obstacles, at a pose: what a
/// range finder's systematic error (and the half cell between a drawn wall's surface and its cell's
/// middle) looks like. One Gauss-Newton step under the same kernel, held to zero with the weight of
/// ten beams. O(beams).
double range_offset(const grid::DistanceField& field, std::span<const Beam> beams,
                    const geometry::Pose2& pose, double sigma);

}  // namespace usher::amcl
