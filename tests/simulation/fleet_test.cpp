// Two meeting assistants in one arena call one meeting together, in lock-step: the whole of both
// robots, one world.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "operations/experiments/meeting_run.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using namespace usher_msgs::msg::MeetingStatus_Constants;

class Together : public testing::Test {
 protected:
  void SetUp() override {
    options_.installation.share = std::string(USHER_BINARY_DIR) + "/share/usher";
    options_.installation.contracts = options_.installation.share + "/contracts";
    auto fleet = meeting_fleet(options_);
    ASSERT_TRUE(fleet.ok()) << fleet.error();
    fleet_ = std::move(fleet).value();
  }
  /// Two people in the hall come along.
  static MeetingCase meeting() {
    MeetingCase one;
    one.people = {{"ada", {7.3, 4.6}, true, false}, {"boole", {4.4, 2.0}, true, false}};
    one.start = {1.5, 1.5, 1.5708};
    one.starts_of_others = {{2.35, 1.5, 1.5708}};
    one.persons = 2;
    one.longest = 600.0;
    return one;
  }
  MeetingRun run(const MeetingCase& one, std::uint64_t seed = 1) {
    auto run = run_meeting(fleet_, one, seed, folder_.path(), "meeting");
    EXPECT_TRUE(run.ok()) << run.error();
    if (!run) return {};
    for (const auto& [robot, status] : run->statuses) {
      const auto& m = status.mission();
      std::printf("%s: %u brought, %u invited, %u lost, outcome %d %s; %s\n", robot.c_str(),
                  m.brought(), m.invited(), m.lost(), m.outcome(), m.reason().c_str(),
                  m.room().c_str());
    }
    std::printf("after %s, %u contacts (%s), %u with the other robot\n",
                minutes(run->seconds).c_str(), run->summary.contacts,
                run->summary.contact_with.c_str(), run->robot_contacts);
    return std::move(run).value();
  }
  static void expect_complete(const MeetingRun& run) {
    EXPECT_EQ(run.status.mission().outcome(), OUTCOME_COMPLETE) << run.complaints;
    EXPECT_EQ(run.status.mission().brought(), 2U);
    EXPECT_EQ(run.robot_contacts, 0U);
  }

  ExperimentOptions options_;
  std::vector<Deployment> fleet_;
  test::Folder folder_;
};

TEST_F(Together, BringTwoPeopleToOneRoomTheSameWayEachTime) {
  const MeetingRun first = run(meeting());
  expect_complete(first);
  const auto& iris = first.statuses.at("iris").mission();
  const auto& otto = first.statuses.at("otto").mission();
  EXPECT_EQ(iris.room(), otto.room());
  EXPECT_EQ(iris.brought(), otto.brought()) << "they count together";
  EXPECT_EQ(iris.accepted() + otto.accepted(), 2U) << "nobody is asked twice";
  EXPECT_EQ(run(meeting()).digest, first.digest);
}

/// Who was with the one that died is asked by the other.
TEST_F(Together, WhoIsLeftGoesOnWhenTheOtherDies) {
  MeetingCase one = meeting();
  one.loss = MeetingLoss{"iris", 45.0, 0.0};
  const MeetingRun left = run(one);
  EXPECT_EQ(left.statuses.at("otto").mission().brought(), 2U) << left.complaints;
  EXPECT_EQ(left.robot_contacts, 0U);
}

}  // namespace
}  // namespace usher::operations
