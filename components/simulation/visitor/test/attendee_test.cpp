#include "simulation/visitor/core/attendee.hpp"

#include <gtest/gtest.h>

namespace usher::visitor {
namespace {

Screen screen(std::uint64_t id, const char* state) {
  Screen screen;
  screen.id = id;
  screen.state = state;
  return screen;
}

TEST(Attendee, ReadsAnswersFollowsAndSits) {
  Attendee person(Manner::kComes, 2.0);
  person.see(screen(1, "explore"), true, 0.0);
  EXPECT_FALSE(person.answer(10.0));
  person.see(screen(2, "invite"), true, 10.0);
  EXPECT_FALSE(person.answer(11.9));
  EXPECT_EQ(person.screen_id(), 2U);
  EXPECT_EQ(person.answer(12.0), "yes");
  EXPECT_FALSE(person.answer(13.0)) << "once";
  person.see(screen(2, "invite"), true, 13.0);
  EXPECT_FALSE(person.answer(20.0)) << "the same question is not answered again";
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
  person.see(screen(3, "guide"), false, 21.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kFollow);
  person.see(screen(4, "arrived"), false, 50.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kToSeat);
  person.see(screen(5, "invite"), true, 60.0);
  EXPECT_FALSE(person.answer(70.0)) << "is there already";
  person.see(screen(6, "guide"), false, 71.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kToSeat) << "somebody else is guided";
}

TEST(Attendee, AnswersOnlyWhenTheRobotStandsBeforeIt) {
  Attendee person(Manner::kComes, 1.0);
  person.see(screen(2, "invite"), false, 0.0);
  EXPECT_FALSE(person.answer(100.0));
  person.see(screen(3, "guide"), false, 101.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
}

TEST(Attendee, DeclinesOrIsSilent) {
  Attendee declines(Manner::kDeclines, 1.0), silent(Manner::kSilent, 1.0);
  declines.see(screen(2, "invite"), true, 0.0);
  silent.see(screen(2, "invite"), true, 0.0);
  EXPECT_EQ(declines.answer(1.0), "no");
  EXPECT_FALSE(silent.answer(100.0));
  declines.see(screen(3, "guide"), false, 2.0);
  EXPECT_EQ(declines.walk(), Attendee::Walk::kStand);
}

TEST(Attendee, StandsWhileTheRobotLooksBackAtIt) {
  Attendee person(Manner::kComes, 0.0);
  person.see(screen(2, "invite"), true, 0.0);
  EXPECT_EQ(person.answer(0.1), "yes");
  person.see(screen(3, "guide"), false, 1.0);
  person.see(screen(4, "look_back"), false, 20.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kFollow) << "it comes up";
  person.see(screen(4, "look_back"), true, 22.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
  person.see(screen(5, "guide"), true, 23.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kFollow);
}

TEST(Attendee, StraysOnce) {
  Attendee person(Manner::kStrays, 0.0, 12.0);
  person.see(screen(2, "invite"), true, 0.0);
  EXPECT_EQ(person.answer(0.1), "yes");
  person.see(screen(3, "guide"), false, 12.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kFollow);
  person.see(screen(3, "guide"), false, 12.2);
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
  person.see(screen(4, "look_back"), false, 20.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
  person.see(screen(5, "explore"), false, 40.0);
  person.see(screen(6, "invite"), true, 60.0);
  EXPECT_EQ(person.answer(60.1), "yes");
  person.see(screen(7, "guide"), false, 90.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kFollow);
}

TEST(Attendee, StandsWhereTheRobotGaveItUp) {
  Attendee person(Manner::kComes, 0.0);
  person.see(screen(2, "invite"), true, 0.0);
  EXPECT_EQ(person.answer(0.1), "yes");
  person.see(screen(3, "guide"), false, 1.0);
  person.see(screen(4, "explore"), false, 2.0);
  EXPECT_EQ(person.walk(), Attendee::Walk::kStand);
  person.see(screen(5, "invite"), true, 3.0);
  EXPECT_EQ(person.answer(3.1), "yes") << "can be asked again";
}

}  // namespace
}  // namespace usher::visitor
