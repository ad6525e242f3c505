#include "runtime/engine/heart.hpp"

#include <gtest/gtest.h>

namespace usher::runtime {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::Heartbeat_Constants;

constexpr auto kLimit = milliseconds(20);
Time at(int ms) { return Time(milliseconds(10'000 + ms)); }

struct Bench {
  Heart heart{"amcl", "nuc", kLimit};
  Bench() { heart.set(HealthState::kOk); }
  void took(int ms, int when) { heart.handler_took(milliseconds(ms), at(when), "input ", "scan"); }
  const usher_msgs::msg::Heartbeat& beat(int ms) { return heart.beat(at(ms), {}, 0); }
};

TEST(Heart, AFewSlowHandlersAreNoFault) {
  Bench bench;
  for (int i = 0; i < 4; ++i) bench.took(500, i * 10);
  for (int i = 0; i < 1000; ++i) bench.took(20, i);
  EXPECT_EQ(bench.beat(1000).state(), STATE_OK);
  EXPECT_EQ(bench.beat(1000).reason(), "");
}

TEST(Heart, SlowHandlersAgainAndAgainAreDegradedAndSayWhich) {
  Bench bench;
  for (int i = 0; i < 5; ++i) bench.took(35, i * 100);
  EXPECT_EQ(bench.beat(410).state(), STATE_DEGRADED);
  EXPECT_EQ(bench.beat(410).reason(), "slow: input scan took 35 ms, at most 20 ms");
  EXPECT_EQ(bench.beat(1000).state(), STATE_DEGRADED);
  EXPECT_EQ(bench.beat(1001).state(), STATE_OK) << "a second after the first of the five";
  EXPECT_EQ(bench.beat(1001).reason(), "");
}

TEST(Heart, SlowHandlersFarApartAreNoFault) {
  Bench bench;
  for (int i = 0; i < 100; ++i) {
    bench.took(35, i * 300);
    EXPECT_EQ(bench.beat(i * 300).state(), STATE_OK);
  }
}

TEST(Heart, WhatTheComponentSaysOfItselfWeighsMore) {
  Bench bench;
  for (int i = 0; i < 5; ++i) bench.took(35, 0);
  bench.heart.set(HealthState::kDegraded, "no map");
  EXPECT_EQ(bench.beat(1).reason(), "no map");
  bench.heart.end("broken");
  EXPECT_EQ(bench.beat(2).state(), STATE_FAULT);
  EXPECT_EQ(bench.beat(2).reason(), "broken");
}

TEST(Heart, TellsTheLongestAndTheSumSinceTheLastBeat) {
  Bench bench;
  bench.took(3, 0);
  bench.took(7, 1);
  EXPECT_FLOAT_EQ(bench.beat(2).handler_time_max(), 0.007F);
  bench.took(2, 3);
  EXPECT_FLOAT_EQ(bench.beat(4).handler_time_max(), 0.002F);
  EXPECT_FLOAT_EQ(bench.beat(5).handler_time_total(), 0.0F);
}

}  // namespace
}  // namespace usher::runtime
