// Laws that hold whatever comes in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "control/movement_control/test/inputs.hpp"
#include "foundation/random/random.hpp"

namespace usher::movement_control {
namespace {

using geometry::Twist2;
using kinematics::RollOut;
using std::chrono::milliseconds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Whatever comes in: what goes out is finite, within the limit in force plus what slowing down
// still needs, never against a whisker (but creeping in place beside what is known), and zero
// without an enabled source.
TEST(MovementControl, KeepsItsLawsOnRandomInputs) {
  Random random(3);
  const auto chance = [&random](std::uint64_t n) { return random.below(n) == 0; };
  bool in_place = false;
  const auto twist = [&]() -> std::optional<Twist2> {
    if (chance(3)) return std::nullopt;
    if (chance(30)) return Twist2{kNan, 1.0};
    return Twist2{in_place ? 0.0 : random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)};
  };
  int beside_what_is_known = 0;
  for (int run = 0; run < 200; ++run) {
    in_place = run % 8 == 7;
    Parameters parameters = run % 2 == 0 ? Parameters{} : with_jerk();
    parameters.guarded = run % 4 >= 2;
    MovementControl control(parameters);
    const kinematics::WhiskerRods rods(parameters.guard.outline, parameters.whiskers);
    const double slowest =
        0.5 * parameters.touched / parameters.guard.outline.circumscribed_radius();
    std::vector<geometry::Point2> things;
    const std::vector<geometry::Point2> people{{3.0, 3.0}};
    Time now{};
    double last = 0.0;
    for (int i = 0; i < 200; ++i) {
      Inputs inputs = all_well();
      inputs.enables = Enables{!chance(5), chance(2), chance(2), chance(2), random.uniform()};
      if (chance(20)) inputs.enables.reset();
      inputs.manual = twist();
      inputs.interaction = twist();
      inputs.navigation = twist();
      if (chance(4)) inputs.whiskers = Whiskers{chance(2), chance(2), chance(2), chance(2)};
      if (chance(20)) inputs.whiskers.reset();
      inputs.situation = static_cast<Situation>(random.below(3));
      inputs.localization = static_cast<Localization>(random.below(3));
      things.clear();
      for (auto n = random.below(4); n > 0; --n)
        things.emplace_back(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
      if (chance(2)) {  // a wall along the whiskers of the left side
        for (int k = -10; k <= 10; ++k) things.emplace_back(0.07 * k, 0.4);
      }
      inputs.view = {.sees = !chance(5)};
      if (!chance(3)) inputs.view.points = things;
      if (!chance(3)) inputs.view.cells = things;
      if (!chance(3)) inputs.people = people;
      now += milliseconds(random.below(50));
      const Decision decision = control.decide(inputs, now);
      const Twist2& out = decision.twist;
      ASSERT_TRUE(out.finite());
      const double bound = control.status().max_current.linear;
      ASSERT_LE(std::abs(out.v), std::max(bound, std::abs(last)) + 1e-9);
      const Enables enables = inputs.enables.value_or(Enables{});
      const bool any = (enables.manual && inputs.manual) ||
                       (enables.interaction && inputs.interaction) ||
                       (enables.navigation && inputs.navigation);
      if (!enables.movement || !any || !inputs.whiskers) {
        ASSERT_EQ(out, Twist2{});
      }
      if (inputs.whiskers) {
        const bool against =
            kinematics::whisker_reflex(out, *inputs.whiskers, Parameters{}.touched) != out;
        if (against) {
          ++beside_what_is_known;
          const bool costs_count = inputs.people && inputs.localization == Localization::kGood;
          const Whiskers unknown = kinematics::without(
              *inputs.whiskers, rods.at_seen(inputs.view.points) |
                                    (costs_count ? rods.at_known(inputs.view.cells) : Whiskers{}));
          ASSERT_EQ(kinematics::whisker_reflex(out, unknown, Parameters{}.touched), out);
          ASSERT_TRUE(parameters.guarded && inputs.measured);
          ASSERT_LT(std::abs(inputs.measured->v), RollOut::kStanding);
          ASSERT_EQ(out.v, 0.0);
          ASSERT_LE(std::abs(out.w), slowest + 1e-12);
        }
      }
      last = out.v;
    }
  }
  EXPECT_GT(beside_what_is_known, 50);
}

/// A base that follows what it is told within a third of a second, and is pushed now and then.
class Rolls {
 public:
  explicit Rolls(Random& random) : random_(random) {}
  const Twist2& does(const Twist2& told, Time step) {
    const double part = std::chrono::duration<double>(step).count() / 0.3;
    does_.v += std::min(1.0, part) * (told.v - does_.v);
    does_.w += std::min(1.0, part) * (told.w - does_.w);
    if (random_.below(100) == 0) does_ = {random_.uniform(-1.4, 1.4), random_.uniform(-1.4, 1.4)};
    return does_;
  }

 private:
  Random& random_;
  Twist2 does_;
};

// Of a base that is not at rest: no more than the limits in force, what it was told before and what
// it does, of a turn lately: it may be the arc that it rolls out on; and where nothing may be
// passed on, no speed, and no turn but the one of the arc that it rolls out on.
TEST(MovementControl, KeepsItsLawsOfABaseThatRolls) {
  Random random(4);
  const auto chance = [&random](std::uint64_t n) { return random.below(n) == 0; };
  int rolled_out = 0, moved = 0, held_back = 0;
  for (int run = 0; run < 400; ++run) {
    Parameters parameters = run % 2 == 0 ? Parameters{} : with_jerk();
    parameters.guarded = run % 4 >= 2;
    if (run % 3 == 0) parameters.largest_drop = 0.25;
    MovementControl control(parameters);
    Rolls base(random);
    std::vector<geometry::Point2> things;
    const std::vector<geometry::Point2> people{{3.0, 3.0}};
    Inputs inputs = all_well();
    Twist2 told;
    std::deque<std::pair<Time, double>> turns;  // told and done, while the longest stop lasts
    Time now{};
    for (int i = 0; i < 200; ++i) {
      const Time step = milliseconds(10 + random.below(30));
      now += step;
      const Twist2 does = base.does(told, step);
      inputs.measured = does;
      if (chance(30)) inputs.measured.reset();
      if (chance(15)) {  // otherwise it would never roll
        inputs.enables = Enables{!chance(3), chance(2), chance(2), !chance(3), random.uniform()};
        if (chance(10)) inputs.enables.reset();
        const auto wish = [&]() -> std::optional<Twist2> {
          if (chance(3)) return std::nullopt;
          return Twist2{random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)};
        };
        inputs.manual = wish(), inputs.interaction = wish(), inputs.navigation = wish();
        inputs.whiskers = Whiskers{};
        if (chance(6)) inputs.whiskers = Whiskers{chance(2), chance(2), chance(2), chance(2)};
        if (chance(10)) inputs.whiskers.reset();
        inputs.person_ahead = chance(2);
        if (chance(4)) inputs.person_ahead.reset();
        inputs.low_battery = chance(4);
        inputs.motors_off = chance(8);
        inputs.localization = static_cast<Localization>(random.below(3));
        inputs.situation = static_cast<Situation>(random.below(3));
        things.clear();
        if (chance(2)) {  // a wall across the way
          const double x = random.uniform(-3.0, 3.0);
          for (int k = -10; k <= 10; ++k) things.emplace_back(x, 0.1 * k);
        }
      }
      inputs.view = {.points = things, .sees = !chance(20), .guessed = 0, .cells = things};
      const Twist2 before = told;
      told = control.decide(inputs, now).twist;

      ASSERT_TRUE(told.finite());
      turns.emplace_back(now, std::max(std::abs(before.w), std::abs(does.w)));
      while (now - turns.front().first > RollOut::longest(10.0)) turns.pop_front();
      const double turned = std::ranges::max(turns, {}, &std::pair<Time, double>::second).second;
      const VelocityLimit& most = control.status().max_current;
      ASSERT_LE(std::abs(told.v),
                std::max({most.linear, std::abs(before.v), std::abs(does.v)}) + 1e-9);
      ASSERT_LE(std::abs(told.w), std::max(most.angular, turned) + RollOut::kTurnSlack + 1e-9);
      const Enables enables = inputs.enables.value_or(Enables{});
      const bool passes_on =
          enables.movement && inputs.measured && inputs.whiskers &&
          ((enables.manual && inputs.manual) || (enables.interaction && inputs.interaction) ||
           (enables.navigation && inputs.navigation));
      if (passes_on) {
        if (told.v != 0.0) ++moved;
        if (control.status().limit == Limit::kObstacle) ++held_back;
        continue;
      }
      ASSERT_EQ(told.v, 0.0);
      if (inputs.motors_off) {
        ASSERT_EQ(told.w, 0.0);
      }
      if (told.w == 0.0) continue;
      ++rolled_out;
      if (inputs.measured) {
        ASSERT_GT(std::abs(does.v), RollOut::kStanding) << "who stands turns no more";
      }
    }
  }
  EXPECT_GT(moved, 5000);
  EXPECT_GT(rolled_out, 1000);
  EXPECT_GT(held_back, 500);
}

}  // namespace
}  // namespace usher::movement_control
