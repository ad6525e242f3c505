// The filter in a real building, the input of the peers' figures.
#include <gtest/gtest.h>

#include "localization/amcl/core/amcl.hpp"
#include "localization/amcl/test/sim_robot.hpp"
#include "localization/amcl/test/willow_scan.hpp"
#include "support/data.hpp"

namespace usher::amcl {
namespace {

double error(const Amcl& amcl, const SimRobot& robot) {
  return distance(amcl.estimate()->map_T_odom() * robot.odometry(), robot.pose());
}

TEST(AmclInWillow, TracksWithinACentimetre) {
  USHER_REQUIRE_DATA(path, "peers/willow-trinary-0.05.pgm");
  const grid::OccupancyGrid map = load_willow(path);
  Random random(1);
  SimRobot robot(map, {27.5, 17.5, 0.0}, 1);
  Amcl amcl({}, 1);
  ASSERT_TRUE(amcl.set_map(map).ok());
  ASSERT_TRUE(
      amcl.set_initial_pose(robot.pose(), Eigen::Vector3d(0.25, 0.25, 0.06).asDiagonal()).ok());
  double sum = 0.0;
  for (int i = 0; i < 400; ++i) {
    robot.step();
    amcl.update(robot.odometry(), robot.scan());
    if (i >= 20) sum += error(amcl, robot) / 380.0;
  }
  EXPECT_LT(sum, 0.01);
}

TEST(AmclInWillow, FindsItselfOnTheWholeFloor) {
  USHER_REQUIRE_DATA(path, "peers/willow-trinary-0.05.pgm");
  const grid::OccupancyGrid map = load_willow(path);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    SimRobot robot(map, SimRobot::free_place(map, random), seed);
    Amcl amcl({}, seed);
    ASSERT_TRUE(amcl.set_map(map).ok());
    amcl.start_globally();
    for (int i = 0; i < 150; ++i) {
      robot.step();
      amcl.update(robot.odometry(), robot.scan());
    }
    found += error(amcl, robot) < 0.1 && amcl.estimate()->quality.confidence == Confidence::kGood;
  }
  EXPECT_GE(found, 4);
}

}  // namespace
}  // namespace usher::amcl
