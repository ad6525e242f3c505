// The people detector's cameras through the ports, with rendered people.
#include <gtest/gtest.h>

#include <cmath>

#include "operations/people_study/scene.hpp"
#include "perception/people_detector/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "sensing/depth_pipeline/shell/component.hpp"
#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/images.hpp"

namespace usher::people_detector {
namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;
using Image = sensor_msgs::msg::Image;

constexpr const char* kKinectFrame = "kinect_depth_optical";
constexpr const char* kRearFrame = "rear_camera_depth_optical";

/// A robot that stands in an empty hall; its cameras see the scene of a name.
class Cameras : public testing::Test {
 protected:
  Cameras() {
    for (const auto& scene : people_study::thesis_scenes()) {
      if (scene.name != "8.17 standing, from the front") continue;
      const auto shot = studio.take(scene, 3).value();
      view = shot.view;
      person = {shot.truths[0].forward, shot.truths[0].left};
      pixels.assign(shot.processed.millimeters.begin(), shot.processed.millimeters.end());
    }
    host.publish(topics::kMap,
                 wire::to_message(host.now(), frames::kMap,
                                  grid::OccupancyGrid({10, 10, 0.1, -5.0, -5.0}, grid::kFree)));
  }

  void tell_cameras() {
    host.publish(topics::kKinectInfo,
                 wire::to_message(host.now(), kKinectFrame, studio.intrinsics()));
    host.publish(topics::kRearInfo, wire::to_message(host.now(), kRearFrame, studio.intrinsics()));
  }
  /// base_footprint_T_optical of a camera 0.2 m ahead of the axle, or behind it.
  geometry::Pose3 optical(bool backward) const {
    Eigen::Matrix3d axes;
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return {{backward ? -0.2 : 0.2, 0.0, view.height},
            geometry::from_roll_pitch_yaw(0.0, view.down, backward ? geometry::kPi : 0.0) *
                Eigen::Quaterniond(axes)};
  }
  Image image(const char* frame) const {
    Image message;
    wire::to_message(host.now(), frame,
                     {studio.intrinsics().width, studio.intrinsics().height, pixels}, message);
    return message;
  }
  /// Of one color, as if the whole image were.
  Image color(const char* frame, std::array<std::uint8_t, 3> rgb, int ms_ago = 0) const {
    const int width = studio.intrinsics().width;
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < width * studio.intrinsics().height; ++i)
      bytes.insert(bytes.end(), rgb.begin(), rgb.end());
    Image message;
    wire::to_color_message(host.now() - milliseconds(ms_ago), frame, width, bytes, message);
    return message;
  }
  /// `write` at 30 Hz beside a laser that sees nothing.
  template <class Write>
  void run(int ms, const Write& write) {
    for (int at = 0; at < ms; at += 33) {
      tf2_msgs::msg::TFMessage places;
      const auto add = [&](const char* parent, const char* child, const geometry::Pose3& pose) {
        places.transforms().push_back(wire::transform(host.now(), parent, child, pose));
      };
      add(frames::kMap, frames::kOdom, {});
      add(frames::kOdom, frames::kBaseFootprint, geometry::to_space(odom_T_base));
      add(frames::kBaseFootprint, "laser_level", {});
      add(frames::kBaseFootprint, kKinectFrame, optical(false));
      add(frames::kBaseFootprint, kRearFrame, optical(true));
      host.publish(topics::kTf, places);
      sensor_msgs::msg::LaserScan scan;
      scan.header(wire::header(host.now(), "laser_level"));
      scan.angle_increment(0.1F), scan.angle_max(0.1F);
      scan.range_max(20.0F);
      scan.ranges({INFINITY, INFINITY});
      host.publish(topics::kScanFiltered, scan);
      write();
      host.run_for(milliseconds(33));
    }
  }
  void look(int ms) {
    run(ms, [this] { host.publish(topics::kKinectProcessed, image(kKinectFrame)); });
  }
  std::vector<usher_msgs::msg::Person> people() const {
    const auto message = host.last(topics::kPeople);
    return message ? message->people() : std::vector<usher_msgs::msg::Person>{};
  }
  std::string reason() const { return host.heartbeat().reason(); }

  people_study::Studio studio;
  View view;
  Point2 person = Point2::Zero();  ///< [m] from the camera's foot
  std::vector<std::uint16_t> pixels;
  const Pose2 odom_T_base{3.0, -1.0, 2.0};
  runtime::TestHost host{runtime::component_factory<PeopleDetectorComponent>("people_detector"),
                         "robot.footprint: [0.3, 0.33, -0.3, 0.33, -0.3, -0.33, 0.3, -0.33]"};
};

TEST_F(Cameras, FindWhoStandsBeforeTheRobotAndTellMovementControl) {
  tell_cameras();
  look(1500);
  ASSERT_EQ(people().size(), 1U);
  const auto found = people()[0];
  const Point2 truth = odom_T_base * Pose2{0.2, 0.0, 0.0} * person;
  EXPECT_LT((Point2(found.x(), found.y()) - truth).norm(), 0.15);
  EXPECT_TRUE(found.by_kinect() && !found.by_rear() && !found.by_laser());
  EXPECT_NEAR(found.height(), 1.75, 0.15);
  EXPECT_LT(Point2(found.vx(), found.vy()).norm(), 0.1);
  EXPECT_EQ(reason(), "");
  const auto ahead = host.last(topics::kPersonAhead);
  ASSERT_TRUE(ahead);
  EXPECT_FALSE(ahead->clear());
  EXPECT_NEAR(ahead->distance(), (Pose2{0.2, 0.0, 0.0} * person).norm(), 0.15);
}

TEST_F(Cameras, FindWhoStandsBehindTheRobot) {
  tell_cameras();
  run(1500, [this] { host.publish(topics::kRearProcessed, image(kRearFrame)); });
  ASSERT_EQ(people().size(), 1U);
  const auto found = people()[0];
  const Point2 truth = odom_T_base * Pose2{-0.2, 0.0, geometry::kPi} * person;
  EXPECT_LT((Point2(found.x(), found.y()) - truth).norm(), 0.15);
  EXPECT_TRUE(found.by_rear());
  EXPECT_TRUE(host.last(topics::kPeople)->rear_looks());
  EXPECT_FALSE(host.last(topics::kPeople)->kinect_looks());
  EXPECT_TRUE(host.last(topics::kPersonAhead)->clear()) << "nobody is ahead";
}

TEST_F(Cameras, TellHowPeopleAreDressedWhereTheyHaveColors) {
  tell_cameras();
  look(1000);
  ASSERT_EQ(people().size(), 1U);
  EXPECT_FALSE(wire::from_message(people()[0].kinect_appearance()).known());
  run(1000, [this] {
    host.publish(topics::kKinectColor, color(kKinectFrame, {165, 35, 40}, 33));
    host.publish(topics::kKinectProcessed, image(kKinectFrame));
  });
  const auto seen = wire::from_message(people()[0].kinect_appearance());
  ASSERT_TRUE(seen.upper.known() && seen.legs.known());
  EXPECT_NEAR(seen.upper.color.a, 51.9, 1.0);
  EXPECT_FALSE(wire::from_message(people()[0].rear_appearance()).known());
  EXPECT_EQ(reason(), "");
  run(1500, [this] {
    host.publish(topics::kRearColor, color(kRearFrame, {48, 66, 100}));
    host.publish(topics::kRearProcessed, image(kRearFrame));
  });
  bool by_rear = false;
  for (const auto& one : people())
    by_rear = by_rear || wire::from_message(one.rear_appearance()).known();
  EXPECT_TRUE(by_rear);
}

TEST_F(Cameras, ColorsOfAnotherTimeOrThatDoNotFitAreNone) {
  tell_cameras();
  run(1000, [this] {
    host.publish(topics::kKinectColor, color(kKinectFrame, {165, 35, 40}, 100));
    host.publish(topics::kKinectProcessed, image(kKinectFrame));
  });
  ASSERT_EQ(people().size(), 1U);
  EXPECT_FALSE(wire::from_message(people()[0].kinect_appearance()).known());
  EXPECT_EQ(host.counter("color images: rejected"), 0U);
  run(1000, [this] {
    Image wrong = color(kKinectFrame, {165, 35, 40});
    wrong.height(wrong.height() / 2);
    wrong.data().resize(wrong.data().size() / 2);
    host.publish(topics::kKinectColor, wrong);
    host.publish(topics::kKinectProcessed, image(kKinectFrame));
  });
  ASSERT_EQ(people().size(), 1U) << "found all the same";
  EXPECT_FALSE(wire::from_message(people()[0].kinect_appearance()).known());
  EXPECT_GT(host.counter("color images: rejected"), 5U);
  EXPECT_EQ(reason(), "");
}

TEST_F(Cameras, TakeNobodyForAPersonWhoIsAWall) {
  grid::OccupancyGrid map({200, 200, 0.05, -5.0, -5.0}, grid::kFree);
  const Point2 place = odom_T_base * Pose2{0.2, 0.0, 0.0} * person;
  map.at(map.geometry().cell_at(place)) = grid::kOccupied;
  host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, map));
  tell_cameras();
  look(1500);
  EXPECT_TRUE(people().empty());
}

TEST_F(Cameras, LookAtEverySecondImage) {
  tell_cameras();
  look(1000);
  host.clear();
  look(3000);
  EXPECT_LE(host.written(topics::kPeople).size(), 52U);
  EXPECT_GE(host.written(topics::kPeople).size(), 40U);
}

TEST_F(Cameras, OneThatFallsSilentIsSaidAndTheOthersGoOn) {
  tell_cameras();
  look(1000);
  EXPECT_EQ(reason(), "");
  EXPECT_TRUE(host.last(topics::kPeople)->kinect_looks());
  EXPECT_FALSE(host.last(topics::kPeople)->rear_looks()) << "never did";
  run(600, [] {});
  EXPECT_FALSE(host.last(topics::kPeople)->kinect_looks());
  EXPECT_EQ(reason(), "no image of the Kinect");
  ASSERT_EQ(people().size(), 1U) << "remembered";
  EXPECT_GT(people()[0].unseen(), 0.4F);
  run(8000, [] {});
  EXPECT_TRUE(people().empty());
  look(1000);
  EXPECT_EQ(reason(), "");
}

/// Through the depth pipeline, which passes no image of a camera that measures nothing: to the
/// detector an image without obstacles is a free floor.
TEST_F(Cameras, ABlindOneDoesNotLook) {
  ASSERT_TRUE(host.world().add(
      runtime::component_factory<depth_pipeline::DepthPipelineComponent>("depth_pipeline"),
      runtime::test_parameters(
          "depth_pipeline",
          "{robot.kinect.mount_x: 0.2 m, robot.kinect.mount_z: 0.665 m, robot.wheel_radius: 0.2 m}")
          .value()));
  tell_cameras();
  const auto stream = [&](int ms, const std::vector<std::uint16_t>& depth) {
    pixels = depth;
    run(ms, [&] {
      if (pixels.back() != 0) ++pixels.back();  // noise
      usher_msgs::msg::BaseStatus status;
      status.header(wire::header(host.now(), frames::kBaseLink));
      status.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
      host.publish(topics::kBaseStatus, status);
      host.publish(topics::kRearDepth, image(kRearFrame));
    });
  };
  const auto count = studio.intrinsics().width * studio.intrinsics().height;
  stream(1000, std::vector<std::uint16_t>(static_cast<std::size_t>(count), 6000));
  EXPECT_TRUE(host.last(topics::kPeople)->rear_looks()) << "and sees nobody";
  stream(1000, std::vector<std::uint16_t>(static_cast<std::size_t>(count), 0));
  EXPECT_FALSE(host.last(topics::kPeople)->rear_looks());
}

TEST_F(Cameras, GoOnWithoutTheLaser) {
  tell_cameras();
  look(1000);
  for (int i = 0; i < 30; ++i) {
    tf2_msgs::msg::TFMessage places;
    places.transforms().push_back(wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint,
                                                  geometry::to_space(odom_T_base)));
    places.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, kKinectFrame, optical(false)));
    host.publish(topics::kTf, places);
    host.publish(topics::kKinectProcessed, image(kKinectFrame));
    host.run_for(milliseconds(33));
  }
  EXPECT_EQ(reason(), "no scan");
  ASSERT_EQ(people().size(), 1U);
  EXPECT_LT(people()[0].unseen(), 0.1F);
}

TEST_F(Cameras, AnImageOfAnUnknownFrameIsDroppedCountedAndSaid) {
  tell_cameras();
  run(1000, [this] { host.publish(topics::kKinectProcessed, image("nowhere")); });
  EXPECT_TRUE(people().empty());
  EXPECT_GT(host.counter("tf: dropped"), 5U);
  EXPECT_EQ(reason(), "nobody says where the Kinect is");
}

TEST_F(Cameras, AnImageThatWaitsForItsPlaceIsLookedAt) {
  tell_cameras();
  Image waiting;
  run(1500, [&] {
    if (!waiting.data().empty()) host.publish(topics::kKinectProcessed, waiting);
    waiting = image(kKinectFrame);  // its place comes with the next one
    waiting.header(wire::header(host.now() + milliseconds(30), kKinectFrame));
  });
  EXPECT_EQ(people().size(), 1U);
  EXPECT_EQ(host.counter("images: late"), 0U);
}

TEST_F(Cameras, ALateImageIsLeftOutAndCounted) {
  tell_cameras();
  run(1000, [] {});
  std::vector<Image> held;
  run(1000, [&] {
    held.push_back(image(kKinectFrame));
    if (held.size() > 15)  // of another host: of this one they would not even come
      host.world().publish(topics::kKinectProcessed, held[held.size() - 16], "camera", "sensing");
  });
  EXPECT_TRUE(people().empty());
  EXPECT_GT(host.counter("images: late"), 5U);
}

TEST_F(Cameras, ImagesThatDoNotFitAreRefusedWithTheReason) {
  run(500, [this] { host.publish(topics::kKinectProcessed, image(kKinectFrame)); });
  EXPECT_EQ(reason(), "Kinect: no camera_info");
  tell_cameras();
  look(500);
  EXPECT_EQ(reason(), "");
  const auto before = host.counter("images: rejected");
  run(500, [this] {
    Image other = image(kKinectFrame);
    other.encoding("bgr8");
    host.publish(topics::kKinectProcessed, other);
  });
  EXPECT_EQ(reason(), "Kinect: a depth image is 16UC1 or 8UC1, got 'bgr8'");
  run(500, [this] {
    Image small = image(kKinectFrame);
    small.width(100), small.height(100), small.step(200);
    small.data().resize(20000);
    host.publish(topics::kKinectProcessed, small);
  });
  EXPECT_NE(reason().find("expected an image of 512 x 424, got 100 x 100"), std::string::npos)
      << reason();
  EXPECT_GT(host.counter("images: rejected"), before + 8);
  EXPECT_TRUE(host.running());
}

TEST_F(Cameras, AnInfoThatIsNoneIsRefusedWithTheReason) {
  auto info = wire::to_message(host.now(), kKinectFrame, studio.intrinsics());
  info.k()[0] = std::nan("");
  host.publish(topics::kKinectInfo, info);
  run(500, [] {});
  EXPECT_EQ(reason().rfind("Kinect: ", 0), 0U) << reason();
  EXPECT_EQ(host.counter("images: rejected"), 1U);
}

}  // namespace
}  // namespace usher::people_detector
