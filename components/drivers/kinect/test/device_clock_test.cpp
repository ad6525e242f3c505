#include "drivers/kinect/core/device_clock.hpp"

#include <gtest/gtest.h>

namespace usher::kinect {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Time first(const Stamps& stamps) {
  estimation::DeviceClock clock(kCounter);
  return came_at(stamps, seconds(100), clock);
}

TEST(CameAt, TheNewestOfThePairHasJustCome) {
  EXPECT_EQ(first({7, 7}), seconds(100));
  EXPECT_EQ(first({7, 600'007}), seconds(100) - milliseconds(10));
  EXPECT_EQ(first({600'007, 7}), seconds(100)) << "the color had come before";
  EXPECT_EQ(first({7, 60'000'007}), seconds(100)) << "of another time";
  EXPECT_EQ(first({0xFFFFFFFFU, 599'999}), seconds(100) - milliseconds(10)) << "it has wrapped";
}

TEST(CameAt, APairThatWaitedForItsReaderCameBefore) {
  estimation::DeviceClock clock(kCounter);
  came_at({0, 480'000}, seconds(100), clock);
  const Time stamp = came_at({6'000'000, 6'480'000}, seconds(100) + milliseconds(130), clock);
  EXPECT_NEAR(std::chrono::duration<double>(stamp - seconds(100)).count(), 0.1 - 0.008, 1e-4);
}

}  // namespace
}  // namespace usher::kinect
