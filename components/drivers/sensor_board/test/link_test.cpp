#include "drivers/sensor_board/core/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"

namespace usher::sensor_board {
namespace {

using std::chrono::milliseconds;

/// A board on the other end.
struct Bench {
  Link link;
  int now_ms = 0;
  std::uint8_t sequence = 0;
  bool speaks = true;
  Sensors sensors;
  Hello hello{1, {1, 0, 0}, 42, 5, 8};
  std::vector<Reading> readings;
  int hello_requests = 0, heartbeats = 0;
  std::vector<int> tilts;  ///< [0.1 deg]

  Bench() {
    sensors.ranges_mm.fill(2000);
    link.opened(now());
  }
  Time now() const { return milliseconds(now_ms); }
  void say(const BoardMessage& message) {
    const Frame frame = to_frame(message);
    link.received(frame.span(), now(),
                  [this](const Reading& reading) { readings.push_back(reading); });
  }
  void listen() {
    FrameDecoder decoder;
    decoder.feed(link.take_output(), [this](std::span<const std::uint8_t> content) {
      if (content[0] == 0x01) {
        ++hello_requests;
        if (speaks) say({sequence++, hello});
      }
      if (content[0] == 0x21) ++heartbeats;
      if (content[0] == 0x20) {
        tilts.push_back(static_cast<std::int16_t>(content[2] | (content[3] << 8)));
      }
    });
  }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      link.tick(now());
      listen();
      if (speaks && now_ms > 2000) say({sequence++, sensors});
    }
  }
};

TEST(Link, GreetsThenReads) {
  Bench bench;
  bench.run(1900);
  EXPECT_EQ(bench.hello_requests, 0) << "the board is still starting";
  EXPECT_EQ(bench.link.reason(bench.now()), "waiting for the board");
  bench.run(1000);
  EXPECT_EQ(bench.hello_requests, 1);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "");
  EXPECT_NEAR(bench.heartbeats, 10, 1);
  ASSERT_FALSE(bench.readings.empty());
  EXPECT_EQ(bench.readings.back().ranges[4], 2.0F);
  EXPECT_EQ(bench.link.lost_messages(), 0U);
}

TEST(Link, ConvertsCodesAndFilters) {
  Bench bench;
  bench.run(2500);
  bench.sensors.ranges_mm = {1270, 0xFFFF, 2540, 152, 0};
  bench.sensors.tilt = -150;
  bench.run(50);
  EXPECT_EQ(bench.readings.back().ranges[0], 2.0F) << "one echo alone is not believed";
  bench.run(150);
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
  bench.say({bench.sequence++, WhiskerChange{1, 0x04, 0x04}});
  ASSERT_EQ(bench.readings.size(), before + 1);
  EXPECT_TRUE(bench.readings.back().whiskers.front_right);
  EXPECT_EQ(bench.readings.back().stamp, bench.now());
  EXPECT_EQ(bench.readings.back().ranges[0], 2.0F);
}

TEST(Link, SilenceIsNoticed) {
  Bench bench;
  bench.run(3000);
  bench.speaks = false;
  bench.run(250);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  bench.run(50);
  EXPECT_FALSE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "no readings from the board");
  bench.speaks = true;
  bench.run(50);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  bench.link.closed();
  EXPECT_EQ(bench.link.reason(bench.now()), "not connected");
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

  bench.sequence = 0;
  bench.say({bench.sequence++, bench.hello});  // it restarted and says so
  bench.run(100);
  EXPECT_EQ(bench.tilts, (std::vector<int>{100, -200, -200}));
  bench.sensors.status = kRebooted;  // it restarted and its hello was lost
  bench.run(50);
  bench.sensors.status = 0;
  bench.run(200);
  EXPECT_EQ(bench.tilts, (std::vector<int>{100, -200, -200, -200}));
  EXPECT_EQ(bench.hello_requests, 2);
}

TEST(Link, RefusesAnotherBoard) {
  struct Row {
    Hello hello;
    const char* reason;
  };
  const Row rows[] = {
      {{2, {}, 0, 5, 8}, "expected protocol version 1, the board speaks 2"},
      {{1, {}, 0, 3, 8}, "expected 5 ultrasonic sensors and 8 switches, the board has 3 and 8"},
      {{1, {}, 0, 5, 4}, "expected 5 ultrasonic sensors and 8 switches, the board has 5 and 4"},
  };
  for (const Row& row : rows) {
    Bench bench;
    bench.hello = row.hello;
    bench.run(3000);
    EXPECT_EQ(bench.link.reason(bench.now()), row.reason);
    EXPECT_TRUE(bench.readings.empty());
  }
}

TEST(Link, ReportsTheBoardsTroubles) {
  Bench bench;
  bench.sensors.status = kServoOff | kSupplyLow;
  bench.run(3000);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "servo off, supply low");
}

TEST(Link, CountsLostDamagedAndSenselessMessages) {
  Bench bench;
  bench.run(3000);
  bench.sequence = static_cast<std::uint8_t>(bench.sequence + 3);
  bench.run(50);
  EXPECT_EQ(bench.link.lost_messages(), 3U);
  const std::uint8_t senseless[] = {0x77, 0x01, 0x02};
  bench.link.received(encode(senseless).span(), bench.now(), [](const Reading&) {});
  EXPECT_EQ(bench.link.rejected(), 1U);
  const std::uint8_t damaged[] = {0x05, 0x21, 0x02, 0x9A, 0x09, 0x00};
  bench.link.received(damaged, bench.now(), [](const Reading&) {});
  EXPECT_EQ(bench.link.damaged(), 1U);
}

TEST(Link, SurvivesNoise) {
  Random random(3);
  Bench bench;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> noise(random.below(400));
    for (auto& byte : noise) {
      byte = random.below(10) == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(random.below(256));
    }
    bench.link.received(noise, bench.now(), [](const Reading&) {});
  }
  const std::uint8_t end[] = {0};
  bench.link.received(end, bench.now(), [](const Reading&) {});
  bench.run(3000);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
}

}  // namespace
}  // namespace usher::sensor_board
