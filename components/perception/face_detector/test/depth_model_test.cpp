#include "perception/face_detector/core/depth_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/random/random.hpp"
#include "perception/face_detector/core/place.hpp"

namespace usher::face_detector {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<FaceSample> step_back(double from, double to, int count, double noise, Random& random) {
  const SizeModel truth{0.02, 0.0105, 4e-6};
  std::vector<FaceSample> samples;
  for (int i = 0; i < count; ++i) {
    const double depth = from + (to - from) * i / (count - 1);
    double size = 10.0;
    while (truth.depth(size) > depth) size += 0.05;
    samples.push_back({size, depth * (1.0 + noise * random.gaussian())});
  }
  return samples;
}

TEST(SizeModel, TheUsualOneIsAFaceOf16CentimetersOfAKinect) {
  const SizeModel usual;
  EXPECT_TRUE(check(usual).ok());
  EXPECT_NEAR(usual.depth(46.0), 2.0, 1e-9);
  EXPECT_TRUE(usual.holds(92.0 / 3.5));
  EXPECT_TRUE(usual.holds(92.0 / 0.3));
}

TEST(SizeModel, ThatCannotBeIsRefusedWithTheReason) {
  EXPECT_THAT(check({0.0, kNan, 0.0}).error(), HasSubstr("finite"));
  EXPECT_THAT(check({0.0, 0.01, 0.0, 50.0, 50.0}).error(), HasSubstr("range"));
  EXPECT_THAT(check({0.0, 0.01, 0.0, kNan, 50.0}).error(), HasSubstr("range"));
  EXPECT_THAT(check({-1.0, 0.01, 0.0}).error(), HasSubstr("positive"));
  EXPECT_THAT(check({0.5, 0.01, -2e-5}).error(), HasSubstr("larger faces must be nearer"));
}

TEST(DepthModel, TheMiddleFortyPercentHaveAModelOfTheirOwn) {
  DepthModel model;
  model.side.b = 0.02;
  EXPECT_EQ(model.at(320, 640).b, model.center.b);
  EXPECT_EQ(model.at(192, 640).b, model.center.b);
  EXPECT_EQ(model.at(448, 640).b, model.center.b);
  EXPECT_EQ(model.at(191, 640).b, model.side.b);
  EXPECT_EQ(model.at(449, 640).b, model.side.b);
}

TEST(Plausible, IsWhatAlgorithm6SaysIs) {
  const DepthModel model;
  const Plausibility rules;
  const Box box{297, 217, 46, 46};  // expected 2 m away
  const auto at = [&](double depth) { return plausible(box, depth, 640, model, rules); };
  EXPECT_TRUE(at(2.0));
  EXPECT_TRUE(at(1.71));
  EXPECT_TRUE(at(2.29));
  EXPECT_FALSE(at(1.69));
  EXPECT_FALSE(at(2.31));
  EXPECT_FALSE(at(kNan));
  EXPECT_FALSE(plausible({300, 220, 26, 26}, 3.51, 640, model, rules)) << "beyond 3.5 m";
  EXPECT_TRUE(plausible({300, 220, 26, 26}, 3.49, 640, model, rules));
  EXPECT_FALSE(plausible({0, 0, 500, 500}, 0.3, 640, model, rules)) << "no model of such a size";
}

TEST(MiddleDepth, IsTheMedianOfTheMiddleTwentyPercent) {
  std::vector<std::uint16_t> pixels(10'000, 4000);
  const imaging::DepthImage depth{100, 100, pixels};
  const Plausibility rules;
  std::vector<std::uint16_t> scratch;
  for (std::size_t row = 46; row <= 53; ++row) {
    for (std::size_t column = 46; column <= 53; ++column) pixels[100 * row + column] = 1500;
  }
  EXPECT_DOUBLE_EQ(middle_depth(depth, {30, 30, 40, 40}, rules, scratch).value(), 1.5);
  EXPECT_DOUBLE_EQ(middle_depth(depth, {0, 0, 100, 100}, rules, scratch).value(), 4.0)
      << "most of the middle 20 % lie behind";
}

TEST(MiddleDepth, LeavesOutWhatHasNone) {
  std::vector<std::uint16_t> pixels(10'000, 0);
  const imaging::DepthImage depth{100, 100, pixels};
  const Plausibility rules;
  std::vector<std::uint16_t> scratch;
  EXPECT_FALSE(middle_depth(depth, {30, 30, 40, 40}, rules, scratch));
  for (std::size_t row = 46; row <= 54; ++row) pixels[100 * row + 50] = 1500;
  EXPECT_FALSE(middle_depth(depth, {30, 30, 40, 40}, rules, scratch)) << "a ninth is too little";
  for (std::size_t row = 46; row <= 54; ++row)
    pixels[100 * row + 49] = 1600, pixels[100 * row + 48] = 1700;
  EXPECT_DOUBLE_EQ(middle_depth(depth, {30, 30, 40, 40}, rules, scratch).value(), 1.6);
  EXPECT_FALSE(middle_depth(depth, {-200, 0, 20, 20}, rules, scratch)) << "outside";
  EXPECT_FALSE(middle_depth(depth, {500, 500, 20, 20}, rules, scratch));
  EXPECT_FALSE(middle_depth({}, {30, 30, 40, 40}, rules, scratch));
}

TEST(FitSizeModel, FindsTheCurveAmongFalseDetections) {
  Random random(7);
  auto samples = step_back(0.5, 3.5, 80, 0.02, random);
  for (int i = 0; i < 20; ++i) samples.push_back({random.uniform(20, 200), random.uniform(0.4, 6)});
  const auto fit = fit_size_model(samples);
  ASSERT_TRUE(fit.ok()) << fit.error();
  const SizeModel truth{0.02, 0.0105, 4e-6};
  for (const double size : {30.0, 60.0, 120.0})
    EXPECT_NEAR(fit->model.depth(size) / truth.depth(size), 1.0, 0.02) << size;
  EXPECT_LT(fit->residual, 0.035);
  EXPECT_GE(std::count(fit->used.begin(), fit->used.begin() + 80, true), 78);
  EXPECT_LE(std::count(fit->used.begin() + 80, fit->used.end(), true), 8);
}

TEST(FitSizeModel, RefusesBadDataWithTheReason) {
  Random random(8);
  EXPECT_THAT(fit_size_model({}).error(), HasSubstr("at least 30 faces, found 0"));
  EXPECT_THAT(fit_size_model(step_back(0.5, 3.5, 29, 0.02, random)).error(), HasSubstr("found 29"));
  EXPECT_THAT(fit_size_model(step_back(1.5, 2.5, 60, 0.02, random)).error(), HasSubstr("factor"));
  auto samples = step_back(0.5, 3.5, 60, 0.02, random);
  samples[3].depth = kNan;
  EXPECT_THAT(fit_size_model(samples).error(), HasSubstr("a size and a depth"));
  samples = step_back(0.5, 3.5, 60, 0.14, random);
  EXPECT_FALSE(fit_size_model(samples).ok());
  std::vector<FaceSample> noise;
  noise.reserve(100);
  for (int i = 0; i < 100; ++i) noise.push_back({random.uniform(20, 200), random.uniform(0.4, 6)});
  EXPECT_THAT(fit_size_model(noise).error(), HasSubstr("lie off any curve"));
}

TEST(PlaceOf, IsSeenFromTheRobot) {
  const imaging::Intrinsics kinect{640, 480, 575.8, 575.8, 319.5, 239.5};
  const auto level = fixed_camera(0.1, 1.15, 0.0);
  const Place ahead = place_of({297, 217, 46, 46}, 2.0, kinect, level);
  EXPECT_NEAR(ahead.range, 2.1, 1e-9);
  EXPECT_NEAR(ahead.bearing, 0.0, 1e-9);
  EXPECT_NEAR(ahead.elevation, 1.15, 1e-9);
  const Place left =
      place_of({297 - 287.9, 217 - 100, 46, 46}, 2.0, kinect, fixed_camera(0, 1.15, 0));
  EXPECT_NEAR(left.bearing, std::atan(0.5), 1e-9);
  EXPECT_NEAR(left.range, std::hypot(2.0, 1.0), 1e-9);
  EXPECT_NEAR(left.elevation, 1.15 + 2.0 * 100 / 575.8, 1e-9);
  const Place above = place_of({297, 217, 46, 46}, 2.0, kinect, fixed_camera(0.0, 1.15, 0.14));
  EXPECT_NEAR(above.elevation, 1.15 + 2.0 * std::sin(0.14), 1e-9);
  EXPECT_NEAR(above.range, 2.0 * std::cos(0.14), 1e-9);
}

}  // namespace
}  // namespace usher::face_detector
