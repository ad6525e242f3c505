#include "drivers/lms100/core/cola.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/lms100/core/scan_telegram.hpp"
#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::lms100 {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes(const std::string& text) { return {text.begin(), text.end()}; }

Bytes hex(const std::string& text) {
  Bytes result;
  std::istringstream in(text);
  for (std::string byte; in >> byte;) {
    result.push_back(static_cast<std::uint8_t>(std::stoul(byte, nullptr, 16)));
  }
  return result;
}

std::vector<std::string> decode(Decoder& decoder, const Bytes& stream, std::size_t piece) {
  std::vector<std::string> found;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t length = std::min(piece, stream.size() - at);
    std::span<const std::uint8_t> rest(stream.data() + at, length);
    while (!rest.empty()) {
      rest = rest.subspan(decoder.feed(rest));
      while (const auto telegram = decoder.next()) {
        found.emplace_back(telegram->payload.begin(), telegram->payload.end());
      }
    }
    at += length;
  }
  return found;
}

const char* const kAccessAnswer =
    "02 02 02 02 00 00 00 13 73 41 4E 20 53 65 74 41 63 63 65 73 73 4D 6F 64 65 20 01 38";

TEST(Cola, FramesTheWorkedExamples) {
  EXPECT_EQ(Command(Dialect::kAscii, "sRN", "LMPscancfg").frame(),
            hex("02 73 52 4E 20 4C 4D 50 73 63 61 6E 63 66 67 03"));
  EXPECT_EQ(
      Command(Dialect::kBinary, "sMN", "SetAccessMode").number(3, 1).number(0xF4724744, 4).frame(),
      hex("02 02 02 02 00 00 00 17 73 4d 4e 20 53 65 74 41 63 63 65 73 73 4d 6f 64 65 20 03 "
          "f4 72 47 44 b3"));
  EXPECT_EQ(
      Command(Dialect::kAscii, "sMN", "SetAccessMode").number(3, 1).number(0xF4724744, 4).frame(),
      bytes("\x02sMN SetAccessMode 3 F4724744\x03"));
  EXPECT_EQ(Command(Dialect::kAscii, "sMN", "x").signed_number(-450000).number(0, 1).frame(),
            bytes("\x02sMN x FFF92230 0\x03"));
}

TEST(Cola, ReadsTheWorkedExample) {
  Decoder decoder;
  const auto found = decode(decoder, hex(kAccessAnswer), 100);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], std::string("sAN SetAccessMode \x01"));
}

TEST(Cola, FindsTelegramsInAnyPieces) {
  Bytes stream;
  for (int i = 0; i < 20; ++i) {
    const Bytes binary = hex(kAccessAnswer);
    stream.insert(stream.end(), binary.begin(), binary.end());
    const Bytes ascii = bytes("\x02sAN Run 1\x03");
    stream.insert(stream.end(), ascii.begin(), ascii.end());
  }
  for (std::size_t piece = 1; piece < 80; ++piece) {
    Decoder decoder;
    EXPECT_EQ(decode(decoder, stream, piece).size(), 40U) << piece;
    EXPECT_EQ(decoder.skipped_bytes(), 0U);
  }
}

TEST(Cola, GoesOnAfterDamage) {
  struct Row {
    const char* name;
    std::string before;
  };
  const Row rows[] = {
      {"noise", "garbage \x01\x7f"},
      {"a text frame without its end", "\x02sRA LMDscandata 1 1 A0"},
      {"stray begins", "\x02\x02\x02"},
      {"a binary frame cut before its end", std::string("\x02\x02\x02\x02\x00\x00\x00\x08sAN", 11)},
      {"a length that cannot be", std::string("\x02\x02\x02\x02\xff\xff\xff\xff", 8)},
      {"a length of zero", std::string("\x02\x02\x02\x02\x00\x00\x00\x00", 8)},
      {"a wrong checksum", std::string("\x02\x02\x02\x02\x00\x00\x00\x03sAN\x00", 12)},
  };
  for (const Row& row : rows) {
    Bytes stream = bytes(row.before);
    const Bytes good = hex(kAccessAnswer);
    for (int i = 0; i < 3; ++i) stream.insert(stream.end(), good.begin(), good.end());
    Decoder decoder;
    const auto found = decode(decoder, stream, 7);
    EXPECT_GE(std::count(found.begin(), found.end(), std::string("sAN SetAccessMode \x01")), 2)
        << row.name;
    EXPECT_GT(decoder.skipped_bytes(), 0U) << row.name;
  }
}

TEST(Cola, RandomDamageCostsAtMostItsNeighbors) {
  Random random(4);
  std::ptrdiff_t all_hits = 0;
  std::ptrdiff_t lost = 0;
  for (int run = 0; run < 300; ++run) {
    Bytes stream;
    std::multiset<std::string> sent;
    for (int i = 0; i < 100; ++i) {  // all different: the checksum of one byte knows no better
      const Bytes frame = Command(Dialect::kBinary, "sAN", "Value")
                              .number(static_cast<std::uint32_t>(random.next()), 4)
                              .frame();
      stream.insert(stream.end(), frame.begin(), frame.end());
      sent.emplace(frame.begin() + 8, frame.end() - 1);
    }
    const auto hits = static_cast<std::size_t>(random.below(5));
    for (std::size_t i = 0; i < hits; ++i) {
      stream[random.below(stream.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    // A damaged length may claim bytes that are still to come: let them come.
    stream.resize(stream.size() + Decoder::kLongestPayload + 16, 0);
    Decoder decoder;
    std::ptrdiff_t whole = 0;
    for (const std::string& found : decode(decoder, stream, 1 + random.below(200))) {
      whole += sent.contains(found) ? 1 : 0;
    }
    all_hits += static_cast<std::ptrdiff_t>(hits);
    lost += 100 - whole;
  }
  // One in 256 damaged lengths finds a checksum of one byte that fits, and costs what it covers.
  EXPECT_LE(lost, all_hits + all_hits / 10);
  EXPECT_GT(lost, all_hits / 2);
}

TEST(Cola, AFloodWithoutAFrameNeedsNoMemory) {
  Decoder decoder;
  const Bytes flood(1 << 20, 's');
  EXPECT_TRUE(decode(decoder, flood, 4096).empty());
  Bytes text_flood(1 << 20, 'A');
  text_flood[0] = 0x02;
  text_flood[1] = 's';
  EXPECT_TRUE(decode(decoder, text_flood, 4096).empty());
  EXPECT_EQ(decode(decoder, hex(kAccessAnswer), 5).size(), 1U);
}

TEST(Cola, OpensKindNameAndFields) {
  const auto open_text = [](const std::string& text) {
    static Bytes kept;
    kept = bytes(text);
    return open({Dialect::kAscii, kept});
  };
  auto message = open_text("sRA LMPscancfg 9C4 1 9C4 FFF92230 225510");
  ASSERT_TRUE(message);
  EXPECT_EQ(message->kind, "sRA");
  EXPECT_EQ(message->name, "LMPscancfg");
  EXPECT_EQ(message->fields.number(4), 2500U);
  EXPECT_EQ(message->fields.number(2), 1U);
  EXPECT_EQ(message->fields.number(4), 2500U);
  EXPECT_EQ(message->fields.signed_number(), -450000);
  EXPECT_EQ(message->fields.signed_number(), 2250000);
  EXPECT_TRUE(message->fields.ok() && message->fields.done());

  message = open_text("sRA STlms 7 0 8 00:34:19 A 01.01.1970 0 0 0");
  ASSERT_TRUE(message);
  EXPECT_EQ(message->fields.number(2), 7U);
  EXPECT_EQ(message->fields.number(2), 0U);
  EXPECT_EQ(message->fields.text(2), "00:34:19");
  EXPECT_EQ(message->fields.text(2), "01.01.1970");

  message = open_text("sFA 3");
  ASSERT_TRUE(message);
  EXPECT_EQ(error_text(message->fields.number(2)), "unknown variable");
  EXPECT_FALSE(open_text("sRA"));
  EXPECT_FALSE(open_text("xRA LMDscandata"));
  EXPECT_FALSE(open_text("sRA  LMDscandata"));
  EXPECT_FALSE(open_text(""));
}

TEST(Cola, OpensTheBinaryErrorWithoutABlank) {
  const Bytes payload{'s', 'F', 'A', 0, 3};
  auto message = open({Dialect::kBinary, payload});
  ASSERT_TRUE(message);
  EXPECT_EQ(message->fields.number(2), 3U);
  EXPECT_EQ(error_text(9999), "undocumented error");
}

TEST(FieldReader, FailsForGoodOnTheFirstWrongField) {
  const char* broken[] = {"", "G", "-5", "123456789", "1FFFF", " 1", "0x1"};
  for (const char* text : broken) {
    const Bytes fields = std::strlen(text) == 0 ? Bytes{} : bytes(std::string(text) + " 1");
    FieldReader reader(Dialect::kAscii, fields);
    EXPECT_EQ(reader.number(2), 0U) << text;
    EXPECT_FALSE(reader.ok()) << text;
    EXPECT_EQ(reader.number(2), 0U);
  }
  const Bytes two{1, 2};
  FieldReader reader(Dialect::kBinary, two);
  EXPECT_EQ(reader.number(4), 0U);
  EXPECT_FALSE(reader.ok());
}

Result<ScanTelegram> parse_text(const std::string& text) {
  const Bytes payload = bytes(text);
  const auto message = open({Dialect::kAscii, payload});
  if (!message) return Error{"no message"};
  ScanTelegram telegram;
  if (Status status = read(*message, telegram); !status) return Error{status.error()};
  return telegram;
}

const std::string kHead = "sSN LMDscandata 1 1 A037B9 0 0 1 2 3E8 BB8 0 0 7 0 0 1388 168 ";
const std::string kDist = "DIST1 3F800000 00000000 FFF92230 1388 ";

TEST(ScanTelegram, ReadsValuesAndCodes) {
  const auto telegram = parse_text(kHead + "0 1 " + kDist +
                                   "5 0 1 3 10 3E8 1 RSSI1 3F800000 00000000 FFF92230 1388 "
                                   "5 1 2 3 4 FF 0 0 0 0 0");
  ASSERT_TRUE(telegram.ok()) << telegram.error();
  Scan scan;
  ASSERT_TRUE(to_scan(*telegram, Time(7), scan));
  ASSERT_EQ(scan.ranges.size(), 5U);
  EXPECT_EQ(scan.ranges[0], std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(scan.ranges[1]) && std::isnan(scan.ranges[2]));
  EXPECT_FLOAT_EQ(scan.ranges[3], 0.016F);
  EXPECT_FLOAT_EQ(scan.ranges[4], 1.0F);
  EXPECT_EQ(scan.intensities, (std::vector<float>{1, 2, 3, 4, 255}));
  EXPECT_NEAR(scan.angle_min, -135.0 * 3.14159265358979 / 180.0, 1e-9);
  EXPECT_NEAR(scan.angle_increment, 0.5 * 3.14159265358979 / 180.0, 1e-12);
  EXPECT_NEAR(scan.scan_time, 0.02, 1e-12);
  EXPECT_NEAR(scan.time_increment, 27.8e-6, 0.1e-6);
  EXPECT_EQ(scan.stamp, Time(7));
}

TEST(ScanTelegram, ReadsEncodersAndTheDoubleScale) {
  const auto telegram =
      parse_text(kHead + "1 0 3E8 1 DIST1 40000000 00000000 6DDD0 9C4 2 3E8 7D0 0 0 0 0 0 0");
  ASSERT_TRUE(telegram.ok()) << telegram.error();
  Scan scan;
  ASSERT_TRUE(to_scan(*telegram, Time(0), scan));
  EXPECT_FLOAT_EQ(scan.ranges[0], 2.0F);
  EXPECT_NEAR(scan.angle_min, -45.0 * 3.14159265358979 / 180.0, 1e-9);
}

TEST(ScanTelegram, RefusesWhatIsCutOrImpossible) {
  const std::string whole = kHead + "0 1 " + kDist + "3 3E8 3E8 3E8 0 0 0 0 0 0";
  ASSERT_TRUE(parse_text(whole).ok());
  const std::size_t needed = whole.find(" 0 0 0 0 0 0") + 2;  // position, name, ... may be absent
  for (std::size_t length = 15; length < needed; ++length) {
    const auto cut = parse_text(whole.substr(0, length));
    if (cut.ok()) {
      // A value that lost its last digits is still a number; only the count of values may betray
      // it.
      ADD_FAILURE() << "accepted " << whole.substr(0, length);
    }
  }
  EXPECT_FALSE(parse_text(kHead + "0 1 " + kDist + "FFFF 1 2 3 0").ok())
      << "values that are not there";
  EXPECT_FALSE(parse_text(kHead + "0 9 " + kDist + "1 1").ok()) << "nine channels";
  EXPECT_FALSE(parse_text(kHead + "FF 1 " + kDist + "1 1 0").ok()) << "255 encoders";
  EXPECT_FALSE(parse_text("sSN LIDinputstate 1").ok());
}

TEST(ScanTelegram, RefusesAScanWithoutDistancesStepOrScale) {
  Scan scan;
  for (const char* channel :
       {"RSSI1 3F800000 00000000 FFF92230 1388 1 3E8", "DIST1 3F800000 00000000 FFF92230 0 1 3E8",
        "DIST1 7FC00000 00000000 FFF92230 1388 1 3E8",
        "DIST1 00000000 00000000 FFF92230 1388 1 3E8",
        "DIST1 3F800000 7F800000 FFF92230 1388 1 3E8", "DIST1 3F800000 00000000 FFF92230 1388 0"}) {
    const auto telegram = parse_text(kHead + "0 1 " + channel + " 0");
    ASSERT_TRUE(telegram.ok()) << telegram.error();
    EXPECT_FALSE(to_scan(*telegram, Time(0), scan)) << channel;
  }
}

TEST(ScanTelegram, ReadsTheRealTextTelegrams) {
  USHER_REQUIRE_DATA(folder, "hw/sick_cola_a");
  struct Row {
    const char* file;
    const char* kind;
    std::size_t count;
    double ahead;
  };
  for (const Row& row : {Row{"lms151_event_scan_541.txt", "sSN", 541, 7.490},
                         Row{"lms111_polled_scan_536.txt", "sRA", 536, 3.546}}) {
    std::ifstream in(folder + "/" + row.file);
    std::stringstream text;
    text << in.rdbuf();
    std::string line = text.str();
    line.erase(line.find_last_not_of(" \r\n\t") + 1);
    const auto telegram = parse_text(line);
    ASSERT_TRUE(telegram.ok()) << row.file << ": " << telegram.error();
    Scan scan;
    ASSERT_TRUE(to_scan(*telegram, Time(0), scan));
    EXPECT_EQ(scan.ranges.size(), row.count);
    EXPECT_NEAR(scan.ranges[270], row.ahead, 5e-4) << "straight ahead is beam 270";
    EXPECT_NEAR(scan.angle_min + 270 * scan.angle_increment, 0.0, 1e-9);
    if (row.count == 541) {
      EXPECT_EQ(telegram->serial_number, 10500025U);
      EXPECT_EQ(telegram->scan_counter, 49606);
      EXPECT_EQ(std::count_if(scan.ranges.begin(), scan.ranges.end(),
                              [](float range) { return std::isnan(range); }),
                51);
      EXPECT_EQ(std::count(scan.ranges.begin(), scan.ranges.end(),
                           std::numeric_limits<float>::infinity()),
                12);
    }
  }
}

ScanTelegram timed(std::uint32_t scan_us, std::uint32_t transmission_us) {
  ScanTelegram telegram;
  telegram.scan_time = scan_us;
  telegram.transmission_time = transmission_us;
  return telegram;
}

TEST(MeasuredAt, IsTheAgeThatTheDeviceTellsBeforeItsWord) {
  estimation::DeviceClock clock(kCounter);
  const Time arrival = std::chrono::seconds(130);
  EXPECT_EQ(measured_at(timed(0xFFFFFF00U, 2744), arrival, clock),
            arrival - std::chrono::microseconds(3000))
      << "its clock has wrapped";
  EXPECT_EQ(measured_at(timed(9000, 4000), arrival, clock), arrival) << "no scan is of the future";
}

}  // namespace
}  // namespace usher::lms100
