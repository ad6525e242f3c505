#include "interaction/phrases/core/way.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::phrases {
namespace {

TEST(RoundedHalfMinutes, AreHonestToAQuarterOfAMinute) {
  for (double seconds = 60.0; seconds < 300.0; seconds += 1.0)
    EXPECT_LE(std::abs(30.0 * static_cast<double>(rounded_half_minutes(seconds)) - seconds), 15.0)
        << seconds;
  EXPECT_EQ(rounded_half_minutes(0.0), 0);
  EXPECT_EQ(rounded_half_minutes(59.9), 0) << "less than a minute";
  EXPECT_EQ(rounded_half_minutes(60.0), 2);
  EXPECT_EQ(rounded_half_minutes(87.0), 3);
  EXPECT_EQ(rounded_half_minutes(299.0), 10);
  EXPECT_EQ(rounded_half_minutes(325.0), 10) << "whole minutes from five on";
  EXPECT_EQ(rounded_half_minutes(331.0), 12);
  EXPECT_GT(rounded_half_minutes(1e300), 0);
}

}  // namespace
}  // namespace usher::phrases
