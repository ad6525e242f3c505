// What a robot makes of what the others say, and what it decides where there is no master.
#include "tasks/meeting/core/team.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace usher::meeting {
namespace {

using std::chrono::seconds;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Time kNow = seconds(100);
constexpr Time kForever = Time::max();

class TeamOfOtto : public testing::Test {
 protected:
  TeamOfOtto() {
    otto.begin(7, "operator");
    otto.hear({"iris"});
  }
  TeamReport says(State state = State::kExplore, const std::string& robot = "iris") {
    TeamReport report;
    report.robot = robot;
    report.sequence = ++sequence;
    report.state = state;
    report.id = 7;
    report.client = "operator";
    report.wanted = 2;
    report.limit = kNow + seconds(300);
    return report;
  }
  static Encounter fact(Met kind, const Point2& at, std::uint64_t id,
                        const std::string& robot = "iris", const std::string& room = "west") {
    return {kind, robot, id, at, kForever, kind == Met::kBrought ? room : ""};
  }
  static Encounter claim(const Point2& at, const std::string& robot = "iris") {
    return {Met::kClaimed, robot, 0, at, kForever, {}};
  }

  Team otto{"otto", 1000};
  std::uint64_t sequence = 0;
};

TEST_F(TeamOfOtto, TakesTheNewestOfEachRobotOnce) {
  TeamReport old = says();
  TeamReport report = says();
  report.people = {fact(Met::kBrought, {1, 1}, 5)};
  EXPECT_TRUE(otto.take(report));
  EXPECT_FALSE(otto.take(report)) << "twice";
  EXPECT_FALSE(otto.take(old)) << "late";
  EXPECT_EQ(otto.brought("west"), 1U);
}

TEST_F(TeamOfOtto, TakesNothingOfItselfAndNothingThatIsNone) {
  EXPECT_FALSE(otto.take(says(State::kExplore, "otto")));
  EXPECT_FALSE(otto.take(says(State::kExplore, "")));
  TeamReport far = says();
  far.people = {fact(Met::kDeclined, {std::numeric_limits<double>::quiet_NaN(), 0}, 1)};
  EXPECT_FALSE(otto.take(far));
  TeamReport many = says();
  many.people.resize(257, fact(Met::kSeen, {1, 1}, 0));
  EXPECT_FALSE(otto.take(many));
  TeamReport unknown = says();
  unknown.people = {fact(static_cast<Met>(9), {1, 1}, 1)};
  EXPECT_FALSE(otto.take(unknown));
  TeamReport lost = says();
  lost.room_way = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(otto.take(lost));
  for (int i = 0; i < 20; ++i) otto.take(says(State::kExplore, "robot " + std::to_string(i)));
  EXPECT_FALSE(otto.take(says(State::kExplore, "one too many")));
}

TEST_F(TeamOfOtto, HearsNobodyInNoFleet) {
  Team alone("", 1);
  alone.begin(7, "operator");
  EXPECT_FALSE(alone.take(says()));
  alone.add(Met::kDeclined, {1, 1}, kForever);
  EXPECT_FALSE(alone.left_alone({1, 1}, kNow)) << "People knows that";
}

TEST_F(TeamOfOtto, LeavesAloneWhomAnotherHasAskedAsLongAsThatHolds) {
  TeamReport report = says();
  report.people = {fact(Met::kDeclined, {1, 1}, 1)};
  Encounter silent = fact(Met::kUnanswered, {5, 1}, 2);
  silent.until = kNow + seconds(10);
  report.people.push_back(silent);
  otto.take(report);
  EXPECT_TRUE(otto.left_alone({1.5, 1.5}, kNow));
  EXPECT_FALSE(otto.left_alone({1.8, 1.8}, kNow)) << "1.1 m away somebody else stands";
  EXPECT_TRUE(otto.left_alone({5, 1}, kNow));
  EXPECT_FALSE(otto.left_alone({5, 1}, kNow + seconds(10)));
}

TEST_F(TeamOfOtto, RemembersWhatADeadRobotFoundOutAndFreesWhatItClaimed) {
  TeamReport report = says(State::kInvite);
  report.people = {fact(Met::kDeclined, {1, 1}, 1), claim({5, 1})};
  otto.take(report);
  EXPECT_TRUE(otto.left_alone({5, 1}, kNow));
  otto.hear({"iris"});
  EXPECT_THAT(otto.take_left_behind(), SizeIs(0));
  otto.hear({});
  const auto left_behind = otto.take_left_behind();
  ASSERT_THAT(left_behind, SizeIs(1)) << "the person stands there";
  EXPECT_EQ(left_behind[0], Point2(5, 1));
  otto.hear({});
  EXPECT_THAT(otto.take_left_behind(), SizeIs(0)) << "once";
  EXPECT_FALSE(otto.left_alone({5, 1}, kNow));
  EXPECT_TRUE(otto.left_alone({1, 1}, kNow));
  EXPECT_THAT(otto.facts(kNow), SizeIs(1)) << "and tells it on";
}

TEST_F(TeamOfOtto, VisitsWhomARobotLeavesThatFails) {
  TeamReport report = says(State::kGuide);
  report.people = {claim({5, 1})};
  otto.take(report);
  TeamReport ended = says(State::kEnded);
  ended.outcome = Outcome::kFailed;
  ended.sequence = report.sequence + 1;
  otto.take(ended);
  const auto left_behind = otto.take_left_behind();
  ASSERT_THAT(left_behind, SizeIs(1));
  EXPECT_EQ(left_behind[0], Point2(5, 1));
  ended.sequence += 1;
  otto.take(ended);
  EXPECT_THAT(otto.take_left_behind(), SizeIs(0)) << "once";
}

TEST_F(TeamOfOtto, KeepsWhoIsNearToAGuideForItsFollower) {
  TeamReport report = says(State::kGuide);
  report.people = {claim({5, 1})};  // where the robot is
  otto.take(report);
  EXPECT_TRUE(otto.left_alone({3, 1}, kNow));
  EXPECT_FALSE(otto.left_alone({2, 1}, kNow));
  EXPECT_EQ(otto.underway(), 1U);
}

TEST_F(TeamOfOtto, YieldsToWhoIsFurtherAndOfEqualOnesToTheFirstName) {
  const Point2 at(5, 1);
  const auto claims = [&](State state, const std::string& robot) {
    Team team("otto", 1);
    team.begin(7, "operator");
    team.hear({robot});
    TeamReport report = says(state, robot);
    report.people = {claim(at, robot)};
    team.take(report);
    return team;
  };
  EXPECT_TRUE(claims(State::kApproach, "iris").is_ahead(at, State::kApproach));
  EXPECT_FALSE(claims(State::kApproach, "zora").is_ahead(at, State::kApproach));
  EXPECT_TRUE(claims(State::kInvite, "zora").is_ahead(at, State::kApproach));
  EXPECT_FALSE(claims(State::kApproach, "iris").is_ahead(at, State::kInvite));
  EXPECT_FALSE(claims(State::kInvite, "iris").is_ahead({5, 3}, State::kInvite)) << "elsewhere";
}

TEST_F(TeamOfOtto, CountsAPersonWhomTwoRobotsBroughtOnce) {
  otto.add(Met::kBrought, {1, 1}, kForever, "west");
  TeamReport report = says();
  report.people = {fact(Met::kBrought, {1.5, 1.5}, 5)};
  otto.take(report);
  EXPECT_EQ(otto.brought("west"), 1U);
  // Two who stood side by side, brought by one robot one after the other, are two.
  otto.add(Met::kBrought, {9, 9}, kForever, "west");
  otto.add(Met::kBrought, {9.5, 9}, kForever, "west");
  EXPECT_EQ(otto.brought("west"), 3U);
  EXPECT_EQ(otto.brought("east"), 0U);
}

TEST_F(TeamOfOtto, AgreesOnTheRoomWithMostPersonsThenOnTheFirstRobots) {
  TeamReport report = says();
  report.room = "west";
  otto.take(report);
  EXPECT_EQ(otto.agreed_room(""), "west");
  EXPECT_EQ(otto.agreed_room("east"), "west") << "iris comes first";
  otto.add(Met::kBrought, {1, 1}, kForever, "east");
  EXPECT_EQ(otto.agreed_room("east"), "east") << "somebody is there";
  otto.hear({});
  EXPECT_EQ(otto.agreed_room("east"), "east");
  EXPECT_EQ(otto.agreed_room(""), "");
}

TEST_F(TeamOfOtto, LeavesTheRoomToWhoIsNearer) {
  TeamReport report = says(State::kToRoom);
  report.room_way = 4.0;
  otto.take(report);
  EXPECT_TRUE(otto.room_is_sought(5.0));
  EXPECT_TRUE(otto.room_is_sought(4.0)) << "iris comes first";
  EXPECT_FALSE(otto.room_is_sought(3.9));
  otto.take(says(State::kExplore));
  EXPECT_FALSE(otto.room_is_sought(5.0));
}

TEST_F(TeamOfOtto, LeavesASightingToWhoIsNearerAndHasTime) {
  otto.take(says(State::kExplore));
  EXPECT_FALSE(otto.is_nearer({5, 1}, {8, 1})) << "nobody knows where iris is";
  otto.place({{"iris", Point2(4, 1)}});
  EXPECT_TRUE(otto.is_nearer({5, 1}, {8, 1}));
  EXPECT_FALSE(otto.is_nearer({5, 1}, {5.5, 1}));
  EXPECT_TRUE(otto.is_nearer({5, 1}, {6, 1})) << "iris comes first";
  otto.take(says(State::kGuide));
  EXPECT_FALSE(otto.is_nearer({5, 1}, {8, 1}));
}

TEST_F(TeamOfOtto, DividesTheWorkTheSameWayOnAllRobots) {
  const Point2 of_iris(1, 2), of_otto(8, 3);
  TeamReport report = says();
  report.place = of_iris;
  otto.take(report);
  const WorkShare otto_has = otto.share(of_otto);
  Team iris("iris", 1);
  iris.begin(7, "operator");
  iris.hear({"otto"});
  TeamReport mine = says(State::kExplore, "otto");
  mine.place = of_otto;
  iris.take(mine);
  const WorkShare iris_has = iris.share(of_iris);
  ASSERT_THAT(otto_has.places, SizeIs(2));
  EXPECT_EQ(otto_has.places, iris_has.places);
  EXPECT_EQ(iris_has.own, 0U);
  EXPECT_EQ(otto_has.own, 1U);
  EXPECT_THAT(otto.share(std::nullopt).places, IsEmpty()) << "it does not look for people yet";
  otto.hear({});
  EXPECT_THAT(otto.share(of_otto).places, IsEmpty()) << "all is its own now";
}

TEST_F(TeamOfOtto, CallsARobotThatHasNoMissionToTheOneThatGoesOn) {
  otto.take(says());
  ASSERT_NE(otto.call(0, ""), nullptr);
  EXPECT_EQ(otto.call(0, "")->wanted, 2U);
  EXPECT_EQ(otto.call(7, "operator"), nullptr) << "it has left that one";
  otto.take(says(State::kDone));
  EXPECT_EQ(otto.call(0, ""), nullptr);
}

TEST_F(TeamOfOtto, TakesOverWhatWasFoundOutBeforeItCame) {
  Team late("late", 1);
  late.hear({"iris"});
  TeamReport report = says();
  report.people = {fact(Met::kBrought, {1, 1}, 5), fact(Met::kDeclined, {4, 4}, 6, "late")};
  late.take(report);
  EXPECT_EQ(late.brought("west"), 0U) << "another mission";
  late.begin(7, "operator");
  EXPECT_EQ(late.brought("west"), 1U);
  EXPECT_TRUE(late.left_alone({4, 4}, kNow)) << "its own, of a life before";
}

TEST_F(TeamOfOtto, ForgetsNobodyWhoIsThere) {
  otto.add(Met::kBrought, {1, 1}, kForever, "west");
  for (std::size_t i = 0; i < 2 * Team::kMostFacts; ++i)
    otto.add(Met::kUnanswered, {static_cast<double>(i), 50}, kForever);
  EXPECT_THAT(otto.facts(kNow), SizeIs(Team::kMostFacts));
  EXPECT_EQ(otto.brought("west"), 1U);
}

TEST_F(TeamOfOtto, HearsThatSomebodyGaveTheMissionUp) {
  TeamReport report = says(State::kEnded);
  report.outcome = Outcome::kCancelled;
  otto.take(report);
  EXPECT_EQ(otto.cancelled_by(), "iris");
  otto.begin(8, "operator");
  EXPECT_EQ(otto.cancelled_by(), "");
}

}  // namespace
}  // namespace usher::meeting
