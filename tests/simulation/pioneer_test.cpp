// The meeting assistant in lock-step: the Pioneer drives a path with each of its local planners.
#include <gtest/gtest.h>

#include <string>

#include "operations/experiments/commanded_robot.hpp"

namespace usher::operations {
namespace {

class Pioneer : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<CommandedRobot> launch() {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    const auto deployment = load_deployment(share + "/deploy/" + GetParam(), installation, {});
    EXPECT_TRUE(deployment.ok()) << deployment.error();
    auto robot = lockstep_robot(*deployment, 1);
    EXPECT_TRUE(robot.ok()) << robot.error();
    return std::move(robot).value();
  }
};

INSTANTIATE_TEST_SUITE_P(LocalPlanners, Pioneer,
                         testing::Values("meeting-sim.yaml", "meeting-waypoints-sim.yaml"),
                         [](const auto& one) {
                           return one.index == 0 ? "DynamicWindow" : "WaypointFollower";
                         });

TEST_P(Pioneer, DrivesFromPlaceToPlaceWithoutATouch) {
  const auto robot = launch();
  const std::pair<const char*, geometry::Point2> places[] = {{"lounge", {10.0, 10.4}},
                                                             {"meeting_room_1", {3.2, 9.6}}};
  for (const auto& [name, place] : places) {
    const auto arrival = robot->send(name, 240.0);
    ASSERT_TRUE(arrival.ok()) << arrival.error();
    EXPECT_TRUE(arrival->reported) << name << ": " << arrival->reason << "\n"
                                   << robot->complaints();
    const RunRecord record = robot->take_record();
    ASSERT_TRUE(record.truth());
    EXPECT_LT((record.truth()->position() - place).norm(), 0.35) << name;
    const auto summary = record.summary();
    EXPECT_EQ(summary.contacts, 0U) << summary.contact_with;
    // The report's own way of driving stops 0.5 m before the posts of a door and then waits for the
    // navigator's recoveries.
    const bool waypoints = std::string(GetParam()) == "meeting-waypoints-sim.yaml";
    EXPECT_GT(summary.mean_speed, waypoints ? 0.02 : 0.15) << "turns included";
  }
}

}  // namespace
}  // namespace usher::operations
