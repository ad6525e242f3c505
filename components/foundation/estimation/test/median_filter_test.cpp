#include "foundation/estimation/median_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace usher::estimation {
namespace {

using std::chrono::milliseconds;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Row {
  std::vector<float> in;
  float out;
};

TEST(MedianFilter, TakesTheMiddleOfTheLastThree) {
  const Row rows[] = {
      {{1.0F}, 1.0F},
      {{1.0F, 3.0F}, 1.0F},
      {{1.0F, 9.0F, 1.1F}, 1.1F},
      {{9.0F, 9.0F, 9.0F, 1.0F}, 9.0F},
      {{9.0F, 9.0F, 9.0F, 1.0F, 1.2F}, 1.2F},
      {{1.0F, kInfinity, kInfinity}, kInfinity},
      {{1.0F, kInfinity, 2.0F}, 2.0F},
      {{kNan}, kNan},
      {{kNan, 2.0F, kNan}, 2.0F},
      {{kNan, 2.0F, 1.0F}, 1.0F},
      {{2.0F, kNan, kNan, kNan}, kNan},
  };
  for (const Row& row : rows) {
    MedianFilter filter(3);
    float out = 0.0F;
    milliseconds now(0);
    for (const float range : row.in) out = filter.update(range, now += milliseconds(50)).range;
    if (std::isnan(row.out)) {
      EXPECT_TRUE(std::isnan(out));
    } else {
      EXPECT_EQ(out, row.out);
    }
  }
}

TEST(MedianFilter, IsAsOldAsItsMiddleMeasurement) {
  for (const std::size_t window : {1, 3, 5, 15}) {
    MedianFilter filter(window);
    for (int i = 0; i < 100; ++i) {  // nears a wall at 1 m/s
      const milliseconds now(50 * i);
      const auto median = filter.update(10.0F - 0.05F * static_cast<float>(i), now);
      const float there = 10.0F - 0.001F * static_cast<float>(median.stamp / milliseconds(1));
      EXPECT_NEAR(median.range, there, 1e-4) << window << " " << i;
      const int middle = std::min(i, static_cast<int>(window) - 1) / 2;
      EXPECT_EQ(median.stamp, now - 50 * milliseconds(middle));
    }
  }
}

TEST(MedianFilter, BeginsAnewAfterAGap) {
  MedianFilter filter(3);
  for (const int ms : {0, 320, 740}) filter.update(1.0F, milliseconds(ms));
  const auto later = milliseconds(740) + MedianFilter::kGap + milliseconds(1);
  EXPECT_EQ(filter.update(2.0F, later).range, 2.0F);
  EXPECT_EQ(filter.update(2.0F, later + milliseconds(50)).range, 2.0F);
}

}  // namespace
}  // namespace usher::estimation
