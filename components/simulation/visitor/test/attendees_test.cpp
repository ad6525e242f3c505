// The people who are invited, as a component: whom the robot's screen asks, who follows, who sits
// where.
#include "simulation/visitor/shell/attendees.hpp"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::visitor {
namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;

constexpr const char* kParameters =
    "{come: ada boole, decline: curry, "
    "site.meeting_rooms: [{name: west, west: 0, south: 0, east: 4, north: 4}], "
    "site.seats: [{room: west, x: 1.0, y: 1.0}, {room: west, x: 1.0, y: 3.0}]}";

struct Bench {
  runtime::TestHost host{runtime::component_factory<AttendeesComponent>("attendees"), kParameters};
  Pose2 robot{6.0, 2.0, 0.0};
  std::map<std::string, Point2> people{
      {"ada", {7.0, 2.0}}, {"boole", {7.6, 2.2}}, {"curry", {6, 9}}};
  usher_msgs::msg::DialogueScreen screen;
  bool truth = true, speaks = true;

  void show(const std::string& state) {
    screen.id(screen.id() + 1);
    screen.state(state);
    screen.place("west");
  }
  void run(int ms) {
    for (int i = 0; i < ms; i += 100) {
      usher_sim_msgs::msg::GroundTruth message;
      message.header(wire::header(host.now(), "map"));
      message.pose(wire::to_message(robot));
      for (const auto& [name, at] : people) {
        usher_sim_msgs::msg::Person person;
        person.name(name);
        person.x(at.x());
        person.y(at.y());
        message.people().push_back(person);
      }
      if (truth) host.publish(topics::kSimGroundTruth, message);
      usher_msgs::msg::MeetingStatus status;
      status.header(wire::header(host.now(), ""));
      if (speaks) host.publish(topics::kMeetingStatus, status);
      host.publish(topics::kDialogueScreen, screen);
      host.run_for(milliseconds(100));
    }
  }
  /// Asks and lets them answer.
  void invite() {
    show("invite");
    run(3000);
  }
  std::size_t answers() const { return host.written(topics::kDialogueAnswer).size(); }
  /// What the world was told last of somebody.
  std::optional<usher_sim_msgs::msg::PersonGoal> goal_of(const std::string& name) const {
    std::optional<usher_sim_msgs::msg::PersonGoal> last;
    for (const auto& goal : host.written(topics::kSimPersonGoal))
      if (goal.name() == name) last = goal;
    return last;
  }
};

TEST(Attendees, WhoStandsNearestBeforeTheRobotIsAskedAndFollows) {
  Bench bench;
  bench.invite();
  const auto answer = bench.host.last(topics::kDialogueAnswer);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->option_id(), "yes");
  EXPECT_EQ(answer->screen_id(), bench.screen.id());
  bench.show("guide");
  bench.run(500);
  EXPECT_TRUE(bench.goal_of("ada")->follow());
  EXPECT_FALSE(bench.goal_of("boole")) << "nobody asked him";
}

TEST(Attendees, NobodyAnswersWhoDoesNotSeeTheScreen) {
  Bench bench;
  bench.robot.yaw = 3.1;  // turned away
  bench.invite();
  EXPECT_EQ(bench.answers(), 0U);
  bench.robot = {2.0, 2.0, 0.0};  // too far to read
  bench.invite();
  EXPECT_EQ(bench.answers(), 0U);
}

TEST(Attendees, WhoDeclinesStays) {
  Bench bench;
  bench.robot = {6.0, 8.0, 1.57};
  bench.invite();
  ASSERT_GE(bench.answers(), 1U);  // repeated until it is acknowledged
  EXPECT_EQ(bench.host.last(topics::kDialogueAnswer)->option_id(), "no");
  bench.show("guide");
  bench.run(500);
  EXPECT_FALSE(bench.goal_of("curry"));
}

TEST(Attendees, ComeInWhenTheyAreLookedAtFromWithinTheRoom) {
  Bench bench;
  bench.invite();
  bench.robot = {2.0, 2.0, 0.0};
  bench.people["ada"] = {3.8, 2.0};  // in the door
  bench.show("look_back");
  bench.run(500);
  EXPECT_TRUE(bench.goal_of("ada")->follow());
  EXPECT_GT(bench.goal_of("ada")->speed(), 0.0);
  bench.people["ada"] = {3.3, 2.0};
  bench.run(500);
  EXPECT_EQ(bench.goal_of("ada")->speed(), 0.0) << "stands while it is looked at";
}

TEST(Attendees, SitWhereNobodyElseSits) {
  Bench bench;
  bench.invite();
  bench.show("arrived");
  bench.run(500);
  EXPECT_EQ(bench.goal_of("ada")->y(), 1.0);
  bench.people["ada"] = {1.0, 1.0};
  bench.invite();
  bench.show("arrived");
  bench.run(500);
  EXPECT_EQ(bench.goal_of("boole")->y(), 3.0);
  EXPECT_FALSE(bench.goal_of("boole")->follow());
}

TEST(Attendees, FollowNoRobotThatFellSilent) {
  Bench bench;
  bench.invite();
  bench.show("guide");
  bench.run(500);
  ASSERT_TRUE(bench.goal_of("ada")->follow());
  bench.speaks = false;
  bench.run(3500);
  EXPECT_FALSE(bench.goal_of("ada")->follow());
  EXPECT_EQ(bench.goal_of("ada")->speed(), 0.0);
}

TEST(Attendees, AnswerNothingWithoutKnowingWhereTheRobotIs) {
  Bench bench;
  bench.run(300);
  bench.truth = false;
  bench.run(700);
  bench.invite();
  EXPECT_EQ(bench.answers(), 0U);
}

}  // namespace
}  // namespace usher::visitor
