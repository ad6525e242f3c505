#include "foundation/imaging/appearance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::imaging {
namespace {

LabColor lab(std::uint8_t r, std::uint8_t g, std::uint8_t b, double gain = 1.0) {
  return to_lab({gain * to_linear(r), gain * to_linear(g), gain * to_linear(b)});
}

ClothesColor clothes(const LabColor& color, int images = 1) { return {color, images}; }

Appearance red_over_jeans(double gain = 1.0) {
  return {clothes(lab(165, 35, 40, gain)), clothes(lab(48, 66, 100, gain))};
}
Appearance black_over_black() { return {clothes(lab(28, 28, 30)), clothes(lab(30, 30, 33))}; }

TEST(Lab, IsThatOfKnownColors) {
  const LabColor white = lab(255, 255, 255);
  EXPECT_NEAR(white.lightness, 100.0, 0.01);
  EXPECT_NEAR(std::hypot(white.a, white.b), 0.0, 0.02);
  const LabColor red = lab(255, 0, 0);  // published: 53.24, 80.09, 67.20
  EXPECT_NEAR(red.lightness, 53.24, 0.02);
  EXPECT_NEAR(red.a, 80.09, 0.05);
  EXPECT_NEAR(red.b, 67.20, 0.05);
  EXPECT_NEAR(lab(0, 0, 0).lightness, 0.0, 1e-9);
  EXPECT_LT(lab(0, 255, 0).a, -80.0);
  EXPECT_LT(lab(0, 0, 255).b, -100.0);
}

TEST(Srgb, IsTheSameThereAndBack) {
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    EXPECT_EQ(to_srgb(to_linear(byte)), byte);
  }
  EXPECT_EQ(to_srgb(-1.0), 0);
  EXPECT_EQ(to_srgb(7.0), 255);
}

TEST(Unlikeness, IsSmallInOtherLightAndLargeForOtherClothes) {
  for (const double gain : {0.6, 1.0, 1.6})
    EXPECT_LT(unlikeness(red_over_jeans(), red_over_jeans(gain)).value(), kAlike) << gain;
  EXPECT_GT(unlikeness(red_over_jeans(), black_over_black()).value(), kAnother);
  EXPECT_EQ(unlikeness(red_over_jeans(), red_over_jeans()).value(), 0.0);
}

TEST(Unlikeness, ComparesOnlyWhatBothShow) {
  Appearance legs = black_over_black();
  legs.upper = {};
  Appearance upper = red_over_jeans();
  upper.legs = {};
  EXPECT_FALSE(unlikeness(legs, upper));
  EXPECT_FALSE(unlikeness(Appearance{}, red_over_jeans()));
  EXPECT_EQ(unlikeness(upper, red_over_jeans()).value(), 0.0);
  EXPECT_TRUE(upper.known());
  EXPECT_FALSE(Appearance{}.known());
}

TEST(Unlikeness, TrustsOneCameraMoreThanTwo) {
  const double same = unlikeness(red_over_jeans(), black_over_black()).value();
  const Appearances one{red_over_jeans(), Appearance{}}, other{Appearance{}, black_over_black()};
  EXPECT_LT(unlikeness(one, other).value(), same);
  EXPECT_GT(unlikeness(one, other).value(), kAlike);
  const Appearances both{red_over_jeans(), black_over_black()};
  EXPECT_EQ(unlikeness(one, both).value(), 0.0) << "the same camera's colors count";
  EXPECT_EQ(unlikeness(both, Appearances{black_over_black(), black_over_black()}).value(), same)
      << "the camera to which he looks unlike";
  EXPECT_FALSE(unlikeness(Appearances{}, both));
}

TEST(Learn, IsTheMeanOfTheLastImages) {
  Appearance mean;
  learn(mean, {clothes({40.0, 10.0, -10.0}), {}});
  EXPECT_EQ(mean.upper.images, 1);
  EXPECT_FALSE(mean.legs.known());
  learn(mean, {clothes({50.0, 20.0, -20.0}), {}});
  EXPECT_NEAR(mean.upper.color.lightness, 45.0, 1e-9);
  EXPECT_NEAR(mean.upper.color.a, 15.0, 1e-9);
  EXPECT_NEAR(mean.upper.color.b, -15.0, 1e-9);
  learn(mean, {});
  EXPECT_EQ(mean.upper.images, 2) << "an image that does not show it";
  for (int i = 0; i < 50; ++i) learn(mean, {clothes({80.0, 0.0, 0.0}), {}});
  EXPECT_EQ(mean.upper.images, ClothesColor::kImages);
  EXPECT_NEAR(mean.upper.color.lightness, 80.0, 0.1);
}

TEST(Blend, TakesAShareAndWhatWasNotKnown) {
  Appearance mean{clothes({40.0, 0.0, 0.0}, 3), {}};
  blend(mean, {clothes({60.0, 0.0, 0.0}, 9), clothes({20.0, 1.0, 1.0}, 4)}, 0.25);
  EXPECT_NEAR(mean.upper.color.lightness, 45.0, 1e-9);
  EXPECT_EQ(mean.upper.images, 9);
  EXPECT_EQ(mean.legs.color.lightness, 20.0);
  blend(mean, {}, 1.0);
  EXPECT_NEAR(mean.upper.color.lightness, 45.0, 1e-9);
}

}  // namespace
}  // namespace usher::imaging
