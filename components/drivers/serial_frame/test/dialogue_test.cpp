#include "drivers/serial_frame/core/dialogue.hpp"

#include <gtest/gtest.h>

#include "drivers/serial_frame/core/emulated_board.hpp"
#include "foundation/random/random.hpp"

namespace usher::serial_frame {
namespace {

using std::chrono::milliseconds;

constexpr std::array<Parts, 2> kParts{{{3, "wheels"}, {1, "bells"}}};
constexpr std::uint8_t kReadings = 0x10;

/// A dialogue with a board whose readings are their type, their sequence and the status.
struct Bench {
  Dialogue dialogue{{}, kParts};
  EmulatedBoard board{{1, {2, 3, 4}, 0xCAFEBABE, {3, 1}}};
  int now_ms = 0;
  bool speaks = true;
  std::uint8_t status = 0;
  int readings = 0;

  Bench() { dialogue.opened(now()); }
  Time now() const { return milliseconds(now_ms); }
  void say(std::span<const std::uint8_t> bytes) {
    dialogue.received(bytes, [this](std::span<const std::uint8_t> content) {
      if (content.size() != 3 || content[0] != kReadings) return dialogue.reject();
      dialogue.count(content[1]);
      if (dialogue.believes(content[2], now())) ++readings;
    });
  }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      dialogue.tick(now());
      const auto answer =
          board.hear(dialogue.take_output(), [](std::span<const std::uint8_t>) { FAIL(); });
      if (!speaks || now_ms < 2000) continue;
      say(answer);
      if (!answer.empty()) status &= static_cast<std::uint8_t>(~kRebooted);
      const std::uint8_t content[] = {kReadings, board.sequence++, status};
      say(encode(content).span());
    }
  }
  std::string reason() const { return dialogue.reason(now(), "no readings"); }
};

TEST(Dialogue, GreetsABoardThatHasBootedAndBelievesItThen) {
  Bench bench;
  bench.run(1900);
  EXPECT_EQ(bench.board.hello_requests, 0) << "the board is still starting";
  EXPECT_EQ(bench.reason(), "waiting for the board");
  bench.run(1000);
  EXPECT_EQ(bench.board.hello_requests, 1);
  EXPECT_TRUE(bench.dialogue.greeted());
  EXPECT_TRUE(bench.dialogue.healthy(bench.now()));
  EXPECT_EQ(bench.reason(), "");
  EXPECT_GT(bench.readings, 10);
  EXPECT_EQ(bench.dialogue.lost_messages(), 0U);
}

TEST(Dialogue, AsksABoardThatDoesNotAnswerAgain) {
  Bench bench;
  bench.speaks = false;
  bench.run(6500);
  EXPECT_EQ(bench.board.hello_requests, 3) << "at 2, 4 and 6 s";
  EXPECT_EQ(bench.reason(), "waiting for the board");
}

TEST(Dialogue, FeedsTheWatchdogTenTimesASecond) {
  Bench bench;
  bench.run(3000);
  const int before = bench.board.heartbeats;
  bench.run(1000);
  EXPECT_EQ(bench.board.heartbeats - before, 10);
}

TEST(Dialogue, NoticesSilenceAndAClosedLine) {
  Bench bench;
  bench.run(3000);
  bench.speaks = false;
  bench.run(250);
  EXPECT_TRUE(bench.dialogue.healthy(bench.now()));
  bench.run(50);
  EXPECT_FALSE(bench.dialogue.healthy(bench.now()));
  EXPECT_EQ(bench.reason(), "no readings");
  bench.speaks = true;
  bench.run(50);
  EXPECT_TRUE(bench.dialogue.healthy(bench.now()));
  bench.dialogue.closed();
  EXPECT_FALSE(bench.dialogue.healthy(bench.now()));
  EXPECT_EQ(bench.reason(), "not connected");
  const int before = bench.readings;
  bench.run(500);
  EXPECT_EQ(bench.readings, before);
}

TEST(Dialogue, GreetsABoardThatRestartedBeforeItBelievesIt) {
  Bench bench;
  bench.run(3000);
  const auto hellos = bench.dialogue.hellos();
  const int before = bench.readings;
  bench.status = kRebooted;
  bench.run(50);
  EXPECT_EQ(bench.readings, before) << "nobody knows yet what board that is";
  EXPECT_FALSE(bench.dialogue.healthy(bench.now()));
  bench.run(100);
  EXPECT_EQ(bench.board.hello_requests, 2);
  EXPECT_GT(bench.readings, before);
  EXPECT_EQ(bench.dialogue.hellos(), hellos + 1);
}

TEST(Dialogue, RefusesAnotherBoard) {
  struct Row {
    Hello hello;
    const char* reason;
  };
  const Row rows[] = {
      {{2, {}, 0, {3, 1}}, "expected protocol version 1, the board speaks 2"},
      {{1, {}, 0, {4, 1}}, "expected 3 wheels and 1 bells, the board has 4 and 1"},
      {{1, {}, 0, {3, 0}}, "expected 3 wheels and 1 bells, the board has 3 and 0"},
  };
  for (const Row& row : rows) {
    Bench bench;
    bench.board.hello = row.hello;
    bench.run(3000);
    EXPECT_EQ(bench.reason(), row.reason);
    EXPECT_FALSE(bench.dialogue.greeted());
    EXPECT_EQ(bench.readings, 0);
  }
}

TEST(Dialogue, CountsLostDamagedAndSenselessMessages) {
  Bench bench;
  bench.run(3000);
  bench.board.sequence = static_cast<std::uint8_t>(bench.board.sequence + 3);
  bench.run(50);
  EXPECT_EQ(bench.dialogue.lost_messages(), 3U);
  const std::uint8_t senseless[] = {0x77, 0x01, 0x02};
  bench.say(encode(senseless).span());
  EXPECT_EQ(bench.dialogue.rejected(), 1U);
  const std::uint8_t damaged[] = {0x05, 0x21, 0x02, 0x9A, 0x09, 0x00};
  bench.say(damaged);
  EXPECT_EQ(bench.dialogue.damaged(), 1U);
}

TEST(Dialogue, ReadsTheHelloThatItWrites) {
  const Hello hello{1, {2, 3, 4}, 0xDEADBEEF, {7, 2}};
  FrameDecoder decoder;
  int heard = 0;
  decoder.feed(to_frame(9, hello).span(), [&](std::span<const std::uint8_t> content) {
    const auto said = parse_hello(content);
    ASSERT_TRUE(said);
    EXPECT_EQ(content[1], 9);
    EXPECT_EQ(said->protocol_version, 1);
    EXPECT_EQ(said->firmware, hello.firmware);
    EXPECT_EQ(said->serial_number, 0xDEADBEEF);
    EXPECT_EQ(said->parts, hello.parts);
    EXPECT_FALSE(parse_hello(content.first(content.size() - 1)));
    EXPECT_FALSE(parse_hello({}));
    ++heard;
  });
  EXPECT_EQ(heard, 1);
}

TEST(Dialogue, SurvivesNoise) {
  Random random(3);
  Bench bench;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> noise(random.below(400));
    for (auto& byte : noise) {
      byte = random.below(10) == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(random.below(256));
    }
    bench.say(noise);
  }
  const std::uint8_t end[] = {0};
  bench.say(end);
  bench.run(3000);
  EXPECT_TRUE(bench.dialogue.healthy(bench.now()));
}

TEST(Describe, JoinsWhatTheBitsMean) {
  constexpr std::array<Trouble, 2> kTroubles{{{0x01, "one"}, {0x04, "three"}}};
  EXPECT_EQ(describe(0x00, kTroubles), "");
  EXPECT_EQ(describe(0x06, kTroubles), "three");
  EXPECT_EQ(describe(0xFF, kTroubles), "one, three");
}

}  // namespace
}  // namespace usher::serial_frame
