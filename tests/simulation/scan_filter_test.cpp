// The scan filter against the simulated LMS100: the two models of a leaning robot are written apart
// and must agree.
#include "sensing/scan_filter/core/scan_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/world/core/world.hpp"

namespace usher::world {
namespace {

using estimation::Pitch;
using geometry::radians;
using scan_filter::PlanarScan;
using scan_filter::ScanFilter;

scan_filter::ScanGeometry geometry_of(const LaserConfig& laser) {
  return {laser.angle_min, laser.increment, 0.05, laser.range_max};
}

Point2 end_of(const PlanarScan& scan, std::size_t i, const Pose2& robot) {
  const double angle =
      scan.geometry.angle_min + static_cast<double>(i) * scan.geometry.angle_increment;
  const double r = static_cast<double>(scan.ranges[i]);
  return robot * (scan.base_T_scan * Point2(r * std::cos(angle), r * std::sin(angle)));
}

Scene room() {
  return {{wall("north", {-6, 3}, {6, 3}, 0.2, 2.7), wall("south", {-6, -2}, {6, -2}, 0.2, 2.7),
           wall("east", {5, -2}, {5, 3}, 0.2, 2.7), wall("west", {-5, -2}, {-5, 3}, 0.2, 2.7),
           box("pillar", {2.5, 1.0, 0.4}, 0.4, 0.4, 0.0, 2.7)},
          2.7};
}

double off_the_walls(const Scene& scene, const Point2& p) {
  return scene.nearest(p, 2.0, 5.0).distance;
}

TEST(ScanFilterInTheWorld, ExactBeamsGiveWallsWithin3CentimetresAndNoFloor) {
  const Scene scene = room();
  LaserConfig config;
  config.statistical_error = config.systematic_error = config.mixed_share = 0.0;
  for (double degrees = -20.0; degrees <= 22.0; degrees += 0.5) {
    for (const double yaw : {0.0, 0.9, 2.5}) {
      Laser laser(config, 1);
      const Pose2 robot{-1.0, 0.3, yaw};
      const double pitch = radians(degrees);
      std::vector<float> ranges;
      laser.scan(scene, {},
                 {{robot.x, robot.y, 0.235}, geometry::from_roll_pitch_yaw(0.0, pitch, yaw)},
                 ranges);
      ScanFilter filter = ScanFilter::make({}).value();
      PlanarScan out;
      ASSERT_TRUE(filter.filter(geometry_of(config), ranges, {pitch, 0.0}, out).ok());
      for (std::size_t i = 0; i < out.ranges.size(); ++i) {
        if (!std::isfinite(out.ranges[i])) continue;
        ASSERT_LT(off_the_walls(scene, end_of(out, i, robot)), 0.03)
            << degrees << " deg, yaw " << yaw << ", angle " << i;
      }
    }
  }
}

TEST(ScanFilterInTheWorld, NoisyBeamsHaveNoBiasFromThePitch) {
  const Scene scene = room();
  LaserConfig config;
  config.systematic_error = config.mixed_share = 0.0;
  Laser laser(config, 1);
  ScanFilter filter = ScanFilter::make({}).value();
  std::vector<float> ranges;
  PlanarScan out;
  for (const double degrees : {-12.0, -6.0, 0.0, 1.5, 6.0}) {
    const double pitch = radians(degrees);
    double sum = 0.0;
    double squares = 0.0;
    int count = 0;
    for (int turn = 0; turn < 100; ++turn) {
      laser.scan(scene, {}, {{-1.0, 0.3, 0.235}, geometry::from_roll_pitch_yaw(0.0, pitch, 0.0)},
                 ranges);
      ASSERT_TRUE(filter.filter(geometry_of(config), ranges, {pitch, 0.0}, out).ok());
      for (std::size_t i = 200; i < 258; ++i) {  // the east wall, 5.7 m ahead
        if (!std::isfinite(out.ranges[i])) continue;
        const Point2 p = end_of(out, i, {-1.0, 0.3, 0.0});
        if (std::abs(p.x() - 4.9) > 0.1) continue;
        sum += p.x() - 4.9;
        squares += (p.x() - 4.9) * (p.x() - 4.9);
        ++count;
      }
    }
    if (degrees > 4.0) {
      EXPECT_EQ(count, 0) << "the floor comes first";
      continue;
    }
    ASSERT_GT(count, 2000) << degrees;
    EXPECT_NEAR(sum / count, 0.0, 0.004) << degrees;
    EXPECT_LT(std::sqrt(squares / count), 0.016) << degrees;
  }
}

// A drive with full acceleration and a stop, corrected with what the base itself says about its
// pitch.
TEST(ScanFilterInTheWorld, ADriveShowsNoFalseObstacle) {
  const auto building = parse_building(R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[0, 0], [30, 0], [30, 6], [0, 6], [0, 0]]}
)",
                                       "hall.yaml");
  ASSERT_TRUE(building.ok());
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    World world({}, *building, {}, {4.0, 3.0, 0.0}, seed);
    estimation::PitchHistory history;
    ScanFilter filter = ScanFilter::make({}).value();
    std::vector<float> ranges;
    PlanarScan out;
    int obstacles = 0;
    for (int step = 0; step < 900; ++step) {
      world.base().command({step < 400 ? 1.4 : 0.0, 0.0});
      world.step();
      const auto now = std::chrono::milliseconds(10 * step);
      const BaseReadings& base = world.base().readings();
      // The pitch arrives one step late: it is extrapolated to the scan.
      if (step > 0) {
        const auto pitch = history.at(now);
        if (pitch.ok() && step % 2 == 0) {
          world.scan(0, ranges);
          ASSERT_TRUE(filter.filter(geometry_of(LaserConfig{}), ranges, *pitch, out).ok());
          for (std::size_t i = 0; i < out.ranges.size(); ++i) {
            if (!std::isfinite(out.ranges[i])) continue;
            const Point2 p = end_of(out, i, world.base().truth().pose);
            if (off_the_walls(world.scene(), p) > 0.15) ++obstacles;
          }
        }
      }
      ASSERT_TRUE(history.add(now, {base.pitch, base.pitch_rate}).ok());
    }
    EXPECT_EQ(obstacles, 0) << "seed " << seed;
    EXPECT_GT(filter.counts().floor, 1000U) << "the floor was in sight";
  }
}

}  // namespace
}  // namespace usher::world
