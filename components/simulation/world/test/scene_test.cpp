#include "simulation/world/core/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/random/random.hpp"
#include "simulation/world/core/ray_caster.hpp"

namespace usher::world {
namespace {

using geometry::kPi;
using geometry::Pose3;
using geometry::radians;

Pose3 sensor_at(double x, double y, double z, double yaw = 0.0, double pitch = 0.0,
                double roll = 0.0) {
  return {{x, y, z}, geometry::from_roll_pitch_yaw(roll, pitch, yaw)};
}

Fan laser_fan() { return {radians(-135.0), radians(0.5), 541}; }

/// The slow truth: one ray against every face of every thing.
struct Reference {
  float range;
  std::int32_t what;
};

void meet_plane_z(const Eigen::Vector3d& o, const Eigen::Vector3d& d, double z, auto&& inside,
                  double& best, std::int32_t id, std::int32_t& what) {
  if (std::abs(d.z()) < 1e-12) return;
  const double t = (z - o.z()) / d.z();
  const Eigen::Vector3d p = o + t * d;
  if (t > 1e-9 && t < best && inside(Point2(p.x(), p.y()))) best = t, what = id;
}

Reference reference_ray(const Scene& scene, std::span<const Mover> movers, const Pose3& sensor,
                        double angle, double max_range) {
  const Eigen::Vector3d o = sensor.translation;
  const Eigen::Vector3d d = sensor.rotation * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  double best = max_range;
  std::int32_t what = kNothing;
  const auto everywhere = [](const Point2&) { return true; };
  meet_plane_z(o, d, 0.0, everywhere, best, kFloor, what);
  meet_plane_z(o, d, scene.ceiling(), everywhere, best, kCeiling, what);
  const auto meet_disc = [&](const Point2& c, double r, double bottom, double top, int id) {
    const Point2 to = c - Point2(o.x(), o.y());
    const Point2 u(d.x(), d.y());
    const double root2 = std::pow(u.dot(to), 2) - u.squaredNorm() * (to.squaredNorm() - r * r);
    if (root2 >= 0.0) {
      const double t = (u.dot(to) - std::sqrt(root2)) / u.squaredNorm();
      const double z = o.z() + t * d.z();
      if (t > 0 && t < best && z >= bottom && z <= top) best = t, what = id;
    }
    const auto in = [&](const Point2& p) { return (p - c).norm() <= r; };
    meet_plane_z(o, d, top, in, best, id, what);
    meet_plane_z(o, d, bottom, in, best, id, what);
  };
  for (std::size_t i = 0; i < scene.things().size(); ++i) {
    const Thing& thing = scene.things()[i];
    const auto id = static_cast<std::int32_t>(i);
    if (thing.outline.empty()) {
      meet_disc(thing.center, thing.radius, thing.bottom, thing.top, id);
      continue;
    }
    const auto inside = [&](const Point2& p) {
      for (std::size_t k = 0; k < thing.outline.size(); ++k) {
        const Point2 a = thing.outline[k];
        const Point2 e = thing.outline[(k + 1) % thing.outline.size()] - a;
        if (e.x() * (p - a).y() - e.y() * (p - a).x() < 0) return false;
      }
      return true;
    };
    for (std::size_t k = 0; k < thing.outline.size(); ++k) {
      const Point2 a = thing.outline[k];
      const Point2 e = thing.outline[(k + 1) % thing.outline.size()] - a;
      const double den = d.x() * e.y() - d.y() * e.x();
      if (den >= 0.0) continue;
      const Point2 to = a - Point2(o.x(), o.y());
      const double t = (to.x() * e.y() - to.y() * e.x()) / den;
      const double s = (to.x() * d.y() - to.y() * d.x()) / den;
      const double z = o.z() + t * d.z();
      if (t > 0 && t < best && s >= 0 && s <= 1 && z >= thing.bottom && z <= thing.top) {
        best = t, what = id;
      }
    }
    meet_plane_z(o, d, thing.top, inside, best, id, what);
    meet_plane_z(o, d, thing.bottom, inside, best, id, what);
  }
  for (std::size_t i = 0; i < movers.size(); ++i) {
    meet_disc(movers[i].center, movers[i].radius, 0.0, movers[i].top,
              static_cast<int>(scene.things().size() + i));
  }
  return {static_cast<float>(best), what};
}

bool inside_something(const Scene& scene, std::span<const Mover> movers, const Point2& p) {
  if (scene.nearest(p, 10.0, 0.02).thing >= 0) return true;
  for (const Mover& m : movers) {
    if ((m.center - p).norm() < m.radius + 0.02) return true;
  }
  return false;
}

Scene random_scene(Random& random, int count) {
  std::vector<Thing> things;
  for (int i = 0; i < count; ++i) {
    const Pose2 pose{random.uniform(-15, 15), random.uniform(-15, 15), random.uniform(-kPi, kPi)};
    const auto name = std::to_string(i);
    const double bottom = random.uniform() < 0.3 ? random.uniform(0.0, 1.0) : 0.0;
    switch (random.below(3)) {
      case 0:
        things.push_back(wall(name, pose.position(), pose * Point2(random.uniform(0.5, 8), 0),
                              random.uniform(0.02, 0.3), 2.7));
        break;
      case 1:
        things.push_back(box(name, pose, random.uniform(0.1, 2), random.uniform(0.1, 1), bottom,
                             bottom + random.uniform(0.1, 1.5)));
        break;
      default:
        things.push_back(disc(name, pose.position(), random.uniform(0.05, 0.5), bottom,
                              bottom + random.uniform(0.1, 1.5)));
    }
  }
  return {std::move(things), 2.7};
}

TEST(RayCaster, AgreesWithRayByRayReference) {
  Random random(1);
  const Fan fan = laser_fan();
  RayCaster caster;
  FanHits hits;
  int beams = 0;
  int differ = 0;
  for (int round = 0; round < 60; ++round) {
    const Scene scene = random_scene(random, 60);
    std::vector<Mover> movers;
    for (int i = 0; i < 5; ++i) {
      movers.push_back({.center = {random.uniform(-10, 10), random.uniform(-10, 10)}});
    }
    const double tilt = round % 3 == 0 ? 0.0 : 0.4;
    const Pose3 sensor = sensor_at(random.uniform(-10, 10), random.uniform(-10, 10),
                                   random.uniform(0.1, 1.6), random.uniform(-kPi, kPi),
                                   random.uniform(-tilt, tilt), random.uniform(-tilt, tilt));
    if (inside_something(scene, movers, sensor.translation.head<2>())) continue;
    caster.cast(scene, fan, sensor, {}, movers, hits);
    for (int i = 0; i < fan.count(); ++i) {
      const Reference truth = reference_ray(scene, movers, sensor, fan.angle(i), 20.0);
      const auto k = static_cast<std::size_t>(i);
      ++beams;
      // Rounding may decide a beam that grazes an edge.
      if (std::abs(hits.range[k] - truth.range) > 1e-3f) ++differ;
    }
  }
  EXPECT_GT(beams, 15000);
  EXPECT_LT(differ, beams / 2000);
}

TEST(RayCaster, SeesThroughNoSeamOfALongWall) {
  const Scene scene({wall("w", {5.0, -30.0}, {5.3, 30.0}, 0.1, 2.7)}, 2.7);
  RayCaster caster;
  FanHits hits;
  const Fan fan(radians(-60.0), radians(0.01), 12001);
  caster.cast(scene, fan, sensor_at(0.0, 0.123, 0.3), {.max_range = 30.0}, {}, hits);
  for (std::size_t i = 0; i < hits.what.size(); ++i) ASSERT_EQ(hits.what[i], 0) << i;
}

TEST(RayCaster, SeesNothingInAnEmptyWorld) {
  const Scene scene({}, 2.7);
  RayCaster caster;
  FanHits hits;
  caster.cast(scene, laser_fan(), sensor_at(0, 0, 0.3), {}, {}, hits);
  for (const auto what : hits.what) ASSERT_EQ(what, kNothing);
  caster.cast(scene, laser_fan(), sensor_at(0, 0, 0.3, 0.0, radians(10.0)), {}, {}, hits);
  EXPECT_EQ(hits.what[270], kFloor);
  EXPECT_NEAR(hits.range[270], 0.3 / std::sin(radians(10.0)), 1e-4);
  EXPECT_EQ(hits.what[0], kCeiling);  // the rear quarter looks up
}

TEST(RayCaster, LooksOverLowThingsAndOntoTheirTops) {
  const Scene scene({box("table", {3.0, 0.0, 0.0}, 1.0, 1.0, 0.0, 0.4),
                     wall("wall", {6.0, -2.0}, {6.0, 2.0}, 0.2, 2.7)},
                    2.7);
  RayCaster caster;
  FanHits hits;
  const Fan forward(0.0, 0.1, 1);
  caster.cast(scene, forward, sensor_at(0, 0, 0.3), {}, {}, hits);
  EXPECT_EQ(hits.what[0], 0);
  EXPECT_NEAR(hits.range[0], 2.5, 1e-5);
  caster.cast(scene, forward, sensor_at(0, 0, 0.5), {}, {}, hits);
  EXPECT_EQ(hits.what[0], 1);
  EXPECT_NEAR(hits.range[0], 5.9, 1e-5);
  const double down = std::atan2(0.6, 3.0);
  caster.cast(scene, forward, sensor_at(0, 0, 1.0, 0.0, down), {}, {}, hits);
  EXPECT_EQ(hits.what[0], 0);
  EXPECT_NEAR(hits.range[0], std::hypot(0.6, 3.0), 1e-5);
}

TEST(RayCaster, GlassIsForSonarsAndRarelyForLasers) {
  Thing pane = wall("pane", {2.0, -5.0}, {2.0, 5.0}, 0.02, 2.7);
  pane.material = Material::kGlass;
  const Scene scene({pane, wall("wall", {4.0, -9.0}, {4.0, 9.0}, 0.2, 2.7)}, 2.7);
  RayCaster caster;
  FanHits hits;
  const Fan fan(radians(-30.0), radians(30.0), 3);
  caster.cast(scene, fan, sensor_at(0, 0, 0.3), {}, {}, hits);
  EXPECT_EQ(hits.what[1], 0);
  const std::vector<std::uint8_t> none(3, 0);
  caster.cast(scene, fan, sensor_at(0, 0, 0.3), {.glass_flags = none}, {}, hits);
  EXPECT_EQ(hits.what[1], 1);
  const std::vector<std::uint8_t> all(3, 1);
  caster.cast(scene, fan, sensor_at(0, 0, 0.3), {.glass_flags = all}, {}, hits);
  EXPECT_EQ(hits.what[0], 1);  // oblique
  EXPECT_EQ(hits.what[1], 0);
}

TEST(RayCaster, ReadsAMapCellByCell) {
  grid::OccupancyGrid map(
      {.width = 40, .height = 30, .resolution = 0.1, .origin_x = -2.0, .origin_y = -1.0});
  Random random(4);
  for (auto& cell : map) {
    cell = random.uniform() < 0.03 ? grid::kOccupied
                                   : (random.uniform() < 0.1 ? grid::kUnknown : grid::kFree);
  }
  map.at({20, 15}) = grid::kFree;
  const Scene scene({}, 2.7, &map);
  RayCaster caster;
  FanHits hits;
  const Fan fan(-3.0, 0.01, 600);
  const Point2 start = map.geometry().center({20, 15});
  caster.cast(scene, fan, sensor_at(start.x(), start.y(), 0.3), {.max_range = 10.0}, {}, hits);
  for (int i = 0; i < fan.count(); ++i) {
    double t = 0.0;
    for (; t < 10.0; t += 1e-3) {
      const Point2 p = start + t * Point2(std::cos(fan.angle(i)), std::sin(fan.angle(i)));
      if (map.value_or(map.geometry().cell_at(p), grid::kFree) == grid::kOccupied) break;
    }
    EXPECT_NEAR(hits.range[static_cast<std::size_t>(i)], t, 0.03) << i;
  }
}

TEST(SceneNearest, MeasuresToWallsBoxesAndDiscs) {
  const Scene scene(
      {wall("wall", {0.0, 2.0}, {30.0, 2.0}, 0.2, 2.7),
       box("box", {5.0, 0.0, kPi / 4}, 1.0, 1.0, 0.0, 0.7), disc("bin", {10.0, 0.0}, 0.2, 0.0, 0.7),
       box("lamp", {15.0, 0.0, 0.0}, 1.0, 1.0, 2.0, 2.3)},
      2.7);
  const auto robot = [](double x, double y) {
    return std::vector<Point2>{
        {x - 0.3, y - 0.3}, {x + 0.3, y - 0.3}, {x + 0.3, y + 0.3}, {x - 0.3, y + 0.3}};
  };
  EXPECT_EQ(scene.nearest(robot(1.0, 1.0), 1.8, 2.0).thing, 0);
  EXPECT_NEAR(scene.nearest(robot(1.0, 1.0), 1.8, 2.0).distance, 0.6, 1e-6);
  EXPECT_NEAR(scene.nearest(robot(3.5, -0.2), 1.8, 2.0).distance, 1.2 - std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(scene.nearest(robot(9.0, 0.1), 1.8, 2.0).distance, 0.5, 1e-6);
  EXPECT_EQ(scene.nearest(robot(15.0, 0.0), 1.8, 0.5).thing, -1) << "under the lamp";
  EXPECT_EQ(scene.nearest(robot(10.0, 0.0), 1.8, 2.0).distance, 0.0);
  EXPECT_EQ(scene.nearest(robot(20.0, 1.7), 1.8, 2.0).distance, 0.0);
  EXPECT_EQ(scene.nearest(robot(20.0, -40.0), 1.8, 2.0).thing, -1);
  EXPECT_NEAR(scene.nearest(Point2(20.0, 1.0), 1.8, 2.0).distance, 0.9, 1e-6);
  EXPECT_NEAR(scene.nearest(Point2(20.0, 1.0), 1.8, 2.0).point.y(), 1.9, 1e-6);
}

}  // namespace
}  // namespace usher::world
