#include "drivers/base_obedience/shell/read_response.hpp"

#include <gtest/gtest.h>

#include "runtime/testing/test_host.hpp"

namespace usher::drive {
namespace {

using std::chrono::milliseconds;

/// What the newest Watcher read.
ResponseWatch::Parameters response;

class Watcher final : public runtime::Component {
 public:
  explicit Watcher(runtime::Host& host) { response = read_response(host.parameters()); }
};

TEST(ReadResponse, TakesTheRobotsOwnThresholds) {
  ASSERT_TRUE(runtime::TestHost::try_make(runtime::component_factory<Watcher>("watcher"), R"(
robot.response.time: 1.5 s
robot.response.linear_threshold: 0.3 m/s
robot.response.linear_patience: 0.7 s
robot.response.angular_threshold: 0.6 rad/s
robot.response.angular_patience: 0.8 s
robot.response.standing_linear_threshold: 0.1 m/s
robot.response.standing_angular_threshold: 0.2 rad/s
)"));
  EXPECT_EQ(response.response, milliseconds(1500));
  EXPECT_DOUBLE_EQ(response.linear.threshold, 0.3);
  EXPECT_EQ(response.linear.patience, milliseconds(700));
  EXPECT_DOUBLE_EQ(response.angular.threshold, 0.6);
  EXPECT_EQ(response.angular.patience, milliseconds(800));
  EXPECT_DOUBLE_EQ(response.standing_linear, 0.1);
  EXPECT_DOUBLE_EQ(response.standing_angular, 0.2);
}

TEST(ReadResponse, IsThatOfASlowBaseWithoutThem) {
  ASSERT_TRUE(runtime::TestHost::try_make(runtime::component_factory<Watcher>("watcher"), "{}"));
  EXPECT_EQ(response.response, milliseconds(2500));
  EXPECT_EQ(response.linear.threshold, 0.5);
  EXPECT_EQ(response.angular.threshold, 0.8);
}

}  // namespace
}  // namespace usher::drive
