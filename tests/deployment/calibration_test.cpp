// `usher calibrate kinect` on a robot that consists of a simulated base, servo and camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "foundation/random/random.hpp"
#include "operations/manifest/tree.hpp"
#include "running_robot.hpp"
#include "simulation/world/core/depth_cameras.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"

namespace usher::test {
namespace {

using geometry::radians;
using runtime::Observer;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double kAxle = 0.235;  // of the simulated base
constexpr const char* kRobot = R"(# Another robot than MARVIN.
wheel_radius: 0.135 m   # lower wheels
kinect:
  model: v2
  mount_x: 0.2 m
  mount_z: 0.9 m        # by ruler
  servo_gain: 1.0
)";

class RobotWithKinect : public testing::Test {
 protected:
  RobotWithKinect() {
    camera_.mount.z = 0.685;
    camera_.servo_gain = 0.95;
    camera_.servo_offset = radians(1.5);
  }

  /// Runs the command beside the simulation; its exit code.
  int calibrate(std::vector<std::string> words) {
    for (const char* word : {"--plot", plot_.c_str(), "--robot", robot_.c_str()})
      words.emplace_back(word);
    words.insert(words.begin(),
                 {usher_program(), "calibrate", "kinect", "--domain", std::to_string(domain_)});
    command_.emplace(words);
    auto observer = Observer::create({.name = "kinect", .domain = domain_}).value();
    auto images = observer->writer(topics::kKinectDepth).value();
    auto info = observer->writer(topics::kKinectInfo).value();
    auto tilt = observer->writer(topics::kKinectTilt).value();
    auto status = observer->writer(topics::kBaseStatus).value();
    auto requests = observer->reader(topics::kKinectTiltRequest).value();

    const auto building = world::parse_building(R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[-8, -8], [12, -8], [12, 8], [-8, 8], [-8, -8]]}
)",
                                                "hall.yaml");
    world::World world({}, *building, {}, {0, 0, 0}, 12);
    world::DepthCamera camera(camera_, 12);
    world::WorldRenderer renderer;
    const auto& lens = camera_.sensor.lens;
    std::vector<std::uint16_t> millimeters;
    sensor_msgs::msg::Image image;
    Random random(3);
    double asked = 0.0;
    for (int frame = 0; frame < 1800; ++frame) {
      if (const int code = command_->wait(milliseconds(1)); code >= 0) return code;
      if (const auto request = requests.take(milliseconds(29));
          request && request->servo() != asked) {
        asked = request->servo();
        camera.set_tilt(asked + random.uniform(-slip_, slip_));
      }
      runtime::Time now = observer->now();
      for (int step = 0; step < 3; ++step) {
        world.step();
        camera.step(world.base().truth());
        now = observer->now();
        usher_msgs::msg::BaseStatus base;
        base.header(wire::header(now, "base_link"));
        base.pitch(world.base().readings().pitch);
        status.write(base);
      }
      usher_msgs::msg::CameraTilt servo;
      servo.header(wire::header(now, "base_link"));
      servo.servo(asked);
      tilt.write(servo);
      info.write(wire::to_message(now, "kinect_depth_optical", rendering::intrinsics_of(lens)));
      EXPECT_TRUE(renderer.update(world).ok());
      camera.measure(camera.exposure(world), renderer.renderer(), millimeters);
      wire::to_message(now, "kinect_depth_optical",
                       imaging::DepthImage{lens.width, lens.height, millimeters}, image);
      images.write(image);
    }
    return -1;
  }

  double value(const std::string& key) const {
    const auto tree = operations::read_tree(robot_);
    const auto* found = tree->find("kinect")->find(key);
    return found == nullptr ? std::nan("") : std::stod(found->scalar);
  }

  Folder folder_;
  const std::string robot_ = folder_.file("robot.yaml", kRobot);
  const std::string plot_ = folder_.path() + "/residuals.png";
  const std::uint32_t domain_ = test_domain();
  world::DepthCameraConfig camera_;
  double slip_ = 0.0;  // [rad]
  std::optional<Process> command_;
};

TEST_F(RobotWithKinect, IsCalibratedInItsOwnFile) {
  ASSERT_EQ(calibrate({"--write"}), 0) << command_->errors();
  EXPECT_NEAR(value("mount_z") + 0.135, camera_.mount.z + kAxle, 0.005)
      << "the file's axle is lower by 0.1 m\n"
      << command_->output();
  const double gain = value("servo_gain"), offset = value("servo_offset");
  for (const double servo : {-0.3, 0.0, 0.3}) {
    EXPECT_NEAR((servo - offset) / gain, 0.95 * servo + radians(1.5), radians(0.2));
  }
  EXPECT_TRUE(std::isfinite(value("mount_z_per_angle")));
  const std::string text = content_of(robot_);
  EXPECT_THAT(text,
              HasSubstr("# Another robot than MARVIN.\nwheel_radius: 0.135 m   # lower wheels"));
  EXPECT_THAT(text, HasSubstr("# by ruler"));
  EXPECT_TRUE(std::filesystem::exists(plot_));
  EXPECT_THAT(command_->output(), HasSubstr("Kinect 0.2000 m ahead of the axle, axle 0.1350 m"));
}

TEST_F(RobotWithKinect, WhoseServoSlipsIsRefusedAndItsFileStays) {
  slip_ = radians(6.0);
  ASSERT_EQ(calibrate({"--write"}), 1) << command_->output();
  EXPECT_THAT(command_->errors(), HasSubstr("refused: only"));
  EXPECT_THAT(command_->errors(), HasSubstr("does the servo slip"));
  EXPECT_EQ(content_of(robot_), kRobot);
  EXPECT_FALSE(std::filesystem::exists(plot_));
}

TEST_F(RobotWithKinect, WithoutItsMountInTheFileIsNotSwept) {
  folder_.file("robot.yaml", "kinect:\n  mount_z: 0.9 m\n");
  ASSERT_EQ(calibrate({"--write"}), 1) << command_->output();
  EXPECT_THAT(command_->errors(), HasSubstr("robot.kinect.mount_x"));
}

}  // namespace
}  // namespace usher::test
