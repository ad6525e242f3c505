#include "drivers/kinect/core/device_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/random/random.hpp"

namespace usher::kinect {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kTicks = 60e6;  // in a second

/// [s] the worst error of the stamps of three minutes at 30 Hz after the first second, of a device
/// whose clock runs `fast` times too fast; one read in three is up to a period late.
double worst_error(double fast) {
  Random random(9);
  DeviceClock clock;
  double worst = 0.0;
  for (int i = 0; i < 5400; ++i) {
    const double taken = i / 30.0;
    const double device = 4294.0e6 + kTicks * taken * (1.0 + fast);  // wraps within a second
    const auto raw = static_cast<std::uint32_t>(static_cast<std::uint64_t>(device));
    const double late = random.below(3) == 0 ? random.uniform(0.0, 0.033) : 0.0;
    const Time arrival(std::llround((1.7e9 + taken + 0.002 + late) * 1e9));
    // The color comes 8 ms after the depths.
    const Time stamp = clock.stamp({raw - 480'000U, raw}, arrival);
    EXPECT_LE(stamp, arrival);
    const Time truth(std::llround((1.7e9 + taken + 0.002 - 0.008) * 1e9));
    const Time error = stamp - truth;
    if (taken > 1.0)
      worst = std::max(worst, std::abs(std::chrono::duration<double>(error).count()));
  }
  return worst;
}

TEST(DeviceClock, FollowsTheShortestWayThroughLateReadsWrapsAndDrift) {
  EXPECT_LT(worst_error(0.0), 2e-4);
  EXPECT_LT(worst_error(50e-6), 2e-4);
  EXPECT_LT(worst_error(-50e-6), 2e-4);
}

TEST(DeviceClock, BelievesThatTheNewestOfTheFirstPairHasJustCome) {
  EXPECT_EQ(DeviceClock().stamp({7, 7}, seconds(100)), seconds(100));
  EXPECT_EQ(DeviceClock().stamp({7, 600'007}, seconds(100)), seconds(100) - milliseconds(10));
  EXPECT_EQ(DeviceClock().stamp({600'007, 7}, seconds(100)), seconds(100))
      << "the color had come before";
  EXPECT_EQ(DeviceClock().stamp({7, 60'000'007}, seconds(100)), seconds(100)) << "of another time";
}

TEST(DeviceClock, PutsAnImageThatWaitedForItsReaderBackToWhenItCame) {
  DeviceClock clock;
  clock.stamp({0, 0}, seconds(100));
  const Time stamp = clock.stamp({6'000'000, 6'000'000}, seconds(100) + milliseconds(130));
  EXPECT_NEAR(std::chrono::duration<double>(stamp - seconds(100)).count(), 0.1, 1e-4);
}

TEST(DeviceClock, StartsAnewWhenTheDeviceDoes) {
  DeviceClock clock;
  clock.stamp({900'000'000, 900'000'000}, seconds(100));
  EXPECT_EQ(clock.stamp({5, 5}, seconds(101)), seconds(101)) << "it went back";
  EXPECT_EQ(clock.stamp({900'000'000, 900'000'000}, seconds(103)), seconds(103)) << "it jumped";
  EXPECT_EQ(clock.stamp({902'000'000, 902'000'000}, seconds(203)), seconds(203))
      << "nobody read for longer than it counts";
  clock.reset();
  EXPECT_EQ(clock.stamp({904'000'000, 904'000'000}, seconds(204)), seconds(204));
}

}  // namespace
}  // namespace usher::kinect
