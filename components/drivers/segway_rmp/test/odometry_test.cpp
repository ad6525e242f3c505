#include "drivers/segway_rmp/core/odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/geometry/angle.hpp"

namespace usher::segway_rmp {
namespace {

constexpr double kRadius = 0.2355;
constexpr double kTrack = 0.5398;
constexpr double kPeriod = 0.01;

/// A base whose true motion is known; its odometers turn with the leaning body.
struct TrueBase {
  double left = 0.0, right = 0.0;  ///< [m] over the floor
  double pitch = 0.0, pitch_rate = 0.0;
  double v = 0.0, w = 0.0;

  SegwayFeedback feedback() const {
    SegwayFeedback feedback;
    feedback.pitch = pitch;
    feedback.pitch_rate = pitch_rate;
    feedback.left_travel = left - kRadius * pitch;
    feedback.right_travel = right - kRadius * pitch;
    feedback.left_velocity = v - 0.5 * kTrack * w - kRadius * pitch_rate;
    feedback.right_velocity = v + 0.5 * kTrack * w - kRadius * pitch_rate;
    return feedback;
  }
  void lean(double to) {
    pitch_rate = (to - pitch) / kPeriod;
    pitch = to;
  }
  void drive(double speed, double turn) {
    v = speed;
    w = turn;
    left += (v - 0.5 * kTrack * w) * kPeriod;
    right += (v + 0.5 * kTrack * w) * kPeriod;
  }
};

TEST(Odometry, RejectsMeasurementsThatHang) {
  Odometry odometry;
  TrueBase base;
  SegwayFeedback feedback;
  const auto after = [&](int ms) {
    feedback.stamp += std::chrono::milliseconds(ms);
    return odometry.update(feedback);
  };
  for (int i = 0; i < 10; ++i) {
    base.drive(0.5, 0.0);
    const auto stamp = feedback.stamp;
    feedback = base.feedback();
    feedback.stamp = stamp;
    EXPECT_TRUE(after(10));
  }
  EXPECT_TRUE(after(250)) << "a lost cycle or two";
  EXPECT_FALSE(after(10)) << "it moves, and gets nowhere";
  EXPECT_EQ(odometry.rejected(), 1U);
  base.drive(0.5, 0.0);
  const auto stamp = feedback.stamp;
  feedback = base.feedback();
  feedback.stamp = stamp;
  EXPECT_TRUE(after(10));
  feedback.left_velocity = feedback.right_velocity = 0.0;
  EXPECT_TRUE(after(5000)) << "it stands";
}

TEST(Odometry, LeaningIsNotDriving) {
  Odometry odometry;
  TrueBase base;
  odometry.update(base.feedback());
  double least_raw_speed = 0.0;
  for (int i = 1; i <= 20; ++i) {  // leans to 7.5 deg in 0.2 s over standing wheels
    base.lean(geometry::radians(7.5) * i / 20.0);
    ASSERT_TRUE(odometry.update(base.feedback()));
    EXPECT_NEAR(odometry.pose().x, 0.0, 1e-12);
    EXPECT_NEAR(odometry.twist().v, 0.0, 1e-12);
    least_raw_speed = std::min(least_raw_speed, odometry.raw_twist().v);
  }
  EXPECT_NEAR(odometry.raw_pose().x, -kRadius * geometry::radians(7.5), 1e-12);
  EXPECT_LT(least_raw_speed, -0.1) << "the backward speed that the thesis saw";
}

TEST(Odometry, FollowsAnAcceleratingTurningLeaningBase) {
  Odometry odometry;
  TrueBase base;
  odometry.update(base.feedback());
  geometry::Pose2 truth;
  for (int i = 1; i <= 2000; ++i) {
    const double t = i * kPeriod;
    base.lean(geometry::radians(10.0) * std::sin(1.3 * t));
    base.drive(0.8 + 0.5 * std::sin(t), 0.4 * std::cos(0.7 * t));
    truth = geometry::integrate(truth, {base.v, base.w}, kPeriod);
    ASSERT_TRUE(odometry.update(base.feedback()));
  }
  EXPECT_NEAR(odometry.pose().x, truth.x, 1e-6);
  EXPECT_NEAR(odometry.pose().y, truth.y, 1e-6);
  EXPECT_NEAR(odometry.pose().yaw, truth.yaw, 1e-9);
  EXPECT_NEAR(odometry.twist().v, base.v, 1e-9);
  EXPECT_NEAR(odometry.twist().w, base.w, 1e-9);
  EXPECT_GT(geometry::distance(odometry.raw_pose(), truth), 0.02);
}

TEST(Odometry, StartsWhereverTheCountersStand) {
  Odometry odometry;
  TrueBase base;
  base.left = base.right = 1234.5;
  base.pitch = 0.1;
  EXPECT_TRUE(odometry.update(base.feedback()));
  EXPECT_EQ(odometry.pose(), geometry::Pose2{});
  base.drive(1.0, 0.0);
  EXPECT_TRUE(odometry.update(base.feedback()));
  EXPECT_NEAR(odometry.pose().x, 0.01, 1e-9);
}

TEST(Odometry, CountsWhatTheBaseRolledOnWhileItsLineWasCut) {
  Odometry odometry;
  TrueBase base;
  odometry.update(base.feedback());
  geometry::Pose2 truth;
  const auto drive = [&](double v, double w) {
    base.drive(v, w);
    truth = geometry::integrate(truth, {v, w}, kPeriod);
  };
  for (int i = 0; i < 100; ++i) {
    drive(0.7, 0.2);
    ASSERT_TRUE(odometry.update(base.feedback()));
  }
  odometry.interrupt();
  for (int i = 0; i < 150; ++i) drive(0.7 * (1.0 - i / 150.0), 0.2 * (1.0 - i / 150.0));
  base.drive(0.0, 0.0);
  ASSERT_TRUE(odometry.update(base.feedback()));
  EXPECT_EQ(odometry.rejected(), 0U);
  EXPECT_LT(geometry::distance(odometry.pose(), truth), 0.01);
  EXPECT_NEAR(odometry.pose().yaw, truth.yaw, 1e-9);
}

TEST(Odometry, ResumesWhereAnEarlierOneEnded) {
  Odometry first;
  EXPECT_FALSE(first.wheels()) << "nothing heard";
  TrueBase base;
  base.left = base.right = 1234.5;
  base.drive(0.7, 0.2);
  first.update(base.feedback());
  const auto wheels = read_wheels(to_text(first.wheels().value()));
  ASSERT_TRUE(wheels);
  Odometry second;
  second.resume(*wheels);
  for (int i = 0; i < 100; ++i) base.drive(0.4, 0.0);
  base.drive(0.0, 0.0);
  ASSERT_TRUE(second.update(base.feedback()));
  EXPECT_NEAR(second.pose().x, 0.4, 1e-9);
  for (const char* text : {"", "1 2 3 4", "1 2 3 4 nan", "1 2 x 4 5"})
    EXPECT_FALSE(read_wheels(text)) << text;
}

TEST(Odometry, AnInterruptedLineIsNoMotion) {
  Odometry odometry;
  SegwayFeedback feedback;
  feedback.left_velocity = feedback.right_velocity = 0.8;
  for (int i = 0; i <= 100; ++i) {
    feedback.left_travel = feedback.right_travel = 0.008 * i;
    ASSERT_TRUE(odometry.update(feedback));
  }
  const geometry::Pose2 before = odometry.pose();
  EXPECT_NEAR(before.x, 0.8, 1e-9);
  odometry.interrupt();
  EXPECT_EQ(odometry.twist(), (geometry::Twist2{})) << "nobody knows, so nothing moves";
  feedback.left_travel = feedback.right_travel = 0.0;  // a base switched on again counts from zero
  ASSERT_TRUE(odometry.update(feedback));
  EXPECT_EQ(odometry.pose(), before);
  feedback.left_travel = feedback.right_travel = 0.01;
  ASSERT_TRUE(odometry.update(feedback));
  EXPECT_NEAR(odometry.pose().x, 0.81, 1e-9);
}

TEST(Odometry, RejectsLeapsAndNonsenseAndGoesOn) {
  Odometry odometry;
  TrueBase base;
  odometry.update(base.feedback());
  base.left += 5.0;
  EXPECT_FALSE(odometry.update(base.feedback()));
  EXPECT_EQ(odometry.pose(), geometry::Pose2{});
  SegwayFeedback broken = base.feedback();
  broken.pitch = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(odometry.update(broken));
  broken = base.feedback();
  broken.right_travel = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(odometry.update(broken));
  EXPECT_EQ(odometry.rejected(), 3U);
  base.drive(1.0, 0.0);
  EXPECT_TRUE(odometry.update(base.feedback()));
  EXPECT_NEAR(odometry.pose().x, 0.01, 1e-9);
  EXPECT_NEAR(odometry.pose().yaw, 0.0, 1e-9);
}

}  // namespace
}  // namespace usher::segway_rmp
