#include "drivers/base_obedience/core/writer_right.hpp"

#include <gtest/gtest.h>

namespace usher::drive {
namespace {

using std::chrono::milliseconds;

WriterSighting sighting(std::uint8_t number, const char* participant = "movement_control") {
  return {{number, 9, 9}, participant, "nuc"};
}

TEST(AllowedWriters, AreTheManifestsNamesOfTheCataloguesTypes) {
  const std::vector<NamedComponent> manifest = {
      {"planner_one", "local_planner"}, {"gamepad", "gamepad"}, {"joy", "manual_control"}};
  using Names = std::vector<std::string>;
  EXPECT_EQ(allowed_writers("local_planner waypoint_follower", manifest), Names{"planner_one"});
  EXPECT_EQ(allowed_writers("manual_control operator", manifest), (Names{"joy", "operator"}));
  EXPECT_EQ(allowed_writers("lms100 urg04lx", {{"laser", "lms100_sim"}}), Names{"laser"});
  EXPECT_EQ(allowed_writers("", manifest), Names{});
  EXPECT_EQ(allowed_writers("local", manifest), Names{}) << "no word is a part of another";
}

TEST(WriterRight, TheFirstLiveWriterOfTheNameHoldsIt) {
  WriterRight right({"movement_control"});
  EXPECT_FALSE(right.holder());
  right.appeared(sighting(1), milliseconds(0));
  EXPECT_EQ(right.holder(), sighting(1).writer);
  EXPECT_EQ(right.foreign(), nullptr);
}

TEST(WriterRight, AnotherNameIsForeignAtOnceAndUntilItIsGone) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(2, "rogue"), milliseconds(0));
  EXPECT_FALSE(right.holder());
  ASSERT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.foreign()->participant, "rogue");
  right.appeared(sighting(1), milliseconds(5));
  EXPECT_EQ(right.holder(), sighting(1).writer);
  right.gone(sighting(2).writer);
  EXPECT_EQ(right.foreign(), nullptr);
  EXPECT_EQ(right.holder(), sighting(1).writer);
}

TEST(WriterRight, ASecondLiveClaimerIsForeign) {
  WriterRight right({"movement_control"}, milliseconds(50));
  right.appeared(sighting(1), milliseconds(0));
  right.appeared(sighting(2), milliseconds(1000));
  EXPECT_EQ(right.foreign(), nullptr) << "it may be the restart of a dead holder";
  right.alive(sighting(1).writer, milliseconds(1040));
  EXPECT_EQ(right.foreign(), nullptr) << "this sign of life may have been under way";
  right.alive(sighting(1).writer, milliseconds(1060));
  ASSERT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.foreign()->writer, sighting(2).writer);
  EXPECT_EQ(right.holder(), sighting(1).writer);
  right.gone(sighting(1).writer);
  EXPECT_FALSE(right.holder()) << "a claimer that lied does not inherit";
}

TEST(WriterRight, AReplacementWaitsUntilTheOldOneIsSeenDead) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(1), milliseconds(0));
  right.appeared(sighting(2), milliseconds(100));
  right.alive(sighting(2).writer, milliseconds(500));
  EXPECT_EQ(right.holder(), sighting(1).writer);
  right.gone(sighting(1).writer);
  EXPECT_EQ(right.holder(), sighting(2).writer);
  EXPECT_EQ(right.foreign(), nullptr);
}

TEST(WriterRight, ASilentHolderIsDoubtedOnlyWhileItsReplacementWaits) {
  WriterRight right({"movement_control"});
  constexpr Time kSilence = std::chrono::milliseconds(100);
  const auto at = [](int ms) { return Time(std::chrono::milliseconds(ms)); };
  EXPECT_FALSE(right.doubted(at(0), kSilence));
  right.appeared({WriterId{1}, "movement_control", "nuc"}, at(0));
  EXPECT_FALSE(right.doubted(at(500), kSilence)) << "silent, but who else";
  right.alive(WriterId{1}, at(500));
  right.appeared({WriterId{2}, "movement_control", "nuc"}, at(560));
  EXPECT_FALSE(right.doubted(at(590), kSilence));
  EXPECT_TRUE(right.doubted(at(600), kSilence));
  right.gone(WriterId{1});
  EXPECT_FALSE(right.doubted(at(900), kSilence));
}

TEST(WriterRight, OfSeveralReplacementsTheOldestIsNext) {
  WriterRight right({"movement_control"});
  for (std::uint8_t i = 1; i <= 3; ++i) right.appeared(sighting(i), milliseconds(i));
  right.gone(sighting(2).writer);
  right.gone(sighting(1).writer);
  EXPECT_EQ(right.holder(), sighting(3).writer);
}

TEST(WriterRight, AHolderThatReturnsIsSecond) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(1), milliseconds(0));
  right.gone(sighting(1).writer);
  right.appeared(sighting(2), milliseconds(100));
  right.appeared(sighting(1), milliseconds(200));
  EXPECT_EQ(right.holder(), sighting(2).writer);
  right.alive(sighting(2).writer, milliseconds(300));
  ASSERT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.foreign()->writer, sighting(1).writer);
}

TEST(WriterRight, RepeatedNewsChangesNothing) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(1), milliseconds(0));
  right.appeared(sighting(1), milliseconds(50));
  right.gone(sighting(7).writer);
  EXPECT_EQ(right.writers().size(), 1U);
  EXPECT_EQ(right.holder(), sighting(1).writer);
}

TEST(WriterRight, EachAllowedNameHasAHolder) {
  WriterRight right({"manual_control", "operator"});
  right.appeared(sighting(1, "manual_control"), milliseconds(0));
  right.appeared(sighting(2, "operator"), milliseconds(10));
  right.appeared(sighting(3, "operator"), milliseconds(20));
  right.appeared(sighting(4, "local_planner"), milliseconds(30));
  EXPECT_TRUE(right.holds(sighting(1).writer));
  EXPECT_TRUE(right.holds(sighting(2).writer));
  EXPECT_FALSE(right.holds(sighting(3).writer)) << "the second of its name waits";
  EXPECT_FALSE(right.holds(sighting(4).writer));
  right.alive(sighting(1).writer, milliseconds(500));
  EXPECT_EQ(right.foreign()->writer, sighting(4).writer) << "another name's life unmasks nobody";
  right.gone(sighting(1).writer);
  EXPECT_FALSE(right.holds(sighting(3).writer)) << "it inherits its own name's right only";
  right.gone(sighting(2).writer);
  EXPECT_TRUE(right.holds(sighting(3).writer));
}

TEST(WriterRight, OfTwoWhoLiveUnderOneNameNeitherIsTrusted) {
  WriterRight right({"local_planner"});
  right.appeared(sighting(1, "local_planner"), milliseconds(0));
  right.appeared(sighting(2, "local_planner"), milliseconds(1000));
  right.appeared(sighting(3, "stranger"), milliseconds(1000));
  EXPECT_TRUE(right.trusted(sighting(1).writer)) << "a stranger takes nobody's name";
  EXPECT_TRUE(right.trusted(sighting(2).writer)) << "it may be the restart of a dead holder";
  EXPECT_FALSE(right.trusted(sighting(3).writer));
  EXPECT_FALSE(right.trusted(sighting(4).writer)) << "never seen";
  right.alive(sighting(1).writer, milliseconds(1100));
  EXPECT_FALSE(right.trusted(sighting(1).writer));
  EXPECT_FALSE(right.trusted(sighting(2).writer));
  right.gone(sighting(1).writer);
  EXPECT_FALSE(right.trusted(sighting(2).writer)) << "it lied";
  right.appeared(sighting(5, "local_planner"), milliseconds(1200));
  EXPECT_FALSE(right.trusted(sighting(5).writer)) << "while the liar is there";
  right.gone(sighting(2).writer);
  EXPECT_TRUE(right.trusted(sighting(5).writer));
}

TEST(WriterRight, NobodyIsNoWriter) {
  WriterRight right({"movement_control"});
  right.appeared({kNobody, "movement_control", "nuc"}, milliseconds(0));
  EXPECT_FALSE(right.holder());
}

TEST(WriterRight, AFloodOfForeignWritersIsBounded) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(1), milliseconds(0));
  for (int i = 0; i < 10000; ++i) {
    WriterSighting rogue = sighting(200, "rogue");
    rogue.writer[14] = static_cast<std::uint8_t>(i >> 8);
    rogue.writer[15] = static_cast<std::uint8_t>(i);
    right.appeared(rogue, milliseconds(i));
  }
  EXPECT_LE(right.writers().size(), 64U);
  EXPECT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.holder(), sighting(1).writer);
}

TEST(WriterRight, OfAFloodNobodyIsForgottenBeforeHeIsGone) {
  WriterRight right({"movement_control"});
  right.appeared(sighting(1), milliseconds(0));
  const auto rogue = [](int i) {
    WriterSighting one = sighting(200, "rogue");
    one.writer[15] = static_cast<std::uint8_t>(i);
    return one;
  };
  for (int i = 0; i < 100; ++i) right.appeared(rogue(i), milliseconds(i));
  right.gone(sighting(1).writer);
  right.appeared(sighting(2), milliseconds(200));
  EXPECT_EQ(right.holder(), sighting(2).writer) << "a restart finds its place among them";
  for (int i = 0; i < 99; ++i) right.gone(rogue(i).writer);
  EXPECT_NE(right.foreign(), nullptr) << "one is left, listed or not";
  right.gone(rogue(99).writer);
  EXPECT_EQ(right.foreign(), nullptr);
}

}  // namespace
}  // namespace usher::drive
