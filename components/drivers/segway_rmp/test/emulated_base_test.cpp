#include "drivers/segway_rmp/core/emulated_base.hpp"

#include <gtest/gtest.h>

#include "drivers/segway_rmp/core/link.hpp"
#include "foundation/random/random.hpp"

namespace usher::segway_rmp {
namespace {

using std::chrono::milliseconds;
using Wish = EmulatedBase::Wish;

std::vector<EmulatedBase::Order> orders(EmulatedBase& base, std::span<const std::uint8_t> bytes) {
  std::vector<EmulatedBase::Order> found;
  base.received(bytes, [&](const auto& order) { found.push_back(order); });
  return found;
}

TEST(EmulatedBase, HearsWhatTheDriverCommands) {
  EmulatedBase base(Calibration{});
  const auto heard = orders(base, command({0.7, -0.4}, Calibration{}));
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].wish, Wish::kDrive);
  EXPECT_NEAR(heard[0].twist.v, 0.7, 0.002);
  EXPECT_NEAR(heard[0].twist.w, -0.4, 0.002);
  EXPECT_EQ(orders(base, shutdown()).at(0).wish, Wish::kShutdown);
  const auto balance =
      orders(base, command({}, Calibration{}, Setting::kOperationalMode, kModeBalance));
  ASSERT_EQ(balance.size(), 2U);
  EXPECT_EQ(balance[0].wish, Wish::kBalance);
  EXPECT_EQ(balance[1].twist, geometry::Twist2{});
}

TEST(EmulatedBase, FindsFramesAmongNoise) {
  EmulatedBase base(Calibration{});
  Random random(3);
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::uint8_t> stream(random.below(4), 0xF0);
    const auto frame = command({0.5, 0.0}, Calibration{});
    stream.insert(stream.end(), frame.begin(), frame.end());
    for (const auto& order : orders(base, stream)) {
      EXPECT_EQ(order.wish, Wish::kDrive);
      EXPECT_NEAR(order.twist.v, 0.5, 0.002);
      ++found;
    }
  }
  EXPECT_EQ(found, 1000);
}

TEST(EmulatedBase, TheRealLinkReadsWhatItSays) {
  EmulatedBase base(Calibration{});
  Link link;
  link.opened(milliseconds(0));
  SegwayFeedback truth;
  truth.mode = Mode::kBalancing;
  truth.pitch = 0.1;
  truth.pitch_rate = -0.2;
  truth.yaw_rate = 0.3;
  truth.left_velocity = 0.9;
  truth.right_velocity = 1.1;
  truth.battery_percent = 75.0;
  std::optional<SegwayFeedback> heard;
  for (int ms = 300; ms < 2300; ms += 10) {
    truth.left_travel += 0.009;
    truth.right_travel += 0.011;
    link.received(base.feedback(truth), milliseconds(ms),
                  [&](const SegwayFeedback& feedback) { heard = feedback; });
  }
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->mode, Mode::kBalancing);
  EXPECT_NEAR(heard->pitch, 0.1, 0.003);
  EXPECT_NEAR(heard->pitch_rate, -0.2, 0.003);
  EXPECT_NEAR(heard->yaw_rate, 0.3, 0.003);
  EXPECT_NEAR(heard->left_velocity, 0.9, 0.003);
  EXPECT_NEAR(heard->right_velocity, 1.1, 0.003);
  EXPECT_NEAR(heard->left_travel, 200 * 0.009, 1e-3) << "as the base counts";
  EXPECT_NEAR(heard->right_travel, 200 * 0.011, 1e-3);
  EXPECT_NEAR(heard->battery_percent, 75.0, 3.0);
  EXPECT_EQ(link.assembler().incomplete_cycles(), 0U);
}

TEST(EmulatedBase, ALinkThatConnectsSetsTheBalanceModeUnlessItRemembersAnEmergency) {
  for (const bool emergency : {false, true}) {
    EmulatedBase base(Calibration{});
    Link link;
    if (emergency) link.emergency_stop();
    link.opened(milliseconds(0));
    int balance = 0, off = 0;
    for (int ms = 10; ms < 1000; ms += 10) {
      for (const auto& order : orders(base, link.cycle({1.0, 0.0}, milliseconds(ms)))) {
        balance += order.wish == Wish::kBalance ? 1 : 0;
        off += order.wish == Wish::kShutdown ? 1 : 0;
      }
    }
    EXPECT_EQ(balance, emergency ? 0 : 3);
    EXPECT_EQ(off, emergency ? 99 : 0);
  }
}

}  // namespace
}  // namespace usher::segway_rmp
