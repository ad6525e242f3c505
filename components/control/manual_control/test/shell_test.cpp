#include <gtest/gtest.h>

#include "control/manual_control/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::manual_control {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::SupervisorRequest_Constants;

sensor_msgs::msg::Joy joy(float forward, std::vector<std::int32_t> buttons) {
  sensor_msgs::msg::Joy message;
  message.axes({0.0F, forward, 0.0F, 0.0F});
  message.buttons(std::move(buttons));
  return message;
}

sensor_msgs::msg::Joy joy_at(runtime::Time stamp, float forward,
                             std::vector<std::int32_t> buttons) {
  auto message = joy(forward, std::move(buttons));
  message.header().stamp(wire::to_message(stamp));
  return message;
}

runtime::TestHost make(const std::string& parameters = {}) {
  return runtime::TestHost(runtime::component_factory<ManualControlComponent>("manual_control"),
                           parameters);
}

TEST(ManualControlShell, PublishesWhileHeldAndFallsSilentAfterZeros) {
  auto host = make();
  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 0, 0, 0}));
  host.run_for(milliseconds(20));
  EXPECT_TRUE(host.written(topics::kCmdVelManual).empty());
  for (int i = 0; i < 10; ++i) {
    host.publish(topics::kJoy, joy_at(host.now(), 1, {0, 0, 0, 0, 1}));
    host.run_for(milliseconds(50));
  }
  ASSERT_GE(host.written(topics::kCmdVelManual).size(), 10U);
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.8);
  host.run_for(milliseconds(400));  // the pad is gone
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.0);
  host.run_for(milliseconds(400));
  host.clear();
  host.run_for(milliseconds(1000));
  EXPECT_TRUE(host.written(topics::kCmdVelManual).empty());
}

TEST(ManualControlShell, ASampleThatComesTooLateDrivesNothingButItsStopIsOne) {
  auto host = make();
  const auto late = [&] { return host.now() - milliseconds(400); };
  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 0, 0, 0}));
  host.run_for(milliseconds(20));
  host.publish(topics::kJoy, joy_at(host.now(), 1, {0, 0, 0, 0, 1}));
  host.run_for(milliseconds(20));
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.8);
  for (int i = 0; i < 12; ++i) {
    host.publish(topics::kJoy, joy_at(late(), 1, {0, 0, 0, 0, 1}));
    host.run_for(milliseconds(50));
  }
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.0);
  host.publish(topics::kJoy, joy_at(host.now(), 1, {0, 0, 0, 0, 1}));
  host.run_for(milliseconds(100));
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.0) << "a new press is needed";
  host.run_for(milliseconds(400));
  host.publish(topics::kJoy, joy_at(late(), 0, {0, 1, 0, 0, 0}));
  host.run_for(milliseconds(100));
  ASSERT_FALSE(host.written(topics::kSupervisorRequest).empty());
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), COMMAND_STOP);
}

// A pad whose turn is where the keyboard's forward is, and its A where the keyboard's dead-man is.
TEST(ManualControlShell, TheKeyboardMeansTheSameWhateverThePadsLayout) {
  auto host = make("{forward_axis: 0, turn_axis: 1, dead_man_button: 5, movement_on_button: 4}");
  const auto press = [&](const std::string& who, float forward, float turn, std::size_t dead_man) {
    for (const bool down : {false, true, true}) {
      sensor_msgs::msg::Joy message;
      message.header().stamp(wire::to_message(host.now()));
      message.axes({0.0F, 0.0F, 0.0F, 0.0F});
      message.buttons(std::vector<std::int32_t>(6, 0));
      const bool keys = who == kKeyboard;
      message.axes()[keys ? kKeyboardMapping.forward_axis : 0] = down ? forward : 0.0F;
      message.axes()[keys ? kKeyboardMapping.turn_axis : 1] = down ? turn : 0.0F;
      message.buttons()[dead_man] = down ? 1 : 0;
      host.publish(topics::kJoy, message, who);
      host.run_for(milliseconds(20));
    }
  };
  const auto commanded = [&] {
    const auto twist = host.last(topics::kCmdVelManual)->twist();
    return std::pair(twist.linear().x(), twist.angular().z());
  };
  press(std::string(kKeyboard), 1.0F, 0.0F, kKeyboardMapping.dead_man);
  ASSERT_TRUE(host.last(topics::kCmdVelManual))
      << "the keyboard's dead-man is no button of the pad";
  EXPECT_EQ(commanded(), std::pair(0.8, 0.0));
  EXPECT_TRUE(host.written(topics::kSupervisorRequest).empty()) << "nobody pressed A";
  host.run_for(milliseconds(1000));
  host.clear();

  press("gamepad", 0.0F, 1.0F, 5);
  ASSERT_TRUE(host.last(topics::kCmdVelManual));
  EXPECT_EQ(commanded(), std::pair(0.0, 0.8));
  host.run_for(milliseconds(1000));
  press("gamepad", 0.0F, 0.0F, 4);
  ASSERT_TRUE(host.last(topics::kSupervisorRequest));
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), COMMAND_MOVEMENT_ON);
}

TEST(ManualControlShell, IsNeverSilentWhileItIsItsTurn) {
  auto host = make();
  usher_msgs::msg::SupervisorStatus status;
  status.state(usher_msgs::msg::SupervisorStatus_Constants::STATE_MANUAL);
  host.publish(topics::kSupervisorStatus, status);
  host.run_for(milliseconds(1000));
  EXPECT_GE(host.written(topics::kCmdVelManual).size(), 19U);
  EXPECT_EQ(host.last(topics::kCmdVelManual)->twist().linear().x(), 0.0);
  status.state(usher_msgs::msg::SupervisorStatus_Constants::STATE_INTERACTION);
  host.publish(topics::kSupervisorStatus, status);
  host.run_for(milliseconds(100));
  host.clear();
  host.run_for(milliseconds(1000));
  EXPECT_TRUE(host.written(topics::kCmdVelManual).empty());
}

TEST(ManualControlShell, AsksUntilAnsweredAndNotForEverButForAStop) {
  auto host = make();
  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 0, 0}));
  host.run_for(milliseconds(20));
  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 1, 0}));
  host.run_for(milliseconds(500));
  const auto asked = host.written(topics::kSupervisorRequest);
  ASSERT_GE(asked.size(), 2U);
  EXPECT_EQ(asked.front().command(), COMMAND_MANUAL_ON);
  EXPECT_EQ(asked.front().client(), "manual_control");
  EXPECT_EQ(asked.front().id(), asked.back().id());
  usher_msgs::msg::SupervisorStatus status;
  status.last_request(asked.front().id());
  status.last_request_client("tablet");
  host.publish(topics::kSupervisorStatus, status);
  host.run_for(milliseconds(20));
  host.clear();
  host.run_for(milliseconds(500));
  EXPECT_FALSE(host.written(topics::kSupervisorRequest).empty()) << "somebody else's request";
  status.last_request_client("manual_control");
  host.publish(topics::kSupervisorStatus, status);
  host.run_for(milliseconds(20));
  host.clear();
  host.run_for(milliseconds(1000));
  EXPECT_TRUE(host.written(topics::kSupervisorRequest).empty());

  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 0, 0}));
  host.run_for(milliseconds(20));
  host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 1, 0, 0}));
  host.run_for(milliseconds(2500));
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), COMMAND_STOP);
  host.clear();
  const auto press = [&](const std::vector<std::int32_t>& buttons) {
    host.publish(topics::kJoy, joy_at(host.now(), 0, {0, 0, 0, 0}));
    host.run_for(milliseconds(20));
    host.publish(topics::kJoy, joy_at(host.now(), 0, buttons));
    host.run_for(milliseconds(20));
  };
  press({0, 0, 1, 0});
  host.run_for(milliseconds(2000));
  ASSERT_TRUE(host.last(topics::kSupervisorRequest)) << "the supervisor may come back";
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), COMMAND_STOP);
  press({1, 0, 0, 0});
  EXPECT_EQ(host.last(topics::kSupervisorRequest)->command(), COMMAND_MOVEMENT_ON);
  host.run_for(milliseconds(2500));
  host.clear();
  host.run_for(milliseconds(2000));
  EXPECT_TRUE(host.written(topics::kSupervisorRequest).empty());
}

}  // namespace
}  // namespace usher::manual_control
