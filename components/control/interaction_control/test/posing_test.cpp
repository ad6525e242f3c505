#include "control/interaction_control/core/posing.hpp"

#include <gtest/gtest.h>

namespace usher::interaction_control {
namespace {

using kinematics::TorsoPose;
constexpr double kStep = 0.05;

Zone zone(const char* name, double near, double far, double tilt) {
  Zone zone;
  zone.name = name;
  zone.range_min = near;
  zone.range_max = far;
  zone.bearing_min = -1.0;
  zone.bearing_max = 1.0;
  zone.pose[2] = tilt;
  zone.left_eye = zone.right_eye = {0.0F, 1.0F, 0.0F};
  return zone;
}

struct Bench {
  Posing posing;
  Posing::Moment moment;
  std::vector<Sighting> people;

  static Posing::Parameters parameters(const char* rest) {
    Posing::Parameters p;
    p.rest = rest;
    p.motion.limits.fill({-0.5, 0.5, 0.5});
    return p;
  }
  static Zones zones() {
    std::vector<Zone> all{zone("nominal", 0, 1.5, 0.1), zone("far", 1.5, 3, 0.3),
                          zone("rest", 0, 0, 0.0)};
    all[0].tracking = true;
    all[1].voice = false;
    all[2].enabled = false;
    return Zones::make(all, {0.1, 0.1}, parameters("").motion.limits).value();
  }
  explicit Bench(const char* rest = "rest") : posing(parameters(rest), zones()) {
    moment.occasion = Occasion::kInteract;
    moment.torso = TorsoPose{};
  }
  void run(double seconds) {
    moment.people = people;
    for (double t = 0.0; t < seconds; t += kStep) posing.step(moment, kStep);
  }
  void person(double range) { people = {{7, {range, 0.0}}}; }
  double tilt() const { return posing.joints()[2]; }
};

TEST(Posing, TakesThePoseOfTheZoneThatThePersonIsIn) {
  Bench bench;
  bench.person(1.0);
  bench.run(2.0);
  EXPECT_EQ(bench.posing.zone()->name, "nominal");
  EXPECT_TRUE(bench.posing.tracks());
  EXPECT_TRUE(bench.posing.posed());
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.1);
  bench.person(2.0);
  bench.run(0.5);
  EXPECT_EQ(bench.posing.pose()->name, "far");
  EXPECT_FALSE(bench.posing.tracks());
  EXPECT_FALSE(bench.posing.posed()) << "on its way";
  bench.run(3.0);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.3);
}

TEST(Posing, KeepsThePoseForAWhileWithoutAnybodyThenRests) {
  Bench bench;
  bench.person(2.0);
  bench.run(3.0);
  bench.people.clear();
  bench.run(3.5);
  EXPECT_EQ(bench.posing.zone(), nullptr);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.3) << "the thesis: no further actions";
  bench.run(4.0);
  EXPECT_EQ(bench.posing.pose()->name, "rest");
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.0);
  Bench without_rest("");
  without_rest.person(2.0);
  without_rest.run(3.0);
  without_rest.people.clear();
  without_rest.run(60.0);
  EXPECT_DOUBLE_EQ(without_rest.tilt(), 0.3);
}

TEST(Posing, RestsWhileItDrivesAndHoldsStillWhereItMayNotPose) {
  Bench bench;
  bench.person(2.0);
  bench.run(1.0);
  bench.moment.occasion = Occasion::kHold;
  bench.run(0.3);
  const double held = bench.tilt();
  EXPECT_GT(held, 0.0);
  EXPECT_LT(held, 0.3);
  bench.run(10.0);
  EXPECT_EQ(bench.tilt(), held);
  EXPECT_EQ(bench.posing.zone(), nullptr);
  EXPECT_FALSE(bench.posing.tracks());
  bench.moment.occasion = Occasion::kDrive;
  bench.moment.listens = true;
  bench.run(4.0);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.0) << "upright, whoever is there or heard";
  bench.moment.listens = false;
  bench.moment.occasion = Occasion::kInteract;
  bench.run(4.0);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.3);
}

TEST(Posing, HoldsStillWhileItListensAndGoesOnAfterwards) {
  Bench bench;
  bench.person(2.0);
  bench.run(1.0);
  bench.moment.listens = true;
  bench.run(0.3);
  const double held = bench.tilt();
  bench.run(5.0);
  EXPECT_EQ(bench.tilt(), held);
  EXPECT_EQ(bench.posing.zone()->name, "far") << "it knows still who is where";
  bench.moment.listens = false;
  bench.run(4.0);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.3);
}

TEST(Posing, StartsFromWhereTheTorsoIsWheneverItComesBack) {
  Bench bench;
  bench.moment.torso.reset();
  bench.person(2.0);
  bench.run(1.0);
  EXPECT_FALSE(bench.posing.shows());
  TorsoPose there{};
  there[2] = -0.4;
  bench.moment.torso = there;
  bench.run(kStep);
  EXPECT_TRUE(bench.posing.shows());
  EXPECT_NEAR(bench.tilt(), -0.4, 0.01);
  bench.run(6.0);
  EXPECT_DOUBLE_EQ(bench.tilt(), 0.3);
  bench.moment.torso.reset();
  bench.run(1.0);
  EXPECT_FALSE(bench.posing.shows());
  bench.moment.torso = there;
  bench.run(kStep);
  EXPECT_NEAR(bench.tilt(), -0.4, 0.01) << "somebody pushed it meanwhile";
}

TEST(Posing, TheEyesFollowTheVoiceWhereTheZoneSaysSo) {
  Bench bench;
  bench.moment.level = 1.0;
  bench.person(1.0);
  bench.run(2.0);
  EXPECT_FLOAT_EQ(bench.posing.eyes().left()[1], 1.0F);
  bench.person(2.0);
  bench.run(2.0);
  EXPECT_FLOAT_EQ(bench.posing.eyes().left()[1], 0.4F);
}

TEST(Posing, WithoutZonesItShowsNothing) {
  Posing posing(Bench::parameters(""), Zones());
  posing.step({.occasion = Occasion::kInteract, .torso = TorsoPose{}}, kStep);
  EXPECT_FALSE(posing.shows());
  EXPECT_FALSE(posing.tracks());
  EXPECT_EQ(posing.pose(), nullptr);
}

}  // namespace
}  // namespace usher::interaction_control
