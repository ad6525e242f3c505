#pragma once

#include <span>
#include <vector>

#include "foundation/geometry/pose3.hpp"
#include "perception/people_detector/core/depth_detector.hpp"
#include "perception/people_detector/core/tracker.hpp"

namespace usher::people_detector {

/// A camera over the floor.
struct PlacedCamera {
  View view;
  geometry::Pose2 base_T_foot;  ///< below the camera, x axis where it looks
};

/// From base_footprint_T_optical (x right, y down, z forward in the image). What looks straight up
/// or down has no direction: its `down` is beyond what DepthDetector takes.
PlacedCamera place_camera(const geometry::Pose3& base_T_optical);

/// How exact sightings of a camera are.
struct SightingErrors {
  double along = 0.05;          ///< [m] {0.01..0.5} standard deviation along the line of sight
  double along_growth = 0.01;   ///< [-] {0..0.2} and this more for each metre of distance
  double across = 0.05;         ///< [m] {0.01..0.5} beside it
  double across_growth = 0.01;  ///< [-] {0..0.2}
};

/// Sightings as observations in odom; `observations` is cleared first. Whoever is close behind
/// another one has neither height nor colors: they may be the other's.
void place_sightings(std::span<const Sighting> sightings, const geometry::Pose2& odom_T_foot,
                     const SightingErrors& errors, std::vector<Observation>& observations);

}  // namespace usher::people_detector
