#include "drivers/torso/core/safe_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace usher::torso {
namespace {

using kinematics::TorsoPose;
constexpr double kStep = 0.05;

SafeFrame::Parameters parameters() {
  SafeFrame::Parameters p;
  p.limits.fill({-0.4, 0.4, 0.5});
  return p;
}

TorsoFrame wanting(double joint) {
  TorsoFrame frame;
  frame.joints.fill(joint);
  frame.left_eye = {1.0F, 0.5F, 0.0F};
  frame.right_eye = {0.0F, 1.0F, 0.0F};
  return frame;
}

TEST(SafeFrame, TellsNothingUntilItKnowsWhereTheJointsAre) {
  SafeFrame safe(parameters());
  const TorsoFrame wanted = wanting(0.1);
  EXPECT_FALSE(safe.step(&wanted, kStep));
  TorsoPose unknown{};
  unknown[3] = std::nan("");
  safe.start_at(unknown);
  EXPECT_FALSE(safe.step(&wanted, kStep));
  safe.start_at({});
  EXPECT_TRUE(safe.step(&wanted, kStep));
}

TEST(SafeFrame, GoesFromWhereTheJointsAreNoFasterThanTheyMayAndNoFarther) {
  SafeFrame safe(parameters());
  TorsoPose last;
  last.fill(-0.3);
  safe.start_at(last);
  const TorsoFrame wanted = wanting(9.0);
  for (int i = 0; i < 40; ++i) {
    const auto frame = safe.step(&wanted, kStep);
    for (std::size_t j = 0; j < kinematics::kTorsoJoints; ++j) {
      EXPECT_LE(std::abs(frame->joints[j] - last[j]), 0.5 * kStep + 1e-12);
      EXPECT_LE(frame->joints[j], 0.4);
    }
    last = frame->joints;
    safe.start_at({});  // it knows already
  }
  EXPECT_EQ(last[0], 0.4);
}

TEST(SafeFrame, HoldsAndDimsInSilenceAndComesBack) {
  SafeFrame safe(parameters());
  safe.start_at({});
  const TorsoFrame wanted = wanting(0.4);
  for (int i = 0; i < 40; ++i) safe.step(&wanted, kStep);
  const auto full = safe.step(&wanted, kStep);
  EXPECT_EQ(full->left_eye, wanted.left_eye);
  const TorsoFrame other = wanting(-0.4);
  safe.step(&other, kStep);
  const auto moving = safe.step(&other, kStep);
  const auto first = safe.step(nullptr, kStep);
  EXPECT_EQ(first->joints, moving->joints) << "holds where it is, not where it would go";
  EXPECT_LT(first->left_eye[0], 1.0F);
  EXPECT_GT(first->left_eye[0], 0.9F) << "dims, does not go dark";
  std::optional<TorsoFrame> later;
  for (int i = 0; i < 100; ++i) later = safe.step(nullptr, kStep);
  EXPECT_EQ(later->joints, moving->joints);
  EXPECT_FLOAT_EQ(later->left_eye[0], 0.15F);
  EXPECT_FLOAT_EQ(later->left_eye[1], 0.075F);
  for (int i = 0; i < 40; ++i) later = safe.step(&wanted, kStep);
  EXPECT_EQ(later->left_eye, wanted.left_eye);
}

TEST(SafeFrame, TakesWhatIsNotFiniteForSilence) {
  SafeFrame safe(parameters());
  safe.start_at({});
  TorsoFrame wanted = wanting(0.1);
  for (int i = 0; i < 40; ++i) safe.step(&wanted, kStep);
  wanted.joints[6] = std::numeric_limits<double>::infinity();
  const auto frame = safe.step(&wanted, kStep);
  EXPECT_EQ(frame->joints[6], 0.1);
  EXPECT_EQ(frame->joints[0], 0.1);
  EXPECT_LT(frame->left_eye[0], 1.0F);
}

TEST(SafeFrame, StartsAnewFromWhereTheJointsAreAfterTheyWereLost) {
  SafeFrame safe(parameters());
  safe.start_at({});
  const TorsoFrame wanted = wanting(0.4);
  for (int i = 0; i < 40; ++i) safe.step(&wanted, kStep);
  safe.forget();
  EXPECT_FALSE(safe.step(&wanted, kStep));
  TorsoPose fallen;
  fallen.fill(-0.2);
  safe.start_at(fallen);
  EXPECT_NEAR(safe.step(&wanted, kStep)->joints[0], -0.2 + 0.5 * kStep, 1e-12);
}

}  // namespace
}  // namespace usher::torso
