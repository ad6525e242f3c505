#include "control/movement_control/core/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace usher::movement_control {
namespace {

using geometry::Point2;
using geometry::Pose2;
using geometry::Twist2;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kAngleMin = -2.0, kIncrement = 0.01;
constexpr int kBeams = 401;

/// A robot whose laser stands 0.28 m before its axle, among straight walls in its odometry's frame.
class Walled : public testing::Test {
 protected:
  /// The half plane nx x + ny y >= d is solid.
  struct Wall {
    double nx, ny, d;
  };

  std::vector<float> scan() const {
    const Pose2 laser = robot * Pose2{0.28, 0.0, 0.0};
    std::vector<float> ranges;
    for (int i = 0; i < kBeams; ++i) {
      const double angle = laser.yaw + kAngleMin + kIncrement * i;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Wall& w : walls) {
        const double closing = w.nx * std::cos(angle) + w.ny * std::sin(angle);
        const double gap = w.d - w.nx * laser.x - w.ny * laser.y;
        if (closing > 1e-9) nearest = std::min(nearest, gap / closing);
      }
      ranges.push_back(nearest < blind_within ? kNan : static_cast<float>(nearest));
    }
    return ranges;
  }
  void look() {
    const auto ranges = scan();
    surroundings.take({ranges, kAngleMin, kIncrement}, now);
  }
  void drive(const Twist2& twist, double duration, bool looks = true) {
    for (int ms = 0; ms < std::lround(1000.0 * duration); ms += 20) {
      surroundings.move(twist, now);
      now += milliseconds(20);
      robot = geometry::integrate(robot, twist, 0.02);
      surroundings.move(twist, now);
      if (looks) look();
    }
  }
  /// [m] from a place in base_footprint to the nearest point.
  double nearest(const Point2& place) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Point2& p : surroundings.points()) least = std::min(least, (p - place).norm());
    return least;
  }

  std::vector<Wall> walls;
  double blind_within = 0.0;  ///< [m]
  Pose2 robot;
  Time now{};
  Surroundings surroundings{{.base_T_sensor = {0.28, 0.0, 0.0}}};
};

TEST_F(Walled, HasWhatTheLaserSees) {
  walls = {{1, 0, 2.0}};
  look();
  EXPECT_LT(nearest({2.0, 0.0}), 1e-6);
  EXPECT_LT(nearest({2.0, 1.0}), 0.02);
  EXPECT_GT(nearest({0.0, 0.0}), 1.9);
}

TEST_F(Walled, MovesItBetweenScans) {
  walls = {{1, 0, 2.0}};
  look();
  drive({0.5, 0.0}, 1.0, false);
  EXPECT_LT(nearest({1.5, 0.0}), 0.02);
  surroundings.move(std::nullopt, now + seconds(1));
  EXPECT_LT(nearest({1.5, 0.0}), 0.02);
}

TEST_F(Walled, RemembersWhatComesTooNearToMeasure) {
  walls = {{1, 0, 1.2}};
  blind_within = 0.5;
  look();
  drive({0.4, 0.0}, 2.0);
  EXPECT_LT(nearest({0.4, 0.0}), 0.02) << "0.12 m before the laser";
  surroundings.move(Twist2{}, now += seconds(600));
  look();
  EXPECT_LT(nearest({0.4, 0.0}), 0.02) << "however long it stands";
}

TEST_F(Walled, KeepsTheEdgeOfWhatIsTooNearToMeasure) {
  walls = {{1, 0, 1.2}};
  blind_within = 0.5;
  look();
  drive({0.4, 0.0}, 2.0);
  auto ranges = scan();
  std::fill_n(ranges.begin(), kBeams / 2, kInfinity);  // to the right of y = 0 there is no wall
  for (int i = 0; i < 100; ++i) surroundings.take({ranges, kAngleMin, kIncrement}, now);
  EXPECT_LT(nearest({0.4, -0.015}), 0.005) << "a beam may pass so near beside it";
  EXPECT_GT(nearest({0.4, -0.06}), 0.03);
}

TEST_F(Walled, RemembersAWallThatIsSeenNowAndThenOnce) {
  walls = {{1, 0, 0.9}};
  drive({}, 2.0);
  const auto seen = surroundings.points().size();
  for (int i = 0; i < 50; ++i) {
    blind_within = i % 2 == 0 ? 5.0 : 0.0;
    look();
  }
  EXPECT_LT(surroundings.points().size(), 2 * seen);
}

TEST_F(Walled, ForgetsWhatHasGone) {
  walls = {{1, 0, 1.2}};
  blind_within = 0.5;
  look();
  drive({0.4, 0.0}, 2.0);
  walls = {{1, 0, 5.0}};
  look();
  EXPECT_GT(nearest({0.4, 0.0}), 3.0);
}

TEST_F(Walled, ForgetsWhatItHasLeftAndAfterAWhileWhatIsBehind) {
  walls = {{0, 1, 0.5}};
  drive({0.6, 0.0}, 1.0);
  walls.clear();  // what is behind the view is not seen to have gone
  look();
  EXPECT_LT(nearest({-0.1, 0.5}), 0.03);
  surroundings.move(Twist2{}, now += seconds(25));
  look();
  EXPECT_LT(nearest({-0.1, 0.5}), 0.03);
  surroundings.move(Twist2{}, now += seconds(6));
  look();
  EXPECT_TRUE(surroundings.points().empty());

  walls = {{0, 1, 0.5}};
  drive({0.6, 0.0}, 1.0);
  walls.clear();
  drive({0.6, 0.0}, 3.0);
  EXPECT_TRUE(surroundings.points().empty()) << "1.8 m on";
}

TEST_F(Walled, AWallThatLeavesTheViewGoesOn) {
  walls = {{0, -1, 0.3}};
  look();
  // The last beam that sees it meets it at x = 0.28 - 0.3 / tan(2.0 - pi / 2).
  EXPECT_LT(nearest({-0.2, -0.3}), 0.02);
  EXPECT_LT(nearest({-0.6, -0.3}), 0.02);
  EXPECT_GT(nearest({-0.9, -0.3}), 0.05);
  const auto seen =
      surroundings.points().first(surroundings.points().size() - surroundings.guessed());
  EXPECT_NEAR(static_cast<double>(surroundings.guessed()), 160.0, 1.0);
  for (const Point2& p : seen) EXPECT_GT(p.x(), 0.1);
  walls = {{0, -1, 2.0}};
  look();
  EXPECT_GT(nearest({-0.9, -2.0}), 0.05) << "too far to matter";
}

TEST_F(Walled, ForgetsAllWhenNoScanComes) {
  walls = {{0, 1, 0.5}};
  drive({0.6, 0.0}, 1.0);
  surroundings.forget();
  EXPECT_TRUE(surroundings.points().empty());
}

TEST_F(Walled, SurvivesNonsense) {
  const std::vector<float> ranges{kNan, kInfinity, -kInfinity, 0.0F};
  surroundings.take({ranges, 0.0, 0.1}, now);
  surroundings.take({ranges, std::nan(""), 0.1}, now);
  surroundings.take({ranges, 0.0, 0.0}, now);
  surroundings.take({{}, 0.0, 0.1}, now);
  surroundings.move(Twist2{std::nan(""), 0.0}, now);
  for (const Point2& p : surroundings.points()) EXPECT_TRUE(p.allFinite());
}

}  // namespace
}  // namespace usher::movement_control
