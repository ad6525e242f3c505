#pragma once

#include "runtime/api/host.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"

namespace usher::depth_pipeline {

/// The component's parameters, with their units, ranges and texts.
PipelineConfig read_pipeline(runtime::Parameters& parameters);
/// How the component is without the Kinect's scans.
runtime::HealthState read_without_kinect(runtime::Parameters& parameters);
/// [m] of the axle above the floor.
double read_axle(runtime::Parameters& parameters);
Mount read_kinect_mount(runtime::Parameters& parameters, double axle);
/// [m per rad] how much higher the camera sits for each radian that it looks up (the servo's axis
/// is not in its focal point).
double read_kinect_mount_slope(runtime::Parameters& parameters);

struct RearMount {
  Mount mount;
  double angle = 0.0;  ///< [rad] on the body, positive up
  bool fitted = true;  ///< else its silence is nobody's trouble
};
RearMount read_rear_mount(runtime::Parameters& parameters, double axle);

}  // namespace usher::depth_pipeline
