#include "perception/face_detector/shell/component.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drawn_scene.hpp"
#include "runtime/testing/test_host.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"

namespace usher::face_detector {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr const char* kMount =
    "robot.kinect.mount_x: 0.0 m\nrobot.kinect.mount_z: 1.05 m\nrobot.wheel_radius: 0.1 m\n";
constexpr const char* kFrame = "kinect_depth_optical";
const imaging::Intrinsics kKinect{640, 480, 575.8, 575.8, 319.5, 239.5};

class FaceDetectorComponentTest : public testing::Test {
 protected:
  runtime::TestHost& host(const std::string& parameters = {}) {
    if (!host_) {
      host_ = std::make_unique<runtime::TestHost>(
          runtime::component_factory<FaceDetectorComponent>("face_detector"), kMount + parameters);
    }
    return *host_;
  }
  void send_info() {
    host().publish(topics::kKinectInfo, wire::to_message(host().now(), kFrame, kKinect));
  }
  void send_color(runtime::Time stamp) {
    sensor_msgs::msg::Image image;
    wire::to_color_message(stamp, kFrame, scene.kWidth, scene.rgb(), image);
    host().publish(topics::kKinectColor, image);
  }
  void send_depth(runtime::Time stamp) {
    sensor_msgs::msg::Image image;
    wire::to_message(stamp, kFrame, scene.depth(), image);
    host().publish(topics::kKinectDepth, image);
  }
  void send_pair() {
    const auto stamp = host().now();
    send_depth(stamp);
    send_color(stamp);
  }

  DrawnScene scene;

 private:
  std::unique_ptr<runtime::TestHost> host_;
};

TEST_F(FaceDetectorComponentTest, TellsEachPairsFacesWithRangeAndBearing) {
  scene.add_face(463, 240, 46, 2000);
  send_info();
  const auto stamp = host().now();
  send_pair();
  host().run_for(milliseconds(60));
  const auto faces = host().last(topics::kFaces);
  ASSERT_TRUE(faces);
  EXPECT_EQ(wire::from_message(faces->header().stamp()), stamp);
  EXPECT_EQ(faces->header().frame_id(), "base_footprint");
  EXPECT_EQ(faces->image_width(), 640U);
  ASSERT_EQ(faces->faces().size(), 1U);
  const auto& face = faces->faces()[0];
  EXPECT_NEAR(face.depth(), 2.0, 0.01);
  EXPECT_NEAR(face.range(), std::hypot(2.0, 0.5), 0.05);
  EXPECT_NEAR(face.bearing(), -std::atan(0.25), 0.03);
  EXPECT_NEAR(face.elevation(), 1.15, 0.06);
  EXPECT_GE(face.neighbors(), 3);
}

TEST_F(FaceDetectorComponentTest, SaysThatNobodyIsSeenToo) {
  send_info();
  send_pair();
  host().run_for(milliseconds(60));
  ASSERT_TRUE(host().last(topics::kFaces));
  EXPECT_TRUE(host().last(topics::kFaces)->faces().empty());
}

TEST_F(FaceDetectorComponentTest, TakesOnlyImagesOfOneMoment) {
  send_info();
  host().run_for(milliseconds(100));
  const auto now = host().now();
  send_depth(now - milliseconds(33));
  send_color(now);
  host().run_for(milliseconds(60));
  EXPECT_FALSE(host().last(topics::kFaces));
  send_depth(now);
  host().run_for(milliseconds(60));
  EXPECT_TRUE(host().last(topics::kFaces));
}

TEST_F(FaceDetectorComponentTest, KeepsToItsRate) {
  host("rate: 5 Hz\n");
  send_info();
  for (int i = 0; i < 60; ++i) {  // two seconds at 30 Hz
    send_pair();
    host().run_for(std::chrono::microseconds(33'333));
  }
  const auto count = host().written(topics::kFaces).size();
  EXPECT_GE(count, 9U);
  EXPECT_LE(count, 11U);
}

TEST_F(FaceDetectorComponentTest, SaysWhichImageIsMissing) {
  send_info();
  for (int i = 0; i < 10; ++i) {
    send_depth(host().now());
    host().run_for(milliseconds(100));
  }
  EXPECT_EQ(host().heartbeat().reason(), "no color image");
  for (int i = 0; i < 10; ++i) {
    send_color(host().now());
    host().run_for(milliseconds(100));
  }
  EXPECT_EQ(host().heartbeat().reason(), "no depth image");
  EXPECT_TRUE(host().written(topics::kFaces).empty());
}

TEST_F(FaceDetectorComponentTest, WithoutIntrinsicsItTellsNothing) {
  send_pair();
  host().run_for(milliseconds(60));
  EXPECT_FALSE(host().last(topics::kFaces));
  host().run_for(milliseconds(100));
  EXPECT_EQ(host().counter("pairs: rejected"), 1U);
  EXPECT_EQ(host().heartbeat().reason(), "no camera_info");
}

TEST_F(FaceDetectorComponentTest, RefusesImagesThatDoNotFitAndGoesOn) {
  send_info();
  const auto stamp = host().now();
  send_depth(stamp);
  sensor_msgs::msg::Image bad;
  wire::to_color_message(stamp, kFrame, 320, std::vector<std::uint8_t>(230'400), bad);
  host().publish(topics::kKinectColor, bad);
  host().run_for(milliseconds(150));
  EXPECT_EQ(host().counter("pairs: rejected"), 1U);
  EXPECT_THAT(host().heartbeat().reason(), HasSubstr("must have the size"));
  send_pair();
  host().run_for(milliseconds(60));
  EXPECT_TRUE(host().last(topics::kFaces));
}

TEST_F(FaceDetectorComponentTest, WhereTfTellsThePlaceItWaitsForIt) {
  host("mount: tf\n");
  send_info();
  send_pair();
  host().run_for(milliseconds(150));
  EXPECT_FALSE(host().last(topics::kFaces));
  EXPECT_THAT(host().heartbeat().reason(), HasSubstr("nobody knows where"));
  tf2_msgs::msg::TFMessage place;
  place.transforms().push_back(
      wire::transform(host().now(), "base_footprint", kFrame, fixed_camera(0.5, 1.3, 0.0)));
  host().publish(topics::kTf, place);
  scene.add_face(320, 240, 46, 2000);
  send_pair();
  host().run_for(milliseconds(60));
  ASSERT_TRUE(host().last(topics::kFaces));
  ASSERT_EQ(host().last(topics::kFaces)->faces().size(), 1U);
  EXPECT_NEAR(host().last(topics::kFaces)->faces()[0].range(), 2.5, 0.05);
}

TEST_F(FaceDetectorComponentTest, EndsWhereTheCascadeIsMissing) {
  const test::Folder empty;
  host("cascades: " + empty.path() + "\n");
  send_info();
  send_pair();
  host().run_for(milliseconds(60));
  EXPECT_FALSE(host().running());
  EXPECT_THAT(host().fault_reason(), HasSubstr("opencv-data"));
}

TEST_F(FaceDetectorComponentTest, RefusesAModelOnWhichLargerIsNotNearer) {
  const auto status = runtime::TestHost::try_make(
      runtime::component_factory<FaceDetectorComponent>("face_detector"),
      std::string(kMount) + "side_model: [0.5, 0.01, -2.0e-5, 16, 400]\n");
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error(), HasSubstr("larger faces must be nearer"));
}

}  // namespace
}  // namespace usher::face_detector
