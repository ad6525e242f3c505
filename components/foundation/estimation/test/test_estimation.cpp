#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "foundation/estimation/gaussian_pose.hpp"
#include "foundation/estimation/pose_histogram.hpp"
#include "foundation/estimation/pose_statistics.hpp"
#include "foundation/estimation/resampling.hpp"

namespace usher::estimation {
namespace {

using geometry::kPi;
using geometry::Pose2;

PoseStatistics statistics(const std::vector<Pose2>& poses, const std::vector<double>& weights) {
  return pose_statistics(
      poses.size(), [&](std::size_t i) { return poses[i]; },
      [&](std::size_t i) { return weights[i]; });
}

TEST(PoseStatistics, MeanYawCrossesThePiBorder) {
  const auto s = statistics({{0, 0, kPi - 0.1}, {0, 0, -kPi + 0.1}}, {1, 1});
  EXPECT_NEAR(std::abs(s.mean.yaw), kPi, 1e-12);
  EXPECT_NEAR(s.covariance(2, 2), 0.01, 1e-12);
}

TEST(PoseStatistics, WeightsCountAsRepetitions) {
  const std::vector<Pose2> poses = {{1, 2, 0.1}, {3, -1, 0.5}, {0, 0, -0.4}};
  const auto weighted = statistics(poses, {1, 2, 3});
  const auto repeated =
      statistics({poses[0], poses[1], poses[1], poses[2], poses[2], poses[2]}, {1, 1, 1, 1, 1, 1});
  EXPECT_NEAR((weighted.covariance - repeated.covariance).norm(), 0.0, 1e-12);
  EXPECT_NEAR(weighted.mean.x, repeated.mean.x, 1e-12);
  EXPECT_EQ(weighted.weight, 6.0);
}

TEST(PoseStatistics, OfNothingIsZero) {
  EXPECT_EQ(statistics({}, {}).weight, 0.0);
  EXPECT_EQ(statistics({{1, 1, 1}}, {0.0}).mean, Pose2{});
}

TEST(LowVarianceResample, PicksEachIndexFloorOrCeilTimes) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    std::vector<double> weights(1 + random.below(40));
    for (double& weight : weights) weight = random.uniform() < 0.2 ? 0.0 : random.uniform();
    weights[random.below(weights.size())] = 1.0;
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<std::uint32_t> picked(1 + random.below(60));
    low_variance_resample(weights, random.uniform(), picked);
    ASSERT_TRUE(std::is_sorted(picked.begin(), picked.end()));
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
      const double expected = weights[i] / total * static_cast<double>(picked.size());
      const auto count = static_cast<double>(std::count(picked.begin(), picked.end(), i));
      ASSERT_LE(std::abs(count - expected), 1.0 + 1e-9);
      if (weights[i] == 0.0) {
        ASSERT_EQ(count, 0.0);
      }
    }
  }
}

TEST(LowVarianceResample, IsUnbiased) {
  const std::vector<double> weights = {0.05, 0.4, 0.0, 0.25, 0.3};
  std::vector<double> counts(weights.size());
  Random random(2);
  constexpr int kRounds = 40000;
  std::vector<std::uint32_t> picked(7);
  for (int round = 0; round < kRounds; ++round) {
    low_variance_resample(weights, random.uniform(), picked);
    for (const auto i : picked) counts[i] += 1.0 / (7.0 * kRounds);
  }
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(counts[i], weights[i], 0.003);
}

TEST(LowVarianceResample, SurvivesOffsetsAtTheBorder) {
  const std::vector<double> weights = {0.1, 0.1, 0.1, 0.0};
  std::vector<std::uint32_t> picked(1000);
  low_variance_resample(weights, std::nextafter(1.0, 0.0), picked);
  EXPECT_LE(picked.back(), 2U);
}

TEST(KldSampleBound, IsHalfTheChiSquareQuantileOverEpsilon) {
  // Chi-square quantiles at 0.99 from tables; Wilson-Hilferty is good to a percent there.
  const std::vector<std::pair<std::size_t, double>> table = {
      {6, 15.086}, {11, 23.209}, {31, 50.892}, {101, 135.807}};
  for (const auto& [bins, quantile] : table) {
    EXPECT_NEAR(kld_sample_bound(bins, 0.05, 2.326348) / (quantile / 0.1), 1.0, 0.01) << bins;
  }
  EXPECT_EQ(kld_sample_bound(0, 0.05, 2.3), 1.0);
  EXPECT_EQ(kld_sample_bound(1, 0.05, 2.3), 1.0);
  EXPECT_GT(kld_sample_bound(50, 0.01, 2.3), kld_sample_bound(50, 0.05, 2.3));
}

TEST(GaussianPose, HasTheMomentsAskedFor) {
  Eigen::Matrix3d covariance;
  covariance << 0.25, 0.1, 0.0, 0.1, 0.5, 0.02, 0.0, 0.02, 0.04;
  const auto gaussian = GaussianPose::make({1, -2, 3.0}, covariance);
  ASSERT_TRUE(gaussian.ok());
  Random random(3);
  std::vector<Pose2> poses(50000);
  for (Pose2& pose : poses) pose = gaussian->sample(random);
  const auto s = statistics(poses, std::vector<double>(poses.size(), 1.0));
  EXPECT_NEAR(s.mean.x, 1.0, 0.01);
  EXPECT_NEAR(geometry::shortest_turn(3.0, s.mean.yaw), 0.0, 0.005);
  EXPECT_LT((s.covariance - covariance).cwiseAbs().maxCoeff(), 0.012);
}

TEST(GaussianPose, TakesACovarianceWithoutFullRank) {
  const auto gaussian =
      GaussianPose::make({1, 2, 0.3}, Eigen::Vector3d(0.1, 0.0, 0.0).asDiagonal());
  Random random(4);
  const Pose2 pose = gaussian->sample(random);
  EXPECT_EQ(pose.y, 2.0);
  EXPECT_NEAR(pose.yaw, 0.3, 1e-12);
}

TEST(GaussianPose, RefusesWhatIsNoCovariance) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  m(0, 1) = 0.5;
  EXPECT_FALSE(GaussianPose::make({}, m).ok());
  EXPECT_FALSE(GaussianPose::make({}, Eigen::Vector3d(1, 1, -1).asDiagonal()).ok());
  EXPECT_FALSE(GaussianPose::make({}, Eigen::Vector3d(1, std::nan(""), 1).asDiagonal()).ok());
  EXPECT_FALSE(
      GaussianPose::make({std::numeric_limits<double>::infinity(), 0, 0}, Eigen::Matrix3d::Zero())
          .ok());
}

TEST(PoseHistogram, CountsBins) {
  PoseHistogram histogram(0.5, kPi / 18, 10);
  EXPECT_EQ(histogram.add({0.1, 0.1, 0.01}), 0U);
  EXPECT_EQ(histogram.add({0.4, 0.2, 0.02}), 0U);
  EXPECT_EQ(histogram.add({0.6, 0.2, 0.02}), 1U);
  EXPECT_EQ(histogram.add({-0.1, 0.2, 0.02}), 2U);
  EXPECT_EQ(histogram.add({0.1, 0.1, 0.01 + 2 * kPi}), 0U);
  EXPECT_EQ(histogram.bins(), 3U);
  histogram.clear();
  EXPECT_EQ(histogram.bins(), 0U);
  EXPECT_EQ(histogram.add({0.6, 0.2, 0.02}), 0U);
}

TEST(PoseHistogram, AgreesWithSortedBins) {
  Random random(5);
  PoseHistogram histogram(0.5, 0.1, 3000);
  for (int round = 0; round < 3; ++round) {
    histogram.clear();
    std::vector<std::array<int, 3>> keys;
    const int yaw_bins = 63;
    for (int i = 0; i < 3000; ++i) {
      const Pose2 pose{random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-kPi, kPi)};
      histogram.add(pose);
      keys.push_back({static_cast<int>(std::floor(pose.x / 0.5)),
                      static_cast<int>(std::floor(pose.y / 0.5)),
                      static_cast<int>((pose.yaw + kPi) * yaw_bins / (2 * kPi)) % yaw_bins});
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    EXPECT_EQ(histogram.bins(), keys.size());
  }
}

TEST(PoseHistogram, ClustersTouchAcrossCornersAndThePiBorder) {
  PoseHistogram histogram(1.0, kPi / 4, 10);
  const auto a = histogram.add({0.5, 0.5, kPi - 0.1});
  const auto b = histogram.add({1.5, 1.5, -kPi + 0.1});  // touches a at a corner, across pi
  const auto c = histogram.add({3.5, 0.5, 0.0});
  const auto d = histogram.add({0.5, 0.5, 0.0});  // the place of a, another direction
  const auto clusters = histogram.clusters();
  EXPECT_EQ(clusters[a], clusters[b]);
  EXPECT_NE(clusters[a], clusters[c]);
  EXPECT_NE(clusters[a], clusters[d]);
  EXPECT_EQ(histogram.cluster_count(), 3U);
}

}  // namespace
}  // namespace usher::estimation
