#include "tasks/meeting/core/meeting.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "foundation/random/random.hpp"
#include "meeting_rig.hpp"
#include "tasks/meeting/core/memory.hpp"

namespace usher::meeting {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Meeting, GoesToTheNearestRoomByTheLengthOfTheWay) {
  Rig near_west, near_east;
  near_west.robot.pose = Pose2{8.0, 4.0, 0.0};
  EXPECT_TRUE(near_west.request(1).ok());
  near_west.depart();
  EXPECT_EQ(near_west.goal_location, "west");
  near_east.robot.pose = Pose2{13.0, 6.0, 0.0};
  EXPECT_TRUE(near_east.request(1).ok());
  near_east.depart();
  EXPECT_EQ(near_east.goal_location, "east");
  // As the crow flies west is nearer, but a wall bars the way there up to the top.
  Rig walled;
  grid::OccupancyGrid map = hall();
  for (int y = 0; y < 92; ++y) map.at({70, y}) = grid::kOccupied;
  for (int x = 70; x < 150; ++x) map.at({x, 20}) = grid::kOccupied;
  ASSERT_TRUE(walled.meeting.set_map(map).ok());
  walled.robot.pose = Pose2{9.5, 3.0, 0.0};
  EXPECT_TRUE(walled.request(1).ok());
  walled.depart();
  EXPECT_EQ(walled.goal_location, "east");
}

TEST(Meeting, GoesOnToTheNextRoomAndAgainFromTheFirst) {
  Rig rig;
  rig.to_check_room();
  std::vector<std::string> gone{rig.goal_location};
  for (int i = 0; i < 4; ++i) {
    rig.see(1.5, 0.1, 2);
    ASSERT_EQ(rig.state(), State::kToRoom);
    rig.arrive();
    gone.push_back(rig.goal_location);
    rig.see(1.5, 0.1);
    ASSERT_EQ(rig.state(), State::kCheckRoom);
  }
  EXPECT_EQ(gone, (std::vector<std::string>{"west", "east", "west", "east", "west"}));
  EXPECT_EQ(rig.meeting.report().rooms_occupied, 4U);
}

TEST(Meeting, EndsWhenNoRoomCanBeReached) {
  Rig rig;
  rig.to_room();
  rig.no_way();
  EXPECT_EQ(rig.state(), State::kToRoom);
  rig.no_way();
  EXPECT_EQ(rig.state(), State::kEnded);
  EXPECT_EQ(rig.meeting.report().reason, "no meeting room can be reached: blocked");
}

TEST(Meeting, TurnsRoundOnceWithoutAFaceInTheRoom) {
  Rig rig;
  rig.to_scan();
  EXPECT_EQ(rig.meeting.turn(), Turn::kSearch);
  for (int i = 0; i < 61; ++i) rig.turn(0.1);
  EXPECT_EQ(rig.state(), State::kScanRoom);
  for (int i = 0; i < 3; ++i) rig.turn(0.1);
  EXPECT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.report().room, "west");
  EXPECT_EQ(rig.meeting.report().rooms_scanned, 1U);
  rig.wait(500);
  EXPECT_NE(rig.taken().find("explore anew"), std::string::npos);
}

TEST(Meeting, CountsNoTurnThatIsNotItsOwn) {
  Rig rig;
  rig.to_scan();
  rig.robot.supervisor = Supervisor::kInactive;
  for (int i = 0; i < 100; ++i) rig.turn(0.1);
  EXPECT_EQ(rig.state(), State::kScanRoom);
}

TEST(Meeting, TakesNobodyOutsideForSomebodyInTheRoom) {
  Rig rig;
  rig.to_scan();
  rig.see({rig.face_at({5.0, 2.0})}, 5);
  EXPECT_EQ(rig.state(), State::kScanRoom);
}

TEST(Meeting, GoesOnTurningWhereItStoppedForAFaceThatWasNone) {
  Rig rig;
  rig.to_scan();
  for (int i = 0; i < 40; ++i) rig.turn(0.1);
  rig.see(1.5, 0.1);
  ASSERT_EQ(rig.state(), State::kCheckRoom);
  EXPECT_EQ(rig.meeting.turn(), Turn::kFace);
  rig.wait(2500);
  ASSERT_EQ(rig.state(), State::kScanRoom);
  rig.see(1.5, 0.1, 3);
  EXPECT_EQ(rig.state(), State::kScanRoom) << "there was none a moment ago";
  for (int i = 0; i < 26; ++i) rig.turn(0.1);
  EXPECT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.report().faces_refused, 1U);
}

TEST(Meeting, ConfirmsWithThreeMessagesInARowOnceItIsCentered) {
  Rig rig;
  rig.to_explore();
  rig.see(2.5, 0.35);
  EXPECT_EQ(rig.state(), State::kExplore) << "one message does not stop it";
  rig.see(2.5, 0.35);
  ASSERT_EQ(rig.state(), State::kCheckFace);
  EXPECT_EQ(rig.meeting.turn(), Turn::kFace);
  EXPECT_NEAR(rig.meeting.bearing(), 0.35, 0.01);
  rig.see(2.5, 0.35, 5);
  EXPECT_EQ(rig.state(), State::kCheckFace) << "not centered";
  rig.robot.pose->yaw += 0.3;
  rig.see(2.5, 0.05);
  EXPECT_EQ(rig.state(), State::kApproach);
}

TEST(Meeting, StartsToConfirmAnewAfterAMessageWithout) {
  Rig rig;
  rig.to_explore();
  rig.see(2.5, 0.05, 2);
  ASSERT_EQ(rig.state(), State::kCheckFace);
  rig.see_nobody();
  rig.see(2.5, 0.05, 2);
  EXPECT_EQ(rig.state(), State::kCheckFace);
  rig.see(2.5, 0.05);
  EXPECT_EQ(rig.state(), State::kApproach);
}

TEST(Meeting, GoesToJustInFrontOfThePersonAndFacesHim) {
  Rig rig;
  rig.to_explore();
  const Point2 person(10.4, 5.3);
  rig.see({rig.face_at(person)}, 4);
  ASSERT_EQ(rig.state(), State::kApproach);
  rig.depart();
  EXPECT_NEAR((rig.goal_pose.position() - person).norm(), 1.0, 1e-6);
  const Point2 ahead = inverse(rig.goal_pose) * person;
  EXPECT_NEAR(ahead.y(), 0.0, 1e-6);
  EXPECT_GT(ahead.x(), 0.0);
  // The straight line leads towards the robot.
  EXPECT_LT((rig.goal_pose.position() - rig.robot.pose->position()).norm(),
            (person - rig.robot.pose->position()).norm());
}

TEST(Meeting, TalksWhereItCanTurnRoundToGuide) {
  Rig rig;
  grid::OccupancyGrid map = hall();
  map.at({95, 43}) = grid::kOccupied;  // 0.35 m beside the place at 1 m
  ASSERT_TRUE(rig.meeting.set_map(map).ok());
  rig.to_explore();
  rig.robot.pose = Pose2{8.0, 4.0, 0.0};
  rig.see({rig.face_at({10.5, 4.0})}, 4);
  ASSERT_EQ(rig.state(), State::kApproach);
  rig.depart();
  EXPECT_NEAR(rig.goal_pose.x, 9.25, 0.15);
  EXPECT_NEAR(rig.goal_pose.y, 4.0, 0.01);
}

TEST(Meeting, ApproachesOnTheWayWhereTheStraightLineIsBarred) {
  Rig rig;
  grid::OccupancyGrid map = hall();
  for (int y = 45; y < 60; ++y) map.at({90, y}) = grid::kOccupied;
  ASSERT_TRUE(rig.meeting.set_map(map).ok());
  rig.to_explore();
  const Point2 person(9.8, 5.0);  // the wall is low: his face is seen over it
  rig.see({rig.face_at(person)}, 4);
  ASSERT_EQ(rig.state(), State::kApproach);
  rig.depart();
  EXPECT_NEAR((rig.goal_pose.position() - person).norm(), 1.0, 0.2);
  const bool beside = rig.goal_pose.y < 4.4 || rig.goal_pose.y > 6.1;
  EXPECT_TRUE(rig.goal_pose.x > 9.2 || beside) << "not before the wall";
}

TEST(Meeting, InvitesWithASoundAndFifteenSeconds) {
  Rig rig;
  rig.to_invite();
  const auto& screen = rig.meeting.screen();
  EXPECT_EQ(screen.tone, service::Tone::kCall);
  EXPECT_TRUE(screen.listens);
  ASSERT_EQ(screen.options.size(), 2U);
  EXPECT_EQ(screen.time_left, 15.0);
  EXPECT_EQ(screen.place, "west");
  ASSERT_FALSE(rig.said.empty());
  EXPECT_EQ(rig.said.back(), "There is a meeting: West room. Would you like to come with me?");
  rig.wait(5000);
  EXPECT_EQ(rig.meeting.screen().time_left, 10.0);
}

TEST(Meeting, TellsHowItStandsAndReports) {
  Rig rig;
  rig.to_arrived();
  rig.wait(3000);
  ASSERT_EQ(rig.state(), State::kDone);
  ASSERT_EQ(rig.reports.size(), 1U);
  const Report& report = rig.reports.front();
  EXPECT_EQ(report.outcome, Outcome::kComplete);
  EXPECT_EQ(report.room, "west");
  EXPECT_EQ(report.brought, 1U);
  EXPECT_EQ(report.invited, 1U);
  EXPECT_EQ(report.accepted, 1U);
  EXPECT_TRUE(report.reason.empty());
  ASSERT_TRUE(report.room_time);
  EXPECT_GT(report.duration, *report.room_time);
  EXPECT_EQ(rig.said.back(), "Everybody is here. Have a good meeting.");
}

TEST(Meeting, LooksBackWhereItsFollowerShouldBeAndGoesOn) {
  Rig rig;
  rig.to_guide();
  rig.wait(1500);
  for (int i = 0; i < 20; ++i) {  // away from the person, to the left of where it met him
    rig.robot.pose->y += 0.2;
    rig.wait(100);
  }
  const Pose2 there = *rig.robot.pose;
  rig.wait(17000);
  ASSERT_EQ(rig.state(), State::kLookBack);
  EXPECT_EQ(rig.meeting.screen().title, "Are you with me?");
  rig.wait(100);
  EXPECT_EQ(rig.meeting.turn(), Turn::kFace);
  EXPECT_NEAR(geometry::normalized(there.yaw + rig.meeting.bearing()), -geometry::kPi / 2, 0.3);
  rig.see({rig.face_at(there.position() + Point2(3.5, 3.0))}, 4);
  EXPECT_EQ(rig.state(), State::kLookBack) << "somebody else";
  rig.robot.pose->yaw = -geometry::kPi / 2;
  rig.see(1.6, 0.1, 1);
  EXPECT_EQ(rig.state(), State::kLookBack) << "one message is not enough";
  rig.taken();
  rig.see(1.6, 0.1, 1);
  ASSERT_EQ(rig.state(), State::kGuide);
  rig.wait(2000);
  EXPECT_NE(rig.taken().find("goal:west"), std::string::npos) << "on to the room";
}

TEST(Meeting, SeesWithTheLaserWhoStandsWhereNobodyWas) {
  Rig rig;
  rig.to_guide();
  rig.wait(1500);
  const auto look = [&](const Point2& at, int times) {
    const std::vector<Point2> points{at, at + Point2(0.03, 0.0), at - Point2(0.03, 0.0)};
    for (int i = 0; i < times; ++i) {
      rig.note(rig.meeting.look(rig.robot.pose->position(), points, rig.now()));
      rig.wait(100);
    }
  };
  const Point2 start = rig.robot.pose->position();
  std::vector<Point2> ahead;  // a wall 4 m to the left of where it looks
  for (int i = -150; i < 150; ++i) ahead.push_back(start + Point2(0.01 * i, 4.0));
  for (int i = 0; i < 10; ++i) {
    rig.note(rig.meeting.look(rig.robot.pose->position(), ahead, rig.now()));
    rig.robot.pose->y += 0.25;
    rig.wait(100);
  }
  rig.wait(20000);
  ASSERT_EQ(rig.state(), State::kLookBack);
  look(start + Point2(1.8, 1.5), 5);
  EXPECT_EQ(rig.state(), State::kLookBack) << "may have stood there before";
  look(rig.robot.pose->position() + Point2(0.0, -0.3), 5);
  EXPECT_EQ(rig.state(), State::kLookBack) << "the robot itself";
  rig.robot.team_at = {{"otto", start + Point2(0.3, 1.0)}};
  rig.turn(0.2);
  look(start + Point2(0.1, 1.2), 5);
  EXPECT_EQ(rig.state(), State::kLookBack) << "another robot of the fleet";
  rig.robot.team_at.clear();
  rig.turn(0.2);
  look(start + Point2(0.1, 1.2), 2);
  look({kNan, kNan}, 1);
  EXPECT_EQ(rig.state(), State::kLookBack) << "three scans in a row";
  look(start + Point2(0.1, 1.2), 3);
  EXPECT_EQ(rig.state(), State::kGuide);
}

TEST(Meeting, LooksBackAtNobodyWhoStandsBeforeIt) {
  Rig rig;
  rig.to_guide();
  rig.wait(60000);  // blocked by whom it guides
  EXPECT_EQ(rig.state(), State::kGuide);
}

TEST(Meeting, LooksBackWhereItHasRoomToTurn) {
  Rig rig;
  grid::OccupancyGrid map = hall();
  for (int x = 0; x < 200; ++x) map.at({x, 69}) = map.at({x, 75}) = grid::kOccupied;
  ASSERT_TRUE(rig.meeting.set_map(map).ok());
  rig.to_guide();
  rig.wait(1500);
  rig.robot.pose->y = 7.2;  // in a passage of 0.6 m
  rig.wait(30000);
  EXPECT_EQ(rig.state(), State::kGuide);
  rig.robot.pose->y = 8.0;
  rig.wait(100);
  EXPECT_EQ(rig.state(), State::kLookBack);
}

TEST(Meeting, CallsWhoDoesNotFollowAndLooksForOthersThen) {
  Rig rig;
  rig.to_look_back(2);
  EXPECT_EQ(rig.meeting.screen().title, "Please come in.");
  rig.said.clear();
  rig.wait(9000);
  EXPECT_EQ(rig.said, std::vector<std::string>{"Are you there? I am waiting for you."});
  EXPECT_EQ(rig.meeting.turn(), Turn::kSearch) << "all round";
  rig.wait(18400);
  EXPECT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.report().lost, 1U);
  EXPECT_EQ(rig.meeting.report().brought, 0U);
}

TEST(Meeting, CountsWhoHasComeIntoTheRoom) {
  Rig rig;
  rig.to_look_back();
  rig.robot.pose = Pose2{2.6, 2.0, 0.0};
  rig.wait(100);
  const Point2 before_the_door(4.3, 2.3), at_the_door(3.9, 2.3), inside(3.5, 2.3);
  rig.see({rig.face_at(before_the_door)}, 5);
  rig.see({rig.face_at(at_the_door)}, 5);
  EXPECT_EQ(rig.state(), State::kLookBack);
  rig.see({rig.face_at(inside)}, 2);
  EXPECT_EQ(rig.state(), State::kArrived);
}

TEST(Meeting, CountsNobodyWhoWasInTheRoomBefore) {
  Rig rig;
  rig.to_guide();
  rig.wait(1000);
  const Point2 sits(3.1, 2.0);
  for (int i = 0; i < 3; ++i) {
    const std::vector<Point2> legs{sits + Point2(0.1, 0.0)};
    rig.note(rig.meeting.look({5.0, 2.0}, legs, rig.now()));
  }
  rig.arrive();
  ASSERT_EQ(rig.state(), State::kLookBack);
  rig.see({rig.face_at(sits)}, 5);
  EXPECT_EQ(rig.state(), State::kLookBack);
  rig.see({rig.face_at({2.9, 2.5})}, 2);
  EXPECT_EQ(rig.state(), State::kArrived);
}

TEST(Meeting, JudgesNothingWhileItIsBlind) {
  Rig rig;
  rig.to_scan();
  rig.robot.sees = false;
  rig.turn_round();
  EXPECT_EQ(rig.state(), State::kScanRoom) << "nobody was seen since nothing was";
  rig.robot.sees = true;
  rig.turn_round();
  EXPECT_EQ(rig.state(), State::kExplore);
  Rig follows;
  follows.to_look_back();
  follows.robot.sees = false;
  follows.wait(40000);
  EXPECT_EQ(follows.state(), State::kLookBack);
  follows.wait(21000);
  EXPECT_EQ(follows.state(), State::kEnded);
  EXPECT_EQ(follows.meeting.report().reason, "no face detector");
}

TEST(Meeting, RefusesNoFaceAndGivesUpNobodyWhileItIsBlind) {
  using Blindness = void (*)(Rig&, bool);
  const Blindness ways[] = {
      [](Rig& rig, bool blind) { rig.robot.sees = !blind; },
      [](Rig& rig, bool blind) {
        rig.robot.pose = blind ? std::nullopt : std::optional(Pose2{8.0, 5.0, 0.0});
      }};
  for (const Blindness& blind : ways) {
    Rig room;
    room.to_check_room();
    const auto pose = room.robot.pose;
    blind(room, true);
    room.wait(10000);
    EXPECT_EQ(room.state(), State::kCheckRoom) << "an occupied room would be free";
    blind(room, false);
    room.robot.pose = pose;
    room.see(1.5, 0.1, 3);
    EXPECT_EQ(room.meeting.report().rooms_occupied, 1U);

    Rig face;
    face.to_check_face();
    blind(face, true);
    face.wait(10000);
    EXPECT_EQ(face.state(), State::kCheckFace);
    blind(face, false);
    face.wait(4000);
    EXPECT_EQ(face.state(), State::kExplore) << "it sees now that there is nobody";

    Rig visit;
    visit.to_revisit();
    visit.arrive();
    blind(visit, true);
    visit.wait(10000);
    EXPECT_EQ(visit.state(), State::kRevisit);

    Rig follower;
    follower.to_look_back();
    blind(follower, true);
    follower.wait(40000);
    EXPECT_EQ(follower.state(), State::kLookBack);
  }
}

TEST(Meeting, AsksANeighborOfWhoDeclined) {
  Rig rig;
  rig.to_invite(2);
  const Point2 first = rig.meeting.bearing() < 100 ? Point2(10.5, 5.25) : Point2();
  rig.press("no");
  ASSERT_EQ(rig.state(), State::kExplore);
  const Point2 declined = first;
  rig.see({rig.face_at(declined + Point2(0.2, 0.0))}, 4);
  EXPECT_EQ(rig.state(), State::kExplore) << "the same one again";
  rig.see({rig.face_at(declined + Point2(0.0, 0.7))}, 4);
  EXPECT_NE(rig.state(), State::kExplore) << "another one beside him";
}

TEST(Meeting, CountsWhomItSawComeInBehindIt) {
  Rig rig;
  rig.to_guide();
  rig.wait(1000);
  rig.robot.pose = Pose2{2.6, 2.0, 0.0};
  const Point2 came(3.1, 2.0);
  for (int i = 0; i < 5; ++i) {  // it turns to its goal's yaw, and the laser meets the follower
    const std::vector<Point2> legs{came + Point2(0.1, 0.0)};
    rig.note(rig.meeting.look(rig.robot.pose->position(), legs, rig.now()));
  }
  rig.arrive();
  ASSERT_EQ(rig.state(), State::kLookBack);
  rig.see({rig.face_at(came)}, 2);
  EXPECT_EQ(rig.state(), State::kArrived);
}

TEST(Meeting, LosesNobodyWhileItMayNotTurn) {
  Rig rig;
  rig.to_look_back();
  rig.robot.supervisor = Supervisor::kInactive;
  rig.wait(40000);
  EXPECT_EQ(rig.state(), State::kLookBack);
  rig.robot.supervisor = Supervisor::kAvailable;
  rig.wait(26000);
  EXPECT_EQ(rig.state(), State::kLookBack);
  rig.see(1.1, 0.0, 2);
  EXPECT_EQ(rig.state(), State::kArrived);
}

TEST(Meeting, LosesNobodyWhileSomebodyStopsIt) {
  Rig rig;
  rig.to_look_back();
  rig.robot.stopped = true;  // the supervisor stays in Interaction
  rig.wait(40000);
  EXPECT_EQ(rig.state(), State::kLookBack);
  EXPECT_EQ(rig.meeting.screen().status, "Somebody has stopped me.");
  rig.robot.stopped = false;
  rig.wait(26000);
  EXPECT_EQ(rig.state(), State::kLookBack);
  EXPECT_EQ(rig.meeting.screen().status, "Here: 0 of 1.");
  rig.see(1.1, 0.0, 2);
  EXPECT_EQ(rig.state(), State::kArrived);
}

TEST(Meeting, TakesNoStopForAnObstacle) {
  for (const bool stopped : {true, false}) {
    Rig rig;
    rig.to_guide();
    rig.wait(1500);
    rig.robot.pose->y += 2.5;
    rig.wait(18500);
    ASSERT_EQ(rig.state(), State::kLookBack);
    rig.robot.stopped = stopped;
    rig.wait(5000);  // it does not turn
    EXPECT_EQ(rig.state(), stopped ? State::kLookBack : State::kGuide);
  }
}

TEST(Meeting, PassesNoRoomOverWhileSomebodyStopsIt) {
  Rig rig;
  rig.to_scan();
  rig.robot.stopped = true;
  rig.wait(90000);
  EXPECT_EQ(rig.state(), State::kScanRoom);
  rig.turn_round();
  EXPECT_EQ(rig.state(), State::kScanRoom) << "who is pushed round has not looked";
  rig.robot.stopped = false;
  rig.turn_round();
  EXPECT_EQ(rig.state(), State::kExplore);
}

TEST(Meeting, AsksNobodyTwiceWhoSaidNo) {
  Rig rig;
  rig.to_invite();
  const Point2 person = *rig.robot.pose * Point2(1.0, 0.0);
  rig.press("no");
  ASSERT_EQ(rig.state(), State::kExplore);
  for (int i = 0; i < 300; ++i) rig.see({rig.face_at(person)}, 10);
  EXPECT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.report().declined, 1U);
}

TEST(Meeting, AsksWhoSaidNothingAgainAfterAWhile) {
  Rig rig;
  rig.to_invite();
  const Point2 person = *rig.robot.pose * Point2(1.0, 0.0);
  rig.wait(15000);
  ASSERT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.report().unanswered, 1U);
  rig.see({rig.face_at(person)}, 10);
  EXPECT_EQ(rig.state(), State::kExplore);
  rig.wait(180000);
  rig.see({rig.face_at(person)}, 3);
  EXPECT_EQ(rig.state(), State::kInvite);
}

TEST(Meeting, LooksForNobodyInMeetingRooms) {
  Rig rig;
  rig.to_explore();
  rig.robot.pose = Pose2{6.0, 2.0, 3.1};
  rig.see({rig.face_at({3.5, 2.0})}, 10);
  EXPECT_EQ(rig.state(), State::kExplore);
}

TEST(Meeting, VisitsWhomItSawOnTheWayBeforeItLooksForOthers) {
  Rig rig;
  rig.to_revisit();
  rig.taken();
  rig.depart();
  EXPECT_NEAR((rig.goal_pose.position() - Point2(4.5, 6.5)).norm(), 1.0, 0.2);
  EXPECT_TRUE(rig.meeting.people().remembered().empty());
}

TEST(Meeting, RemembersOnItsWayToARoomButNotWhomItGuides) {
  Rig rig;
  rig.to_room();
  rig.depart();
  rig.robot.pose = Pose2{6.0, 4.0, 0.0};
  rig.see(2.0, 0.1, 2);
  EXPECT_TRUE(rig.meeting.people().remembered().empty());
  rig.see(2.0, 0.1, 3);
  EXPECT_EQ(rig.meeting.people().remembered().size(), 1U);
  Rig guide;
  guide.to_guide(2);
  guide.see(1.0, 0.1, 5);
  guide.wait(1500);
  guide.see(1.0, 0.3, 5);
  EXPECT_TRUE(guide.meeting.people().remembered().empty());
}

TEST(Meeting, TakesAnAnswerOnceAndNoneThatIsLate) {
  Rig rig;
  rig.to_invite();
  const std::uint64_t old = rig.meeting.screen().id;
  rig.press("perhaps", 1);
  EXPECT_EQ(rig.meeting.last_result(), service::AnswerResult::kNotOffered);
  rig.press("no", 2);
  ASSERT_EQ(rig.state(), State::kExplore);
  rig.note(rig.meeting.answer({old, "yes", "", service::Input::kTouch, "tablet", 3}, rig.now()));
  EXPECT_EQ(rig.meeting.last_result(), service::AnswerResult::kLate);
  EXPECT_EQ(rig.state(), State::kExplore);
  EXPECT_EQ(rig.meeting.ignored_answers(), 2U);
  rig.note(rig.meeting.answer({old, "yes", "", service::Input::kTouch, "tablet", 2}, rig.now()));
  EXPECT_EQ(rig.meeting.ignored_answers(), 2U) << "a repetition changes nothing";
}

TEST(Meeting, RefusesRequestsThatAreNoneAndASecondOne) {
  Rig rig;
  const auto refused = [&](const MissionRequest& request) {
    const Status status = rig.meeting.request(request, rig.now());
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(rig.meeting.reason(), status.ok() ? "" : status.error());
    return rig.state();
  };
  EXPECT_EQ(refused({0, "test", 1, 0.0}), State::kIdle);
  EXPECT_EQ(refused({1, "", 1, 0.0}), State::kIdle);
  EXPECT_EQ(refused({2, "test", 0, 0.0}), State::kIdle);
  EXPECT_EQ(refused({3, "test", 4'000'000'000U, 0.0}), State::kIdle);
  std::uint64_t id = 4;
  for (const double limit : {kNan, -1.0, 1e9, std::numeric_limits<double>::infinity()})
    EXPECT_EQ(refused({id++, "test", 1, limit}), State::kIdle);
  ASSERT_TRUE(rig.meeting.request({50, "test", 1, 60.0}, rig.now()).ok());
  EXPECT_TRUE(rig.meeting.request({50, "test", 1, 60.0}, rig.now()).ok()) << "repeated";
  EXPECT_EQ(refused({51, "other", 1, 0.0}), State::kToRoom);
  EXPECT_EQ(*rig.meeting.time_left(rig.now()), std::chrono::seconds(60));
  EXPECT_FALSE(rig.meeting.cancel(99, rig.now()).report) << "another mission's id";
  EXPECT_EQ(rig.state(), State::kToRoom);
}

TEST(Meeting, IsNotReadyAndSaysWhy) {
  const auto lacks = [](void (*act)(Rig&)) {
    Rig rig;
    act(rig);
    rig.wait(100);
    EXPECT_EQ(rig.state(), State::kInitialise);
    EXPECT_FALSE(rig.request(1).ok());
    return rig.meeting.screen().status;
  };
  EXPECT_EQ(lacks([](Rig& r) { r.robot.pose.reset(); }), "not localized");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.pose = Pose2{kNan, 0, 0}; }), "not localized");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.pose = Pose2{1e12, 0, 0}; }), "not localized");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.navigation.reset(); }), "no navigator");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.exploration.reset(); }), "no explorer");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.sees = false; }), "no face detector");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.supervisor = Supervisor::kUnknown; }), "no supervisor");
  EXPECT_EQ(lacks([](Rig& r) { r.robot.supervisor = Supervisor::kManual; }), "an operator drives");
  EXPECT_EQ(lacks([](Rig& r) { r.meeting.set_places({}); }), "no location 'west'");
  EXPECT_EQ(lacks([](Rig& r) {
              r.meeting.set_places({{"west", "", {kNan, 0}}});
            }),
            "no location 'west'");
  Rig bare({}, {});
  EXPECT_EQ(bare.meeting.screen().status, "the site has no meeting rooms");
}

TEST(Meeting, TurnsToNobodyWhereItHasNoRoomAndTakesTheFaceAsItIs) {
  Rig rig;
  grid::OccupancyGrid map = hall();
  for (int x = 0; x < 200; ++x) map.at({x, 53}) = grid::kOccupied;
  ASSERT_TRUE(rig.meeting.set_map(map).ok());
  rig.to_explore();  // 0.3 m from the wall
  rig.see(2.5, 0.35, 2);
  ASSERT_EQ(rig.state(), State::kCheckFace);
  EXPECT_EQ(rig.meeting.turn(), Turn::kStand);
  rig.see(2.5, 0.35, 1);
  EXPECT_EQ(rig.state(), State::kApproach);
}

TEST(Meeting, TurnsToNobodyWithoutAPose) {
  Rig rig;
  rig.to_check_face();
  EXPECT_EQ(rig.meeting.turn(), Turn::kFace);
  rig.robot.pose.reset();
  rig.wait(100);
  EXPECT_EQ(rig.meeting.turn(), Turn::kStand);
}

TEST(Meeting, AsksNobodyAgainWhoLeftOnTheWay) {
  for (const bool looked_back : {false, true}) {
    Rig rig;
    rig.to_guide(2);
    rig.wait(1500);
    rig.robot.pose = Pose2{6.0, 5.0, 3.0};
    rig.wait(100);
    if (looked_back) {
      rig.wait(20000);
      ASSERT_EQ(rig.state(), State::kLookBack);
      rig.robot.pose->yaw = 0.0;
      rig.see(1.1, 0.0, 2);
      ASSERT_EQ(rig.state(), State::kGuide);
      rig.robot.pose->yaw = 3.0;
    }
    rig.press("leave");
    EXPECT_EQ(rig.state(), State::kExplore);
    rig.depart();
    rig.see({rig.face_at({5.2, 5.1})}, 6);
    EXPECT_EQ(rig.state(), State::kExplore) << "he stands beside the robot";
  }
}

TEST(Meeting, WaitsForARobotThatMayNotMoveAndFailsAfterAWhile) {
  Rig rig;
  rig.to_explore();
  rig.robot.supervisor = Supervisor::kUnknown;
  rig.wait(59000);
  EXPECT_EQ(rig.state(), State::kExplore);
  rig.wait(1100);
  EXPECT_EQ(rig.state(), State::kEnded);
  EXPECT_EQ(rig.meeting.report().reason, "the robot may not move");
  Rig lost;
  lost.to_explore();
  lost.robot.pose.reset();
  lost.wait(60100);
  EXPECT_EQ(lost.meeting.report().reason, "the robot is not localized");
}

TEST(Meeting, EndsAfterExplorationsThatFailInARow) {
  Rig rig;
  rig.to_explore();
  for (int i = 0; i < 4; ++i) {
    rig.explorer(GoalState::kFailed, "nothing to see");
    ASSERT_EQ(rig.state(), State::kExplore) << i;
    rig.depart();
  }
  rig.explorer(GoalState::kFailed, "nothing to see");
  EXPECT_EQ(rig.state(), State::kEnded);
  EXPECT_EQ(rig.meeting.report().reason, "exploration: nothing to see");
}

TEST(Meeting, KnowsWhatEndedWithItsRestart) {
  Report report;
  report.id = 42;
  report.client = "the operator";
  report.room = "";
  report.wanted = 3;
  report.brought = 1;
  const auto read = report_from_text(to_text(report));
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(read->id, 42U);
  EXPECT_EQ(read->client, "the operator");
  EXPECT_EQ(read->brought, 1U);
  const std::string text = to_text(report);
  for (std::size_t i = 0; i < text.size(); ++i)
    EXPECT_FALSE(report_from_text(text.substr(0, i)).ok()) << i;
  EXPECT_FALSE(report_from_text(text + "x").ok());
  EXPECT_FALSE(report_from_text("id -1\nclient a\nroom \nwanted 1\nbrought 0\n").ok());
}

/// A robot, people and operators that do anything; after it all a mission still ends, and the next
/// one is taken.
TEST(Meeting, HasNoDeadEnd) {
  std::array<std::uint64_t, 5> outcomes{};
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Rig rig;
    ASSERT_TRUE(rig.request(1 + static_cast<std::uint32_t>(random.uniform() * 3)).ok());
    const double mischief = random.uniform();
    const double numbers[] = {kNan, 1e300, -1e300, 0.0, 1.0};
    const auto any = [&] { return numbers[static_cast<std::size_t>(random.uniform() * 5)]; };
    for (int i = 0; i < 4000 && rig.reports.empty(); ++i) {
      if (random.uniform() < 0.02 * mischief)
        rig.robot.supervisor = static_cast<Supervisor>(static_cast<int>(random.uniform() * 5));
      if (random.uniform() < 0.02 * mischief) rig.robot.navigation.reset();
      if (random.uniform() < 0.02 * mischief) rig.robot.exploration.reset();
      if (random.uniform() < 0.005 * mischief) rig.robot.pose = Pose2{any(), any(), any()};
      if (random.uniform() < 0.01) {
        rig.robot.pose =
            Pose2{20.0 * random.uniform(), 10.0 * random.uniform(), 6.28 * random.uniform() - 3.14};
        rig.robot.supervisor = Supervisor::kAvailable;
      }
      for (const Place& place : places()) {
        if (rig.state() == State::kGuide && place.name == rig.meeting.report().room &&
            random.uniform() < 0.1)
          rig.robot.pose = Pose2{place.at.x(), place.at.y(), 0.0};
      }
      const auto any_state = [&] {
        return random.uniform() < mischief
                   ? static_cast<GoalState>(static_cast<int>(random.uniform() * 7))
                   : GoalState::kSucceeded;
      };
      if (random.uniform() < 0.02)
        rig.robot.navigation = GoalReport{rig.goal, any_state(), "chance"};
      if (random.uniform() < 0.002 * mischief)
        rig.robot.exploration = GoalReport{rig.exploration, any_state(), "chance"};
      if (random.uniform() < 0.05 && !rig.robot.navigation) rig.robot.navigation = GoalReport{};
      if (random.uniform() < 0.05 && !rig.robot.exploration)
        rig.robot.exploration = GoalReport{rig.exploration, GoalState::kActive, {}};
      if (rig.robot.pose) rig.robot.pose->yaw = geometry::normalized(rig.robot.pose->yaw + 0.1);
      if (random.uniform() < 0.1) {
        rig.see(0.5 + 3.0 * random.uniform(), 0.8 * random.uniform() - 0.4,
                1 + static_cast<int>(4 * random.uniform()));
      }
      if (rig.state() == State::kLookBack && random.uniform() < 0.1) {
        const Point2 near = rig.robot.pose ? rig.robot.pose->position() : Point2(any(), any());
        const std::vector<Point2> points(3, near + Point2(any(), any()));
        for (int k = 0; k < 3; ++k) rig.note(rig.meeting.look(near, points, rig.now()));
        rig.see(1.1, 0.0, 2);
      }
      if (random.uniform() < 0.02) rig.see({{any(), any(), any(), any(), any(), any(), any()}});
      const auto& options = rig.meeting.screen().options;
      if (!options.empty() && random.uniform() < 0.1)
        rig.press(options[static_cast<std::size_t>(random.uniform() *
                                                   static_cast<double>(options.size()))]
                      .id);
      rig.wait(1 + static_cast<int>(400 * random.uniform()));
    }
    // The limit ends what chance did not.
    for (int i = 0; i < 1000 && rig.reports.empty(); ++i) rig.wait(1000);
    ASSERT_EQ(rig.reports.size(), 1U);
    ++outcomes[static_cast<std::size_t>(rig.reports.front().outcome)];
    rig.robot.supervisor = Supervisor::kAvailable;
    rig.robot.pose = Pose2{8.0, 4.0, 0.0};
    rig.robot.navigation = GoalReport{};
    rig.robot.exploration = GoalReport{};
    rig.wait(5500);
    ASSERT_EQ(rig.state(), State::kIdle);
    EXPECT_TRUE(rig.request(1).ok());
  }
  std::printf(
      "complete %llu, time over %llu, failed %llu\n", static_cast<unsigned long long>(outcomes[1]),
      static_cast<unsigned long long>(outcomes[2]), static_cast<unsigned long long>(outcomes[3]));
  EXPECT_GT(outcomes[1], 10U);
}

}  // namespace
}  // namespace usher::meeting
