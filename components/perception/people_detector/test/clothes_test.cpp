#include "perception/people_detector/core/clothes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/random/random.hpp"

namespace usher::people_detector {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr imaging::Intrinsics kLens{320, 240, 287.9, 287.9, 159.5, 119.5};
constexpr View kView{0.9, 0.1, 0.05};
constexpr Rgb kRed{165, 35, 40}, kBlue{48, 66, 100}, kGreen{50, 160, 60};

/// Upright boards before a camera, each with a color above its middle and one below.
class Picture {
 public:
  Picture() : millimeters_(320 * 240, 0), rgb_(3 * 320 * 240, 200) {}

  void add(double forward, double left, double height, const Rgb& upper, const Rgb& legs,
           double half_width = 0.2) {
    for (int row = 0; row < kLens.height; ++row) {
      for (int column = 0; column < kLens.width; ++column) {
        const double u = (column - kLens.cx) / kLens.fx, v = (row - kLens.cy) / kLens.fy;
        const double x = u * std::cos(kView.roll) - v * std::sin(kView.roll);
        const double y = u * std::sin(kView.roll) + v * std::cos(kView.roll);
        const double along = forward / (std::cos(kView.down) - y * std::sin(kView.down));
        const double up = kView.height - along * (std::sin(kView.down) + y * std::cos(kView.down));
        const auto i = static_cast<std::size_t>(row * kLens.width + column);
        const bool hidden = millimeters_[i] != 0 && 1e-3 * millimeters_[i] < along;
        if (std::abs(-x * along - left) > half_width || up < 0.0 || up > height || hidden) continue;
        millimeters_[i] = static_cast<std::uint16_t>(1000.0 * along);
        std::ranges::copy(up > 0.53 * height ? upper : legs, rgb_.begin() + 3 * i);
      }
    }
  }
  /// Of every n-th pixel.
  void spoil(std::size_t every, const Rgb& color) {
    for (std::size_t i = 0; i < millimeters_.size(); i += every)
      std::ranges::copy(color, rgb_.begin() + 3 * static_cast<std::ptrdiff_t>(i));
  }
  imaging::Appearance look(const Sighting& person) {
    Clothes clothes(kLens);
    return clothes.look({320, 240, millimeters_}, {320, 240, rgb_}, kView, person);
  }

  std::vector<std::uint16_t> millimeters_;
  std::vector<std::uint8_t> rgb_;
};

imaging::LabColor lab(const Rgb& color) {
  return imaging::to_lab(
      {imaging::to_linear(color[0]), imaging::to_linear(color[1]), imaging::to_linear(color[2])});
}

void expect_color(const imaging::ClothesColor& clothes, const Rgb& color) {
  ASSERT_TRUE(clothes.known());
  EXPECT_NEAR(clothes.color.lightness, lab(color).lightness, 0.5);
  EXPECT_NEAR(clothes.color.a, lab(color).a, 0.5);
  EXPECT_NEAR(clothes.color.b, lab(color).b, 0.5);
}

TEST(Clothes, AreSeenAtAnyPlaceOfAnImage) {
  for (const double forward : {1.5, 3.0, 5.5}) {
    for (const double left : {-0.25, 0.0, 0.25}) {
      Picture picture;
      picture.add(forward, left * forward, 1.75, kRed, kBlue);
      const auto seen = picture.look({forward, left * forward, 1.75, 1.0, {}});
      expect_color(seen.upper, kRed);
      if (forward > 2.0) expect_color(seen.legs, kBlue);
    }
  }
}

TEST(Clothes, AreThoseOfTheOneWhoIsMeant) {
  Picture picture;
  picture.add(4.0, 0.0, 1.8, kGreen, kGreen, 1.5);  // a crowd behind and beside
  picture.add(2.5, 0.0, 1.7, kRed, kBlue);
  const auto seen = picture.look({2.5, 0.0, 1.7, 1.0, {}});
  expect_color(seen.upper, kRed);
  expect_color(seen.legs, kBlue);
}

TEST(Clothes, AreTheMedianOfWhatIsSeen) {
  Picture picture;
  picture.add(2.5, 0.0, 1.7, kRed, kBlue);
  picture.spoil(3, kGreen);
  const auto seen = picture.look({2.5, 0.0, 1.7, 1.0, {}});
  ASSERT_TRUE(seen.upper.known());
  EXPECT_NEAR(seen.upper.color.a, lab(kRed).a, 2.0);
}

TEST(Clothes, OfWhoIsNotUprightAreKnownFromTheHipsUpOnly) {
  Picture picture;
  picture.add(2.5, 0.0, 1.2, kRed, kBlue);
  const auto seen = picture.look({2.5, 0.0, 1.2, 1.0, {}});
  expect_color(seen.upper, kRed);
  EXPECT_FALSE(seen.legs.known());
}

TEST(Clothes, AreNotKnownWhereTooLittleIsSeen) {
  Picture hidden;
  hidden.add(2.5, 0.0, 1.7, kRed, kBlue, 0.2);
  hidden.add(1.5, 0.0, 0.95, kGreen, kGreen, 1.0);  // a counter hides the legs
  const auto seen = hidden.look({2.5, 0.0, 1.7, 1.0, {}});
  expect_color(seen.upper, kRed);
  EXPECT_FALSE(seen.legs.known());
  EXPECT_FALSE(Picture().look({2.5, 0.0, 1.7, 1.0, {}}).known()) << "nobody";
}

TEST(Clothes, ThatAreExposedWronglyAreNotKnown) {
  for (const Rgb& wrong : {Rgb{255, 255, 255}, Rgb{255, 120, 90}, Rgb{2, 3, 1}}) {
    Picture picture;
    picture.add(2.5, 0.0, 1.7, wrong, kBlue);
    const auto seen = picture.look({2.5, 0.0, 1.7, 1.0, {}});
    EXPECT_FALSE(seen.upper.known());
    expect_color(seen.legs, kBlue);
  }
  Picture some;  // a few pixels that shine do not matter
  some.add(2.5, 0.0, 1.7, kRed, kBlue);
  some.spoil(4, {255, 255, 255});
  expect_color(some.look({2.5, 0.0, 1.7, 1.0, {}}).upper, kRed);
}

TEST(Clothes, OfImagesThatDoNotFitAreNotKnown) {
  Picture picture;
  picture.add(2.5, 0.0, 1.7, kRed, kBlue);
  Clothes clothes(kLens);
  const Sighting person{2.5, 0.0, 1.7, 1.0, {}};
  const imaging::DepthImage depth{320, 240, picture.millimeters_};
  const std::span<const std::uint8_t> rgb(picture.rgb_);
  EXPECT_TRUE(clothes.look(depth, {320, 240, rgb}, kView, person).known());
  EXPECT_FALSE(clothes.look(depth, {160, 120, rgb.first(3 * 160 * 120)}, kView, person).known());
  EXPECT_FALSE(clothes.look(depth, {320, 240, rgb.first(100)}, kView, person).known());
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_FALSE(clothes.look(depth, {320, 240, rgb}, kView, {wrong, 0, 1.7, 1, {}}).known());
    EXPECT_FALSE(clothes.look(depth, {320, 240, rgb}, kView, {2.5, wrong, 1.7, 1, {}}).known());
  }
  EXPECT_FALSE(clothes.look(depth, {320, 240, rgb}, kView, {2.5, 0, std::nan(""), 1, {}}).known());
}

TEST(Clothes, SurviveAnyBytes) {
  Random random(5);
  Picture picture;
  for (auto& depth : picture.millimeters_) depth = static_cast<std::uint16_t>(random.next());
  for (auto& byte : picture.rgb_) byte = static_cast<std::uint8_t>(random.next());
  Clothes clothes(kLens);
  for (int i = 0; i < 200; ++i) {
    const Sighting person{
        random.uniform(-2.0, 8.0), random.uniform(-5.0, 5.0), random.uniform(0.0, 3.0), 1.0, {}};
    const View view{random.uniform(0.05, 3.0), random.uniform(-1.2, 1.2),
                    random.uniform(-1.2, 1.2)};
    const auto seen =
        clothes.look({320, 240, picture.millimeters_}, {320, 240, picture.rgb_}, view, person);
    EXPECT_TRUE(std::isfinite(seen.upper.color.lightness + seen.legs.color.a));
  }
}

}  // namespace
}  // namespace usher::people_detector
