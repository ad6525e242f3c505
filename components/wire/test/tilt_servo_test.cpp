#include "wire/tilt_servo.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using testing::HasSubstr;

/// What the newest Body read.
kinematics::TiltServo servo;

class Body final : public runtime::Component {
 public:
  explicit Body(runtime::Host& host) { servo = read_tilt_servo(host.parameters()); }
};

std::string error_of(const std::string& parameters) {
  const Status made =
      runtime::TestHost::try_make(runtime::component_factory<Body>("body"), parameters);
  return made ? "" : made.error();
}

TEST(ReadTiltServo, StandsWhereTheCameraLooksUnlessTheRobotSaysOtherwise) {
  ASSERT_EQ(error_of("{}"), "");
  EXPECT_DOUBLE_EQ(servo.servo_for(0.1), 0.1);
  ASSERT_EQ(error_of("robot.kinect.servo_gain: 1.05\nrobot.kinect.servo_offset: -0.1 rad"), "");
  EXPECT_DOUBLE_EQ(servo.servo_for(0.2), 0.11);
  EXPECT_DOUBLE_EQ(servo.angle_of(0.11), 0.2);
}

TEST(ReadTiltServo, RefusesWhatIsNoServo) {
  EXPECT_THAT(error_of("robot.kinect.servo_gain: 2.1"), HasSubstr("[0.5, 2]"));
  EXPECT_THAT(error_of("robot.kinect.servo_offset: 0.31 rad"), HasSubstr("[-0.3, 0.3]"));
}

TEST(ReadTiltServo, IsTheOnlyReader) {
  namespace fs = std::filesystem;
  for (const auto& entry : fs::recursive_directory_iterator(USHER_COMPONENTS)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".cpp" || path.stem() == "tilt_servo" ||
        path.stem() == "tilt_servo_test")
      continue;
    std::ifstream file(path);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(text.find("\"robot.kinect.servo_"), std::string::npos) << path;
  }
}

}  // namespace
}  // namespace usher::wire
