#include "drivers/base_obedience/core/response_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace usher::drive {
namespace {

using std::chrono::milliseconds;
using Verdict = ResponseWatch::Verdict;
using Profile = std::function<double(double)>;

Time at(double seconds) { return milliseconds(std::lround(seconds * 1000.0)); }

/// The worst verdict over a run at 100 Hz.
Verdict worst(const Profile& commanded, const Profile& measured, double duration,
              bool angular = false, double* first_disobedience = nullptr) {
  ResponseWatch watch;
  Verdict verdict = Verdict::kObeys;
  for (int i = 0; i <= static_cast<int>(duration * 100.0); ++i) {
    const double t = i * 0.01;
    const geometry::Twist2 command{angular ? 0.0 : commanded(t), angular ? commanded(t) : 0.0};
    const geometry::Twist2 measure{angular ? 0.0 : measured(t), angular ? measured(t) : 0.0};
    const Verdict now = watch.observe(command, measure, at(t));
    if (now == Verdict::kDisobeys && verdict != Verdict::kDisobeys && first_disobedience) {
      *first_disobedience = t;
    }
    verdict = std::max(verdict, now);
  }
  return verdict;
}

double step_up_and_down(double t, double speed) { return t >= 1.0 && t < 6.0 ? speed : 0.0; }

/// Odometry of the Segway: dips backward as it leans, 0.7 m/s2, 7 % overshoot; then 1.5 s at 0.2
/// m/s2, a hard stop, 25 % overshoot that rings out.
double balancing_base(double t, double speed) {
  if (t < 1.0) return 0.0;
  if (t < 1.5) return -0.26 * speed * std::sin((t - 1.0) / 0.5 * 3.14159);
  if (t < 6.0) {
    const double rising = 0.7 * (t - 1.5);
    return rising < 1.07 * speed ? rising : speed * (1.0 + 0.07 * std::exp(-(t - 3.6)));
  }
  const double slow = speed - 0.2 * (t - 6.0);
  if (t < 7.5) return slow;
  const double hard = (speed - 0.3) - (speed > 1.2 ? 2.8 : 1.8) * (t - 7.5);
  if (hard > -0.25 * speed) return hard;
  return -0.25 * speed * std::exp(-(t - 8.0)) * std::cos(3.0 * (t - 8.0));
}

TEST(ResponseWatch, TrustsABaseThatNeedsTwoSecondsToStop) {
  for (const double speed : {0.4, 0.8, 1.0, 1.4, -0.4}) {
    EXPECT_EQ(worst([&](double t) { return step_up_and_down(t, speed); },
                    [&](double t) { return balancing_base(t, speed); }, 12.0),
              Verdict::kObeys)
        << speed;
  }
}

TEST(ResponseWatch, TrustsAnIdealAndALaggingBase) {
  double lag = 0.0;
  EXPECT_EQ(worst([](double t) { return step_up_and_down(t, 1.4); },
                  [](double t) { return step_up_and_down(t, 1.4); }, 12.0),
            Verdict::kObeys);
  EXPECT_EQ(worst([](double t) { return step_up_and_down(t, 1.4); },
                  [&](double t) {
                    lag += 0.01 / 0.8 * (step_up_and_down(t, 1.4) - lag);
                    return lag;
                  },
                  12.0),
            Verdict::kObeys);
}

TEST(ResponseWatch, TrustsABaseThatIsCommandedInAllDirections) {
  double lag = 0.0;
  const Profile wild = [](double t) { return 1.2 * std::sin(2.0 * t) + 0.2 * std::sin(17.0 * t); };
  EXPECT_EQ(worst(
                wild,
                [&](double t) {
                  lag += 0.01 / 0.5 * (wild(t) - lag);
                  return lag;
                },
                60.0, true),
            Verdict::kObeys);
}

struct Disobedience {
  const char* name;
  Profile commanded;
  Profile measured;
  double noticed_before;  ///< [s]
  bool angular;
};

TEST(ResponseWatch, NoticesDisobedience) {
  const Disobedience cases[] = {
      {"drives on when told to stop", [](double t) { return t < 2.0 ? 1.0 : 0.0; },
       [](double) { return 1.0; }, 2.0 + 2.5 + 1.0 + 0.2, false},
      {"runs away", [](double) { return 0.3; }, [](double t) { return 0.5 * t; }, 4.0, false},
      {"drives without a command", [](double) { return 0.0; },
       [](double t) { return t < 1.0 ? 0.0 : 0.8; }, 2.2, false},
      {"drives the wrong way", [](double) { return 0.6; },
       [](double t) { return -0.6 * (t > 2.0); }, 5.0, false},
      {"creeps on when told to stop", [](double t) { return t < 2.0 ? 0.4 : 0.0; },
       [](double) { return 0.4; }, 2.0 + 2.5 + 1.0 + 0.2, false},
      {"turns without a command", [](double) { return 0.0; }, [](double) { return 0.5; }, 1.2,
       true},
      {"spins", [](double) { return 0.0; }, [](double) { return 1.5; }, 1.2, true},
  };
  for (const Disobedience& test : cases) {
    double noticed = 1e9;
    EXPECT_EQ(worst(test.commanded, test.measured, 10.0, test.angular, &noticed),
              Verdict::kDisobeys)
        << test.name;
    EXPECT_LE(noticed, test.noticed_before) << test.name;
  }
}

TEST(ResponseWatch, StandingInsteadOfDrivingIsFallingShort) {
  EXPECT_EQ(worst([](double) { return 1.0; }, [](double) { return 0.0; }, 20.0),
            Verdict::kFallsShort);
  for (const double told : {0.2, -0.2}) {
    for (const bool angular : {false, true}) {
      const auto of = [&](double share) {
        return worst([&](double) { return told; }, [&](double) { return share * told; }, 20.0,
                     angular);
      };
      EXPECT_EQ(of(0.0), Verdict::kFallsShort) << "a slow command too";
      EXPECT_EQ(of(-0.1), Verdict::kFallsShort) << "it sways";
      EXPECT_EQ(of(0.45), Verdict::kFallsShort);
      EXPECT_EQ(of(0.6), Verdict::kObeys);
    }
  }
  EXPECT_EQ(worst([](double t) { return std::fmod(t, 2.0) < 1.0 ? 0.2 : 0.0; },
                  [](double) { return 0.0; }, 20.0),
            Verdict::kObeys)
      << "it was told to stand in between";
}

TEST(ResponseWatch, ReportsSignedErrorAndItsTime) {
  ResponseWatch watch;
  for (int i = 0; i <= 50; ++i) watch.observe({0.0, 0.0}, {-0.75, 0.1}, at(i * 0.01));
  EXPECT_DOUBLE_EQ(watch.linear().error, 0.75);
  EXPECT_EQ(watch.linear().lasting, milliseconds(500));
  EXPECT_DOUBLE_EQ(watch.angular().error, -0.1);
  EXPECT_EQ(watch.angular().lasting, milliseconds(0));
  watch.observe({0.0, 0.0}, {0.2, 0.0}, at(0.51));
  EXPECT_EQ(watch.linear().lasting, milliseconds(0));
}

TEST(ResponseWatch, IgnoresWhatIsNotFinite) {
  ResponseWatch watch;
  for (int i = 0; i < 1000; ++i) {
    watch.observe({0.0, 0.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}, at(i * 0.01));
  }
  EXPECT_EQ(watch.verdict(), Verdict::kObeys);
}

TEST(ResponseWatch, AGapIsNoEvidence) {
  ResponseWatch watch;
  watch.observe({0.0, 0.0}, {0.0, 0.0}, at(0.0));
  EXPECT_EQ(watch.observe({0.0, 0.0}, {0.9, 0.0}, at(30.0)), Verdict::kObeys);
}

TEST(ResponseWatch, ForgetsOnReset) {
  ResponseWatch watch;
  for (int i = 0; i <= 300; ++i) watch.observe({0.0, 0.0}, {1.0, 0.0}, at(i * 0.01));
  ASSERT_EQ(watch.verdict(), Verdict::kDisobeys);
  watch.reset();
  EXPECT_EQ(watch.verdict(), Verdict::kObeys);
}

TEST(ResponseWatch, ABaseFoundMovingHasTheTimeOfAResponse) {
  for (const bool stops : {true, false}) {
    ResponseWatch watch;
    watch.reset({1.2, 0.9});
    Verdict verdict = Verdict::kObeys;
    for (int i = 0; i <= 400; ++i) {
      const double t = i * 0.01;
      const double rest = stops ? std::max(0.0, 1.0 - t / 2.4) : 1.0;
      verdict = std::max(verdict, watch.observe({}, {1.2 * rest, 0.9 * rest}, at(t)));
    }
    EXPECT_EQ(verdict, stops ? Verdict::kObeys : Verdict::kDisobeys);
  }
}

}  // namespace
}  // namespace usher::drive
