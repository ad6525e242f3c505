#include "drivers/torso/core/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "drivers/serial_frame/core/emulated_board.hpp"

namespace usher::torso {
namespace {

using std::chrono::milliseconds;

/// A board on the other end.
struct Bench {
  Link link;
  serial_frame::EmulatedBoard board{{1, {1, 0, 0}, 42, {7, 2}}};
  int now_ms = 0;
  State state;
  std::vector<Reading> readings;
  std::vector<TorsoFrame> shown;

  Bench() { link.opened(now()); }
  Time now() const { return milliseconds(now_ms); }
  void say(std::span<const std::uint8_t> bytes) {
    link.received(bytes, now(), [this](const Reading& reading) { readings.push_back(reading); });
  }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      link.tick(now());
      say(board.hear(link.take_output(), [this](std::span<const std::uint8_t> content) {
        const auto frame = parse_command(content);
        ASSERT_TRUE(frame);
        shown.push_back(*frame);
      }));
      if (now_ms > 2000) say(to_frame({board.sequence++, state}).span());
    }
  }
};

TorsoFrame leaning(double tilt) {
  TorsoFrame frame;
  frame.joints[2] = tilt;
  return frame;
}

TEST(Link, SaysWhereTheTorsoIs) {
  Bench bench;
  bench.state.frame = leaning(0.1);
  bench.run(3000);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "");
  ASSERT_FALSE(bench.readings.empty());
  EXPECT_NEAR(bench.readings.back().frame.joints[2], 0.1, 1e-4);
  EXPECT_TRUE(bench.readings.back().moves);
}

TEST(Link, ShowsEachFrameOnce) {
  Bench bench;
  bench.run(3000);
  bench.link.show(leaning(0.2));
  bench.run(500);
  ASSERT_EQ(bench.shown.size(), 1U);
  EXPECT_NEAR(bench.shown[0].joints[2], 0.2, 1e-4);
}

TEST(Link, NeverShowsWhatIsNotFinite) {
  Bench bench;
  bench.run(3000);
  bench.link.show(leaning(std::nan("")));
  bench.run(200);
  EXPECT_TRUE(bench.shown.empty());
}

TEST(Link, KeepsNoFrameForABoardThatComesLater) {
  Bench bench;
  bench.link.show(leaning(0.3));
  bench.link.closed();
  bench.link.opened(bench.now());
  bench.run(3000);
  EXPECT_TRUE(bench.shown.empty()) << "an old frame would jerk the joints";
}

TEST(Link, ShowsNothingToAnotherBoard) {
  Bench bench;
  bench.board.hello.parts = {6, 2};
  bench.run(2500);
  bench.link.show(leaning(0.1));
  bench.run(500);
  EXPECT_EQ(bench.link.reason(bench.now()), "expected 7 joints and 2 eyes, the board has 6 and 2");
  EXPECT_TRUE(bench.readings.empty());
  EXPECT_TRUE(bench.shown.empty());
}

TEST(Link, ReportsTheBoardsTroubles) {
  struct Row {
    std::uint8_t status;
    const char* reason;
    bool moves;
  };
  const Row rows[] = {{serial_frame::kWatchdogExpired, "the board missed this host", false},
                      {kServosOff | kSupplyLow, "servos off, supply low", false},
                      {kJointStuck, "a joint is stuck", true}};
  for (const Row& row : rows) {
    Bench bench;
    bench.state.status = row.status;
    bench.run(3000);
    EXPECT_TRUE(bench.link.healthy(bench.now()));
    EXPECT_EQ(bench.link.reason(bench.now()), row.reason);
    EXPECT_EQ(bench.readings.back().moves, row.moves) << row.reason;
  }
}

TEST(Link, CountsMessagesWithoutSense) {
  Bench bench;
  bench.run(3000);
  const std::uint8_t senseless[] = {0x77, 0x01, 0x02};
  bench.say(serial_frame::encode(senseless).span());
  EXPECT_EQ(bench.link.dialogue().rejected(), 1U);
  EXPECT_EQ(bench.link.dialogue().lost_messages(), 0U);
}

}  // namespace
}  // namespace usher::torso
