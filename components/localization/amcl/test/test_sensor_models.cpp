#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/estimation/pose_statistics.hpp"
#include "localization/amcl/core/beam_model.hpp"
#include "localization/amcl/core/laser_beams.hpp"
#include "localization/amcl/core/likelihood_field.hpp"
#include "localization/amcl/core/likelihood_kernel.hpp"
#include "localization/amcl/core/motion_model.hpp"
#include "localization/amcl/core/scan_refinement.hpp"
#include "localization/amcl/test/sim_robot.hpp"

namespace usher::amcl {
namespace {

using cpu::Simd;
using geometry::kPi;
using geometry::Pose2;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Particles around(const Pose2& center, double position, double yaw, std::size_t count,
                 std::uint64_t seed) {
  Random random(seed);
  Particles particles;
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    particles.set(i,
                  {random.gaussian(center.x, position), random.gaussian(center.y, position),
                   geometry::normalized(random.gaussian(center.yaw, yaw))},
                  1.0 / static_cast<double>(count));
  }
  return particles;
}

// ---- beams

LaserBeams scan_of(const std::vector<float>& ranges) { return {{}, -1.0, 0.1, 0.1, 20.0, ranges}; }

TEST(ChooseBeams, CountsWhatItLeavesOut) {
  std::vector<Beam> beams;
  const auto counts =
      choose_beams(scan_of({1, kNan, 2, kInfinity, 0.05F, -3, 20, 25, 3}), 60, 30.0, false, beams);
  EXPECT_EQ(counts.used, 3U);
  EXPECT_EQ(counts.not_finite, 2U);
  EXPECT_EQ(counts.out_of_range, 2U);
  EXPECT_EQ(counts.no_return, 2U);
  EXPECT_NEAR(beams[1].angle, -0.8, 1e-12);
}

TEST(ChooseBeams, KeepsBeamsWithoutReturnOnRequestAtTheLargestRange) {
  std::vector<Beam> beams;
  EXPECT_EQ(choose_beams(scan_of({1, 20, 25}), 60, 30.0, true, beams).used, 3U);
  EXPECT_EQ(beams[2].range, 20.0);
}

TEST(ChooseBeams, SpreadsEvenlyFromFirstToLast) {
  const std::vector<float> ranges(541, 5.0F);
  std::vector<Beam> beams;
  for (const std::size_t wanted : {2U, 3U, 60U, 180U, 540U, 541U, 600U}) {
    const auto counts = choose_beams(scan_of(ranges), wanted, 30.0, false, beams);
    ASSERT_EQ(counts.used, std::min<std::size_t>(wanted, 541));
    EXPECT_NEAR(beams.front().angle, -1.0, 1e-9);
    EXPECT_NEAR(beams.back().angle, -1.0 + 54.0, 1e-9);
    for (std::size_t i = 2; i < beams.size(); ++i) {
      EXPECT_NEAR(beams[i].angle - beams[i - 1].angle, beams[1].angle - beams[0].angle, 0.1 + 1e-9);
    }
  }
}

TEST(ChooseBeams, PlacesTheLaserOnTheBase) {
  const std::vector<float> ranges = {2.0F};
  std::vector<Beam> beams;
  choose_beams({{0.2, 0.1, kPi / 2}, 0.0, 0.1, 0.0, 20.0, ranges}, 60, 30.0, false, beams);
  EXPECT_NEAR(beams[0].x, 0.2, 1e-12);
  EXPECT_NEAR(beams[0].y, 2.1, 1e-12);
  EXPECT_NEAR(beams[0].direction_y, 1.0, 1e-12);
}

TEST(ChooseBeams, OfNothingIsNothing) {
  std::vector<Beam> beams;
  EXPECT_EQ(choose_beams(scan_of({}), 60, 30.0, false, beams).used, 0U);
  EXPECT_EQ(choose_beams(scan_of({kNan}), 60, 30.0, false, beams).used, 0U);
  EXPECT_EQ(choose_beams(scan_of({1.0F}), 60, 30.0, false, beams).used, 1U);
}

// ---- likelihood field

TEST(CosineSine, IsExactToFloatAndTheSameEverywhere) {
  std::vector<double> yaw;
  for (int i = -3200; i <= 3200; ++i) yaw.push_back(i * kPi / 3200.0);
  std::vector<float> c(yaw.size()), s(yaw.size()), c2(yaw.size()), s2(yaw.size());
  cosine_sine(yaw.data(), yaw.size(), c.data(), s.data(), Simd::kPortable);
  for (std::size_t i = 0; i < yaw.size(); ++i) {
    EXPECT_NEAR(c[i], std::cos(yaw[i]), 1.5e-7);
    EXPECT_NEAR(s[i], std::sin(yaw[i]), 1.5e-7);
  }
  cosine_sine(yaw.data(), yaw.size(), c2.data(), s2.data(), cpu::best_simd());
  EXPECT_EQ(c, c2);
  EXPECT_EQ(s, s2);
}

class Field : public testing::Test {
 protected:
  Field() {
    field_.build(map_, parameters_);
    choose_beams(robot_.scan(), 60, 30.0, false, beams_);
  }
  std::vector<double> log_likelihood(const Particles& particles, Simd simd = cpu::best_simd()) {
    std::vector<double> result(particles.size());
    field_.log_likelihood(particles, beams_, result, simd);
    return result;
  }

  const grid::OccupancyGrid map_ = small_building();
  const Pose2 pose_{2.0, 5.1, 0.4};
  SimRobot robot_{map_, pose_, 1};
  SensorParameters parameters_;
  LikelihoodField field_;
  std::vector<Beam> beams_;
};

TEST_F(Field, IsTheSameOnEveryInstructionSet) {
  Particles particles = around(pose_, 3.0, 2.0, 1003, 2);
  particles.set(0, {1e6, -1e6, 1.0}, 1.0);  // outside, on all sides and far away
  particles.set(1, {-50.0, 5.0, 3.1}, 1.0);
  EXPECT_EQ(log_likelihood(particles, Simd::kPortable), log_likelihood(particles, Simd::kAvx2));
}

TEST_F(Field, QuantizationCostsLessThanOneInTenThousand) {
  const Particles particles = around(pose_, 0.5, 0.3, 500, 3);
  const std::vector<double> fast = log_likelihood(particles);
  double worst = 0.0;
  int moved = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    double exact = 0.0;
    for (const Beam& beam : beams_) {
      const auto point = particles.pose(i) * geometry::Point2(beam.x, beam.y);
      const auto cell = map_.geometry().cell_at(point);
      const bool inside = map_.geometry().contains(cell);
      const double distance =
          inside ? field_.distances().distance(cell) : field_.distances().radius();
      exact += std::log(field_.beam_likelihood(distance)) / static_cast<double>(beams_.size());
    }
    // Coordinates in float put one point in 10^4 into the neighbouring cell; the rest is the 16-bit
    // step.
    if (std::abs(fast[i] - exact) > 5e-5) ++moved;
    worst = std::max(worst, std::abs(fast[i] - exact));
  }
  EXPECT_LE(moved, 25);
  EXPECT_LT(worst, 0.03);
}

TEST_F(Field, IsHighestWhereTheRobotStands) {
  const Particles particles = around(pose_, 1.0, 0.5, 2000, 4);
  const std::vector<double> values = log_likelihood(particles);
  const auto best =
      static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
  EXPECT_LT(distance(particles.pose(best), pose_), 0.2);
}

TEST_F(Field, WithoutBeamsIsZero) {
  beams_.clear();
  EXPECT_EQ(log_likelihood(around(pose_, 1.0, 1.0, 3, 5)), (std::vector<double>{0.0, 0.0, 0.0}));
}

TEST_F(Field, ForgetsTheLastMap) {
  LikelihoodField other;
  other.build(grid::OccupancyGrid({480, 280, 0.05, -3.0, -2.0}, grid::kOccupied), parameters_);
  other.build(map_, parameters_);
  std::vector<double> a(20), b(20);
  const Particles particles = around(pose_, 1.0, 1.0, 20, 6);
  other.log_likelihood(particles, beams_, a);
  field_.log_likelihood(particles, beams_, b);
  EXPECT_EQ(a, b);
}

// ---- beam model

TEST_F(Field, BeamModelIsHighestWhereTheRobotStands) {
  const Particles particles = around(pose_, 0.7, 0.3, 2000, 7);
  std::vector<double> values(particles.size());
  choose_beams(robot_.scan(), 60, 30.0, true, beams_);
  beam_model_log_likelihood(field_.distances(), parameters_, 20.0, particles,
                            SimRobot::base_T_laser(), beams_, values);
  const auto best =
      static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
  EXPECT_LT(distance(particles.pose(best), pose_), 0.2);
}

TEST_F(Field, BeamModelForgivesPeopleButNotWallsSeenThrough) {
  Particles one;
  one.resize(1);
  one.set(0, pose_, 1.0);
  std::vector<double> as_is(1), early(1), late(1);
  const auto weigh = [&](std::vector<double>& out) {
    beam_model_log_likelihood(field_.distances(), parameters_, 20.0, one, SimRobot::base_T_laser(),
                              beams_, out);
  };
  weigh(as_is);
  const std::vector<Beam> seen = beams_;
  for (std::size_t i = 0; i < 20; ++i) beams_[i].range *= 0.5;
  weigh(early);
  beams_ = seen;
  for (std::size_t i = 0; i < 20; ++i) beams_[i].range *= 1.5;
  weigh(late);
  EXPECT_LT(early[0], as_is[0]);
  EXPECT_LT(late[0], early[0]);
}

// ---- motion

TEST(Move, WithoutNoiseIsTheOdometryStep) {
  Random random(1);
  for (const Pose2& step :
       {Pose2{0.1, 0.02, 0.1}, {-0.1, 0.0, 0.05}, {0.0, 0.0, 0.3}, {0.005, 0.0, -0.2}, {0, 0, 0}}) {
    Particles particles = around({1, 2, 3.0}, 0.5, 0.5, 10, 8);
    const Particles before = particles;
    move(particles, step, {0, 0, 0, 0}, random);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Pose2 expected = before.pose(i) * step;
      EXPECT_NEAR(distance(particles.pose(i), expected), 0.0,
                  0.0051);  // tiny steps have no direction
      EXPECT_NEAR(geometry::shortest_turn(particles.yaw[i], expected.yaw), 0.0, 1e-9);
    }
  }
}

TEST(Move, SpreadsAsItsAlphasSay) {
  Random random(2);
  Particles particles;
  particles.resize(20000);
  for (std::size_t i = 0; i < particles.size(); ++i) particles.set(i, {}, 1.0);
  move(particles, {1.0, 0.0, 0.0}, {0.0, 0.01, 0.04, 0.0}, random);
  const auto s = estimation::pose_statistics(
      particles.size(), [&](std::size_t i) { return particles.pose(i); },
      [](std::size_t) { return 1.0; });
  EXPECT_NEAR(s.covariance(0, 0), 0.04, 0.002);    // along
  EXPECT_NEAR(s.covariance(2, 2), 0.02, 0.001);    // two rotations of 0.1 rad each
  EXPECT_NEAR(s.covariance(1, 1), 0.0104, 0.001);  // across: the first of them times the way
}

TEST(Move, BackwardsIsNoHalfTurn) {
  Random random(3);
  Particles particles;
  particles.resize(5000);
  for (std::size_t i = 0; i < particles.size(); ++i) particles.set(i, {}, 1.0);
  move(particles, {-1.0, 0.0, 0.0}, {0.1, 0.0, 0.0, 0.1}, random);
  for (std::size_t i = 0; i < particles.size(); ++i) ASSERT_NEAR(particles.x[i], -1.0, 1e-9);
}

// ---- refinement

TEST_F(Field, RefinementFindsThePoseFromNearby) {
  Random random(9);
  choose_beams(robot_.scan(), 180, 30.0, false, beams_);
  const Eigen::Matrix3d prior = Eigen::Vector3d(100.0, 100.0, 400.0).asDiagonal();
  double worst = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Pose2 start{pose_.x + random.uniform(-0.1, 0.1), pose_.y + random.uniform(-0.1, 0.1),
                      pose_.yaw + random.uniform(-0.05, 0.05)};
    const auto result = refine(field_.distances(), beams_, start, prior, {});
    EXPECT_TRUE(result.accepted);
    worst = std::max(worst, distance(result.pose, pose_));
  }
  EXPECT_LT(worst, 0.02);
}

TEST_F(Field, RefinementStaysWithinItsBounds) {
  choose_beams(robot_.scan(), 180, 30.0, false, beams_);
  RefinementParameters tight;
  tight.max_shift = 0.01;
  const Pose2 start{pose_.x + 0.1, pose_.y, pose_.yaw};
  const auto result = refine(field_.distances(), beams_, start, Eigen::Matrix3d::Zero(), tight);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.pose, start);
}

TEST_F(Field, RefinementWithoutBeamsOrWallsKeepsTheStart) {
  const Pose2 start{1.0, 2.0, 0.5};
  EXPECT_EQ(refine(field_.distances(), {}, start, Eigen::Matrix3d::Zero(), {}).pose, start);
  const Pose2 far{1000.0, 0.0, 0.0};
  EXPECT_EQ(refine(field_.distances(), beams_, far, Eigen::Matrix3d::Zero(), {}).pose, far);
}

TEST(Refinement, HoldsThePoseAlongACorridor) {
  grid::OccupancyGrid map({1200, 60, 0.05, -30.0, -1.5}, grid::kFree);
  for (int x = 0; x < 1200; ++x) map.at({x, 10}) = map.at({x, 50}) = grid::kOccupied;
  SimRobot robot(map, {0, 0, 0}, 1);
  grid::DistanceField field;
  field.build(map, 2.0);
  std::vector<Beam> beams;
  choose_beams(robot.scan(), 180, 10.0, false, beams);
  const Eigen::Matrix3d prior = Eigen::Vector3d(100.0, 100.0, 400.0).asDiagonal();
  const auto result = refine(field, beams, {0.4, 0.08, 0.03}, prior, {});
  EXPECT_NEAR(result.pose.x, 0.4, 0.03);  // as well known as before
  EXPECT_NEAR(result.pose.y, 0.0, 0.02);
  EXPECT_NEAR(result.pose.yaw, 0.0, 0.01);
}

}  // namespace
}  // namespace usher::amcl
