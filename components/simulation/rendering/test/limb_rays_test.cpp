#include "simulation/rendering/core/limb_rays.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "foundation/random/random.hpp"

namespace usher::rendering {
namespace {

/// How far a point is from the limb, by the definition: from the nearest of the balls between both.
double distance_to(const Limb& limb, const Eigen::Vector3d& p) {
  const auto to_ball = [&](double share) {
    const Eigen::Vector3d middle =
        (1.0 - share) * limb.from.cast<double>() + share * limb.to.cast<double>();
    const double radius = (1.0 - share) * static_cast<double>(limb.from_radius) +
                          share * static_cast<double>(limb.to_radius);
    return (p - middle).norm() - radius;
  };
  double low = 0.0, high = 1.0;  // it is convex in the share
  for (int i = 0; i < 60; ++i) {
    const double first = low + (high - low) / 3.0, second = high - (high - low) / 3.0;
    if (to_ball(first) < to_ball(second)) {
      high = second;
    } else {
      low = first;
    }
  }
  return to_ball(0.5 * (low + high));
}

struct Walk {
  std::optional<double> met;  // where the limb begins
  double nearest = 1e9;       // on the way
};

/// Steps along a ray that never pass the limb.
Walk walk(const Limb& limb, const Eigen::Vector3d& from, const Eigen::Vector3d& unit) {
  Walk walk;
  for (double way = 0.0; way < 12.0;) {
    const double left = distance_to(limb, from + way * unit);
    walk.nearest = std::min(walk.nearest, left);
    if (left < 1e-7) return {way, left};
    way += left;
  }
  return walk;
}

Limb random_limb(Random& random) {
  const auto point = [&] {
    return Eigen::Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5),
                           random.uniform(-0.5, 0.5))
        .cast<float>()
        .eval();
  };
  Limb limb{point(), point(), static_cast<float>(random.uniform(0.02, 0.3)),
            static_cast<float>(random.uniform(0.02, 0.3))};
  if (random.uniform(0, 1) < 0.2) limb.to_radius = limb.from_radius;
  if (random.uniform(0, 1) < 0.1) limb.to = limb.from;
  return limb;
}

TEST(LimbRays, MeetTheNearestOfAllBallsBetween) {
  Random random(7);
  int met = 0, missed = 0, along = 0;
  for (int i = 0; i < 4000; ++i) {
    const Limb limb = random_limb(random);
    Eigen::Vector3d from(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-2, 2));
    const bool axial = i % 4 == 0;  // steeper than the cone
    const Eigen::Vector3d axis = (limb.to - limb.from).cast<double>();
    if (axial) from = limb.from.cast<double>() - (3.0 - 6.0 * (i % 8 == 0)) * axis;
    if (distance_to(limb, from) < 0.05) continue;
    const double aside = axial ? 0.05 : 0.4;
    const Eigen::Vector3d target =
        limb.from.cast<double>() + random.uniform(0, 1) * axis +
        Eigen::Vector3d(random.uniform(-aside, aside), random.uniform(-aside, aside), 0.0);
    const Eigen::Vector3d way = target - from;
    if (way.norm() < 0.1) continue;
    const Walk truth = walk(limb, from, way.normalized());
    if (!truth.met && truth.nearest < 1e-4) continue;  // it touches

    LimbHits hits;
    const std::array<float, 1> x{0.5F};
    const Eigen::Vector3f right(0.3F, -0.2F, 0.1F);
    LimbRays(limb, from.cast<float>()).meet({way.cast<float>() - 0.5F * right, right}, x, hits);
    ASSERT_EQ(std::isfinite(hits.distance[0]), truth.met.has_value()) << i;
    if (!truth.met) {
      ++missed;
      continue;
    }
    ++(axial ? along : met);
    const double found = static_cast<double>(hits.distance[0]) * way.norm();
    const Eigen::Vector3d at = from + *truth.met * way.normalized();
    Eigen::Vector3d normal;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = 1e-4 * Eigen::Vector3d::Unit(k);
      normal[k] = distance_to(limb, at + step) - distance_to(limb, at - step);
    }
    const double cosine = std::abs(normal.normalized().dot(way.normalized()));
    if (cosine < 0.1) continue;  // the nearer to touching, the less is the place known
    EXPECT_NEAR(found, *truth.met, 1e-4 + 3e-4 / cosine) << i;
    EXPECT_NEAR(static_cast<double>(hits.cosine[0]), cosine, 0.02) << i;
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(along, 300);
  EXPECT_GT(missed, 500);
}

TEST(LimbRays, DoNotMeetWhatLiesBehind) {
  const Limb limb{{0, 0, 0}, {0, 0, 1}, 0.1F, 0.2F};
  LimbHits hits;
  const std::array<float, 2> x{-1.0F, 1.0F};  // toward it and away from it
  LimbRays(limb, {0, 2, 0.5F}).meet({{0, 0, 0}, {0, 1, 0}}, x, hits);
  EXPECT_NEAR(hits.distance[0], 1.85F, 0.01F);
  EXPECT_FALSE(std::isfinite(hits.distance[1]));
}

}  // namespace
}  // namespace usher::rendering
