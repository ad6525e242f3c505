#include "drivers/sensor_board/core/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "drivers/serial_frame/core/emulated_board.hpp"
#include "foundation/geometry/angle.hpp"

namespace usher::sensor_board {
namespace {

using std::chrono::milliseconds;

/// A board on the other end.
struct Bench {
  Link link;
  serial_frame::EmulatedBoard board{{1, {1, 0, 0}, 42, {5, 8}}};
  int now_ms = 0;
  Sensors sensors;
  std::vector<Reading> readings;
  std::vector<int> tilts;  ///< [0.1 deg]

  Bench() {
    sensors.ranges_mm.fill(2000);
    link.opened(now());
  }
  Time now() const { return milliseconds(now_ms); }
  void say(std::span<const std::uint8_t> bytes) {
    link.received(bytes, now(), [this](const Reading& reading) { readings.push_back(reading); });
  }
  void say(const BoardMessage& message) { say(to_frame(message).span()); }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      link.tick(now());
      say(board.hear(link.take_output(), [this](std::span<const std::uint8_t> content) {
        ASSERT_EQ(content[0], 0x20);
        tilts.push_back(static_cast<std::int16_t>(content[2] | (content[3] << 8)));
      }));
      if (now_ms > 2000) say({board.sequence++, sensors});
    }
  }
};

TEST(Link, ConvertsCodes) {
  Bench bench;
  bench.run(2500);
  bench.sensors.ranges_mm = {1270, 0xFFFF, 2540, 152, 0};
  bench.sensors.tilt = -150;
  bench.run(50);
  const Reading& reading = bench.readings.back();
  EXPECT_FLOAT_EQ(reading.ranges[0], 1.27F);
  EXPECT_EQ(reading.ranges[1], std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(reading.ranges[2], 2.54F);
  EXPECT_FLOAT_EQ(reading.ranges[3], 0.152F);
  EXPECT_TRUE(std::isnan(reading.ranges[4]));
  EXPECT_NEAR(reading.tilt, geometry::radians(-15.0), 1e-9);
}

TEST(Link, EitherSwitchOfAWhiskerPressesItsCorner) {
  Bench bench;
  bench.run(2500);
  for (int bit = 0; bit < 8; ++bit) {
    bench.sensors.whisker_mask = static_cast<std::uint8_t>(1 << bit);
    bench.run(50);
    const Whiskers expected{bit / 2 == 0, bit / 2 == 1, bit / 2 == 2, bit / 2 == 3};
    EXPECT_EQ(bench.readings.back().whiskers, expected) << bit;
  }
  bench.sensors.whisker_mask = 0;
  bench.run(50);
  EXPECT_EQ(bench.readings.back().whiskers, Whiskers{});
}

TEST(Link, AWhiskerIsKnownAtOnce) {
  Bench bench;
  bench.run(2500);
  const std::size_t before = bench.readings.size();
  bench.now_ms += 3;
  bench.say({bench.board.sequence++, WhiskerChange{1, 0x04, 0x04}});
  ASSERT_EQ(bench.readings.size(), before + 1);
  EXPECT_TRUE(bench.readings.back().whiskers.front_right);
  EXPECT_EQ(bench.readings.back().stamp, bench.now());
  EXPECT_FALSE(bench.readings.back().measured) << "the ranges are of before";
  bench.run(50);
  EXPECT_TRUE(bench.readings.back().measured);
}

TEST(Link, AWhiskerOfABoardThatNobodyKnowsIsNone) {
  Bench bench;
  bench.run(2500);
  bench.sensors.status = serial_frame::kRebooted;
  bench.say({bench.board.sequence++, bench.sensors});
  const std::size_t before = bench.readings.size();
  bench.say({bench.board.sequence++, WhiskerChange{1, 0x04, 0x04}});
  EXPECT_EQ(bench.readings.size(), before);
}

TEST(Link, SetsTheTiltOnceAndAgainAfterARestart) {
  Bench bench;
  bench.link.set_tilt(geometry::radians(10.0));
  bench.run(3000);
  bench.link.set_tilt(geometry::radians(10.0));
  bench.run(500);
  EXPECT_EQ(bench.tilts, std::vector<int>{100});
  bench.link.set_tilt(geometry::radians(-90.0));
  bench.run(100);
  EXPECT_EQ(bench.tilts, (std::vector<int>{100, -200})) << "clipped to its limit";
  bench.link.set_tilt(std::nan(""));
  bench.run(100);
  EXPECT_EQ(bench.tilts.size(), 2U);

  bench.board.sequence = 0;
  bench.say(serial_frame::to_frame(bench.board.sequence++, bench.board.hello).span());
  bench.run(100);
  EXPECT_EQ(bench.tilts, (std::vector<int>{100, -200, -200})) << "it restarted and said so";
  bench.sensors.status = serial_frame::kRebooted;  // it restarted and its hello was lost
  bench.run(50);
  bench.sensors.status = 0;
  bench.run(200);
  EXPECT_EQ(bench.tilts, (std::vector<int>{100, -200, -200, -200}));
  EXPECT_EQ(bench.board.hello_requests, 2);
}

TEST(Link, RefusesAnotherBoard) {
  Bench bench;
  bench.board.hello.parts = {3, 8};
  bench.run(3000);
  EXPECT_EQ(bench.link.reason(bench.now()),
            "expected 5 ultrasonic sensors and 8 switches, the board has 3 and 8");
  EXPECT_TRUE(bench.readings.empty());
}

TEST(Link, ReportsTheBoardsTroubles) {
  Bench bench;
  bench.sensors.status = kServoOff | kSupplyLow;
  bench.run(3000);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "servo off, supply low");
}

TEST(Link, NamesASensorThatDoesNotAnswer) {
  Bench bench;
  bench.run(3000);
  bench.sensors.ranges_mm[2] = 0;
  bench.run(950);
  EXPECT_EQ(bench.link.reason(bench.now()), "") << "not yet";
  bench.run(50);
  EXPECT_EQ(bench.link.reason(bench.now()), "ultrasonic sensor 3 does not answer");
  bench.sensors.status = kSupplyLow;
  bench.sensors.ranges_mm[4] = 0;
  bench.run(1000);
  EXPECT_EQ(bench.link.reason(bench.now()),
            "supply low, ultrasonic sensor 3 does not answer, ultrasonic sensor 5 does not answer");
  bench.sensors.status = 0;
  bench.sensors.ranges_mm[2] = bench.sensors.ranges_mm[4] = 0xFFFF;
  bench.run(50);
  EXPECT_EQ(bench.link.reason(bench.now()), "") << "no echo is an answer";
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
}  // namespace usher::sensor_board
