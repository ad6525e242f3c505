#include <gtest/gtest.h>

#include <utility>

#include "drivers/gamepad/shell/component.hpp"
#include "runtime/testing/test_host.hpp"

namespace usher::gamepad {
namespace {

using std::chrono::milliseconds;
constexpr std::uint8_t kDeadMan = 4;
constexpr std::uint8_t kForward = 1;

/// A pad that tells what the test has put into its mouth.
class Pad final : public runtime::LockstepDevice {
 public:
  runtime::Bytes answer(std::span<const std::uint8_t> /*bytes*/) override { return {}; }
  runtime::Bytes speak(runtime::Time /*now*/) override { return std::exchange(says_, {}); }
  void button(std::uint8_t number, bool down) { say(down ? 1 : 0, 1, number); }
  void axis(std::uint8_t number, std::int16_t value) { say(value, 2, number); }

 private:
  void say(std::int16_t value, std::uint8_t type, std::uint8_t number) {
    const auto raw = static_cast<std::uint16_t>(value);
    says_.insert(says_.end(), {0, 0, 0, 0, static_cast<std::uint8_t>(raw & 0xFF),
                               static_cast<std::uint8_t>(raw >> 8), type, number});
  }
  runtime::Bytes says_;
};

class GamepadShell : public testing::Test {
 protected:
  void SetUp() override {
    pad->axis(kForward, 0);
    pad->button(kDeadMan, false);
    host.run_for(milliseconds(100));
  }
  bool held() const { return host.last(topics::kJoy)->buttons().at(kDeadMan) != 0; }
  void drives() {
    pad->button(kDeadMan, true);
    pad->axis(kForward, -20000);
    host.run_for(milliseconds(100));
    ASSERT_TRUE(held());
  }
  std::shared_ptr<Pad> pad = std::make_shared<Pad>();
  runtime::TestHost host{runtime::component_factory<GamepadComponent>("gamepad"), "", pad};
};

TEST_F(GamepadShell, RepeatsAHeldButtonForHoldTimeoutOnlyWhenThePadIsSilent) {
  drives();
  host.run_for(milliseconds(1850));
  EXPECT_TRUE(held());
  host.run_for(milliseconds(150));
  EXPECT_FALSE(held()) << "a pad without power tells nothing, and its device stays";
  EXPECT_EQ(host.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
  pad->axis(kForward, -21000);
  host.run_for(milliseconds(200));
  EXPECT_FALSE(held()) << "the stick is no new press";
  pad->button(kDeadMan, false);
  host.run_for(milliseconds(50));
  drives();
  host.run_for(milliseconds(1000));
  EXPECT_EQ(host.counter("holds: too long without a word"), 1U);
}

TEST_F(GamepadShell, AHandThatHoldsTheStickKeepsIt) {
  drives();
  for (std::int16_t i = 0; i < 20; ++i) {
    host.run_for(milliseconds(900));
    pad->axis(kForward, static_cast<std::int16_t>(-20000 - i % 2));
  }
  EXPECT_TRUE(held());
}

TEST_F(GamepadShell, AButtonHeldWithoutAStickIsKept) {
  pad->button(kDeadMan, true);
  host.run_for(milliseconds(10000));
  EXPECT_TRUE(held());
  drives();
  host.run_for(milliseconds(1000));
  EXPECT_TRUE(held());
}

}  // namespace
}  // namespace usher::gamepad
