// The people whom the robot with simulated depth cameras knows of, against those who are there.
#include <gtest/gtest.h>

#include <cstdio>

#include "operations/command_line/installation.hpp"
#include "simulation/watched_people.hpp"

namespace usher::operations {
namespace {

/// MARVIN in the foyer of the office, people walking about.
TEST(PeopleOfTheRobot, AreThoseWhoAreThereSeenByCamerasAndLaserTogether) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const auto deployment = load_deployment(share + "/deploy/marvin-depth-sim.yaml", installation,
                                          {{"world", "people", "true"}});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  const auto run = LockstepRun::create(*deployment, 3);
  ASSERT_TRUE(run.ok()) << run.error();
  int real = 0, nobody = 0, by_camera = 0, by_both = 0;
  const WatchedPeople people(**run, [&](const auto& person, const auto* who) {
    ++(who != nullptr ? real : nobody);
    const bool camera = person.by_kinect() || person.by_rear();
    by_camera += camera;
    by_both += camera && person.by_laser();
  });

  (*run)->world().run_for(std::chrono::seconds(120));
  std::printf("%d real, %d nobody, %d by a camera, %d by both\n", real, nobody, by_camera, by_both);
  EXPECT_GT(real, 200);
  EXPECT_LT(nobody, real / 50);
  EXPECT_GT(by_camera, real / 10);
  EXPECT_GT(by_both, by_camera / 3);
}

}  // namespace
}  // namespace usher::operations
