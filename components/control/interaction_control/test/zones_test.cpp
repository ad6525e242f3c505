#include "control/interaction_control/core/zones.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "control/interaction_control/core/companion.hpp"
#include "foundation/geometry/angle.hpp"

namespace usher::interaction_control {
namespace {

using geometry::radians;
using testing::HasSubstr;

kinematics::TorsoLimits limits() {
  kinematics::TorsoLimits limits;
  limits.fill({-0.3, 0.3, 0.5});
  return limits;
}

Zone zone(const char* name, double near, double far, double right, double left) {
  Zone zone;
  zone.name = name;
  zone.range_min = near;
  zone.range_max = far;
  zone.bearing_min = radians(right);
  zone.bearing_max = radians(left);
  return zone;
}

/// As figure 7.4 names them.
Zones zones(bool close_enabled = false) {
  std::vector<Zone> all{zone("close", 0, 0.6, -90, 90), zone("nominal", 0, 1.5, -25, 25),
                        zone("left", 0, 1.5, 25, 90), zone("right", 0, 1.5, -90, -25),
                        zone("far", 1.5, 3.0, -45, 45)};
  all[0].enabled = close_enabled;
  auto made = Zones::make(std::move(all), {0.15, radians(8.0)}, limits());
  EXPECT_TRUE(made.ok());
  return std::move(made).value();
}

std::string at(Zones& zones, double range, double bearing) {
  const Zone* zone = zones.update(Polar{range, radians(bearing)});
  return zone == nullptr ? "" : zone->name;
}

TEST(Zones, AreWhereTheyAreConfigured) {
  struct Row {
    double range, bearing;
    const char* name;
  };
  const Row rows[] = {{1.0, 0, "nominal"}, {1.0, 24.9, "nominal"}, {1.0, 25.1, "left"},
                      {1.0, 89, "left"},   {1.0, 91, ""},          {1.0, -26, "right"},
                      {1.0, -91, ""},      {1.49, 0, "nominal"},   {1.51, 0, "far"},
                      {1.6, 60, ""},       {2.9, -44, "far"},      {3.1, 0, ""},
                      {0.3, 0, "nominal"}, {1.0, 180, ""},         {0.0, 0, "nominal"}};
  for (const Row& row : rows) {
    Zones fresh = zones();
    EXPECT_EQ(at(fresh, row.range, row.bearing), row.name) << row.range << " " << row.bearing;
  }
}

TEST(Zones, TheFirstOneThatHoldsThePersonCounts) {
  Zones with_close = zones(true);
  EXPECT_EQ(at(with_close, 0.3, 0), "close");
  Zones without = zones(false);
  EXPECT_EQ(at(without, 0.3, 0), "nominal") << "the aggressive pose is off";
}

TEST(Zones, APersonLeavesOneOnlyBeyondItsBorder) {
  Zones z = zones();
  EXPECT_EQ(at(z, 1.4, 0), "nominal");
  EXPECT_EQ(at(z, 1.64, 0), "nominal");
  EXPECT_EQ(at(z, 1.66, 0), "far");
  EXPECT_EQ(at(z, 1.51, 0), "far");
  EXPECT_EQ(at(z, 1.36, 0), "far") << "called into an earlier one only well within it";
  EXPECT_EQ(at(z, 1.34, 0), "nominal");
  EXPECT_EQ(at(z, 1.0, 32), "nominal");
  EXPECT_EQ(at(z, 1.0, 34), "left");
  EXPECT_EQ(at(z, 1.0, 18), "left");
  EXPECT_EQ(at(z, 1.0, 16), "nominal");
  EXPECT_EQ(at(z, 1.0, -34), "right");
  EXPECT_EQ(at(z, 1.0, -97), "right");
  EXPECT_EQ(at(z, 1.0, -99), "");
  EXPECT_EQ(at(z, 1.0, -91), "") << "outside there is no border to stay beyond";
  EXPECT_EQ(at(z, 2.9, 0), "far");
  EXPECT_EQ(at(z, 3.14, 0), "far");
  EXPECT_EQ(at(z, 3.16, 0), "");
}

TEST(Zones, AnEarlierZoneWithinAnotherCallsWhoIsWellWithinIt) {
  Zones z = zones(true);
  EXPECT_EQ(at(z, 1.0, 0), "nominal");
  EXPECT_EQ(at(z, 0.5, 0), "nominal");
  EXPECT_EQ(at(z, 0.44, 0), "close");
  EXPECT_EQ(at(z, 0.7, 0), "close");
  EXPECT_EQ(at(z, 0.76, 0), "nominal");
  EXPECT_EQ(at(z, 0.05, 0), "close") << "there is no border at the robot's middle";
}

TEST(Zones, AllAroundThereIsNoBorderOfBearings) {
  auto made = Zones::make({zone("around", 0, 1, -180, 180), zone("wide", 0, 2, -180, 180)},
                          {0.15, 0.12}, limits());
  ASSERT_TRUE(made.ok());
  Zones z = std::move(made).value();
  EXPECT_EQ(at(z, 1.5, 180), "wide");
  EXPECT_EQ(at(z, 0.5, 180), "around");
}

TEST(Zones, NobodyChattersOnABorder) {
  Zones z = zones();
  int changes = 0;
  std::string last = at(z, 1.4, 20);
  for (int i = 0; i < 1000; ++i) {
    const std::string now = at(z, 1.5 + 0.1 * std::sin(i * 0.7), 25 + 6 * std::sin(i * 1.3));
    changes += now != last;
    last = now;
  }
  EXPECT_LE(changes, 1);
}

TEST(Zones, MayLieAcrossTheBackAndAllAround) {
  auto made = Zones::make({zone("behind", 0, 1, 135, 225), zone("around", 0, 2, -180, 180)}, {0, 0},
                          limits());
  ASSERT_TRUE(made.ok());
  Zones z = std::move(made).value();
  EXPECT_EQ(at(z, 0.5, 180), "behind");
  EXPECT_EQ(at(z, 0.5, -170), "behind");
  EXPECT_EQ(at(z, 0.5, -130), "around");
  EXPECT_EQ(at(z, 0.5, 90), "around");
}

TEST(Zones, NobodyIsInNone) {
  Zones z = zones();
  EXPECT_EQ(at(z, 1.0, 0), "nominal");
  EXPECT_EQ(z.update(std::nullopt), nullptr);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(z.update(Polar{nan, 0}), nullptr);
  EXPECT_EQ(z.update(Polar{1, nan}), nullptr);
  EXPECT_EQ(Zones().update(Polar{1, 0}), nullptr);
}

TEST(Zones, RefusesWhatMakesNoSenseAndSaysWhichAndWhy) {
  struct Row {
    std::vector<Zone> zones;
    const char* reason;
  };
  Zone unable = zone("left", 0, 1, 0, 1);
  unable.pose[2] = 0.4;
  Zone nan = zone("left", 0, 1, 0, 1);
  nan.pose[6] = std::numeric_limits<double>::quiet_NaN();
  const Row rows[] = {
      {{zone("near", 1, 0.5, 0, 1)}, "zone 'near': range_min must not be above range_max"},
      {{zone("near", 0, 1, 5, 1)}, "zone 'near': bearing_min must not be above bearing_max"},
      {{zone("a", 0, 1, 0, 1), zone("a", 0, 1, 0, 1)}, "zone 'a' is there twice"},
      {{zone("", 0, 1, 0, 1)}, "a zone must have a name"},
      {{unable}, "torso_tilt must be in [-0.300, 0.300], the joint's limits, got 0.400"},
      {{nan}, "head_shake must be in"}};
  for (const Row& row : rows) {
    const auto made = Zones::make(row.zones, {}, limits());
    ASSERT_FALSE(made.ok()) << row.reason;
    EXPECT_THAT(made.error(), HasSubstr(row.reason));
  }
}

TEST(Color, IsReadFromSixHexDigitsAndNothingElse) {
  EXPECT_EQ(*color_from("#ff0033"), (kinematics::EyeColor{1.0F, 0.0F, 0.2F}));
  EXPECT_EQ(*color_from("#FF0033"), (kinematics::EyeColor{1.0F, 0.0F, 0.2F}));
  for (const char* none : {"", "ff0033", "#ff003", "#ff00333", "#ff00g3", "green"})
    EXPECT_FALSE(color_from(none)) << none;
}

TEST(Companion, IsTheNearestInAZoneElseTheNearestOfAll) {
  const Zones z = zones();
  Companion companion(0.4);
  const std::vector<Sighting> people{{1, {0.5, radians(180.0)}}, {2, {2.0, 0.0}}, {3, {1.2, 0.0}}};
  EXPECT_EQ(companion.choose(people, z)->id, 3U) << "one is nearer, but behind";
  EXPECT_EQ(companion.choose(std::span(people).first(1), z)->id, 1U);
  EXPECT_FALSE(companion.choose({}, z));
}

TEST(Companion, StaysUntilAnotherIsClearlyNearer) {
  const Zones z = zones();
  Companion companion(0.4);
  std::vector<Sighting> people{{1, {1.3, 0.0}}, {2, {1.2, 0.3}}};
  EXPECT_EQ(companion.choose(people, z)->id, 2U);
  people[0].place.range = 0.9;
  EXPECT_EQ(companion.choose(people, z)->id, 2U);
  people[0].place.range = 0.7;
  EXPECT_EQ(companion.choose(people, z)->id, 1U);
  people[1].place.range = 0.6;
  EXPECT_EQ(companion.choose(people, z)->id, 1U);
  people.erase(people.begin());
  EXPECT_EQ(companion.choose(people, z)->id, 2U) << "the other one is gone";
}

}  // namespace
}  // namespace usher::interaction_control
