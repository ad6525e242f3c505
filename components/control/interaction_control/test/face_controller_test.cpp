#include "control/interaction_control/core/face_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/geometry/angle.hpp"

namespace usher::interaction_control {
namespace {

/// A base that follows turn rates with the Segway's lag.
struct Base {
  double yaw = 0.0;
  double rate = 0.0;
  void step(double wanted) {
    rate += (wanted - rate) * 0.05 / 0.2;
    yaw += rate * 0.05;
  }
};

TEST(FaceController, StandsUntilItIsTold) {
  FaceController controller(Parameters{});
  EXPECT_EQ(controller.step(1.0), 0.0);
}

TEST(FaceController, FacesEveryBearingWithinTenSecondsAndStays) {
  for (double bearing = -3.1; bearing <= 3.1; bearing += 0.1) {
    const Parameters parameters;
    FaceController controller(parameters);
    Base base;
    base.yaw = 3.0;  // across the seam
    const double start = base.yaw;
    controller.face(start + bearing);
    int turns = 0;
    for (int i = 0; i < 400; ++i) {
      const double rate = controller.step(base.yaw);
      EXPECT_LE(std::abs(rate), parameters.max_rate);
      if (i > 200 && rate != 0.0) ++turns;
      base.step(rate);
    }
    EXPECT_LE(std::abs(geometry::shortest_turn(base.yaw, start + bearing)), parameters.resume_zone)
        << bearing;
    EXPECT_LE(std::abs(base.yaw - start), 3.2) << "the short way, " << bearing;
    EXPECT_EQ(turns, 0) << "no hunting, " << bearing;
  }
}

TEST(FaceController, APersonWhoSwaysDoesNotMoveIt) {
  FaceController controller(Parameters{});
  for (int i = 0; i < 200; ++i) {
    controller.face(0.2 * std::sin(i * 0.3));
    EXPECT_EQ(controller.step(0.0), 0.0);
  }
  EXPECT_TRUE(controller.faces());
}

TEST(FaceController, TurnsIntoTheDeadZoneNotOnlyToItsEdge) {
  FaceController controller(Parameters{});
  controller.face(0.5);
  EXPECT_GT(controller.step(0.0), 0.0);
  EXPECT_GT(controller.step(0.3), 0.0) << "between the two thresholds it goes on";
  EXPECT_EQ(controller.step(0.4), 0.0);
  EXPECT_EQ(controller.step(0.3), 0.0) << "and then it stays";
}

TEST(FaceController, SearchesSlowlyBothWays) {
  FaceController controller(Parameters{});
  controller.search(true);
  EXPECT_EQ(controller.step(0.0), Parameters{}.search_rate);
  controller.search(false);
  EXPECT_EQ(controller.step(9.0), -Parameters{}.search_rate);
  controller.stand();
  EXPECT_EQ(controller.step(9.0), 0.0);
}

TEST(FaceController, WhatIsNotFiniteMakesItStand) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FaceController controller(Parameters{});
  controller.face(1.0);
  EXPECT_EQ(controller.step(nan), 0.0);
  controller.face(nan);
  EXPECT_EQ(controller.step(0.0), 0.0);
}

}  // namespace
}  // namespace usher::interaction_control
