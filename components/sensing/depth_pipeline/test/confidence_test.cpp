#include "sensing/depth_pipeline/core/confidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace usher::depth_pipeline {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Rated {
  float range, intensity;
};

Rated rate(Confidence& confidence, float range) {
  std::vector<float> ranges{range}, intensities{-1.0F};
  confidence.rate(ranges, 0.2, intensities);
  return {ranges[0], intensities[0]};
}

TEST(Confidence, FollowsEquation423WithItsAbsoluteValue) {
  Confidence confidence(1, 3, 0.5, 5.0);
  rate(confidence, 2.0F);
  rate(confidence, 2.0F);
  // mean (2 + 2 + 1.7) / 3 = 1.9
  EXPECT_NEAR(rate(confidence, 1.7F).intensity, 1.0 - 0.2 / 0.5, 1e-6);
}

TEST(Confidence, DropsASingleNearPointAndASingleFarOne) {
  Confidence confidence(1, 3, 0.5, 5.0);
  for (int i = 0; i < 3; ++i) rate(confidence, 4.0F);
  EXPECT_EQ(rate(confidence, 4.0F).range, 4.0F);
  EXPECT_TRUE(std::isnan(rate(confidence, 0.8F).range));
  for (int i = 0; i < 3; ++i) rate(confidence, 4.0F);
  EXPECT_EQ(rate(confidence, 4.0F).range, 4.0F);
  EXPECT_TRUE(std::isnan(rate(confidence, kInfinity).range));
}

TEST(Confidence, BelievesWhatStaysWithinItsFrames) {
  Confidence confidence(1, 3, 0.5, 5.0);
  for (int i = 0; i < 3; ++i) rate(confidence, kInfinity);
  EXPECT_TRUE(std::isnan(rate(confidence, 1.0F).range));
  EXPECT_TRUE(std::isnan(rate(confidence, 1.0F).range));
  EXPECT_EQ(rate(confidence, 1.0F).range, 1.0F);
  EXPECT_EQ(rate(confidence, 1.0F).intensity, 1.0F);
}

TEST(Confidence, WhatWasNotMeasuredIsNoPartOfTheMean) {
  Confidence confidence(1, 3, 0.5, 5.0);
  EXPECT_EQ(rate(confidence, 1.5F).intensity, 0.0F);
  EXPECT_EQ(rate(confidence, kNan).intensity, 0.0F);
  EXPECT_EQ(rate(confidence, 1.5F).intensity, 1.0F);
}

TEST(Confidence, TheFirstFrameAfterItForgotIsNotBelieved) {
  Confidence confidence(1, 3, 0.5, 5.0);
  for (int i = 0; i < 3; ++i) rate(confidence, 2.0F);
  confidence.forget();
  EXPECT_TRUE(std::isnan(rate(confidence, 2.0F).range));
  EXPECT_EQ(rate(confidence, 2.0F).range, 2.0F);
}

TEST(Confidence, OneFrameAfterNothingWasMeasuredIsNotBelieved) {
  Confidence confidence(1, 3, 0.5, 5.0);
  for (int i = 0; i < 3; ++i) rate(confidence, kNan);
  EXPECT_TRUE(std::isnan(rate(confidence, 1.5F).range));
  EXPECT_EQ(rate(confidence, 1.5F).range, 1.5F);
}

TEST(Confidence, OfOneFrameTrustsAll) {
  Confidence confidence(1, 1, 0.5, 5.0);
  EXPECT_EQ(rate(confidence, 4.0F).intensity, 1.0F);
  EXPECT_EQ(rate(confidence, 0.6F).intensity, 1.0F);
}

}  // namespace
}  // namespace usher::depth_pipeline
