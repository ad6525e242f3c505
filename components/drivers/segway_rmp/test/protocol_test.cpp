#include "drivers/segway_rmp/core/protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/segway_rmp/core/link.hpp"
#include "drivers/segway_rmp/core/status.hpp"
#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"
#include "support/bytes.hpp"
#include "support/data.hpp"

namespace usher::segway_rmp {
namespace {

using std::chrono::milliseconds;
using test::Bytes;
using test::hex;

Bytes unhex(const std::string& digits) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::vector<Packet> decode(PacketDecoder& decoder, const Bytes& stream, std::size_t piece = 62) {
  std::vector<Packet> packets;
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    decoder.feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)),
                 [&](const Packet& packet) { packets.push_back(packet); });
  }
  return packets;
}

void append(Bytes& stream, const PacketBytes& packet) {
  stream.insert(stream.end(), packet.begin(), packet.end());
}

TEST(UsbPacket, MatchesTheWorkedExamples) {
  const Calibration calibration;
  Calibration by_degree;
  by_degree.command_counts_per_turn_rate = 7.8 * 180.0 / geometry::kPi;
  EXPECT_EQ(hex(command({}, calibration)), "F0 55 00 00 00 00 04 13 00 00 00 00 00 00 00 00 00 A3");
  EXPECT_EQ(hex(command({1.0, 0.0}, calibration)),
            "F0 55 00 00 00 00 04 13 00 01 49 00 00 00 00 00 00 59");
  EXPECT_EQ(hex(command({-0.5, geometry::radians(15.0)}, by_degree)),
            "F0 55 00 00 00 00 04 13 00 FF 5C 00 75 00 00 00 00 D1");
  EXPECT_EQ(hex(command({}, calibration, Setting::kResetIntegrators, 0x0F)),
            "F0 55 00 00 00 00 04 13 00 00 00 00 00 00 32 00 0F 62");
  EXPECT_EQ(hex(command({}, calibration, Setting::kOperationalMode, kModeBalance)),
            "F0 55 00 00 00 00 04 13 00 00 00 00 00 00 10 00 02 91");
  EXPECT_EQ(hex(command({}, calibration, Setting::kOperationalMode, kModeTractor)),
            "F0 55 00 00 00 00 04 13 00 00 00 00 00 00 10 00 01 92");
  EXPECT_EQ(hex(shutdown()), "F0 55 00 00 00 00 04 12 00 00 00 00 00 00 00 00 00 A4");
}

TEST(UsbPacket, ClipsAndRefusesNonsense) {
  const Calibration calibration;
  EXPECT_EQ(hex(command({99.0, -99.0}, calibration)).substr(27, 11), "04 98 FC 00");
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(command({value, 0.5}, calibration), command({}, calibration));
    EXPECT_EQ(command({0.5, value}, calibration), command({}, calibration));
  }
}

TEST(UsbPacket, CountsACommandAsTheBaseIsCalibrated) {
  Calibration other;
  other.command_counts_per_speed = 332.0;
  other.command_counts_per_turn_rate = 333.0;
  EXPECT_EQ(hex(command({1.0, 0.6}, Calibration{})).substr(27, 11), "01 49 01 0C");
  EXPECT_EQ(hex(command({1.0, 0.6}, other)).substr(27, 11), "01 4C 00 C8");
  other.command_turn_sign = -1.0;
  EXPECT_EQ(hex(command({1.0, 0.6}, other)).substr(27, 11), "01 4C FF 38");
  EXPECT_EQ(command({}, other), command({}, Calibration{})) << "zero is zero";
}

TEST(UsbPacket, DecodesWhatItEncodes) {
  Random random(1);
  Bytes stream;
  std::vector<Packet> sent;
  for (int i = 0; i < 500; ++i) {
    Packet packet;
    packet.channel_b = random.below(2) == 0;
    packet.id = static_cast<std::uint16_t>(random.below(0x800));
    for (auto& slot : packet.slots) slot = static_cast<std::uint16_t>(random.below(65536));
    sent.push_back(packet);
    append(stream, from_base(packet));
  }
  for (const std::size_t piece : {1U, 17U, 62U, 4096U}) {
    PacketDecoder decoder;
    EXPECT_EQ(decode(decoder, stream, piece), sent);
    EXPECT_EQ(decoder.skipped_bytes(), 0U);
  }
}

TEST(UsbPacket, ADamagedPacketCostsOnlyItself) {
  Random random(2);
  int lost = 0;
  int hits = 0;
  for (int run = 0; run < 200; ++run) {
    Bytes stream;
    for (std::uint16_t i = 0; i < 100; ++i)
      append(stream, from_base({false, kIdPitch, {i, 1, 2, 3}}));
    const auto damage = static_cast<int>(random.below(6));
    for (int i = 0; i < damage; ++i) {
      const auto at = static_cast<std::ptrdiff_t>(random.below(stream.size()));
      switch (random.below(3)) {
        case 0:
          stream[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1 + random.below(255));
          break;
        case 1:
          stream.erase(stream.begin() + at);
          break;
        default:
          stream.insert(stream.begin() + at, static_cast<std::uint8_t>(random.below(256)));
      }
    }
    PacketDecoder decoder;
    std::vector<bool> found(100, false);
    for (const Packet& packet : decode(decoder, stream)) {
      if (packet.id == kIdPitch && packet.slots[0] < 100 && packet.slots[3] == 3) {
        found[packet.slots[0]] = true;
      }
    }
    lost += static_cast<int>(std::count(found.begin(), found.end(), false));
    hits += damage;
  }
  EXPECT_LE(lost, hits);
  EXPECT_GT(lost, hits / 2);
}

struct Cycle {
  std::int16_t pitch = 0, pitch_rate = 0;
  std::int16_t left_speed = 0, right_speed = 0, yaw_rate = 0;
  std::int32_t left = 0, right = 0;
  std::uint16_t mode = kModeBalance;
  std::uint16_t status_1 = kMotorsEnabled | kBalanceMode, status_2 = 0;
  std::uint16_t volts_times_4 = 312;
};

std::vector<Packet> cycle_packets(const Cycle& cycle, bool channel_b = false) {
  const auto u = [](int value) { return static_cast<std::uint16_t>(value & 0xFFFF); };
  return {
      {channel_b, kIdPitch, {u(cycle.pitch), u(cycle.pitch_rate), 0, 0}},
      {channel_b, kIdVelocity, {u(cycle.left_speed), u(cycle.right_speed), u(cycle.yaw_rate), 0}},
      {channel_b,
       kIdWheels,
       {u(cycle.left), u(cycle.left >> 16), u(cycle.right), u(cycle.right >> 16)}},
      {channel_b, kIdTorque, {0, 0, 0, 0}},
      {channel_b, kIdMode, {cycle.mode, 1, 0x27A, cycle.volts_times_4}},
      {channel_b, kIdStatus, {0, cycle.status_1, cycle.status_2, 0}},
      {channel_b, kIdEcho, {0, 0, 0, 0}},
  };
}

std::optional<SegwayFeedback> take(FeedbackAssembler& assembler, const std::vector<Packet>& packets,
                                   Time now = Time(0)) {
  std::optional<SegwayFeedback> last;
  for (const Packet& packet : packets) {
    if (const auto feedback = assembler.take(packet, now)) last = feedback;
  }
  return last;
}

TEST(Feedback, ConvertsTheRecordedPayloads) {
  USHER_REQUIRE_DATA(path, "hw/segway_rmp/can_payloads_with_expected.csv");
  std::ifstream in(path);
  FeedbackAssembler assembler{Calibration{}};
  PacketDecoder decoder;
  int lines = 0;
  Packet wheels;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    ++lines;
    const Bytes frame = unhex(line.substr(line.find_last_of(',') + 1, 36));
    const auto packets = decode(decoder, frame);
    ASSERT_EQ(packets.size(), 1U) << line;
    EXPECT_EQ(packets[0].id, std::stoul(line.substr(0, 4), nullptr, 16));
    EXPECT_EQ(hex(from_base(packets[0])), hex(frame));
    if (packets[0].id == kIdWheels) wheels = packets[0];
    assembler.take(packets[0], Time(0));
  }
  EXPECT_EQ(lines, 6);
  EXPECT_EQ(wheels.counter(0), -506);
  EXPECT_EQ(wheels.counter(2), 79);
  const auto feedback = assembler.take({false, kIdEcho, {}}, milliseconds(10));
  ASSERT_TRUE(feedback);
  EXPECT_EQ(feedback->stamp, milliseconds(10));
  EXPECT_NEAR(geometry::degrees(feedback->pitch), -0.897, 1e-3);
  EXPECT_NEAR(geometry::degrees(feedback->pitch_rate), 1.923, 1e-3);
  EXPECT_NEAR(geometry::degrees(feedback->roll), -0.128, 1e-3);
  EXPECT_NEAR(geometry::degrees(feedback->roll_rate), 1.154, 1e-3);
  EXPECT_NEAR(feedback->left_velocity, 0.0361, 1e-4);
  EXPECT_NEAR(feedback->right_velocity, -0.0422, 1e-4);
  EXPECT_NEAR(geometry::degrees(feedback->yaw_rate), 9.6154, 1e-3);
  EXPECT_NEAR(feedback->left_torque, -0.006399, 1e-5);
  EXPECT_NEAR(feedback->right_torque, 0.152651, 1e-5);
  EXPECT_NEAR(feedback->battery_percent, 100.0, 1e-9);
  EXPECT_EQ(assembler.operational_mode(), kModeTractor);
  EXPECT_EQ(feedback->mode, Mode::kStandby) << "a tractor does not balance";
}

TEST(Feedback, TravelWrapsNeverAndJumpsNever) {
  FeedbackAssembler assembler{Calibration{}};
  Cycle cycle;
  cycle.left = cycle.right = std::numeric_limits<std::int32_t>::max() - 1000;
  auto feedback = take(assembler, cycle_packets(cycle));
  ASSERT_TRUE(feedback);
  const double start = feedback->left_travel;
  EXPECT_NEAR(start, cycle.left / 33215.0, 1e-9) << "the base's own count";
  cycle.left = cycle.right = std::numeric_limits<std::int32_t>::min() + 2321;  // 3322 counts on
  feedback = take(assembler, cycle_packets(cycle));
  ASSERT_TRUE(feedback);
  EXPECT_NEAR(feedback->left_travel - start, 3322.0 / 33215.0, 1e-9);
  cycle.left = cycle.right = 0;  // the integrators were reset
  feedback = take(assembler, cycle_packets(cycle));
  EXPECT_NEAR(feedback->left_travel - start, 3322.0 / 33215.0, 1e-9);
  EXPECT_EQ(assembler.counter_jumps(), 1U);
  cycle.left = 332;
  feedback = take(assembler, cycle_packets(cycle));
  EXPECT_NEAR(feedback->left_travel - start, (3322.0 + 332.0) / 33215.0, 1e-9);
  EXPECT_NEAR(feedback->right_travel - start, 3322.0 / 33215.0, 1e-9);
}

TEST(Feedback, TravelGoesOnWhereTheLineWasOpenedAnew) {
  FeedbackAssembler assembler{Calibration{}};
  Cycle cycle;
  take(assembler, cycle_packets(cycle));
  cycle.left = cycle.right = 33215;
  assembler.reopened();
  const auto feedback = take(assembler, cycle_packets(cycle));
  ASSERT_TRUE(feedback);
  EXPECT_NEAR(feedback->left_travel, 1.0 - Cycle{}.left / 33215.0, 1e-9);
}

TEST(Feedback, FollowsOneChannelAndChangesWhenItFallsSilent) {
  FeedbackAssembler assembler{Calibration{}};
  Cycle cycle;
  int whole = 0;
  for (int i = 0; i < 10; ++i) {
    whole += take(assembler, cycle_packets(cycle, false)) ? 1 : 0;
    whole += take(assembler, cycle_packets(cycle, true)) ? 1 : 0;
  }
  EXPECT_EQ(whole, 10);
  for (int i = 0; i < 10; ++i) whole += take(assembler, cycle_packets(cycle, true)) ? 1 : 0;
  EXPECT_GE(whole, 16) << "B took over";
  EXPECT_LE(assembler.incomplete_cycles(), 1U);
}

TEST(Feedback, AnIncompleteCycleIsNone) {
  for (const std::uint16_t missing : {kIdPitch, kIdVelocity, kIdWheels}) {
    FeedbackAssembler assembler{Calibration{}};
    auto packets = cycle_packets({});
    std::erase_if(packets, [&](const Packet& packet) { return packet.id == missing; });
    EXPECT_FALSE(take(assembler, packets));
    EXPECT_EQ(assembler.incomplete_cycles(), 1U);
    EXPECT_TRUE(take(assembler, cycle_packets({})));
  }
}

struct StatusRow {
  std::uint16_t word_1, word_2;
  Severity severity;
  bool balancing, emergency;
  const char* text;
};

TEST(Status, MeansWhatTheBitsSay) {
  const StatusRow rows[] = {
      {0x0080, 0, Severity::kOk, false, false, ""},
      {0x0180, 0, Severity::kOk, true, false, ""},
      {0x0100, 0, Severity::kOk, false, false, ""},
      {0x4180, 0, Severity::kWarning, true, false, "low battery hazard"},
      {0x1190, 0, Severity::kWarning, true, false, "wheel slip"},
      {0x0040, 0, Severity::kError, false, false, "system integrity fault"},
      {0x0005, 0, Severity::kError, false, false, "safety shutdown 1, safety shutdown 2"},
      {0x0180, 0x0002, Severity::kError, true, true, "emergency stop open"},
      {0x0180, 0x0200, Severity::kError, true, true, "emergency stop open"},
      {0x0180, 0x4001, Severity::kError, true, false, "pitch limit, roll limit"},
  };
  for (const StatusRow& row : rows) {
    const StatusReport status = report(row.word_1, row.word_2);
    EXPECT_EQ(status.severity, row.severity) << row.text;
    EXPECT_EQ(status.balancing, row.balancing) << row.text;
    EXPECT_EQ(status.emergency_stop_open, row.emergency) << row.text;
    EXPECT_EQ(status.text, row.text);
  }
}

/// A base that keeps what it is told.
struct Base {
  std::map<std::uint16_t, std::uint16_t> settings;
  std::int16_t speed = 0, turn = 0;
  bool off = false;
  bool lies = false;  ///< and does not balance, whatever it is told
  int shutdowns = 0;
  Cycle cycle;

  void hear(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return;
    ASSERT_EQ(bytes.size(), kPacketSize);
    const auto word = [&](std::size_t i) {
      return static_cast<std::uint16_t>((bytes[i] << 8) | bytes[i + 1]);
    };
    if (word(6) == kIdShutdown) off = true, ++shutdowns;
    if (word(6) != kIdCommand) return;
    speed = static_cast<std::int16_t>(word(9));
    turn = static_cast<std::int16_t>(word(11));
    if (word(13) != 0) settings[word(13)] = word(15);
    if (word(13) == 16 && word(15) == kModeBalance && !lies) off = false;
    cycle.status_1 = off ? 0 : kMotorsEnabled | kBalanceMode;
  }
  Bytes speak(const std::vector<std::uint16_t>& damaged = {}) const {
    Bytes stream;
    for (const bool channel_b : {false, true}) {
      for (const Packet& packet : cycle_packets(cycle, channel_b)) {
        if (std::find(damaged.begin(), damaged.end(), packet.id) == damaged.end())
          append(stream, from_base(packet));
      }
    }
    return stream;
  }
};

struct Bench {
  Link link;
  Base base;
  int now_ms = 0;
  int feedbacks = 0;
  bool base_speaks = true;
  std::vector<std::uint16_t> damaged{};  ///< frames that do not arrive

  Bench() { link.opened(now()); }
  Time now() const { return milliseconds(now_ms); }
  void run(int ms, const geometry::Twist2& wanted = {}) {
    for (const int end = now_ms + ms; now_ms < end;) {
      now_ms += 10;
      base.hear(link.cycle(wanted, now()));
      if (base_speaks) {
        link.received(base.speak(damaged), now(), [this](const SegwayFeedback&) { ++feedbacks; });
      }
    }
  }
};

TEST(Link, ConfiguresThenDrives) {
  Bench bench;
  bench.run(100, {1.0, 0.0});
  EXPECT_EQ(bench.base.speed, 0) << "not before it is configured";
  EXPECT_EQ(bench.feedbacks, 0) << "the first bytes are old";
  bench.run(300, {1.0, 0.0});
  const std::map<std::uint16_t, std::uint16_t> expected{{10, 16}, {11, 8}, {12, 16},
                                                        {13, 1},  {15, 0}, {16, 2}};
  EXPECT_EQ(bench.base.settings, expected);
  EXPECT_EQ(bench.base.speed, 329);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
  EXPECT_EQ(bench.link.reason(), "");
  EXPECT_EQ(bench.feedbacks, 16);
}

TEST(Link, EmergencyHoldsUntilReset) {
  Bench bench;
  bench.run(500, {1.0, 0.0});
  bench.link.emergency_stop();
  bench.run(100, {1.0, 0.0});
  EXPECT_TRUE(bench.base.off);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  EXPECT_EQ(bench.link.reason(), "emergency stop");
  bench.run(5000, {1.0, 0.0});
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  bench.link.reset();
  bench.run(500, {0.5, 0.0});
  EXPECT_FALSE(bench.base.off);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
  EXPECT_EQ(bench.base.speed, 164);
}

TEST(Link, ABaseThatFellDoesNotGetUpByItself) {
  Bench bench;
  bench.run(500, {1.0, 0.0});
  bench.base.off = true;
  bench.run(20, {1.0, 0.0});
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  bench.link.closed();
  bench.run(500);
  bench.link.opened(bench.now());  // somebody sees to the cable
  bench.run(3000, {1.0, 0.0});
  EXPECT_TRUE(bench.base.off);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  EXPECT_TRUE(bench.link.emergency()) << "to be remembered over a restart";
  bench.link.reset();
  bench.run(500, {0.5, 0.0});
  EXPECT_FALSE(bench.base.off);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
}

TEST(Link, ABaseThatWentOffWhileItsLineWasOutStaysOff) {
  Bench bench;
  bench.run(500, {1.0, 0.0});
  bench.link.closed();
  bench.base.off = true;
  bench.run(500);
  bench.link.opened(bench.now());
  bench.run(3000, {1.0, 0.0});
  EXPECT_TRUE(bench.base.off);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  bench.link.reset();
  bench.run(500, {0.5, 0.0});
  EXPECT_FALSE(bench.base.off);
  EXPECT_EQ(bench.base.speed, 164);
}

TEST(Link, ABaseThatWasNotUprightYetIsAskedAgainToBalance) {
  Bench bench;
  bench.link.balanced_before();
  bench.base.off = true;
  bench.run(400);  // switched on in the morning
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  EXPECT_EQ(bench.base.shutdowns, 0) << "who is off is not switched off";
  bench.base.lies = true;
  bench.link.reset();
  bench.run(1000);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kStandby);
  bench.base.lies = false;
  bench.run(1000);
  EXPECT_TRUE(bench.base.off) << "not by itself";
  bench.link.reset();
  bench.run(500, {0.5, 0.0});
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
  EXPECT_EQ(bench.base.speed, 164);
}

TEST(Link, ABaseThatStillBalancesIsConfiguredAnewWhenItsLineIsBack) {
  Bench bench;
  bench.run(500);
  const auto settings = bench.base.settings;
  bench.link.closed();
  bench.base.settings.clear();
  bench.run(500);
  bench.link.opened(bench.now());
  bench.run(200, {0.5, 0.0});
  EXPECT_TRUE(bench.base.settings.empty()) << "not before it says that it balances";
  EXPECT_EQ(bench.base.speed, 0);
  bench.run(500, {0.5, 0.0});
  EXPECT_EQ(bench.base.settings, settings);
  EXPECT_EQ(bench.base.speed, 164);
}

// The driver before this one ended while the base drove along a bend.
TEST(Link, ABaseThatStillRollsKeepsItsArcWhileItIsConfigured) {
  Bench bench;
  bench.link.balanced_before();
  bench.base.cycle.status_1 = kMotorsEnabled | kBalanceMode;
  bench.run(240, {0.0, 0.5});
  EXPECT_EQ(bench.base.turn, 0) << "not before it says that it balances";
  bench.run(60, {0.0, 0.5});
  EXPECT_FALSE(bench.link.configured());
  EXPECT_NE(bench.base.turn, 0);
  bench.run(50, {0.5, 0.5});
  EXPECT_FALSE(bench.link.configured());
  EXPECT_EQ(bench.base.turn, 0) << "it does not drive before it is configured";
  EXPECT_EQ(bench.base.speed, 0);
}

TEST(Link, ABaseThatNoLongerSaysWhetherItBalancesIsNotHeard) {
  Bench bench;
  bench.run(500);
  bench.damaged = {kIdStatus};
  bench.run(90);
  const int before = bench.feedbacks;
  bench.run(1100);
  EXPECT_EQ(bench.feedbacks, before) << "its mode alone is not believed: it told a status before";
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kDisconnected);
  bench.base.off = true;
  bench.damaged = {};
  bench.run(50);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency) << "it fell meanwhile";
}

TEST(Link, DamagedFramesAfterOpeningAreNoFall) {
  Bench bench;
  bench.link.balanced_before();
  bench.base.off = false;
  for (int opening = 0; opening < 2; ++opening) {
    bench.damaged = {kIdMode, kIdStatus};
    bench.run(260);
    EXPECT_EQ(bench.link.mode(bench.now()), Mode::kDisconnected) << "it has not said what it does";
    bench.damaged = {kIdStatus};
    bench.run(20);
    EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
    bench.damaged = {};
    bench.run(500);
    EXPECT_FALSE(bench.base.off);
    EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
    bench.link.closed();
    bench.run(100);
    bench.link.opened(bench.now());
  }
}

TEST(Link, NoticesASilentBase) {
  Bench bench;
  bench.run(500);
  bench.base_speaks = false;
  bench.run(980);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
  bench.run(40);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kDisconnected);
  EXPECT_EQ(bench.link.reason(), "no feedback from the base");
  bench.base_speaks = true;
  bench.run(20);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kBalancing);
  bench.link.closed();
  EXPECT_TRUE(bench.link.cycle({1.0, 0.0}, bench.now()).empty());
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kDisconnected);
}

TEST(Link, ConfiguresABaseAnewThatWasAway) {
  Bench bench;
  bench.run(500);
  const auto settings = bench.base.settings;
  bench.base_speaks = false;
  bench.base.settings.clear();  // somebody switches it off and on
  bench.run(1500);
  EXPECT_TRUE(bench.base.settings.empty());
  bench.base_speaks = true;
  bench.run(500, {0.5, 0.0});
  EXPECT_EQ(bench.base.settings, settings);
  EXPECT_EQ(bench.base.speed, 164);
}

TEST(Link, ReportsTheEmergencyButtonOfTheBase) {
  Bench bench;
  bench.run(500);
  bench.base.cycle.status_2 = kEmergencyStopOpen;
  bench.run(20);
  EXPECT_EQ(bench.link.mode(bench.now()), Mode::kEmergency);
  EXPECT_EQ(bench.link.reason(), "emergency stop open");
}

}  // namespace
}  // namespace usher::segway_rmp
