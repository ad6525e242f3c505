#include "wire/torso.hpp"

#include <gmock/gmock.h>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using testing::HasSubstr;

/// What the newest Body read.
kinematics::TorsoLimits limits;

class Body final : public runtime::Component {
 public:
  explicit Body(runtime::Host& host) { limits = read_torso_limits(host); }
};

std::string error_of(const std::string& parameters) {
  const Status made =
      runtime::TestHost::try_make(runtime::component_factory<Body>("body"), parameters);
  return made ? "" : made.error();
}

TEST(ReadTorsoLimits, HasOneRateForAnglesAndOneForTheNeck) {
  ASSERT_EQ(error_of("robot.torso.torso_tilt: [-10 deg, 12 deg]\n"
                     "robot.torso.head_rise: [0 mm, 80 mm]\n"
                     "robot.torso.turn_rate: 30 deg/s\nrobot.torso.rise_rate: 0.05 m/s"),
            "");
  const auto& tilt = limits[static_cast<std::size_t>(kinematics::TorsoJoint::kTorsoTilt)];
  EXPECT_NEAR(tilt.low, -0.1745, 1e-4);
  EXPECT_NEAR(tilt.high, 0.2094, 1e-4);
  EXPECT_NEAR(tilt.rate, 0.5236, 1e-4);
  const auto& rise = limits[static_cast<std::size_t>(kinematics::TorsoJoint::kHeadRise)];
  EXPECT_DOUBLE_EQ(rise.high, 0.08);
  EXPECT_DOUBLE_EQ(rise.rate, 0.05);
  EXPECT_TRUE(kinematics::moves(limits));
}

TEST(ReadTorsoLimits, NothingMovesWithoutThem) {
  ASSERT_EQ(error_of("{}"), "");
  EXPECT_FALSE(kinematics::moves(limits));
}

TEST(ReadTorsoLimits, RefusesWhatIsNoRange) {
  EXPECT_THAT(error_of("robot.torso.head_nod: [10 deg, -10 deg]"),
              HasSubstr("the lowest position comes first"));
  EXPECT_THAT(error_of("robot.torso.head_nod: [10 deg]"), HasSubstr("robot.torso.head_nod"));
  EXPECT_THAT(error_of("robot.torso.head_nod: [-10 mm, 10 mm]"), HasSubstr("units"));
}

}  // namespace
}  // namespace usher::wire
