// A stairway down across the whole hall, before the goal: only the Kinect sees that floor is
// missing.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/experiments/site_facts.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using std::chrono::seconds;

constexpr double kEdge = 7.0;  // [m] x of the first step

std::string hall(const std::string& stairs) {
  return R"(name: hall
ceiling: 2.7
rooms:
  - {name: hall, title: Hall, area: [0.0, 0.0, 12.0, 6.0]}
walls:
  - {name: around, thickness: 0.2, points: [[-0.1, -0.1], [12.1, -0.1], [12.1, 6.1], [-0.1, 6.1], [-0.1, -0.1]]}
furniture:
  - {name: stairs, box: [)" +
         stairs + "], height: [-0.6, 0.0]}\n";
}
const std::string kAcross = "8.0, 3.0, 0.0, 2.0, 6.0";    // of the whole hall
const std::string kWithAWay = "8.0, 1.9, 0.0, 2.0, 3.8";  // 2.2 m are left beside it

struct Outcome {
  double fastest = 0.0;  ///< [m/s]
  double at_edge = 0.0;  ///< [m/s] fastest within the last two meters before it
  double nearest = std::numeric_limits<double>::infinity();  ///< [m] of the robot's front to it
  std::string contact;                                       ///< with what; empty: none
  bool arrived = false;
};

class Stairway : public testing::Test {
 protected:
  /// An errand beyond the stairs; `blind`: the depth pipeline dies as the robot departs.
  Outcome drive(const std::string& manifest, const std::string& stairs, seconds limit,
                bool blind = false, std::uint64_t seed = 1) const {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    const test::Folder folder;
    const std::string file = folder.file(
        "stairs.yaml", "extends: " + share + "/deploy/" + manifest + "\nsite: obstacle_course\n");
    auto deployment = load_deployment(file, installation, {});
    EXPECT_TRUE(deployment.ok()) << deployment.error();
    set_site_value(*deployment, "site.world", folder.file("world.yaml", hall(stairs)));
    set_site_value(*deployment, "site.initial_pose", "[1.0, 3.0, 0.0]");
    const auto robot = lockstep_robot(*deployment, seed, [&](LockstepRun& run) {
      auto& world = run.world();
      if (blind) world.at(world.now() + seconds(2), [&world] { world.stop("depth_pipeline"); });
    });
    EXPECT_TRUE(robot.ok()) << robot.error();
    double front = 0.0;
    const auto footprint = robot_footprint(*deployment).value();
    for (const auto& corner : footprint) front = std::max(front, corner.x());

    Outcome outcome;
    const auto arrival = (*robot)->send("goal", runtime::seconds(limit));
    EXPECT_TRUE(arrival.ok()) << arrival.error();
    const RunRecord record = (*robot)->take_record();
    for (const auto& sample : record.samples()) {
      outcome.fastest = std::max(outcome.fastest, sample.v);
      const double before = kEdge - sample.truth.x - front;
      outcome.nearest = std::min(outcome.nearest, before);
      if (before < 2.0) outcome.at_edge = std::max(outcome.at_edge, sample.v);
    }
    outcome.contact = record.summary().contact_with;
    outcome.arrived = arrival->reported;
    return outcome;
  }
  static void stands_before_it(const Outcome& outcome) {
    EXPECT_GT(outcome.fastest, 0.5) << "it went there at speed";
    EXPECT_LT(outcome.nearest, 1.0) << "and got near";
    EXPECT_GT(outcome.nearest, 0.05) << "and never onto it, whatever it tried then";
    EXPECT_EQ(outcome.contact, "");
    EXPECT_FALSE(outcome.arrived);
  }
};

TEST_F(Stairway, StopsTheRobotBeforeItsEdge) {
  for (const std::uint64_t seed : {1U, 2U, 3U})
    stands_before_it(drive("marvin-depth-sim.yaml", kAcross, seconds(60), false, seed));
}

TEST_F(Stairway, StopsTheRobotBeforeItsEdgeInRenderedPixels) {
  stands_before_it(drive("marvin-pixels.yaml", kAcross, seconds(25)));
}

TEST_F(Stairway, IsDrivenRoundWhereThereIsAWay) {
  const Outcome outcome = drive("marvin-depth-sim.yaml", kWithAWay, seconds(120));
  EXPECT_TRUE(outcome.arrived);
  EXPECT_EQ(outcome.contact, "");
}

/// The control, and what is documented: no other sensor sees it, the robot drives on at half speed.
/// The simulated base stops at the edge as at a wall.
TEST_F(Stairway, StopsNobodyWhoseKinectIsLost) {
  const Outcome outcome = drive("marvin-depth-sim.yaml", kAcross, seconds(12), true);
  EXPECT_LT(outcome.nearest, 0.01);
  EXPECT_NE(outcome.contact, "");
  EXPECT_GT(outcome.at_edge, 0.5);
  EXPECT_LT(outcome.at_edge, 0.75) << "half of 1.4 m/s";
}

}  // namespace
}  // namespace usher::operations
