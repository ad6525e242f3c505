#include "control/supervisor/core/drive_right.hpp"

#include <gtest/gtest.h>

namespace usher::supervisor {
namespace {

using std::chrono::milliseconds;

WriterSighting sighting(std::uint8_t number, const char* participant = "movement_control") {
  return {{number, 9, 9}, participant, "nuc"};
}

TEST(DriveRight, TheFirstLiveWriterOfTheNameHoldsIt) {
  DriveRight right("movement_control");
  EXPECT_FALSE(right.holder());
  right.appeared(sighting(1), milliseconds(0));
  EXPECT_EQ(right.holder(), sighting(1).writer);
  EXPECT_EQ(right.foreign(), nullptr);
}

TEST(DriveRight, AnotherNameIsForeignAtOnceAndUntilItIsGone) {
  DriveRight right("movement_control");
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

TEST(DriveRight, ASecondLiveClaimerIsForeign) {
  DriveRight right("movement_control", milliseconds(50));
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

TEST(DriveRight, AReplacementWaitsUntilTheOldOneIsSeenDead) {
  DriveRight right("movement_control");
  right.appeared(sighting(1), milliseconds(0));
  right.appeared(sighting(2), milliseconds(100));
  right.alive(sighting(2).writer, milliseconds(500));
  EXPECT_EQ(right.holder(), sighting(1).writer);
  right.gone(sighting(1).writer);
  EXPECT_EQ(right.holder(), sighting(2).writer);
  EXPECT_EQ(right.foreign(), nullptr);
}

TEST(DriveRight, OfSeveralReplacementsTheOldestIsNext) {
  DriveRight right("movement_control");
  for (std::uint8_t i = 1; i <= 3; ++i) right.appeared(sighting(i), milliseconds(i));
  right.gone(sighting(2).writer);
  right.gone(sighting(1).writer);
  EXPECT_EQ(right.holder(), sighting(3).writer);
}

TEST(DriveRight, AHolderThatReturnsIsSecond) {
  DriveRight right("movement_control");
  right.appeared(sighting(1), milliseconds(0));
  right.gone(sighting(1).writer);
  right.appeared(sighting(2), milliseconds(100));
  right.appeared(sighting(1), milliseconds(200));
  EXPECT_EQ(right.holder(), sighting(2).writer);
  right.alive(sighting(2).writer, milliseconds(300));
  ASSERT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.foreign()->writer, sighting(1).writer);
}

TEST(DriveRight, RepeatedNewsChangesNothing) {
  DriveRight right("movement_control");
  right.appeared(sighting(1), milliseconds(0));
  right.appeared(sighting(1), milliseconds(50));
  right.gone(sighting(7).writer);
  EXPECT_EQ(right.writers(), 1U);
  EXPECT_EQ(right.holder(), sighting(1).writer);
}

TEST(DriveRight, NobodyIsNoWriter) {
  DriveRight right("movement_control");
  right.appeared({drive::kNobody, "movement_control", "nuc"}, milliseconds(0));
  EXPECT_FALSE(right.holder());
}

TEST(DriveRight, AFloodOfForeignWritersIsBounded) {
  DriveRight right("movement_control");
  right.appeared(sighting(1), milliseconds(0));
  for (int i = 0; i < 10000; ++i) {
    WriterSighting rogue = sighting(200, "rogue");
    rogue.writer[14] = static_cast<std::uint8_t>(i >> 8);
    rogue.writer[15] = static_cast<std::uint8_t>(i);
    right.appeared(rogue, milliseconds(i));
  }
  EXPECT_LE(right.writers(), 64U);
  EXPECT_NE(right.foreign(), nullptr);
  EXPECT_EQ(right.holder(), sighting(1).writer);
}

}  // namespace
}  // namespace usher::supervisor
