#include "sensing/depth_pipeline/shell/parameters.hpp"

#include "wire/low_scan.hpp"

namespace usher::depth_pipeline {

PipelineConfig read_pipeline(runtime::Parameters& p) {
  PipelineConfig c;
  c.floor.floor_margin = p.number("floor_margin", "m", {0, 0.5}, c.floor.floor_margin,
                                  "What is lower than this counts as floor.");
  c.floor.angle_margin = p.number("angle_margin", "rad", {0, 0.1}, c.floor.angle_margin,
                                  "And this more for each metre of distance: error of the pitch.");
  c.floor.ceiling = p.number("ceiling", "m", {0.3, 4}, c.floor.ceiling,
                             "What is higher is nothing to the robot.");
  c.floor.low_height = p.number("low_height", "m", {0, 2}, c.floor.low_height,
                                "What is lower leaves the image near the robot: see scan/low.");
  c.floor.drop_depth = p.number("drop_depth", "m", {0.02, 1}, c.floor.drop_depth,
                                "Deeper below the floor than this is a drop.");
  c.floor.drop_range = p.number("drop_range", "m", {0, 6}, c.floor.drop_range,
                                "How far drops are looked for; 0 = nowhere.");
  c.refitted.ceiling = c.floor.ceiling;
  c.refitted.low_height = c.floor.low_height;
  c.refitted.drop_depth = c.floor.drop_depth;
  c.refitted.drop_range = c.floor.drop_range;
  c.refit = p.flag("refit", c.refit, "Fits the floor in every frame; then flat things are found.");
  c.refitted.floor_margin = p.number("refit_margin", "m", {0.001, 0.1}, c.refitted.floor_margin,
                                     "What is lower than this over a fitted floor is floor.");
  c.min_depth = p.number("min_depth", "m", {0.05, 2}, c.min_depth, "Nearer pixels are noise.");
  c.max_depth = p.number("max_depth", "m", {1, 16}, c.max_depth, "Farther pixels are background.");
  c.max_range =
      p.number("max_range", "m", {0.5, 16}, c.max_range, "Farther obstacles are not in the scan.");
  c.opening = p.flag("opening", c.opening, "Erodes and dilates by 3 x 3 first: fills holes.");
  c.missing_is_drop = p.flag("missing_is_drop", c.missing_is_drop,
                             "Floor that measures nothing counts as missing, in columns that "
                             "measure something.");
  c.drop_length = p.number("drop_length", "m", {0.05, 2}, c.drop_length,
                           "So much floor must be missing along a column.");
  c.drop_width =
      p.number("drop_width", "m", {0, 2}, c.drop_width, "So much floor must be missing across.");
  c.grazing_drop_width =
      p.number("grazing_drop_width", "m", {0, 2}, c.grazing_drop_width,
               "The same where the floor is looked at flatter than 62 deg: vinyl mirrors there.");
  c.confidence_frames = static_cast<int>(
      p.integer("confidence_frames", "-", {1, 8}, c.confidence_frames, "Of the rolling mean."));
  c.confidence_threshold =
      p.number("confidence_threshold", "m", {0.01, 10}, c.confidence_threshold,
               "Deviation from the mean that has no confidence (equation 4.23).");
  c.least_confidence = p.number("least_confidence", "-", {0, 1}, c.least_confidence,
                                "Ranges with less are left out.");
  c.lasting_confidence = p.number("lasting_confidence", "-", {0, 1}, c.lasting_confidence,
                                  "The same of low things, which the costmap remembers.");
  c.low_from = wire::read_kinect_blind_range(p);
  c.least_measured = p.number("least_measured", "-", {0, 1}, c.least_measured,
                              "A camera that measures in a smaller share of its pixels is blind.");
  return c;
}

runtime::HealthState read_without_kinect(runtime::Parameters& p) {
  const bool needed = p.flag("kinect_needed", false,
                             "Without the Kinect's scans it is not able to work, and a robot whose "
                             "manifest says `criticality: stop` of it stands: before stairs.");
  return needed ? runtime::HealthState::kStarting : runtime::HealthState::kDegraded;
}

double read_axle(runtime::Parameters& p) {
  return p.number("robot.wheel_radius", "m", {0.05, 0.5},
                  "Of the driven wheels; also the axle's height.");
}

Mount read_kinect_mount(runtime::Parameters& p, double axle) {
  Mount mount;
  mount.x = p.number("robot.kinect.mount_x", "m", {-1, 1}, "Kinect ahead of the axle's middle.");
  mount.z = p.number("robot.kinect.mount_z", "m", {0, 3}, "Kinect above the axle's middle.");
  mount.axle = axle;
  return mount;
}

double read_kinect_mount_slope(runtime::Parameters& p) {
  return p.number("robot.kinect.mount_z_per_angle", "-", {-0.3, 0.3}, 0.0,
                  "Metres that the Kinect rises for each radian that it looks up.");
}

RearMount read_rear_mount(runtime::Parameters& p, double axle) {
  RearMount rear;
  rear.mount.x = p.number("robot.rear_camera.mount_x", "m", {-1, 1}, -0.2,
                          "Rear camera ahead of the axle's middle; negative is behind.");
  rear.mount.z = p.number("robot.rear_camera.mount_z", "m", {0, 3}, 0.9,
                          "Rear camera above the axle's middle.");
  rear.mount.axle = axle;
  rear.mount.backward = true;
  rear.fitted =
      p.flag("robot.rear_camera.fitted", rear.fitted, "Whether the robot has a rear camera.");
  rear.angle = p.number("robot.rear_camera.angle", "rad", {-0.6, 0.6}, -0.26,
                        "Of the rear camera on the body, positive up.");
  return rear;
}

}  // namespace usher::depth_pipeline
