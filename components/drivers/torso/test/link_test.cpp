#include "drivers/torso/core/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::torso {
namespace {

using std::chrono::milliseconds;

/// A board on the other end.
struct Bench {
  Link link;
  int now_ms = 0;
  std::uint8_t sequence = 0;
  bool speaks = true;
  State state;
  Hello hello{1, {1, 0, 0}, 42, 7, 2};
  std::vector<Reading> readings;
  std::vector<TorsoFrame> shown;
  int hello_requests = 0, heartbeats = 0;

  Bench() { link.opened(now()); }
  Time now() const { return milliseconds(now_ms); }
  void say(const BoardMessage& message) {
    link.received(to_frame(message).span(), now(),
                  [this](const Reading& reading) { readings.push_back(reading); });
  }
  void listen() {
    serial_frame::FrameDecoder decoder;
    decoder.feed(link.take_output(), [this](std::span<const std::uint8_t> content) {
      if (is_hello_request(content)) {
        ++hello_requests;
        state.status = static_cast<std::uint8_t>(state.status & ~kRebooted);
        if (speaks) say({sequence++, hello});
      } else if (const auto frame = parse_command(content)) {
        shown.push_back(*frame);
      } else {
        ++heartbeats;
      }
    });
  }
  void run(int ms) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 50;
      link.tick(now());
      listen();
      if (speaks && now_ms > 2000) say({sequence++, state});
    }
  }
};

TorsoFrame leaning(double tilt) {
  TorsoFrame frame;
  frame.joints[2] = tilt;
  return frame;
}

TEST(Link, GreetsThenReads) {
  Bench bench;
  bench.run(1900);
  EXPECT_EQ(bench.hello_requests, 0) << "the board is still starting";
  EXPECT_EQ(bench.link.reason(bench.now()), "waiting for the board");
  bench.state.frame = leaning(0.1);
  bench.run(1000);
  EXPECT_EQ(bench.hello_requests, 1);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "");
  ASSERT_FALSE(bench.readings.empty());
  EXPECT_NEAR(bench.readings.back().frame.joints[2], 0.1, 1e-4);
  EXPECT_TRUE(bench.readings.back().moves);
  EXPECT_EQ(bench.link.lost_messages(), 0U);
}

TEST(Link, ShowsEachFrameOnceAndFeedsTheWatchdogBetween) {
  Bench bench;
  bench.run(3000);
  const int before = bench.heartbeats;
  bench.run(1000);
  EXPECT_NEAR(bench.heartbeats - before, 10, 1);
  bench.link.show(leaning(0.2));
  bench.run(500);
  ASSERT_EQ(bench.shown.size(), 1U);
  EXPECT_NEAR(bench.shown[0].joints[2], 0.2, 1e-4);
  const int then = bench.heartbeats;
  for (int i = 0; i < 10; ++i) {
    bench.link.show(leaning(0.01 * i));
    bench.run(50);
  }
  EXPECT_EQ(bench.shown.size(), 11U);
  EXPECT_EQ(bench.heartbeats, then) << "frames are word enough";
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

TEST(Link, SilenceIsNoticed) {
  Bench bench;
  bench.run(3000);
  bench.speaks = false;
  bench.run(250);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  bench.run(50);
  EXPECT_FALSE(bench.link.healthy(bench.now()));
  EXPECT_EQ(bench.link.reason(bench.now()), "no word from the board");
  bench.speaks = true;
  bench.run(50);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
  bench.link.closed();
  EXPECT_EQ(bench.link.reason(bench.now()), "not connected");
}

TEST(Link, GreetsAgainAfterARestart) {
  Bench bench;
  bench.run(3000);
  bench.state.status = kRebooted;
  const std::size_t before = bench.readings.size();
  bench.run(50);
  EXPECT_EQ(bench.readings.size(), before) << "nobody knows yet what board that is";
  bench.run(200);
  EXPECT_EQ(bench.hello_requests, 2);
  EXPECT_GT(bench.readings.size(), before);
  EXPECT_TRUE(bench.link.healthy(bench.now()));
}

TEST(Link, RefusesAnotherBoard) {
  struct Row {
    Hello hello;
    const char* reason;
  };
  const Row rows[] = {
      {{2, {}, 0, 7, 2}, "expected protocol version 1, the board speaks 2"},
      {{1, {}, 0, 6, 2}, "expected 7 joints and 2 eyes, the board has 6 and 2"},
      {{1, {}, 0, 7, 0}, "expected 7 joints and 2 eyes, the board has 7 and 0"},
  };
  for (const Row& row : rows) {
    Bench bench;
    bench.hello = row.hello;
    bench.run(2500);
    bench.link.show(leaning(0.1));
    bench.run(500);
    EXPECT_EQ(bench.link.reason(bench.now()), row.reason);
    EXPECT_TRUE(bench.readings.empty());
    EXPECT_TRUE(bench.shown.empty());
  }
}

TEST(Link, ReportsTheBoardsTroubles) {
  struct Row {
    std::uint8_t status;
    const char* reason;
    bool moves;
  };
  const Row rows[] = {{kWatchdogExpired, "the board missed this host", false},
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

TEST(Link, CountsLostDamagedAndSenselessMessages) {
  Bench bench;
  bench.run(3000);
  bench.sequence = static_cast<std::uint8_t>(bench.sequence + 3);
  bench.run(50);
  EXPECT_EQ(bench.link.lost_messages(), 3U);
  const std::uint8_t senseless[] = {0x77, 0x01, 0x02};
  bench.link.received(serial_frame::encode(senseless).span(), bench.now(), [](const Reading&) {});
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
}  // namespace usher::torso
