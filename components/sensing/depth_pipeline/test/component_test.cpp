#include "sensing/depth_pipeline/shell/component.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/testing/test_host.hpp"
#include "sensing/depth_pipeline/test/synthetic.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"
#include "wire/low_scan.hpp"

namespace usher::depth_pipeline {
namespace {

using runtime::TestHost;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr const char* kParameters =
    "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m, robot.wheel_radius: 0.235 m, "
    "robot.rear_camera.fitted: false, confidence_frames: 1}";

/// Images are written only for who reads them.
class Viewer final : public runtime::Component {
 public:
  explicit Viewer(runtime::Host& host)
      : input_(host.input(topics::kKinectProcessed, {.optional = true},
                          [](const auto&, const auto&) {})),
        rear_(host.input(topics::kRearProcessed, {.optional = true},
                         [](const auto&, const auto&) {})) {}

 private:
  runtime::Input<sensor_msgs::msg::Image> input_, rear_;
};

class DepthPipelineComponentTest : public testing::Test {
 protected:
  explicit DepthPipelineComponentTest(const std::string& parameters = kParameters)
      : host_(runtime::component_factory<DepthPipelineComponent>("depth_pipeline"), parameters) {
    scene_.boxes = {{-0.3, 0.3, 0.6, 2.0, 2.4}};
  }

  /// Time passes with the base, the servo and, when asked, the camera alive.
  void live(int milliseconds_count, double pitch = 0.0) {
    for (int i = 0; i < milliseconds_count; i += 10, elapsed_ += 10) {
      if (with_pitch_) {
        usher_msgs::msg::BaseStatus status;
        status.header(wire::header(host_.now(), "base_link"));
        status.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
        status.pitch(pitch);
        host_.publish(topics::kBaseStatus, status);
      }
      if (with_tilt_ && elapsed_ % 50 == 0) {
        if (swinging_) servo_ = -servo_;
        usher_msgs::msg::CameraTilt tilt;
        tilt.header(wire::header(host_.now(), "base_link"));
        tilt.servo(servo_);
        host_.publish(topics::kKinectTilt, tilt);
      }
      host_.run_for(milliseconds(10));
    }
  }
  void tell_camera() {
    host_.publish(topics::kKinectInfo,
                  wire::to_message(host_.now(), "kinect_depth_optical", scene_.camera));
  }
  void show(double pitch = 0.0, milliseconds age = {}) {
    auto depth = scene_.draw(camera_pose({}, servo_, pitch));
    depth.back() = ++shown_;  // noise: no two images are the same
    sensor_msgs::msg::Image image;
    wire::to_message(host_.now() - age, "kinect_depth_optical", view_of(scene_.camera, depth),
                     image);
    host_.publish(topics::kKinectDepth, image);
  }
  /// Both cameras at their rates, each with one image again and again, but for the noise of a pixel
  /// while they are not frozen; all of it 0 where they are blind.
  void stream(int milliseconds_count, bool rear = false) {
    sensor_msgs::msg::Image image;
    auto depth = scene_.draw(camera_pose({}, -0.0873, 0.0));
    if (blind_) std::fill(depth.begin(), depth.end(), std::uint16_t{0});
    for (int i = 0; i < milliseconds_count; i += 30) {
      if (!frozen_ && !blind_) ++depth.back();
      wire::to_message(host_.now() + images_ahead_, "kinect_depth_optical",
                       view_of(scene_.camera, depth), image);
      host_.publish(topics::kKinectDepth, image);
      if (rear && i % 60 == 0) {
        image.encoding(rear_encoding_);
        host_.publish(topics::kRearDepth, image);
      }
      live(30);
    }
  }
  void order(double servo) {
    usher_msgs::msg::CameraTilt request;
    request.servo(servo);
    host_.publish(topics::kKinectTiltRequest, request);
  }
  std::string reason() { return host_.heartbeat().reason(); }
  std::size_t left() { return host_.written(topics::kKinectScan).size(); }

  TestHost host_;
  SyntheticScene scene_;
  double servo_ = -0.0873;
  bool with_pitch_ = true, with_tilt_ = true, swinging_ = false, blind_ = false, frozen_ = false;
  milliseconds images_ahead_{};
  std::string rear_encoding_ = "16UC1";
  int elapsed_ = 0;  // [ms]
  std::uint16_t shown_ = 0;
};

class FittingDepthPipelineTest : public DepthPipelineComponentTest {
 protected:
  FittingDepthPipelineTest()
      : DepthPipelineComponentTest(std::string(kParameters).insert(1, "refit: true, ")) {}
};

/// Of three frames, as by default.
class NeededKinectTest : public DepthPipelineComponentTest {
 protected:
  NeededKinectTest()
      : DepthPipelineComponentTest(std::string(kParameters).insert(1, "kinect_needed: true, ")) {}
};

class RatingDepthPipelineTest : public DepthPipelineComponentTest {
 protected:
  RatingDepthPipelineTest()
      : DepthPipelineComponentTest(
            "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m, robot.wheel_radius: "
            "0.235 m, robot.rear_camera.fitted: false}") {
    tell_camera();
    live(100);
    stream(300);
  }
};

float ahead(const sensor_msgs::msg::LaserScan& scan) {
  return scan.ranges()[static_cast<std::size_t>(-scan.angle_min() / scan.angle_increment())];
}

TEST_F(FittingDepthPipelineTest, KnowsTheNoiseOfTheRearCamerasFloor) {
  ASSERT_TRUE(host_.world().add(runtime::component_factory<Viewer>("viewer"),
                                runtime::test_parameters("viewer", "{}").value()));
  scene_.boxes.clear();
  scene_.half_width = scene_.end = 30.0;
  scene_.noise = 0.0025;
  host_.publish(topics::kRearInfo,
                wire::to_message(host_.now(), "rear_camera_depth_optical", scene_.camera));
  tell_camera();
  live(100);
  const auto depth = scene_.draw({.height = 1.135, .forward = 0.2, .down = 0.2618});
  sensor_msgs::msg::Image image;
  wire::to_message(host_.now(), "rear_camera_depth_optical", view_of(scene_.camera, depth), image);
  host_.publish(topics::kRearDepth, image);
  live(30);
  const auto processed = host_.last(topics::kRearProcessed);
  ASSERT_TRUE(processed);
  const auto bytes = std::count_if(processed->data().begin(), processed->data().end(),
                                   [](std::uint8_t byte) { return byte != 0; });
  EXPECT_LT(bytes, 8000) << "of 434,176: obstacles on an empty floor";
}

TEST_F(DepthPipelineComponentTest, MakesScansImagesAndFramesOfImages) {
  ASSERT_TRUE(host_.world().add(runtime::component_factory<Viewer>("viewer"),
                                runtime::test_parameters("viewer", "{}").value()));
  tell_camera();
  live(100, 0.05);
  show(0.05);
  live(120, 0.05);
  const auto scan = host_.last(topics::kKinectScan);
  ASSERT_TRUE(scan.has_value());
  EXPECT_EQ(scan->header().frame_id(), "kinect_level");
  const double moved = camera_pose({}, -0.0873, 0.05).forward - 0.2;
  EXPECT_NEAR(ahead(*scan), 2.0 + moved, 0.03);
  EXPECT_EQ(scan->intensities().size(), scan->ranges().size());
  ASSERT_TRUE(host_.last(topics::kKinectScanLow).has_value());
  const auto frames = host_.last(topics::kTf);
  ASSERT_TRUE(frames.has_value());
  const auto& place = frames->transforms()[0];
  EXPECT_EQ(place.child_frame_id(), "kinect_depth_optical");
  const auto pose = wire::from_message(place.transform()).value();
  // What is 2 m along the optical axis lies ahead and below.
  const Eigen::Vector3d point = pose * Eigen::Vector3d(0.0, 0.0, 2.0);
  const CameraPose camera = camera_pose({}, -0.0873, 0.05);
  EXPECT_NEAR(point.z(), camera.height - 2.0 * std::sin(camera.down), 1e-6);
  EXPECT_NEAR(point.x(), camera.forward + 2.0 * std::cos(camera.down), 1e-6);
  EXPECT_NEAR((pose * Eigen::Vector3d(1.0, 0.0, 0.0)).y(), -1.0, 1e-6);
  const auto processed = host_.last(topics::kKinectProcessed);
  ASSERT_TRUE(processed.has_value());
  EXPECT_EQ(processed->encoding(), "16UC1");
  EXPECT_EQ(host_.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
}

TEST_F(DepthPipelineComponentTest, MarksWhereFloorIsMissing) {
  scene_.half_width = scene_.end = 30.0;
  scene_.ceiling = 3.0;
  scene_.boxes = {{0.5, 0.9, 0.3, 1.8, 2.0}};  // x is right: -0.35 rad
  scene_.edge = 2.4;
  tell_camera();
  live(100);
  show();
  live(120);
  const auto low = host_.last(topics::kKinectScanLow);
  ASSERT_TRUE(low.has_value());
  const auto at = [&](double bearing) {
    return static_cast<std::size_t>((bearing - static_cast<double>(low->angle_min())) /
                                    static_cast<double>(low->angle_increment()));
  };
  EXPECT_NEAR(low->ranges()[at(0.1)], 2.4, 0.1);
  EXPECT_TRUE(wire::is_drop(*low, at(0.1)));
  EXPECT_NEAR(low->ranges()[at(-0.35)], 1.8 / std::cos(0.35), 0.1);
  EXPECT_FALSE(wire::is_drop(*low, at(-0.35)));
  EXPECT_EQ(low->intensities()[at(-0.35)], 1.0F) << "its confidence";
  const auto scan = host_.last(topics::kKinectScan);
  ASSERT_TRUE(scan.has_value());
  EXPECT_EQ(scan->intensities()[at(0.1)], 1.0F) << "in the scan of everything, too";
}

TEST_F(DepthPipelineComponentTest, WaitsForThePitchOfTheImage) {
  tell_camera();
  live(100);
  with_pitch_ = false;
  live(30);
  show();  // the newest pitch is older than what may be extrapolated
  live(10);
  EXPECT_TRUE(host_.written(topics::kKinectScan).empty());
  with_pitch_ = true;
  live(20);
  EXPECT_EQ(host_.written(topics::kKinectScan).size(), 1U);
}

TEST_F(RatingDepthPipelineTest, ForgetsItsFramesOverAGap) {
  EXPECT_NEAR(ahead(*host_.last(topics::kKinectScan)), 2.0, 0.03);
  live(200);
  show();
  live(30);
  EXPECT_NEAR(ahead(*host_.last(topics::kKinectScan)), 2.0, 0.03) << "a few are missing";
  live(400);
  show();
  live(30);
  EXPECT_TRUE(std::isnan(ahead(*host_.last(topics::kKinectScan)))) << "confirmed by old ones";
  show();
  live(30);
  EXPECT_NEAR(ahead(*host_.last(topics::kKinectScan)), 2.0, 0.03);
}

TEST_F(RatingDepthPipelineTest, ForgetsItsFramesOverATurnOfTheCamera) {
  host_.clear();
  servo_ = -0.05;
  live(150);
  show();
  live(30);
  ASSERT_TRUE(host_.last(topics::kKinectScan));
  EXPECT_TRUE(std::isnan(ahead(*host_.last(topics::kKinectScan)))) << "confirmed by another view";
  show();
  live(30);
  EXPECT_NEAR(ahead(*host_.last(topics::kKinectScan)), 2.0, 0.03);
}

TEST_F(DepthPipelineComponentTest, SaysWhenTheCameraIsSilent) {
  tell_camera();
  live(100);
  show();
  live(120);
  EXPECT_EQ(host_.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
  live(600);
  EXPECT_EQ(reason(), "Kinect: no depth image");
}

TEST_F(DepthPipelineComponentTest, KnowsNoTiltBeforeTheServoWasHeard) {
  with_tilt_ = false;  // a restart, and the servo stands at -5 deg
  tell_camera();
  live(100);
  stream(600);
  EXPECT_EQ(left(), 0U);
  EXPECT_GE(host_.counter("images: without tilt"), 15U);
  EXPECT_EQ(reason(), "Kinect: no kinect/tilt says where it looks");
  with_tilt_ = true;
  stream(300);
  EXPECT_GE(left(), 5U);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, TrustsTheLastTiltOfACameraThatStood) {
  tell_camera();
  live(100);
  with_tilt_ = false;
  stream(1200);
  EXPECT_GE(left(), 38U);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, SaysThatTheTiltEndedWhileItTurned) {
  tell_camera();
  live(100);
  stream(300);
  servo_ = 0.1;
  live(10);
  with_tilt_ = false;
  host_.clear();
  stream(420);
  EXPECT_EQ(reason(), "") << "turns take so long";
  stream(600);
  EXPECT_EQ(left(), 0U);
  EXPECT_EQ(reason(), "Kinect: kinect/tilt ended while it turned");
  servo_ = -0.0873;
  with_tilt_ = true;
  stream(300);
  EXPECT_GE(left(), 3U);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, SaysThatTheCameraTurnsOnAndOn) {
  tell_camera();
  live(100);
  stream(300);
  swinging_ = true;
  stream(1500);
  EXPECT_EQ(reason(), "");
  stream(1500);
  EXPECT_EQ(reason(), "Kinect: it turns");
}

TEST_F(DepthPipelineComponentTest, SaysThatImagesAndPitchDoNotMeet) {
  tell_camera();
  live(100);
  stream(300);
  images_ahead_ = milliseconds(2000);  // the camera's host has another time
  host_.clear();
  stream(600);
  EXPECT_EQ(left(), 0U);
  EXPECT_GE(host_.counter("images: without pitch"), 15U);
  EXPECT_THAT(reason(), HasSubstr("Kinect: image without pitch: the "));
  images_ahead_ = {};
  stream(300);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, SaysThatACameraMeasuresNothing) {
  tell_camera();
  host_.publish(topics::kRearInfo,
                wire::to_message(host_.now(), "rear_camera_depth_optical", scene_.camera));
  live(100);
  stream(300, true);
  EXPECT_EQ(reason(), "");
  blind_ = true;
  host_.clear();
  stream(600, true);
  EXPECT_EQ(left(), 0U);
  EXPECT_TRUE(host_.written(topics::kRearScan).empty());
  EXPECT_EQ(reason(), "Kinect: it measures nothing");
  EXPECT_GE(host_.counter("images: blind"), 25U);
  blind_ = false;
  stream(300, true);
  EXPECT_EQ(reason(), "");
}

TEST_F(NeededKinectTest, IsNotAbleToWorkWithoutIt) {
  using namespace usher_msgs::msg::Heartbeat_Constants;
  tell_camera();
  live(100);
  stream(300);
  EXPECT_EQ(host_.heartbeat().state(), STATE_OK);
  blind_ = true;
  stream(600);
  EXPECT_EQ(host_.heartbeat().state(), STATE_STARTING) << reason();
  EXPECT_EQ(reason(), "Kinect: it measures nothing");
  blind_ = false;
  stream(300);
  EXPECT_EQ(host_.heartbeat().state(), STATE_OK);
  live(600);
  EXPECT_EQ(host_.heartbeat().state(), STATE_STARTING) << reason();
}

TEST_F(NeededKinectTest, IsNotAbleToWorkWithoutThePitch) {
  using namespace usher_msgs::msg::Heartbeat_Constants;
  tell_camera();
  live(100);
  stream(300);
  EXPECT_EQ(host_.heartbeat().state(), STATE_OK);
  with_pitch_ = false;
  stream(600);
  EXPECT_EQ(host_.heartbeat().state(), STATE_STARTING) << reason();
  EXPECT_EQ(reason(), "no pitch");
  with_pitch_ = true;
  stream(300);
  EXPECT_EQ(host_.heartbeat().state(), STATE_OK);
}

TEST_F(DepthPipelineComponentTest, SaysThatACameraIsBlindFromItsFirstImageOn) {
  tell_camera();
  live(100);
  blind_ = true;
  stream(600);
  EXPECT_EQ(reason(), "Kinect: it measures nothing");
}

TEST_F(DepthPipelineComponentTest, SaysThatACameraIsFrozen) {
  tell_camera();
  live(100);
  stream(300);
  frozen_ = true;
  stream(300);
  EXPECT_EQ(reason(), "") << "a driver may repeat an image";
  host_.clear();
  stream(600);
  EXPECT_LE(left(), 1U);
  EXPECT_EQ(reason(), "Kinect: its image is frozen");
  EXPECT_GE(host_.counter("images: frozen"), 15U);
  frozen_ = false;
  stream(300);
  EXPECT_GE(left(), 8U);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, HealthIsThatOfBothCameras) {
  tell_camera();
  host_.publish(topics::kRearInfo,
                wire::to_message(host_.now(), "rear_camera_depth_optical", scene_.camera));
  live(100);
  stream(300, true);
  EXPECT_EQ(reason(), "");
  rear_encoding_ = "32FC1";
  for (int i = 0; i < 10; ++i) {
    stream(120, true);
    EXPECT_THAT(reason(), HasSubstr("rear camera: ")) << "the Kinect's images are good";
  }
  rear_encoding_ = "16UC1";
  stream(240, true);
  EXPECT_EQ(reason(), "");
  stream(600);
  EXPECT_EQ(reason(), "rear camera: no depth image");
  stream(240, true);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, TakesImagesOf8Bits) {
  tell_camera();
  live(100);
  const auto depth = scene_.draw(camera_pose({}, servo_, 0.0));
  sensor_msgs::msg::Image image;
  image.header(wire::header(host_.now(), "kinect_depth_optical"));
  image.encoding("8UC1");
  image.width(512);
  image.height(424);
  image.step(512);
  for (const std::uint16_t value : depth)
    image.data().push_back(static_cast<std::uint8_t>(std::lround(value * 255.0 / 12000.0)));
  host_.publish(topics::kKinectDepth, image);
  live(120);
  const auto scan = host_.last(topics::kKinectScan);
  ASSERT_TRUE(scan.has_value()) << reason();
  EXPECT_NEAR(ahead(*scan), 2.0 + camera_pose({}, servo_, 0.0).forward - 0.2, 0.047);
  const auto& ranges = scan->ranges();
  const auto near = std::count_if(ranges.begin(), ranges.end(), [](float r) { return r < 1.9F; });
  EXPECT_EQ(near, 0) << "the floor in steps of 47 mm is floor";
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, LeavesOutImagesWhileTheCameraTurns) {
  tell_camera();
  live(100);
  servo_ = 0.1;
  live(20);
  show();
  live(30);
  EXPECT_TRUE(host_.written(topics::kKinectScan).empty());
  live(100);
  show();
  live(30);
  EXPECT_EQ(host_.written(topics::kKinectScan).size(), 1U);
  EXPECT_EQ(host_.counter("images: camera turning"), 1U);
}

TEST_F(DepthPipelineComponentTest, LosesNoImageOfACameraThatStands) {
  tell_camera();
  live(100);
  for (int i = 0; i < 10; ++i) {
    order(servo_);
    stream(90);
  }
  EXPECT_EQ(left(), 30U);
  EXPECT_EQ(host_.counter("images: camera turning"), 0U);
  EXPECT_EQ(host_.counter("images: without tilt"), 0U);
}

TEST_F(DepthPipelineComponentTest, LeavesOutAnImageOfATurnThatNoReadingShowsYet) {
  tell_camera();
  live(110);  // the servo was read 10 ms ago
  order(0.1);
  live(20);
  servo_ = -0.06;
  show();
  live(10);
  servo_ = 0.1;
  live(110);
  EXPECT_EQ(left(), 0U);
  EXPECT_EQ(host_.counter("images: camera turning"), 1U);
  stream(300);
  EXPECT_GE(left(), 9U) << "it stands where it was ordered to";
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, GoesOnWithAServoThatDoesNotGoWhereItIsOrderedTo) {
  tell_camera();
  live(100);
  for (int i = 0; i < 4; ++i) {
    order(0.3);
    stream(300);
  }
  EXPECT_GE(left(), 30U);
  EXPECT_EQ(reason(), "") << "it may be on its way";
}

TEST_F(DepthPipelineComponentTest, SaysThatTheCameraLooksElsewhere) {
  tell_camera();
  live(100);
  stream(1000);
  servo_ = 0.2;  // pushed there, and stuck
  stream(1500);
  EXPECT_EQ(reason(), "") << "no turn needs longer than 2 s";
  stream(1500);
  EXPECT_EQ(reason(), "Kinect: looks 11 deg up, not -5 deg");
  EXPECT_GT(left(), 60U) << "of what it sees there";
  servo_ = -0.0873;
  stream(500);
  EXPECT_EQ(reason(), "");
}

TEST_F(DepthPipelineComponentTest, TrustsNoTiltOfBeforeATurnThatItOrdered) {
  tell_camera();
  live(100);
  with_tilt_ = false;
  stream(600);
  order(0.1);
  live(10);
  host_.clear();
  stream(600);
  EXPECT_EQ(left(), 0U);
  EXPECT_EQ(reason(), "Kinect: kinect/tilt ended while it turned");
}

TEST_F(DepthPipelineComponentTest, JudgesALateImageWithTheTiltOfItsTime) {
  tell_camera();
  live(160);
  servo_ = 0.1;  // read at 200 ms for the first time
  live(140);
  show(0.0, milliseconds(115));
  live(110);
  EXPECT_EQ(left(), 0U) << "of the turn, though it stands again";
  EXPECT_EQ(host_.counter("images: camera turning"), 1U);
  servo_ = -0.0873;
  show(0.0, milliseconds(275));
  live(10);
  ASSERT_EQ(left(), 1U) << "of before the turn";
  const auto& scan = host_.last(topics::kKinectScan);
  const auto near = std::count_if(scan->ranges().begin(), scan->ranges().end(),
                                  [](float range) { return range < 1.9F; });
  EXPECT_EQ(near, 0) << "the floor is none of its obstacles";
}

TEST_F(DepthPipelineComponentTest, RefusesAndCountsATiltFromTheFuture) {
  tell_camera();
  live(100);
  usher_msgs::msg::CameraTilt tilt;
  tilt.header(wire::header(host_.now() + milliseconds(2000), "base_link"));
  tilt.servo(0.1);
  host_.publish(topics::kKinectTilt, tilt);
  stream(1200);
  EXPECT_EQ(host_.counter("kinect/tilt: refused"), 1U);
  EXPECT_EQ(left(), 40U);
}

TEST_F(DepthPipelineComponentTest, RefusesImagesThatDoNotFit) {
  tell_camera();
  live(100);
  sensor_msgs::msg::Image image;
  image.header(wire::header(host_.now(), "kinect_depth_optical"));
  image.encoding("16UC1");
  image.width(512);
  image.height(424);
  image.step(1024);
  host_.publish(topics::kKinectDepth, image);
  live(120);
  EXPECT_TRUE(host_.written(topics::kKinectScan).empty());
  EXPECT_EQ(host_.counter("images: rejected"), 1U);
  EXPECT_THAT(host_.heartbeat().reason(), HasSubstr("carries 0"));
}

TEST_F(DepthPipelineComponentTest, TiltFollowsTheSupervisorAndAnOperatorMayHoldIt) {
  usher_msgs::msg::SupervisorStatus status;
  const auto tell = [&](float angle) {
    status.header(wire::header(host_.now(), ""));
    status.kinect_angle(angle);
    host_.publish(topics::kSupervisorStatus, status);
  };
  tell(0.1745F);
  live(250);
  EXPECT_NEAR(host_.last(topics::kKinectTiltCommand)->servo(), 0.1745, 1e-6);
  tell(-0.0873F);
  live(250);
  EXPECT_NEAR(host_.last(topics::kKinectTiltCommand)->servo(), -0.0873, 1e-6);
  usher_msgs::msg::CameraTilt request;
  request.servo(9.0);
  host_.publish(topics::kKinectTiltRequest, request);
  live(1500);
  EXPECT_NEAR(host_.last(topics::kKinectTiltCommand)->servo(), kinematics::TiltServo::kLimit, 1e-9);
  live(900);
  EXPECT_NEAR(host_.last(topics::kKinectTiltCommand)->servo(), -0.0873, 1e-6);
}

TEST(DepthPipelineParameters, HaveNoAxleOfTheirOwn) {
  constexpr const char* kMount = "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m}";
  const auto made = TestHost::try_make(
      runtime::component_factory<DepthPipelineComponent>("depth_pipeline"), kMount);
  ASSERT_FALSE(made.ok());
  EXPECT_THAT(made.error(), HasSubstr("robot.wheel_radius"));
}

}  // namespace
}  // namespace usher::depth_pipeline
