#include "foundation/estimation/device_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "foundation/random/random.hpp"

namespace usher::estimation {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = DeviceClock::Time;

/// 60 MHz in 32 bits, microseconds in 32, milliseconds in 24.
constexpr DeviceClock::Counter kKinect{32, 60, Time(1000), seconds(1)};
constexpr DeviceClock::Counter kLms100{32, 1, Time(1000), seconds(10)};
constexpr DeviceClock::Counter kUrg{24, 1, Time(1'000'000), seconds(10)};

class Counted : public testing::TestWithParam<DeviceClock::Counter> {
 protected:
  /// What it shows after so many seconds; it wraps within the first.
  std::uint32_t raw(double elapsed) const {
    const double per_second =
        1e9 * static_cast<double>(GetParam().ticks) / static_cast<double>(GetParam().last.count());
    const auto range = std::uint64_t{1} << GetParam().bits;
    const double start = static_cast<double>(range) - 0.9 * per_second;
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(start + per_second * elapsed) %
                                      range);
  }
};

TEST_P(Counted, FollowsTheShortestWayThroughLateReadsWrapsAndDrift) {
  for (const double fast : {0.0, 50e-6, -50e-6}) {
    Random random(9);
    DeviceClock clock(GetParam());
    double worst = 0.0;
    for (int i = 0; i < 5400; ++i) {
      const double taken = i / 30.0;
      const double late = random.below(3) == 0 ? random.uniform(0.0, 0.033) : 0.0;
      const Time arrival(std::llround((1.7e9 + taken + 0.002 + late) * 1e9));
      const Time stamp = clock.stamp(raw(taken * (1.0 + fast)), arrival);
      ASSERT_LE(stamp, arrival);
      const Time error = stamp - Time(std::llround((1.7e9 + taken + 0.002) * 1e9));
      if (i > 30) worst = std::max(worst, std::abs(std::chrono::duration<double>(error).count()));
    }
    const double tick = std::chrono::duration<double>(GetParam().last).count() /
                        static_cast<double>(GetParam().ticks);
    EXPECT_LT(worst, 2e-4 + tick) << fast;
  }
}

TEST_P(Counted, PutsBackWhatWaited) {
  DeviceClock clock(GetParam());
  clock.stamp(raw(0.0), seconds(100));
  const Time stamp = clock.stamp(raw(0.5), seconds(100) + milliseconds(530));
  EXPECT_NEAR(std::chrono::duration<double>(stamp - seconds(100)).count(), 0.5, 2e-3);
}

TEST_P(Counted, StartsAnewWhenTheDeviceDoes) {
  DeviceClock clock(GetParam());
  clock.stamp(raw(60.0), seconds(160));
  EXPECT_EQ(clock.stamp(raw(30.0), seconds(161)), seconds(161)) << "it went back";
  EXPECT_EQ(clock.stamp(raw(50.0), seconds(163)), seconds(163)) << "it jumped";
  EXPECT_EQ(clock.stamp(raw(50.1), seconds(263)), seconds(263)) << "nobody read for long";
  clock.reset();
  EXPECT_EQ(clock.stamp(raw(51.0), seconds(270)), seconds(270));
}

TEST_P(Counted, TellsTheShorterWayBetweenTwoCounts) {
  const DeviceClock clock(GetParam());
  const auto top = static_cast<std::uint32_t>((std::uint64_t{1} << GetParam().bits) - 1);
  EXPECT_EQ(clock.step(top, 4), 5);
  EXPECT_EQ(clock.step(4, top), -5);
  EXPECT_EQ(clock.step(7, 7), 0);
  EXPECT_EQ(clock.time_of(3 * GetParam().ticks), 3 * GetParam().last);
}

INSTANTIATE_TEST_SUITE_P(Devices, Counted, testing::Values(kKinect, kLms100, kUrg));

}  // namespace
}  // namespace usher::estimation
