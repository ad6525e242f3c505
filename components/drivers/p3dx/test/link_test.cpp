#include "drivers/p3dx/core/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::p3dx {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::string digits;
  for (const char c : text)
    if (std::isxdigit(static_cast<unsigned char>(c)) != 0) digits.push_back(c);
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

void append(Bytes& bytes, const Bytes& more) {
  for (const std::uint8_t byte : more) bytes.push_back(byte);
}

Bytes bytes_of(const Frame& frame) { return {frame.span().begin(), frame.span().end()}; }

/// A report as the controller sends it.
Bytes report(int x, int y, int heading, int left, int right, bool motors,
             std::uint8_t type = 0x32) {
  Bytes b = {type};
  const auto u16 = [&](int v) {
    b.push_back(static_cast<std::uint8_t>(v & 0xFF));
    b.push_back(static_cast<std::uint8_t>(v >> 8 & 0xFF));
  };
  for (const int v : {x, y, heading, left, right}) u16(v);
  b.push_back(120);
  for (const int v : {0, 0, motors ? 1 : 0}) u16(v);
  append(b, {0, 1, 3});
  u16(1500);
  append(b, {0, 0, 0, 0, 0});
  Bytes packet = {0xFA, 0xFB, static_cast<std::uint8_t>(b.size() + 2)};
  append(packet, b);
  const std::uint16_t sum = checksum(b);
  packet.push_back(static_cast<std::uint8_t>(sum >> 8));
  packet.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  return packet;
}

TEST(Packet, CommandsAreThoseOfTheManualToTheByte) {
  USHER_REQUIRE_DATA(path, "hw/p3dx/command_examples.hex");
  std::map<std::string, Bytes> examples;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name, hex;
    if (line[0] != '#' && words >> name >> hex) examples[name] = from_hex(hex);
  }
  EXPECT_EQ(bytes_of(encode(Command::kPulse)), examples.at("SYNC0"));
  EXPECT_EQ(bytes_of(encode(Command::kOpen)), examples.at("SYNC1"));
  EXPECT_EQ(bytes_of(encode(Command::kClose)), examples.at("SYNC2"));
  EXPECT_EQ(bytes_of(encode(Command::kEnable, 1)), examples.at("ENABLE_1"));
  EXPECT_EQ(bytes_of(encode(Command::kEnable, 0)), examples.at("ENABLE_0"));
  EXPECT_EQ(bytes_of(encode(Command::kVelocity, 200)), examples.at("VEL_200"));
  EXPECT_EQ(bytes_of(encode(Command::kVelocity, -200)), examples.at("VEL_-200"));
  EXPECT_EQ(bytes_of(encode(Command::kTurnRate, -30)), examples.at("RVEL_-30"));
  EXPECT_EQ(bytes_of(encode(Command::kSonar, 1)), examples.at("SONAR_1"));
  EXPECT_EQ(bytes_of(encode(Command::kSetAcceleration, 300)), examples.at("SETA_300"));
  EXPECT_EQ(bytes_of(encode(Command::kSetTurnAcceleration, 100)), examples.at("SETRA_100"));
  EXPECT_EQ(bytes_of(encode(Command::kEmergencyStop)), examples.at("ESTOP"));
}

TEST(Packet, ADamagedPacketCostsOnlyItself) {
  const Bytes good = report(100, 0, 0, 0, 0, true);
  Bytes stream = {0x00, 0xFA, 0xFA};
  append(stream, good);
  Bytes damaged = good;
  damaged[10] ^= 0x40;
  append(stream, damaged);
  append(stream, good);
  append(stream, good);
  for (const std::size_t piece : {1, 5, 1000}) {
    Decoder decoder;
    int packets = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece)
      decoder.feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)),
                   [&](std::span<const std::uint8_t> packet) {
                     EXPECT_EQ(packet.size(), good.size() - 5);
                     ++packets;
                   });
    EXPECT_EQ(packets, 3);
    EXPECT_EQ(decoder.damaged(), 1U);
  }
}

TEST(Information, ReadsTheExampleAndCutsNowhereInvalid) {
  const Bytes bytes = from_hex(
      "FAFB2833D204C8FF0004C800B4007F000000001F04000200DC0503881300000000007F0000730000005E0C");
  Decoder decoder;
  int packets = 0;
  decoder.feed(bytes, [&](std::span<const std::uint8_t> packet) {
    const auto info = parse_information(packet);
    ASSERT_TRUE(info);
    ++packets;
    EXPECT_TRUE(info->moving);
    EXPECT_EQ(info->x, 1234);
    EXPECT_EQ(static_cast<std::int16_t>(info->y), -56);
    EXPECT_EQ(info->heading, 1024);
    EXPECT_EQ(info->left_velocity, 200);
    EXPECT_EQ(info->right_velocity, 180);
    EXPECT_NEAR(info->battery, 12.7, 1e-9);
    EXPECT_TRUE(info->motors_on);
    ASSERT_EQ(info->sonar_count, 2U);
    EXPECT_EQ(info->sonar[0].range, 1500);
    EXPECT_EQ(info->sonar[1].number, 3);
    EXPECT_EQ(info->sonar[1].range, 5000);
    for (std::size_t length = 0; length < packet.size(); ++length)
      parse_information(packet.first(length));  // never beyond its end (asan)
    EXPECT_FALSE(parse_information(packet.first(20)));
  });
  EXPECT_EQ(packets, 1);
}

TEST(Information, ReadsARealReport) {
  USHER_REQUIRE_DATA(path, "hw/p3dx/sip_real_pioneer.hex");
  std::ifstream file(path);
  std::string hex;
  for (std::string line; std::getline(file, line);)
    if (line[0] != '#') hex += line;
  Decoder decoder;
  int packets = 0;
  decoder.feed(from_hex(hex), [&](std::span<const std::uint8_t> packet) {
    const auto info = parse_information(packet);
    ASSERT_TRUE(info);
    ++packets;
    EXPECT_FALSE(info->moving);
    EXPECT_FALSE(info->motors_on);
    EXPECT_FALSE(info->left_stall || info->right_stall);
    EXPECT_NEAR(info->battery, 14.4, 1e-9);
    EXPECT_EQ(info->sonar_count, 2U);
    EXPECT_FALSE(info->rotation_rate);
  });
  EXPECT_EQ(packets, 1);
}

TEST(Tracker, WrapsNeverAndJumpsNever) {
  Tracker tracker(Tracker::Parameters{});
  Information info;
  info.motors_on = true;
  Time now{};
  geometry::Pose2 pose;
  for (int i = 0; i < 2000; ++i) {  // 100 m straight on, heading 90 deg: x stays, y wraps thrice
    info.heading = 1024;
    info.y = static_cast<std::uint16_t>((50 * i + 32000) & 0x7FFF);
    pose = tracker.take(info, now += milliseconds(100)).pose;
  }
  EXPECT_NEAR(pose.x, 0.05 * 1999, 1e-6);
  EXPECT_NEAR(pose.y, 0.0, 1e-6);
  info.y = static_cast<std::uint16_t>(info.y + 9000);  // the origin was reset
  EXPECT_EQ(tracker.take(info, now).pose, pose);
  for (int i = 0; i < 100; ++i) {  // turns on the spot, the heading wraps
    info.heading = static_cast<std::int16_t>((info.heading + 100) % 4096);
    pose = tracker.take(info, now += milliseconds(100)).pose;
  }
  EXPECT_NEAR(geometry::shortest_turn(pose.yaw, 10000 * 2 * geometry::kPi / 4096), 0.0, 1e-6);
}

TEST(Tracker, SonarsKeepTheirPlacesAndAreToldOnce) {
  Tracker tracker(Tracker::Parameters{});
  Information info;
  info.sonar = {SonarReading{0, 700}, SonarReading{4, 1200}, SonarReading{7, 32000}};
  info.sonar_count = 3;
  auto sonar = tracker.take(info, milliseconds(1000)).sonar;
  EXPECT_NEAR(sonar[9], 0.7F, 1e-6) << "sonar 0 looks to the left";
  EXPECT_NEAR(sonar[4], 1.2F, 1e-6);
  EXPECT_TRUE(std::isinf(sonar[0]));
  EXPECT_TRUE(std::isnan(sonar[1]) && std::isnan(sonar[8])) << "nothing looks to 70 deg";
  info.sonar_count = 0;
  sonar = tracker.take(info, milliseconds(1100)).sonar;
  EXPECT_TRUE(std::isnan(sonar[4]));
}

/// A controller that echoes handshakes.
class Base {
 public:
  void connect(Link& link) {
    link.opened(now);
    for (int i = 0; i < 3; ++i) {
      const auto sent = link.cycle({}, now);
      hear(link, {sent.begin(), sent.begin() + 6});
    }
    setup = cycle(link, {});
  }
  void hear(Link& link, const Bytes& bytes) {
    link.received(bytes, now, [this](const Feedback& f) { feedback = f; });
  }
  Bytes cycle(Link& link, const geometry::Twist2& wanted) {
    const auto sent = link.cycle(wanted, now += milliseconds(40));
    return {sent.begin(), sent.end()};
  }
  Time now = std::chrono::seconds(10);
  Feedback feedback;
  Bytes setup;
};

bool contains(const Bytes& bytes, const Frame& frame) {
  const auto part = frame.span();
  return std::search(bytes.begin(), bytes.end(), part.begin(), part.end()) != bytes.end();
}

TEST(Link, ShakesHandsOpensAndEnables) {
  Link link({});
  Base base;
  base.connect(link);
  EXPECT_TRUE(contains(base.setup, encode(Command::kOpen)));
  EXPECT_TRUE(contains(base.setup, encode(Command::kEnable, 1)));
  EXPECT_TRUE(contains(base.setup, encode(Command::kVelocity, 0)));
  EXPECT_EQ(link.mode(base.now), Mode::kStandby);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  EXPECT_EQ(link.mode(base.now), Mode::kReady);
  EXPECT_EQ(link.reason(), "");
}

TEST(Link, DrivesOnlyWithMotorsOn) {
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 0, 0, false));
  EXPECT_TRUE(contains(base.cycle(link, {0.4, 0.1}), encode(Command::kVelocity, 0)));
  base.now += milliseconds(500);
  EXPECT_TRUE(contains(base.cycle(link, {}), encode(Command::kEnable, 1))) << "asked again";
  base.hear(link, report(0, 0, 0, 0, 0, true));
  const Bytes sent = base.cycle(link, {0.4, 0.523599});
  EXPECT_TRUE(contains(sent, encode(Command::kVelocity, 400)));
  EXPECT_TRUE(contains(sent, encode(Command::kTurnRate, 30)));
  EXPECT_TRUE(contains(base.cycle(link, {std::nan(""), 0.1}), encode(Command::kTurnRate, 0)));
}

TEST(Link, AnEmergencyStopHoldsUntilReset) {
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  link.emergency_stop();
  const Bytes stopping = base.cycle(link, {0.4, 0});
  EXPECT_TRUE(contains(stopping, encode(Command::kEmergencyStop)));
  EXPECT_FALSE(contains(stopping, encode(Command::kVelocity, 400)));
  EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
  link.reset();
  const Bytes released = base.cycle(link, {0.4, 0});
  EXPECT_TRUE(contains(released, encode(Command::kEnable, 1)));
  EXPECT_TRUE(contains(released, encode(Command::kVelocity, 0))) << "its motors may be off";
  base.hear(link, report(0, 0, 0, 0, 0, true));
  EXPECT_TRUE(contains(base.cycle(link, {0.4, 0}), encode(Command::kVelocity, 400)));
}

TEST(Link, AnEmergencyStopBrakesAndThenTakesTheMotorsOff) {
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 400, 400, true));
  link.emergency_stop();
  EXPECT_FALSE(contains(base.cycle(link, {}), encode(Command::kEnable, 0))) << "it still rolls";
  base.hear(link, report(0, 0, 0, 0, 0, true));
  EXPECT_TRUE(contains(base.cycle(link, {}), encode(Command::kEnable, 0)));
  base.hear(link, report(0, 0, 0, 0, 0, false));
  EXPECT_EQ(base.cycle(link, {}), bytes_of(encode(Command::kEmergencyStop)));
}

TEST(Link, WhatStoppedItHoldsOverANewConnection) {
  const auto stays_stopped = [](Link& link, Base& base) {
    base.connect(link);
    EXPECT_FALSE(contains(base.setup, encode(Command::kEnable, 1)));
    for (int i = 0; i < 50; ++i) {
      base.hear(link, report(0, 0, 0, 0, 0, false));
      EXPECT_FALSE(contains(base.cycle(link, {0.4, 0}), encode(Command::kEnable, 1)));
    }
    EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
  };
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  link.emergency_stop();
  stays_stopped(link, base);
  Link restarted({});
  restarted.stay_stopped(link.stopped_by());
  stays_stopped(restarted, base);
  EXPECT_EQ(restarted.reason(), "emergency stop");
}

/// A report whose flags say what stopped the motors.
Bytes stopped_by(std::uint8_t flags) {
  Bytes packet = report(0, 0, 0, 0, 0, false);
  constexpr std::size_t kFlags =
      3 + 1 + 10 + 1 + 4;  // header, type, odometry, battery, stall and bumpers, heading to hold
  packet[kFlags] = flags;
  const Bytes body(packet.begin() + 3, packet.end() - 2);
  const std::uint16_t sum = checksum(body);
  packet[packet.size() - 2] = static_cast<std::uint8_t>(sum >> 8);
  packet[packet.size() - 1] = static_cast<std::uint8_t>(sum & 0xFF);
  return packet;
}

TEST(Link, ItsStopButtonAndAStallHoldUntilReset) {
  constexpr std::uint8_t kStopButton = 0x20, kStallStop = 0x40;
  for (const std::uint8_t flags : {kStopButton, kStallStop}) {
    Link link({});
    Base base;
    base.connect(link);
    base.hear(link, report(0, 0, 0, 0, 0, true));
    base.hear(link, stopped_by(flags));
    EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
    base.hear(link, report(0, 0, 0, 0, 0, false));  // released
    base.now += milliseconds(600);
    EXPECT_FALSE(contains(base.cycle(link, {0.4, 0}), encode(Command::kEnable, 1)));
    EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
    EXPECT_EQ(link.reason(),
              flags == kStopButton ? "its stop button was pressed" : "stopped after a stall");
    link.reset();
    base.hear(link, report(0, 0, 0, 0, 0, false));
    base.now += milliseconds(600);
    EXPECT_TRUE(contains(base.cycle(link, {0.4, 0}), encode(Command::kEnable, 1)));
  }
}

TEST(Link, AStallIsReportedUntilTheMotorsAreOnAndForgivenMeanwhile) {
  constexpr std::uint8_t kStallStop = 0x40;
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, stopped_by(kStallStop));
  EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
  link.reset();
  base.hear(link, stopped_by(kStallStop));  // the base has not been told yet
  EXPECT_TRUE(contains(base.cycle(link, {}), encode(Command::kEnable, 1)));
  base.hear(link, stopped_by(kStallStop));
  EXPECT_EQ(link.mode(base.now), Mode::kStandby);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  EXPECT_EQ(link.mode(base.now), Mode::kReady);
  base.now += std::chrono::seconds(1);
  base.hear(link, stopped_by(kStallStop));
  EXPECT_EQ(link.mode(base.now), Mode::kEmergency) << "a new one";
}

TEST(Link, MotorsThatSomebodySwitchedOffStayOffUntilReset) {
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  base.hear(link, report(0, 0, 0, 0, 0, false));
  base.now += milliseconds(600);
  EXPECT_FALSE(contains(base.cycle(link, {0.4, 0}), encode(Command::kEnable, 1)));
  EXPECT_EQ(link.mode(base.now), Mode::kEmergency);
  EXPECT_EQ(link.reason(), "its motors were switched off at the base");
  link.reset();
  base.hear(link, report(0, 0, 0, 0, 0, false));
  base.now += milliseconds(600);
  EXPECT_TRUE(contains(base.cycle(link, {0.4, 0}), encode(Command::kEnable, 1)));
}

TEST(Link, StandstillIsZeroVelocity) {
  const Bytes bytes = Link::velocity({});
  EXPECT_TRUE(contains(bytes, encode(Command::kVelocity, 0)));
  EXPECT_TRUE(contains(bytes, encode(Command::kTurnRate, 0)));
}

TEST(Link, NoticesASilentBase) {
  Link link({});
  Base base;
  base.connect(link);
  base.hear(link, report(0, 0, 0, 0, 0, true));
  base.now += std::chrono::seconds(1);
  EXPECT_EQ(link.mode(base.now), Mode::kDisconnected);
  EXPECT_EQ(base.cycle(link, {0.4, 0}), bytes_of(encode(Command::kPulse))) << "SYNC0 again";
  EXPECT_EQ(link.reason(), "no reports from the base");
}

TEST(Link, ClosesABaseThatWasLeftOpen) {
  Link link({});
  Base base;
  link.opened(base.now);
  base.cycle(link, {});
  base.hear(link, report(0, 0, 0, 0, 0, true));
  EXPECT_EQ(base.cycle(link, {}), bytes_of(encode(Command::kClose)));
}

TEST(Link, SurvivesNoise) {
  Random random(3);
  Link link({});
  Base base;
  for (int round = 0; round < 500; ++round) {
    Bytes noise = report(static_cast<int>(random.below(65536)), 0, 0, 0, 0, true);
    for (int i = 0; i < 3; ++i)
      noise[random.below(noise.size())] = static_cast<std::uint8_t>(random.below(256));
    base.hear(link, noise);
    base.cycle(link, {0.1, 0.1});
    if (round % 100 == 0) base.connect(link);
    EXPECT_TRUE(base.feedback.pose.finite());
  }
}

}  // namespace
}  // namespace usher::p3dx
