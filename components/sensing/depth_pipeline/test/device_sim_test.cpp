#include "sensing/depth_pipeline/device_sim/component.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/testing/test_host.hpp"
#include "sensing/depth_pipeline/shell/component.hpp"
#include "sensing/depth_pipeline/test/synthetic.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"

namespace usher::depth_pipeline {
namespace {

using runtime::TestHost;
using std::chrono::milliseconds;
using testing::HasSubstr;

class DepthPipelineSim : public testing::Test {
 protected:
  DepthPipelineSim() {
    scan.angle_min(-0.5F);
    scan.angle_max(0.5F);
    scan.angle_increment(0.5F);
    scan.range_min(0.05F);
    scan.range_max(5.0F);
    scan.ranges({1.0F, 2.0F, 3.0F});
  }
  std::string reason() { return host.heartbeat().reason(); }

  TestHost host{runtime::component_factory<DepthPipelineSimComponent>("depth_pipeline_sim"),
                "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m, "
                "robot.wheel_radius: 0.235 m, robot.rear_camera.fitted: false}"};
  sensor_msgs::msg::LaserScan scan;
};

TEST_F(DepthPipelineSim, RatesAndPassesTheModelsScans) {
  for (int i = 0; i < 4; ++i) {
    scan.header(wire::header(host.now(), "kinect_level"));
    if (i == 3) scan.ranges({1.0F, 0.6F, 3.0F});
    host.publish(topics::kSimKinectScan, scan);
    host.run_for(milliseconds(33));
  }
  const auto passed = host.last(topics::kKinectScan).value();
  EXPECT_EQ(passed.ranges()[0], 1.0F);
  EXPECT_TRUE(std::isnan(passed.ranges()[1]));  // appeared for one frame
  EXPECT_EQ(passed.intensities()[2], 1.0F);
  scan.angle_increment(0.0F);
  host.publish(topics::kSimKinectScan, scan);
  host.run_for(milliseconds(1100));
  EXPECT_EQ(host.counter("scans: rejected"), 1U);
}

TEST_F(DepthPipelineSim, ForgetsItsScansOverAGap) {
  for (int i = 0; i < 4; ++i) {
    scan.header(wire::header(host.now(), "kinect_level"));
    host.publish(topics::kSimKinectScan, scan);
    host.run_for(milliseconds(i == 2 ? 400 : 33));
  }
  EXPECT_TRUE(std::isnan(host.last(topics::kKinectScan)->ranges()[0]));
}

TEST_F(DepthPipelineSim, TellsTheTimeBetweenTheScansOfEachCamera) {
  scan.header(wire::header(host.now(), "level"));
  host.publish(topics::kSimKinectScan, scan);
  host.publish(topics::kSimRearScan, scan);
  host.run_for(milliseconds(20));
  EXPECT_FLOAT_EQ(host.last(topics::kKinectScan).value().scan_time(), 1.0F / 30.0F);
  EXPECT_FLOAT_EQ(host.last(topics::kRearScan).value().scan_time(), 1.0F / 15.0F);
}

TEST_F(DepthPipelineSim, RemembersNothingLowThatStandsElsewhereInEachScan) {
  for (int i = 0; i < 6; ++i) {
    scan.header(wire::header(host.now(), "kinect_level"));
    scan.ranges({1.0F, i % 2 == 0 ? 2.0F : 2.45F, -3.0F});
    host.publish(topics::kSimKinectScan, scan);
    host.publish(topics::kSimKinectScanLow, scan);
    host.run_for(milliseconds(33));
  }
  EXPECT_FALSE(std::isnan(host.last(topics::kKinectScan)->ranges()[1]));
  const auto low = host.last(topics::kKinectScanLow).value();
  EXPECT_EQ(low.ranges()[0], 1.0F);
  EXPECT_TRUE(std::isnan(low.ranges()[1]));
  EXPECT_EQ(low.ranges()[2], -3.0F) << "nothing low up to there";
}

TEST(FittedRearCamera, IsMissedFromTheStart) {
  for (const bool simulated : {false, true}) {
    SCOPED_TRACE(simulated);
    constexpr const char* kFitted =
        "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m, robot.wheel_radius: 0.235 m}";
    TestHost host(simulated
                      ? runtime::component_factory<DepthPipelineSimComponent>("depth_pipeline_sim")
                      : runtime::component_factory<DepthPipelineComponent>("depth_pipeline"),
                  kFitted);
    SyntheticScene scene;
    sensor_msgs::msg::LaserScan scan;
    scan.angle_increment(0.5F);
    scan.angle_max(0.5F);
    scan.range_max(5.0F);
    scan.ranges({1.0F, 2.0F});
    auto depth = scene.draw(camera_pose({}, -0.0873, 0.0));
    host.publish(topics::kKinectInfo,
                 wire::to_message(host.now(), "kinect_depth_optical", scene.camera));
    for (int i = 0; i < 100; ++i) {
      usher_msgs::msg::BaseStatus status;
      status.header(wire::header(host.now(), "base_link"));
      status.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
      host.publish(topics::kBaseStatus, status);
      if (i % 5 == 0) {
        usher_msgs::msg::CameraTilt tilt;
        tilt.header(wire::header(host.now(), "base_link"));
        tilt.servo(-0.0873);
        host.publish(topics::kKinectTilt, tilt);
      }
      if (i % 3 == 0) {
        scan.header(wire::header(host.now(), "level"));
        host.publish(topics::kSimKinectScan, scan);
        sensor_msgs::msg::Image image;
        ++depth.back();
        wire::to_message(host.now(), "kinect_depth_optical", view_of(scene.camera, depth), image);
        host.publish(topics::kKinectDepth, image);
      }
      host.run_for(milliseconds(10));
    }
    EXPECT_THAT(host.heartbeat().reason(), HasSubstr("rear camera: no depth"));
  }
}

TEST_F(DepthPipelineSim, HealthIsThatOfBothCameras) {
  const auto live = [&](bool front, bool rear) {
    for (int i = 0; i < 10; ++i) {
      scan.header(wire::header(host.now(), "level"));
      if (front) host.publish(topics::kSimKinectScan, scan);
      if (rear) host.publish(topics::kSimRearScan, scan);
      host.run_for(milliseconds(66));
    }
  };
  live(true, false);
  EXPECT_EQ(reason(), "") << "there was no rear camera";
  live(true, true);
  EXPECT_EQ(reason(), "");
  live(true, false);
  EXPECT_EQ(reason(), "rear camera: no depth scan");
  live(true, true);
  EXPECT_EQ(reason(), "");
  live(false, true);
  EXPECT_EQ(reason(), "no depth scan");
  live(true, true);
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace usher::depth_pipeline
