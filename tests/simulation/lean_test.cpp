// How far an operator's stick makes MARVIN lean: its range data can be used from -10 to 10 deg of
// pitch.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "control/movement_control/core/movement_control.hpp"
#include "foundation/geometry/angle.hpp"
#include "simulation/world/core/segway.hpp"

namespace usher::movement_control {
namespace {

using std::chrono::milliseconds;

constexpr double kFull = 0.8;  // [m/s] of manual_control's stick
/// As in config/robots/marvin.yaml.
constexpr geometry::Twist2 kJerk{1.0, 4.0};

/// [deg] The greatest pitch while the stick goes to and fro, as long there as here [ms].
double lean(const geometry::Twist2& jerk, double back, int period, std::uint64_t seed) {
  Parameters parameters;
  parameters.largest_drop = 0.25;
  parameters.jerk = jerk;
  MovementControl control(parameters);
  world::Segway base(world::SegwayConfig{}, seed);
  base.place({});
  Inputs inputs;
  inputs.enables = Enables{true, true, true, true, 1.0};
  inputs.whiskers = Whiskers{};
  inputs.person_ahead = false;
  inputs.situation = Situation::kOpen;
  double most = 0.0;
  for (int ms = 0; ms < 60'000; ms += 10) {
    inputs.manual = geometry::Twist2{ms % (2 * period) < period ? kFull : back, 0.0};
    inputs.measured = geometry::Twist2{base.readings().velocity(), 0.0};
    if (ms % 20 == 0) base.command(control.decide(inputs, milliseconds(ms)).twist);
    base.step();
    most = std::max(most, std::abs(base.truth().pitch));
  }
  return geometry::degrees(most);
}

/// Of all paces that a hand has.
double worst_lean(const geometry::Twist2& jerk, double back) {
  double worst = 0.0;
  for (const int period : {200, 400, 600, 800, 1000, 1200, 1400, 1700, 2000, 2500, 3000, 4000}) {
    for (const std::uint64_t seed : {1, 2, 3})
      worst = std::max(worst, lean(jerk, back, period, seed));
  }
  return worst;
}

TEST(Lean, FullAheadAndFullBackKeepTheRangeOfTheSensors) {
  EXPECT_LT(worst_lean(kJerk, -kFull), 10.0);
  EXPECT_GT(worst_lean({}, -kFull), 14.0) << "without the limit";
}

TEST(Lean, AheadAndLetGoKeepsIt) { EXPECT_LT(worst_lean(kJerk, 0.0), 10.0); }

TEST(Lean, AStartLeansHalfAsFar) {
  EXPECT_LT(lean(kJerk, 0.0, 500, 1), 0.5 * lean({}, 0.0, 500, 1));
}

/// [m] The way from `speed` to rest; `drop`: told to be so much slower than it is, else to stand.
double way_to_rest(double speed, std::optional<double> drop, std::uint64_t seed) {
  world::Segway base(world::SegwayConfig{}, seed);
  base.place({});
  for (int ms = 0; ms < 6000; ms += 10) {
    base.command({speed, 0.0});
    base.step();
  }
  const double from = base.truth().pose.x;
  for (int ms = 0; ms < 10'000 && base.truth().twist.v > 0.02; ms += 10) {
    const double slower = base.readings().velocity() - drop.value_or(speed);
    if (ms % 20 == 0) base.command({drop ? std::max(0.0, slower) : 0.0, 0.0});
    base.step();
  }
  return base.truth().pose.x - from;
}

TEST(Braking, ToldToBeALittleSlowerThanItIsItIsAtRestSooner) {
  for (const double speed : {0.5, 0.8, 1.0}) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
      const double told_to_stand = way_to_rest(speed, std::nullopt, seed);
      EXPECT_LT(way_to_rest(speed, 0.25, seed), 0.9 * told_to_stand) << speed;
      EXPECT_GT(way_to_rest(speed, 0.35, seed), 0.95 * told_to_stand) << "too much for it";
    }
  }
}

}  // namespace
}  // namespace usher::movement_control
