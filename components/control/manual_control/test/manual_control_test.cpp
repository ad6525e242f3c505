#include "control/manual_control/core/manual_control.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace usher::manual_control {
namespace {

using std::chrono::milliseconds;

constexpr drive::WriterId kPad{1};
constexpr drive::WriterId kOtherPad{2};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
enum Button { kA = 0, kB = 1, kX = 2, kY = 3, kLb = 4 };

Time at(int ms) { return milliseconds(1000 + ms); }

struct Pad {
  ManualControl control;
  Wish joy(int ms, std::vector<int> down, float forward = 0.0F, float turn = 0.0F,
           const drive::WriterId& writer = kPad) {
    const std::vector<float> axes{0.0F, forward, 0.0F, turn};
    std::vector<std::int32_t> buttons(11, 0);
    for (const int button : down) buttons[static_cast<std::size_t>(button)] = 1;
    return control.take({writer, axes, buttons}, at(ms));
  }
  std::optional<double> v(int ms) {
    const auto twist = control.command(at(ms));
    return twist ? std::optional(twist->v) : std::nullopt;
  }
};

TEST(ManualControl, DrivesOnlyWhileTheButtonIsHeld) {
  Pad pad;
  pad.joy(0, {}, 1.0F);
  EXPECT_EQ(pad.v(0), std::nullopt);
  pad.joy(10, {kLb}, 1.0F);
  EXPECT_EQ(pad.v(10), 0.8);
  pad.joy(20, {}, 1.0F);
  EXPECT_EQ(pad.v(20), 0.0) << "at once";
  EXPECT_EQ(pad.v(319), 0.0);
  EXPECT_EQ(pad.v(320), std::nullopt) << "then others may drive";
}

TEST(ManualControl, SilenceReleasesAndABeginningNeedsANewPress) {
  Pad pad;
  pad.joy(0, {});
  pad.joy(10, {kLb}, 1.0F);
  EXPECT_EQ(pad.v(259), 0.8);
  EXPECT_EQ(pad.v(260), 0.0);
  pad.joy(270, {kLb}, 1.0F);
  EXPECT_EQ(pad.v(270), 0.0) << "still held: no new press";
  pad.joy(280, {});
  pad.joy(290, {kLb}, 1.0F);
  EXPECT_EQ(pad.v(290), 0.8);
}

TEST(ManualControl, AButtonHeldFromTheStartDoesNotCount) {
  Pad pad;
  for (int ms = 0; ms < 1000; ms += 50) {
    EXPECT_EQ(pad.joy(ms, {kLb, kA, kX}, 1.0F), Wish::kNone);
    EXPECT_EQ(pad.v(ms), std::nullopt);
  }
}

TEST(ManualControl, AJoyWithoutTheButtonReleases) {
  Pad pad;
  pad.joy(0, {});
  pad.joy(10, {kLb}, 1.0F);
  pad.control.take({kPad, {}, {}}, at(20));
  EXPECT_EQ(pad.v(20), 0.0);
}

TEST(ManualControl, NonsenseReleases) {
  Pad pad;
  pad.joy(0, {});
  pad.joy(10, {kLb}, 1.0F);
  pad.joy(20, {kLb}, kNan);
  EXPECT_EQ(pad.v(20), 0.0);
  EXPECT_EQ(pad.control.rejected(), 1U);
  pad.joy(30, {kLb}, 1.0F);
  EXPECT_EQ(pad.v(30), 0.0) << "not before it was released";
}

TEST(ManualControl, SticksHaveADeadZoneAndScale) {
  Pad pad;
  pad.joy(0, {});
  pad.joy(1, {kLb}, 0.12F, -0.12F);
  EXPECT_EQ(pad.control.command(at(1)), (geometry::Twist2{0.0, -0.0}));
  pad.joy(2, {kLb}, -1.0F, 0.56F);
  EXPECT_NEAR(pad.control.command(at(2))->v, -0.8, 1e-6);
  EXPECT_NEAR(pad.control.command(at(2))->w, 0.4, 1e-6);
  pad.joy(3, {kLb}, 7.0F);
  EXPECT_NEAR(pad.control.command(at(3))->v, 0.8, 1e-6) << "a stick ends at 1";
}

TEST(ManualControl, OnePadDrivesAtATime) {
  Pad pad;
  pad.joy(0, {}, 0.0F, 0.0F, kPad);
  pad.joy(0, {}, 0.0F, 0.0F, kOtherPad);
  pad.joy(10, {kLb}, 1.0F, 0.0F, kPad);
  pad.joy(20, {kLb}, -1.0F, 0.0F, kOtherPad);
  EXPECT_EQ(pad.v(20), 0.8);
  pad.joy(30, {}, -1.0F, 0.0F, kOtherPad);
  EXPECT_EQ(pad.v(30), 0.8) << "its release is not the holder's";
  pad.joy(40, {}, 1.0F, 0.0F, kPad);
  pad.joy(50, {kLb}, -1.0F, 0.0F, kOtherPad);
  EXPECT_EQ(pad.v(50), -0.8);
}

TEST(ManualControl, ButtonsAskOncePerPress) {
  struct Case {
    Button button;
    Wish wish;
  };
  for (const Case& test : {Case{kA, Wish::kMovementOn}, Case{kB, Wish::kMovementOff},
                           Case{kX, Wish::kManualOn}, Case{kY, Wish::kManualOff}}) {
    Pad pad;
    pad.joy(0, {});
    EXPECT_EQ(pad.joy(10, {test.button}), test.wish);
    EXPECT_EQ(pad.joy(20, {test.button}), Wish::kNone);
    EXPECT_EQ(pad.joy(30, {}), Wish::kNone);
    EXPECT_EQ(pad.joy(40, {test.button}), test.wish);
  }
}

TEST(ManualControl, WhatStopsWins) {
  Pad pad;
  pad.joy(0, {});
  EXPECT_EQ(pad.joy(10, {kA, kX, kB, kY}), Wish::kMovementOff);
}

TEST(ManualControl, AHeldStopCountsThoughThePadWasSilent) {
  Pad pad;
  EXPECT_EQ(pad.joy(0, {kB}), Wish::kMovementOff) << "first heard";
  EXPECT_EQ(pad.joy(100, {kB}), Wish::kNone);
  EXPECT_EQ(pad.joy(1000, {kA, kB, kX}), Wish::kMovementOff);
  EXPECT_EQ(pad.joy(2000, {kA}), Wish::kNone) << "no more than that";
}

TEST(ManualControl, RemembersAFewPadsOnly) {
  Pad pad;
  for (std::uint8_t i = 0; i < 100; ++i) pad.joy(i, {}, 0.0F, 0.0F, drive::WriterId{i});
  pad.joy(101, {kLb}, 1.0F, 0.0F, drive::WriterId{99});
  EXPECT_EQ(pad.v(101), 0.8);
}

}  // namespace
}  // namespace usher::manual_control
