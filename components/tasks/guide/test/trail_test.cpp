#include "tasks/guide/core/trail.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace usher::guide {
namespace {

TEST(Trail, IsGoneAlongAndNotCutShort) {
  Trail trail;
  trail.begin({0.0, 0.0});
  for (int i = 1; i <= 10; ++i) trail.see({0.3 * i, 0.0});
  for (int i = 1; i <= 4; ++i) trail.see({3.0, 0.3 * i});
  const auto before = trail.behind(0.6);
  ASSERT_TRUE(before);
  EXPECT_NEAR(before->x, 3.0, 1e-9);
  EXPECT_NEAR(before->y, 0.6, 1e-9);
  EXPECT_NEAR(before->yaw, std::numbers::pi / 2, 1e-9);
  const auto farther = trail.behind(2.2);
  ASSERT_TRUE(farther);
  EXPECT_NEAR(farther->x, 2.0, 1e-9);
  EXPECT_NEAR(farther->y, 0.0, 1e-9);
  EXPECT_FALSE(trail.behind(4.3)) << "longer than the way";
}

TEST(Trail, WhoStandsTakesNoWay) {
  Trail trail;
  EXPECT_TRUE(trail.empty());
  EXPECT_FALSE(trail.behind(0.1));
  trail.begin({0.0, 0.0});
  for (int i = 0; i < 1000; ++i) trail.see({1.0 + 0.05 * (i % 2), 0.05 * (i % 3)});
  EXPECT_FALSE(trail.behind(1.1)) << "to and fro is no way";
  EXPECT_TRUE(trail.behind(0.9));
}

TEST(Trail, WhoComesBackIsNotSoughtBeyondHim) {
  Trail trail;
  trail.begin({0.0, 0.0});
  for (int i = 1; i <= 20; ++i) trail.see({0.25 * i, 0.0});
  for (int i = 1; i <= 14; ++i) trail.see({5.0 - 0.25 * i, 0.1});
  EXPECT_NEAR(trail.newest().x(), 1.5, 1e-9);
  const auto behind = trail.behind(1.2);
  ASSERT_TRUE(behind);
  EXPECT_LT(behind->x, 1.0);
}

TEST(Trail, ForgetsWhatIsFarBehind) {
  Trail trail;
  trail.begin({0.0, 0.0});
  for (int i = 1; i <= 1000; ++i) trail.see({0.2 * i, 0.0});
  EXPECT_TRUE(trail.behind(20.0));
  EXPECT_FALSE(trail.behind(40.0));
}

}  // namespace
}  // namespace usher::guide
