#include "simulation/world/core/pioneer.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::world {
namespace {

TEST(Pioneer, FollowsACommandAndStopsWhenCommandsCease) {
  Pioneer base(PioneerConfig{}, 1);
  base.place({1.0, 2.0, 0.0});
  for (int i = 0; i < 300; ++i) base.command({0.6, 0.0}), base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.6, 1e-3);
  EXPECT_EQ(base.truth().pitch, 0.0);
  for (int i = 0; i < 300; ++i) base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.0, 1e-3);
}

TEST(Pioneer, TurnsOnTheSpot) {
  Pioneer base(PioneerConfig{}, 1);
  base.place({});
  for (int i = 0; i < 300; ++i) base.command({0.0, 1.0}), base.step();
  EXPECT_NEAR(base.truth().twist.w, 1.0, 1e-3);
  EXPECT_EQ(base.truth().pose.x, 0.0);
}

TEST(Pioneer, OdometryIsNearTheTruthButNotEqual) {
  Pioneer base(PioneerConfig{}, 3);
  base.place({});
  for (int i = 0; i < 1000; ++i) base.command({0.5, 0.0}), base.step();
  EXPECT_NEAR(base.readings().travel(), base.truth().pose.x, 0.04 * base.truth().pose.x);
  EXPECT_NE(base.readings().travel(), base.truth().pose.x);
}

TEST(Pioneer, EmergencyStopLatches) {
  Pioneer base(PioneerConfig{}, 1);
  base.place({});
  for (int i = 0; i < 200; ++i) base.command({0.8, 0.0}), base.step();
  const double from = base.truth().pose.x;
  base.emergency_stop();
  for (int i = 0; i < 100; ++i) base.command({0.8, 0.0}), base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.0, 1e-3);
  EXPECT_LT(base.truth().pose.x - from, 0.3);
  base.reset();
  for (int i = 0; i < 200; ++i) base.command({0.8, 0.0}), base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.8, 1e-3);
}

TEST(Pioneer, IgnoresWhatIsNotFinite) {
  Pioneer base(PioneerConfig{}, 1);
  base.place({});
  base.command({std::nan(""), 0.0});
  base.step();
  EXPECT_EQ(base.truth().twist.v, 0.0);
}

}  // namespace
}  // namespace usher::world
