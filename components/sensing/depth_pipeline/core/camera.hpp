#pragma once

#include "foundation/imaging/depth_image.hpp"

namespace usher::depth_pipeline {

using imaging::DepthImage;
using imaging::Intrinsics;

/// Where a camera sits on the body (thesis 4.2): on base_link, whose origin is the middle of the
/// axle and leans with the body.
struct Mount {
  double x = 0.20;        ///< [m] {-1..1} ahead of the axle; behind for a camera that looks back
  double z = 0.665;       ///< [m] {0..3} above the axle
  double axle = 0.235;    ///< [m] {0..1} height of the axle
  bool backward = false;  ///< looks against the direction of travel
};

/// The camera over the floor at one time.
struct CameraPose {
  double height = 0.9;   ///< [m] above the floor
  double forward = 0.2;  ///< [m] ahead of the axle, in the camera's own direction
  double down = 0.0;     ///< [rad] of the optical axis below the horizon
  double roll = 0.0;     ///< [rad] positive: the image's right side is lower
};

/// Equations 4.2 and 4.3. `angle` [rad] is the camera's on the body, positive up; `pitch` [rad] is
/// the body's, positive forward.
CameraPose camera_pose(const Mount& mount, double angle, double pitch);

}  // namespace usher::depth_pipeline
