#pragma once

#include "foundation/geometry/pose3.hpp"
#include "perception/face_detector/core/depth_model.hpp"

namespace usher::face_detector {

/// Where a face is, seen from the robot.
struct Place {
  double range = 0.0;      ///< [m] along the floor
  double bearing = 0.0;    ///< [rad] {-pi..pi, positive left}
  double elevation = 0.0;  ///< [m] above the floor
};

/// The middle of a box at a depth [m]; base_T_camera is that of the optical frame (x right, y down,
/// z forward).
Place place_of(const Box& box, double depth, const imaging::Intrinsics& intrinsics,
               const geometry::Pose3& base_T_camera);

/// base_T_camera of a camera on a fixed mount that looks ahead: its place in base_footprint [m] and
/// how far it looks up [rad].
geometry::Pose3 fixed_camera(double forward, double height, double up);

}  // namespace usher::face_detector
