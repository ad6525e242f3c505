// Assistants that call one meeting together, over a link that loses, repeats, delays and breaks.
#include <deque>
#include <map>
#include <memory>

#include "foundation/random/random.hpp"
#include "meeting_rig.hpp"

namespace usher::meeting {
namespace {

Parameters named(const std::string& robot) {
  Parameters parameters;
  parameters.robot = robot;
  return parameters;
}

/// Two robots and what carries their reports, twice a second.
class Fleet : public testing::Test {
 protected:
  struct Robot {
    explicit Robot(const std::string& its_name) : rig(named(its_name)), name(its_name) {}
    Rig rig;
    std::string name;
    std::uint64_t told = 0;
  };

  void say(Robot& from, Robot& to) {
    TeamReport report = from.rig.meeting.tell(from.rig.now());
    report.robot = from.name;
    report.sequence = ++from.told;
    to.rig.meeting.hear(report);
  }
  /// Time passes; what is said is heard, unless the link is cut.
  void run(int ms) {
    for (int at = 0; at < ms; at += 500) {
      iris.rig.robot.team = otto.rig.robot.team = {};
      iris.rig.robot.team_at = otto.rig.robot.team_at = {};
      if (linked) {
        iris.rig.robot.team = {"otto"};
        otto.rig.robot.team = {"iris"};
        iris.rig.robot.team_at = otto.rig.robot.team_at = {
            {"iris", iris.rig.robot.pose->position()}, {"otto", otto.rig.robot.pose->position()}};
        say(iris, otto);
        say(otto, iris);
      }
      iris.rig.wait(500);
      otto.rig.wait(500);
    }
  }
  /// Both are called; iris finds the room, otto explores meanwhile.
  void to_explore(std::uint32_t persons) {
    iris.rig.robot.pose = Pose2{6.0, 2.0, 0.0};
    otto.rig.robot.pose = Pose2{7.0, 2.0, 0.0};
    iris.rig.to_room(persons);
    run(1500);
    ASSERT_EQ(otto.rig.state(), State::kExplore);
    iris.rig.arrive();
    iris.rig.turn_round();
    ASSERT_EQ(iris.rig.state(), State::kExplore);
    iris.rig.robot.pose = Pose2{8.0, 5.0, 0.0};
    otto.rig.robot.pose = Pose2{12.0, 5.0, 0.0};
    run(1000);
    ASSERT_EQ(otto.rig.meeting.report().room, iris.rig.meeting.report().room);
  }
  void bring(Robot& robot) {
    robot.rig.see(2.5, 0.1, 4);
    ASSERT_EQ(robot.rig.state(), State::kApproach);
    robot.rig.arrive();
    robot.rig.press("yes");
    robot.rig.wait(1000);
    robot.rig.arrive();
    robot.rig.see(1.1, 0.0, 2);
    ASSERT_EQ(robot.rig.state(), State::kArrived);
  }

  Robot iris{"iris"}, otto{"otto"};
  bool linked = true;
};

TEST_F(Fleet, JoinsAMissionThatItHearsOfAndLeavesTheRoomToTheNearer) {
  iris.rig.robot.pose = Pose2{6.0, 2.0, 0.0};
  otto.rig.robot.pose = Pose2{7.0, 2.0, 0.0};
  iris.rig.to_room(2);
  run(1500);
  EXPECT_EQ(iris.rig.state(), State::kToRoom);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
  EXPECT_EQ(otto.rig.meeting.report().wanted, 2U);
  EXPECT_EQ(otto.rig.meeting.report().id, iris.rig.meeting.report().id);
  EXPECT_EQ(otto.rig.meeting.time_left(otto.rig.now())->count() / 1'000'000'000 / 10,
            iris.rig.meeting.time_left(iris.rig.now())->count() / 1'000'000'000 / 10);
}

TEST_F(Fleet, CountsNobodyWhomAnotherBroughtAMomentAgo) {
  to_explore(3);
  bring(otto);
  iris.rig.see(2.5, 0.1, 4);
  iris.rig.arrive();
  iris.rig.press("yes");
  iris.rig.wait(1000);
  iris.rig.arrive();
  ASSERT_EQ(iris.rig.state(), State::kLookBack);
  run(500);
  iris.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(iris.rig.state(), State::kLookBack) << "that may be otto's, on his way to a seat";
  run(11000);
  iris.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(iris.rig.state(), State::kArrived);
}

TEST_F(Fleet, OfTwoInTheRoomTheFirstCountsFirst) {
  to_explore(3);
  const auto guide = [](Robot& robot) {
    robot.rig.see(2.5, 0.1, 4);
    robot.rig.arrive();
    robot.rig.press("yes");
    robot.rig.wait(1000);
    robot.rig.arrive();
    ASSERT_EQ(robot.rig.state(), State::kLookBack);
  };
  guide(otto);
  run(500);
  guide(iris);
  run(500);
  iris.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(iris.rig.state(), State::kLookBack) << "that may be otto's";
  otto.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(otto.rig.state(), State::kArrived);
  run(500);
  iris.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(iris.rig.state(), State::kLookBack);
  run(11000);
  iris.rig.see(1.1, 0.0, 4);
  EXPECT_EQ(iris.rig.state(), State::kArrived);
}

TEST_F(Fleet, RemembersWhomItSeesUntilThereIsARoom) {
  iris.rig.to_room(1);
  otto.rig.robot.pose = Pose2{7.5, 5.0, 0.0};
  iris.rig.robot.pose = Pose2{6.0, 2.0, 0.0};
  run(1500);
  Robot& explores = otto.rig.state() == State::kExplore ? otto : iris;
  Robot& seeks = &explores == &otto ? iris : otto;
  ASSERT_EQ(explores.rig.state(), State::kExplore);
  explores.rig.see(2.5, 0.1, 4);
  EXPECT_EQ(explores.rig.state(), State::kExplore);
  EXPECT_EQ(explores.rig.meeting.people().remembered().size(), 1U);
  seeks.rig.arrive();
  seeks.rig.turn_round();
  run(1000);
  EXPECT_EQ(explores.rig.state(), State::kRevisit);
  EXPECT_EQ(seeks.rig.state(), State::kExplore) << "it is farther from there";
}

TEST_F(Fleet, SeeksTheRoomItselfWhenTheOtherFallsSilent) {
  iris.rig.robot.pose = Pose2{6.0, 2.0, 0.0};
  otto.rig.robot.pose = Pose2{7.0, 2.0, 0.0};
  iris.rig.to_room(1);
  run(1500);
  ASSERT_EQ(otto.rig.state(), State::kExplore);
  linked = false;
  run(500);
  EXPECT_EQ(otto.rig.state(), State::kToRoom);
  linked = true;
  run(1000);
  EXPECT_EQ(otto.rig.state(), State::kExplore) << "and leaves it to the other one again";
}

TEST_F(Fleet, AsksNobodyWhomTheOtherOneAsks) {
  to_explore(2);
  iris.rig.robot.pose = Pose2{8.0, 5.0, 0.0};
  iris.rig.see({iris.rig.face_at({10.0, 5.0})}, 4);
  ASSERT_EQ(iris.rig.state(), State::kApproach);
  run(500);
  otto.rig.robot.pose = Pose2{12.0, 5.0, 3.1416};
  otto.rig.see({otto.rig.face_at({10.2, 5.1})}, 6);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
  iris.rig.arrive();
  iris.rig.press("no");
  run(1000);
  otto.rig.see({otto.rig.face_at({10.2, 5.1})}, 6);
  EXPECT_EQ(otto.rig.state(), State::kExplore) << "nor whom it has asked";
  EXPECT_EQ(otto.rig.meeting.report().invited, 0U);
}

TEST_F(Fleet, OfTwoWhoGoToOnePersonOneTurnsAway) {
  to_explore(2);
  linked = false;
  iris.rig.robot.pose = Pose2{8.0, 5.0, 0.0};
  otto.rig.robot.pose = Pose2{12.0, 5.0, 3.1416};
  iris.rig.see({iris.rig.face_at({10.0, 5.0})}, 4);
  otto.rig.see({otto.rig.face_at({10.1, 5.1})}, 4);
  ASSERT_EQ(iris.rig.state(), State::kApproach);
  ASSERT_EQ(otto.rig.state(), State::kApproach);
  linked = true;
  run(500);
  EXPECT_EQ(iris.rig.state(), State::kApproach);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
}

TEST_F(Fleet, CountsTogetherAndStopsWhenEnoughAreThere) {
  to_explore(2);
  bring(iris);
  run(500);
  EXPECT_EQ(otto.rig.meeting.report().brought, 1U);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
  otto.rig.robot.pose = Pose2{14.0, 3.0, 1.0};
  run(11000);  // whom iris brought has sat down
  bring(otto);
  run(3500);
  EXPECT_EQ(iris.rig.state(), State::kDone);
  EXPECT_EQ(otto.rig.state(), State::kDone);
  ASSERT_EQ(iris.rig.reports.size(), 1U);
  ASSERT_EQ(otto.rig.reports.size(), 1U);
  EXPECT_EQ(iris.rig.reports[0].outcome, Outcome::kComplete);
  EXPECT_EQ(iris.rig.reports[0].brought, 2U);
  EXPECT_EQ(otto.rig.reports[0].brought, 2U);
}

TEST_F(Fleet, InvitesNoMoreThanAreWanted) {
  to_explore(1);
  iris.rig.see(2.5, 0.1, 4);
  iris.rig.arrive();
  otto.rig.robot.pose = Pose2{14.0, 3.0, 1.0};
  otto.rig.see(2.5, 0.1, 4);
  ASSERT_EQ(otto.rig.state(), State::kApproach);
  iris.rig.press("yes");
  run(500);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
  EXPECT_EQ(otto.rig.meeting.people().remembered().size(), 1U) << "in case the other one loses him";
  run(2000);
  EXPECT_EQ(otto.rig.state(), State::kExplore);
}

TEST_F(Fleet, VisitsWhomTheOtherSawOnItsWay) {
  to_explore(3);
  iris.rig.see(2.5, 0.1, 4);
  iris.rig.arrive();
  iris.rig.press("yes");
  iris.rig.wait(1500);
  iris.rig.robot.pose = Pose2{6.0, 5.0, 3.0};
  iris.rig.see({iris.rig.face_at({4.5, 6.5})}, 4);
  ASSERT_EQ(iris.rig.meeting.people().remembered().size(), 1U);
  run(500);
  EXPECT_EQ(otto.rig.state(), State::kExplore) << "it could be who follows iris";
  iris.rig.robot.pose = Pose2{2.5, 3.0, 3.0};
  run(1000);
  EXPECT_EQ(otto.rig.state(), State::kRevisit);
  run(500);
  EXPECT_TRUE(iris.rig.meeting.people().remembered().empty()) << "the other one goes there";
}

TEST_F(Fleet, FinishesAloneAndTakesTheOtherBackIn) {
  to_explore(2);
  bring(iris);
  run(500);
  linked = false;  // iris is gone
  run(500);
  EXPECT_EQ(otto.rig.meeting.report().brought, 1U) << "who is there is there";
  Robot again("iris");  // and comes back without memory
  again.told = 1000;
  say(otto, again);
  again.rig.robot.team = {"otto"};
  again.rig.wait(500);
  say(otto, again);
  again.rig.wait(500);
  EXPECT_EQ(again.rig.state(), State::kExplore);
  EXPECT_EQ(again.rig.meeting.report().brought, 1U) << "its own work of a life before";
  EXPECT_EQ(again.rig.meeting.report().room, otto.rig.meeting.report().room);
}

TEST_F(Fleet, GivesUpTogether) {
  to_explore(2);
  iris.rig.note(iris.rig.meeting.cancel(0, iris.rig.now()));
  run(500);
  EXPECT_EQ(otto.rig.meeting.report().outcome, Outcome::kCancelled);
  run(7000);
  EXPECT_EQ(iris.rig.state(), State::kIdle) << "and nobody is called again";
  EXPECT_EQ(otto.rig.state(), State::kIdle);
}

TEST_F(Fleet, DividesTheWorkWhileBothAreThere) {
  std::map<std::string, WorkShare> shares;
  const auto watch = [&](Robot& robot) {
    const Actions& actions = robot.rig.meeting.step(robot.rig.robot, robot.rig.now());
    if (actions.share) shares[robot.name] = *actions.share;
  };
  to_explore(2);
  linked = false;
  iris.rig.robot.team = otto.rig.robot.team = {};
  watch(iris), watch(otto);
  EXPECT_TRUE(shares.at("iris").places.empty());
  say(iris, otto), say(otto, iris);
  iris.rig.robot.team = {"otto"}, otto.rig.robot.team = {"iris"};
  watch(iris), watch(otto);
  EXPECT_EQ(shares.at("iris").places.size(), 2U);
  EXPECT_EQ(shares.at("iris").places, shares.at("otto").places);
  EXPECT_NE(shares.at("iris").own, shares.at("otto").own);
}

/// Two rigs that live at random among people who answer at random, over a link that loses, repeats
/// and delays. Whatever happens: no state without a way, and once the link is well both count
/// alike.
TEST_F(Fleet, AgreesAfterABadLink) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Robot a("iris"), b("otto");
    std::deque<std::pair<bool, TeamReport>> way;  // to a?
    a.rig.robot.pose = Pose2{6.0, 2.0, 0.0};
    b.rig.robot.pose = Pose2{7.0, 2.0, 0.0};
    ASSERT_TRUE(a.rig.request(3).ok());
    const auto live = [&](Robot& robot) {
      Rig& rig = robot.rig;
      switch (rig.state()) {
        case State::kToRoom:
        case State::kRevisit:
        case State::kApproach:
          random.uniform() < 0.8 ? rig.arrive() : rig.no_way();
          break;
        case State::kGuide:
          rig.wait(1000);
          if (rig.state() == State::kGuide) rig.arrive();
          break;
        case State::kScanRoom:
          rig.turn_round();
          break;
        case State::kInvite:
          if (random.uniform() < 0.8) rig.press(random.uniform() < 0.5 ? "yes" : "no");
          break;
        case State::kLookBack:
          rig.see(1.1, 0.0, 2);
          break;
        case State::kExplore:
          rig.robot.pose = Pose2{5.0 + 9.0 * random.uniform(), 1.0 + 8.0 * random.uniform(),
                                 6.0 * random.uniform()};
          if (random.uniform() < 0.5) rig.see(2.0, 0.1, 4);
          break;
        default:
          rig.wait(500);
      }
    };
    const auto carry = [&](Robot& from, bool to_a, bool well) {
      TeamReport report = from.rig.meeting.tell(from.rig.now());
      report.robot = from.name;
      report.sequence = ++from.told;
      if (!well && random.uniform() < 0.3) return;
      way.emplace_back(to_a, report);
      if (random.uniform() < 0.2) way.emplace_back(to_a, report);
      while (!way.empty() && (well || random.uniform() < 0.6)) {
        const auto late =
            static_cast<std::size_t>(random.uniform() * static_cast<double>(way.size()));
        (way[late].first ? a : b).rig.meeting.hear(way[late].second);
        way.erase(way.begin() + static_cast<std::ptrdiff_t>(late));
      }
    };
    for (int round = 0; round < 120; ++round) {
      const bool well = round >= 110;
      const bool heard = well || random.uniform() < 0.8;
      a.rig.robot.team = heard ? std::vector<std::string>{"otto"} : std::vector<std::string>{};
      b.rig.robot.team = heard ? std::vector<std::string>{"iris"} : std::vector<std::string>{};
      if (!well) live(a), live(b);
      carry(a, false, well), carry(b, true, well);
      a.rig.wait(300), b.rig.wait(300);
    }
    const auto &one = a.rig.meeting.report(), &other = b.rig.meeting.report();
    if (one.id == other.id && one.outcome == Outcome::kOpen && other.outcome == Outcome::kOpen) {
      EXPECT_EQ(one.room, other.room);
      EXPECT_EQ(one.brought, other.brought);
    }
  }
}

}  // namespace
}  // namespace usher::meeting
