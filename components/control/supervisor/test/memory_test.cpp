#include "control/supervisor/core/memory.hpp"

#include <gtest/gtest.h>

#include "foundation/random/random.hpp"

namespace usher::supervisor {
namespace {

std::span<const std::uint8_t> bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Memory example() {
  Memory memory;
  memory.epoch = 4711;
  memory.stopped_by = {"operator", "guide"};
  memory.manual = true;
  memory.latched.push_back(
      {3, Time(123456789), Cause::kForeignWriter, "rogue", "writes drive/command", true});
  memory.latched.push_back({9, Time(-5), Cause::kEmergencyStop, "", "button", true});
  return memory;
}

TEST(Memory, ComesBackAsItWas) {
  const std::string text = to_text(example());
  const Result<Memory> back = memory_from_text(bytes(text));
  ASSERT_TRUE(back.ok()) << back.error();
  EXPECT_EQ(back->epoch, 4711U);
  EXPECT_EQ(back->stopped_by, (std::vector<std::string>{"operator", "guide"}));
  EXPECT_TRUE(back->manual);
  ASSERT_EQ(back->latched.size(), 2U);
  EXPECT_EQ(back->latched[0].id, 3U);
  EXPECT_EQ(back->latched[0].at, Time(123456789));
  EXPECT_EQ(back->latched[0].cause, Cause::kForeignWriter);
  EXPECT_EQ(back->latched[0].component, "rogue");
  EXPECT_EQ(back->latched[1].detail, "button");
  EXPECT_TRUE(back->latched[1].active);
}

TEST(Memory, NamesWithTabsAndNewlinesCannotForgeALine) {
  Memory memory;
  memory.latched.push_back({1, Time(0), Cause::kForeignWriter, "a\tb\nepoch\t9", "c\nd", true});
  const Result<Memory> back = memory_from_text(bytes(to_text(memory)));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->epoch, 0U);
  EXPECT_EQ(back->latched[0].component, "a b epoch 9");
}

TEST(Memory, RefusesWithLineAndExpectation) {
  const char* broken[] = {
      "",
      "usher supervisor memory 2\nepoch\t1\n",
      "usher supervisor memory 1\n",
      "usher supervisor memory 1\nepoch\t-1\n",
      "usher supervisor memory 1\nepoch\t99999999999999999999\n",
      "usher supervisor memory 1\nepoch\t1",
      "usher supervisor memory 1\nepoch\t1\nstop\toperator",
      "usher supervisor memory 1\nepoch\t1\nfault\t1\t2\n",
      "usher supervisor memory 1\nepoch\t1\nfault\t1\t2\t0\ta\tb\n",  // not a latching cause
      "usher supervisor memory 1\nepoch\t1\nfault\t1\t2\t9\ta\tb\n",
      "usher supervisor memory 1\nepoch\t1\nfault\t1\t2\t3\ta\tb",
  };
  for (const char* text : broken) {
    const Result<Memory> result = memory_from_text(bytes(text));
    ASSERT_FALSE(result.ok()) << text;
    EXPECT_NE(result.error().find("line"), std::string::npos);
    EXPECT_NE(result.error().find("expected"), std::string::npos);
  }
}

TEST(Memory, SurvivesAnyDamage) {
  Random random(5);
  const std::string text = to_text(example());
  for (int i = 0; i < 20000; ++i) {
    std::string damaged = text.substr(0, random.below(text.size() + 1));
    for (std::uint64_t k = random.below(4); k > 0 && !damaged.empty(); --k) {
      damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    }
    const Result<Memory> result = memory_from_text(bytes(damaged));
    if (result.ok()) {
      EXPECT_LE(result->latched.size(), 2U);
    }
  }
}

TEST(FaultLog, KeepsLatchedFaultsWhenItIsFull) {
  FaultLog log;
  log.raise(Cause::kForeignWriter, "rogue", "", Time(0));
  for (int i = 0; i < 200; ++i) {
    log.raise(Cause::kComponentLost, std::to_string(i), "silent", Time(i));
  }
  EXPECT_EQ(log.faults().size(), FaultLog::kCapacity);
  ASSERT_NE(log.latched(), nullptr);
  EXPECT_EQ(log.latched()->component, "rogue");
  log.raise(Cause::kEmergencyStop, "operator", "", Time(300));
  EXPECT_TRUE(log.active(Cause::kEmergencyStop)) << "a latched fault finds room";
  log.clear("operator", Time(70));
  EXPECT_EQ(log.latched(), nullptr);
  for (int i = 0; i < 200; ++i) {
    log.raise(Cause::kDisobeyingBase, std::to_string(i), "", Time(i));
  }
  EXPECT_LE(log.faults().size(), FaultLog::kCapacity);
  EXPECT_NE(log.latched(), nullptr);
}

TEST(FaultLog, AnEmergencyStopIsNeverLost) {
  FaultLog log;
  for (int i = 0; i < 200; ++i) log.raise(Cause::kForeignWriter, std::to_string(i), "", Time(i));
  log.raise(Cause::kEmergencyStop, "operator", "", Time(300));
  EXPECT_TRUE(log.active(Cause::kEmergencyStop));
  EXPECT_EQ(log.faults().size(), FaultLog::kCapacity);
}

TEST(FaultLog, NotesARepeatedFaultOnceAndAReturnAnew) {
  FaultLog log;
  log.raise(Cause::kComponentLost, "amcl", "silent", Time(1));
  log.raise(Cause::kComponentLost, "amcl", "silent", Time(2));
  EXPECT_EQ(log.faults().size(), 1U);
  log.settle(Cause::kComponentLost, "amcl", Time(60));
  EXPECT_FALSE(log.active(Cause::kComponentLost));
  log.raise(Cause::kComponentLost, "amcl", "silent", Time(3));
  ASSERT_EQ(log.faults().size(), 2U);
  EXPECT_GT(log.faults()[1].id, log.faults()[0].id);
}

TEST(FaultLog, LatchedFaultsDoNotSettle) {
  FaultLog log;
  log.raise(Cause::kForeignWriter, "rogue", "", Time(1));
  log.settle(Cause::kForeignWriter, "rogue", Time(60));
  EXPECT_NE(log.latched(), nullptr);
}

}  // namespace
}  // namespace usher::supervisor
