#include "simulation/world/core/segway.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "foundation/geometry/angle.hpp"

namespace usher::world {
namespace {

using geometry::degrees;

constexpr int kSeeds = 20;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) { low = std::min(low, value), high = std::max(high, value); }
};

/// One run as section 8.1 of the thesis describes it: drive until the odometry has kept the target
/// for 0.2 s, stop.
struct StopRun {
  double distance = 0.0;           // m, from the stop command to the farthest point
  double odometry_distance = 0.0;  // the same by the encoders
  Range speed;                     // m/s, by the encoders
  Range true_speed;
  Range pitch;                      // deg
  Range yaw;                        // deg
  double tip_time = 0.0;            // s, of the pitch's peak at the start
  double tip = 0.0;                 // deg, that peak
  double acceleration = 0.0;        // m/s^2, true, between 20 and 80 % of the target
  double hold_deceleration = 0.0;   // m/s^2, true, from 0.4 to 1.0 s after the stop command
  double brake_deceleration = 0.0;  // m/s^2, by the encoders, steepest 0.3 s
  double slide_deceleration = 0.0;  // m/s^2, true, from 0.7 to 1.2 s after the stop command
};

StopRun run_stop(double target, bool emergency, std::uint64_t seed) {
  Segway base(SegwayConfig{}, seed);
  base.place({});
  StopRun run;
  std::vector<double> seen;
  std::vector<double> real;
  int kept = 0;
  int stop = -1;
  double from = 0.0;
  double odometry_from = 0.0;
  for (int i = 0; stop < 0 || i < stop + 800; ++i) {
    if (stop < 0 && kept >= 20) {
      stop = i;
      from = base.truth().pose.x;
      odometry_from = base.readings().travel();
      if (emergency) base.emergency_stop();
    }
    if (i > 1500) break;  // never got there
    base.command({stop < 0 ? target : 0.0, 0.0});
    base.step();
    const double speed = base.readings().velocity();
    kept = speed >= 0.98 * target ? kept + 1 : 0;
    seen.push_back(speed);
    real.push_back(base.truth().twist.v);
    run.speed.add(speed);
    run.true_speed.add(real.back());
    run.pitch.add(degrees(base.truth().pitch));
    run.yaw.add(degrees(base.truth().pose.yaw));
    if (i < 80 && degrees(base.truth().pitch) > run.tip) {
      run.tip = degrees(base.truth().pitch);
      run.tip_time = i * kStep;
    }
    if (stop >= 0) {
      run.distance = std::max(run.distance, base.truth().pose.x - from);
      run.odometry_distance =
          std::max(run.odometry_distance, base.readings().travel() - odometry_from);
    }
  }
  const auto at = [&](double seconds) {
    return real[static_cast<std::size_t>(stop) + static_cast<std::size_t>(seconds / kStep)];
  };
  const auto reaches = [&](double share) {
    return std::find_if(real.begin(), real.end(), [&](double v) { return v >= share * target; });
  };
  run.acceleration = 0.6 * target / (static_cast<double>(reaches(0.8) - reaches(0.2)) * kStep);
  run.hold_deceleration = (at(0.4) - at(1.0)) / 0.6;
  run.slide_deceleration = (at(0.7) - at(1.2)) / 0.5;
  for (std::size_t i = static_cast<std::size_t>(stop) + 60; i + 30 < seen.size(); ++i) {
    run.brake_deceleration = std::max(run.brake_deceleration, (seen[i] - seen[i + 30]) / 0.3);
  }
  return run;
}

template <class Value>
double mean(double target, bool emergency, Value value) {
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    sum += value(run_stop(target, emergency, static_cast<std::uint64_t>(seed)));
  }
  return sum / kSeeds;
}

/// Within 10 % or one standard deviation of the published figure.
void expect_published(double ours, double published, double sigma, const char* what) {
  EXPECT_NEAR(ours, published, std::max(sigma, 0.1 * std::abs(published))) << what;
}

struct Row {
  double target;
  bool emergency;
  double distance, distance_sigma;
  double speed_low, speed_high, speed_sigma;
  double pitch_low, pitch_high, pitch_sigma;  // NaN: the published figure is a misprint
  double yaw_low, yaw_high, yaw_sigma;
};

void expect_row(const Row& row) {
  const auto of = [&](auto value) { return mean(row.target, row.emergency, value); };
  expect_published(of([](const StopRun& r) { return r.distance; }), row.distance,
                   row.distance_sigma, "stopping distance");
  expect_published(of([](const StopRun& r) { return r.odometry_distance; }), row.distance,
                   row.emergency ? std::max(row.distance_sigma, 0.1) : 0.1,
                   "stopping distance by odometry");
  expect_published(of([](const StopRun& r) { return r.speed.low; }), row.speed_low, row.speed_sigma,
                   "lowest speed");
  expect_published(of([](const StopRun& r) { return r.speed.high; }), row.speed_high,
                   row.speed_sigma, "highest speed");
  if (!std::isnan(row.pitch_low)) {
    expect_published(of([](const StopRun& r) { return r.pitch.low; }), row.pitch_low,
                     row.pitch_sigma, "lowest pitch");
  }
  expect_published(of([](const StopRun& r) { return r.pitch.high; }), row.pitch_high,
                   row.pitch_sigma, "highest pitch");
  expect_published(of([](const StopRun& r) { return r.yaw.low; }), row.yaw_low, row.yaw_sigma,
                   "lowest yaw");
  expect_published(of([](const StopRun& r) { return r.yaw.high; }), row.yaw_high, row.yaw_sigma,
                   "highest yaw");
}

constexpr double kMisprint = std::numeric_limits<double>::quiet_NaN();

// Table 8.1 of the thesis, row by row; the last column is yaw.
TEST(SegwayTable81, StandardStopFrom1) {
  expect_row({1.0, false, 1.48, 0.05, -0.25, 1.08, 0.04, -9.22, 7.5, 0.54, -0.57, 1.06, 0.36});
}
TEST(SegwayTable81, StandardStopFrom1Point4) {
  expect_row({1.4, false, 2.08, 0.07, -0.36, 1.49, 0.04, -13.5, 10.3, 0.49, -0.61, 1.19, 0.43});
}
TEST(SegwayTable81, EmergencyStopFrom1) {
  expect_row({1.0, true, 0.76, 0.10, -0.25, 1.07, 0.02, kMisprint, 21.9, 0.66, -1.29, 1.04, 1.13});
}
TEST(SegwayTable81, EmergencyStopFrom1Point4) {
  expect_row({1.4, true, 1.53, 0.26, -0.31, 1.48, 0.02, kMisprint, 22.1, 0.74, -2.03, 2.76, 3.36});
}

TEST(SegwayTable81, StopsSpreadAsMeasured) {
  const auto sigma = [](double target, bool emergency) {
    const double m = mean(target, emergency, [](const StopRun& r) { return r.distance; });
    return std::sqrt(mean(target, emergency,
                          [m](const StopRun& r) { return (r.distance - m) * (r.distance - m); }));
  };
  EXPECT_NEAR(sigma(1.0, false), 0.05, 0.035);
  EXPECT_NEAR(sigma(1.4, false), 0.07, 0.035);
  EXPECT_NEAR(sigma(1.0, true), 0.10, 0.06);
  EXPECT_NEAR(sigma(1.4, true), 0.26, 0.12);
}

// Section 8.1.1: what the figures show between start and standstill.
TEST(SegwayPhases, AcceleratesAt0Point7AfterALeanForward) {
  for (const double target : {1.0, 1.4}) {
    EXPECT_NEAR(mean(target, false, [](const StopRun& r) { return r.acceleration; }), 0.7, 0.07);
    EXPECT_NEAR(mean(target, false, [](const StopRun& r) { return r.tip_time; }), 0.4, 0.15);
  }
  EXPECT_NEAR(mean(1.0, false, [](const StopRun& r) { return r.tip; }), 7.0, 1.0);
  EXPECT_NEAR(mean(1.4, false, [](const StopRun& r) { return r.tip; }), 11.0, 1.5);
}

TEST(SegwayPhases, HoldsAt0Point2ThenDropsTheSpeed) {
  EXPECT_NEAR(mean(1.0, false, [](const StopRun& r) { return r.hold_deceleration; }), 0.2, 0.07);
  EXPECT_NEAR(mean(1.4, false, [](const StopRun& r) { return r.hold_deceleration; }), 0.2, 0.07);
  EXPECT_NEAR(mean(1.0, false, [](const StopRun& r) { return r.brake_deceleration; }), 1.8, 0.18);
  EXPECT_NEAR(mean(1.4, false, [](const StopRun& r) { return r.brake_deceleration; }), 2.8, 0.28);
}

TEST(SegwayPhases, SlidesAt0Point4OnTheLimiters) {
  for (const double target : {1.0, 1.4}) {
    EXPECT_NEAR(mean(target, true, [](const StopRun& r) { return r.slide_deceleration; }), 0.4,
                0.06);
  }
}

TEST(SegwayPhases, OnlyTheOdometryRollsBackAtTheStart) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  double lowest_seen = 0.0;
  double lowest_real = 0.0;
  for (int i = 0; i < 100; ++i) {
    base.command({1.0, 0.0});
    base.step();
    lowest_seen = std::min(lowest_seen, base.readings().velocity());
    lowest_real = std::min(lowest_real, base.truth().twist.v);
  }
  EXPECT_LT(lowest_seen, -0.2);
  EXPECT_GT(lowest_real, -0.01);
}

double stopping_distance(double speed) {
  SegwayConfig config;
  Segway base(config, 3);
  base.place({});
  for (int i = 0; i < 700; ++i) base.command({speed, 0.0}), base.step();
  const double from = base.truth().pose.x;
  double farthest = from;
  for (int i = 0; i < 800; ++i) {
    base.command({});
    base.step();
    farthest = std::max(farthest, base.truth().pose.x);
  }
  return farthest - from;
}

// The stopping distance that planner and guards assume.
TEST(SegwayStop, NeedsAtMost1Point48SecondsTimesSpeed) {
  for (double speed = 0.1; speed < 1.45; speed += 0.1) {
    EXPECT_LE(stopping_distance(speed), 1.48 * speed + 0.02) << speed;
  }
}

TEST(SegwayFollow, LagsABoundedTimeBehindARamp) {
  SegwayConfig config;
  config.sway_acceleration = 0.0;
  Segway base(config, 1);
  base.place({});
  double command = 0.0;
  for (; command < 1.0; command += 0.4 * kStep) base.command({command, 0.0}), base.step();
  EXPECT_NEAR((command - base.truth().twist.v) / 0.4, 0.43, 0.06);
  for (int i = 0; i < 300; ++i) base.command({command, 0.0}), base.step();
  for (; command > 0.4; command -= 0.5 * kStep) base.command({command, 0.0}), base.step();
  EXPECT_NEAR((base.truth().twist.v - command) / 0.5, 0.43, 0.06);
}

TEST(SegwayFollow, TakesASmallCorrectionAtOnce) {
  for (const double change : {-0.3, -0.1, 0.1, 0.3}) {
    SegwayConfig config;
    config.sway_acceleration = 0.0;
    Segway base(config, 1);
    base.place({});
    for (int i = 0; i < 600; ++i) base.command({0.6, 0.0}), base.step();
    const double before = base.truth().twist.v;
    for (int i = 0; i < 70; ++i) base.command({0.6 + change, 0.0}), base.step();
    EXPECT_NEAR(base.truth().twist.v, before + change, 0.35 * std::abs(change)) << change;
  }
}

TEST(SegwayFollow, TurnsWithin0Point6Seconds) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  for (int i = 0; i < 60; ++i) base.command({0.0, 0.8}), base.step();
  EXPECT_NEAR(base.truth().twist.w, 0.8, 0.12);
  double turned = base.truth().pose.yaw;
  for (int i = 0; i < 100; ++i) base.command({0.0, 0.8}), base.step();
  EXPECT_NEAR(base.truth().pose.yaw - turned, 0.8, 0.05);
}

TEST(SegwayStand, StaysWithinCentimetres) {
  Segway base(SegwayConfig{}, 5);
  base.place({});
  Range x;
  Range pitch;
  for (int i = 0; i < 6000; ++i) {
    base.command({});
    base.step();
    x.add(base.truth().pose.x);
    pitch.add(degrees(base.truth().pitch));
  }
  EXPECT_LT(x.high - x.low, 0.25);
  EXPECT_LT(pitch.high, 2.0);
  EXPECT_GT(pitch.low, -2.0);
}

TEST(SegwayCommand, StopsWhenCommandsCease) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  for (int i = 0; i < 300; ++i) base.command({0.8, 0.0}), base.step();
  for (int i = 0; i < 600; ++i) base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.0, 0.06);
}

TEST(SegwayCommand, IgnoresWhatIsNotFinite) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  base.command({std::nan(""), 0.0});
  base.command({0.0, std::numeric_limits<double>::infinity()});
  for (int i = 0; i < 100; ++i) base.step();
  EXPECT_TRUE(base.truth().pose.finite());
  EXPECT_NEAR(base.truth().twist.v, 0.0, 0.05);
}

TEST(SegwayEmergency, LatchesUntilResetThenStandsUp) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  for (int i = 0; i < 300; ++i) base.command({1.0, 0.0}), base.step();
  base.emergency_stop();
  for (int i = 0; i < 600; ++i) base.command({1.0, 0.0}), base.step();
  EXPECT_TRUE(base.readings().emergency);
  EXPECT_FALSE(base.readings().motors_on);
  EXPECT_EQ(base.truth().twist.v, 0.0);
  EXPECT_NEAR(degrees(base.truth().pitch), 20.3, 2.0);
  base.reset();
  for (int i = 0; i < 150; ++i) base.command({0.0, 0.0}), base.step();
  EXPECT_FALSE(base.readings().emergency);
  EXPECT_TRUE(base.readings().motors_on);
  EXPECT_NEAR(degrees(base.truth().pitch), 0.0, 2.0);
  for (int i = 0; i < 300; ++i) base.command({0.5, 0.0}), base.step();
  EXPECT_NEAR(base.truth().twist.v, 0.5, 0.1);
}

TEST(SegwayEmergency, FallsBackwardWhenItDrivesBackward) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  for (int i = 0; i < 300; ++i) base.command({-0.6, 0.0}), base.step();
  base.emergency_stop();
  for (int i = 0; i < 300; ++i) base.step();
  EXPECT_NEAR(degrees(base.truth().pitch), -20.3, 2.0);
}

TEST(SegwayObstruct, LosesTheSpeedButNotTheEncoders) {
  Segway base(SegwayConfig{}, 1);
  base.place({});
  for (int i = 0; i < 300; ++i) base.command({0.8, 0.0}), base.step();
  const Pose2 wall = base.truth().pose;
  const double before = base.readings().travel();
  for (int i = 0; i < 50; ++i) {
    base.command({0.8, 0.0});
    base.step();
    base.obstruct(wall);
  }
  EXPECT_EQ(base.truth().pose, wall);
  EXPECT_TRUE(std::isfinite(base.readings().travel()));
  EXPECT_NE(base.readings().travel(), before);
}

TEST(SegwaySeed, RepeatsEveryBit) {
  const auto fingerprint = [](std::uint64_t seed) {
    Segway base(SegwayConfig{}, seed);
    base.place({1.0, 2.0, 0.3});
    for (int i = 0; i < 500; ++i) base.command({0.9, 0.4}), base.step();
    return std::pair(base.truth().pose.x, base.readings().pitch);
  };
  EXPECT_EQ(fingerprint(7), fingerprint(7));
  EXPECT_NE(fingerprint(7), fingerprint(8));
}

}  // namespace
}  // namespace usher::world
