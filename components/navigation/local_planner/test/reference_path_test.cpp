#include "navigation/local_planner/core/reference_path.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::local_planner {
namespace {

TEST(PolylineDistance, IsTheSameOnEveryInstructionSet) {
  Random random(2);
  PolylineDistance portable(cpu::Simd::kPortable);
  PolylineDistance best(cpu::best_simd());
  for (int i = 0; i < 60; ++i) {
    float c[4];
    for (float& v : c) v = static_cast<float>(random.uniform(-3, 3));
    portable.add(c[0], c[1], c[2], c[3]);
    best.add(c[0], c[1], c[2], c[3]);
  }
  std::vector<float> x(1000), y(1000), one(1000), other(1000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<float>(random.uniform(-4, 4)),
    y[i] = static_cast<float>(random.uniform(-4, 4));
  }
  portable.measure(x, y, one);
  best.measure(x, y, other);
  EXPECT_EQ(one, other);
}

TEST(PolylineDistance, KnowsSidesEndsAndPoints) {
  PolylineDistance line;
  line.add(0, 0, 2, 0);
  line.add(2, 0, 2, 0);
  const std::vector<float> x{1, -3, 5, 2, 0, 0, 0, 0};
  const std::vector<float> y{2, 4, 4, 0, 0, 0, 0, 3};
  std::vector<float> d(8);
  line.measure(x, y, d);
  EXPECT_EQ(d, (std::vector<float>{2, 5, 5, 0, 0, 0, 0, 3}));
  line.clear();
  line.measure(x, y, d);
  EXPECT_EQ(d[0], std::numeric_limits<float>::infinity());
}

std::vector<geometry::Pose2> there_and_back() {
  return {{0, 0, 0}, {5, 0, 0}, {5, 0.4, 0}, {0, 0.4, 1.0}};
}

TEST(ReferencePath, StaysOnItsLegWhereThePathPassesTwice) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  for (int i = 0; i <= 30; ++i) path.advance({0.1 * i, 0.25});  // nearer to the way back
  EXPECT_NEAR(path.progress(), 3.0, 0.05);
}

TEST(ReferencePath, FindsTheRobotAgainAfterAJump) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  path.advance({4.0, 0.0});
  EXPECT_NEAR(path.progress(), 4.0, 1e-9);
}

TEST(ReferencePath, RunsStraightOnBeyondItsEnd) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  EXPECT_NEAR(path.length(), 10.4, 1e-12);
  EXPECT_NEAR(path.at(10.9).x, -0.5, 1e-9);
  EXPECT_EQ(path.goal().yaw, 1.0);
}

TEST(ReferencePath, OnePoseIsAPath) {
  ReferencePath path;
  ASSERT_TRUE(path.set(std::vector<geometry::Pose2>{{1, 2, 0}, {1, 2, 0.5}}).ok());
  path.advance({0, 0});
  EXPECT_EQ(path.length(), 0.0);
  EXPECT_EQ(path.goal().yaw, 0.5);
  EXPECT_NEAR(path.at(0.0).x, 1.0, 1e-12);
}

TEST(ReferencePath, RefusesNothingAndNonsenseAndKeepsWhatItHas) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  EXPECT_FALSE(path.set({}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Status status = path.set(std::vector<geometry::Pose2>{{0, 0, 0}, {nan, 0, 0}});
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().find("pose 1"), std::string::npos);
  EXPECT_NEAR(path.length(), 10.4, 1e-12);
}

}  // namespace
}  // namespace usher::local_planner
