// The meeting assistant alone in its arena, whole missions in lock-step: what it is for, and what
// the loss of any of its parts may do to it.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "foundation/random/random.hpp"
#include "operations/experiments/meeting_run.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using namespace usher_msgs::msg::MeetingStatus_Constants;

class Mission : public testing::Test {
 protected:
  void SetUp() override {
    options_.installation.share = std::string(USHER_BINARY_DIR) + "/share/usher";
    options_.installation.contracts = options_.installation.share + "/contracts";
  }
  /// Two people in the hall come along.
  static MeetingCase meeting() {
    MeetingCase one;
    one.people = {{"ada", {7.3, 4.6}, true, false}, {"boole", {4.4, 2.0}, true, false}};
    one.start = {1.5, 1.5, 1.5708};
    one.persons = 2;
    return one;
  }
  MeetingRun run(const MeetingCase& one, std::uint64_t seed = 1,
                 const std::string& manifest = "meeting-demo.yaml") {
    const auto deployment = meeting_deployment(options_, manifest);
    EXPECT_TRUE(deployment.ok()) << deployment.error();
    if (!deployment) return {};
    auto run = run_meeting(*deployment, one, seed, folder_.path(), "meeting");
    EXPECT_TRUE(run.ok()) << run.error();
    if (!run) return {};
    const auto& m = run->status.mission();
    const std::string lost =
        one.loss ? one.loss->component + " at " + std::to_string(one.loss->after) + " s: " : "";
    std::printf("%s%u brought, %u there, outcome %d %s, after %s, %u contacts (%s)\n", lost.c_str(),
                m.brought(), run->present, m.outcome(), m.reason().c_str(),
                minutes(run->seconds).c_str(), run->summary.contacts,
                run->summary.contact_with.c_str());
    return std::move(run).value();
  }
  static void expect_complete(const MeetingRun& run, std::uint32_t persons) {
    EXPECT_EQ(run.status.mission().outcome(), OUTCOME_COMPLETE) << run.complaints;
    EXPECT_EQ(run.status.mission().brought(), persons);
    EXPECT_EQ(run.present, persons) << run.whereabouts;
    EXPECT_EQ(run.summary.contacts, 0U) << run.summary.contact_with;
  }

  ExperimentOptions options_;
  test::Folder folder_;
};

TEST_F(Mission, BringsTwoPeopleToAFreeRoom) {
  const MeetingRun first = run(meeting());
  expect_complete(first, 2);
  EXPECT_EQ(first.status.mission().room(), "meeting_room_1");
  EXPECT_EQ(run(meeting()).digest, first.digest);
}

TEST_F(Mission, FindsFacesInRenderedImages) {
  MeetingCase one = meeting();
  one.people = {{"ada", {3.6, 6.4}, true, false}};
  one.persons = 1;
  expect_complete(run(one, 1, "meeting-pixels.yaml"), 1);
}

/// Whatever ends and comes back after 3 s: nobody is touched or counted who is not there, and the
/// mission goes on.
TEST_F(Mission, GoesOnAfterTheLossOfAnyOfItsParts) {
  Random random(7);
  for (const char* component :
       {"supervisor", "p3dx", "movement_control", "urg04lx", "scan_filter", "map_server", "amcl",
        "costmap", "global_planner", "local_planner", "navigator", "explorer",
        "interaction_control", "people_detector", "face_detector", "tablet"}) {
    MeetingCase one = meeting();
    one.loss = MeetingLoss{{}, random.uniform(5.0, 120.0), 3.0, component};
    SCOPED_TRACE(component);
    expect_complete(run(one), 2);
  }
}

/// Its own death ends the mission; the robot says so and stands.
TEST_F(Mission, EndsWithTheAssistant) {
  MeetingCase one = meeting();
  one.loss = MeetingLoss{{}, 60.0, 3.0, "meeting"};
  const MeetingRun left = run(one);
  EXPECT_EQ(left.summary.contacts, 0U);
  EXPECT_NE(left.status.mission().outcome(), OUTCOME_COMPLETE);
}

/// Somebody sits in the first room; the face detector is gone for a while as the robot looks round
/// in it.
TEST_F(Mission, TakesNoOccupiedRoomWhileItIsBlind) {
  for (double after = 16.0; after < 36.0; after += 2.0) {
    MeetingCase one;
    one.people = {{"host", {1.6, 10.2}, false, false}};
    one.start = {1.5, 1.5, 1.5708};
    one.longest = 200.0;
    one.over = [](const auto& status) { return !status.mission().room().empty(); };
    one.loss = MeetingLoss{{}, after, 4.0, "face_detector"};
    const MeetingRun found = run(one);
    EXPECT_EQ(found.status.mission().room(), "meeting_room_2") << after;
    EXPECT_EQ(found.status.mission().rooms_occupied(), 1U) << after;
  }
}

}  // namespace
}  // namespace usher::operations
