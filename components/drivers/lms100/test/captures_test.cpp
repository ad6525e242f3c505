// The real traffic of SICK scanners, as recorded by the vendor.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/lms100/core/cola.hpp"
#include "drivers/lms100/core/scan_telegram.hpp"
#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::lms100 {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string read_gz(const std::string& path) {
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return text;
  std::vector<char> chunk(1 << 16);
  for (int got = 0; (got = gzread(file, chunk.data(), static_cast<unsigned>(chunk.size()))) > 0;) {
    text.append(chunk.data(), static_cast<std::size_t>(got));
  }
  gzclose(file);
  return text;
}

std::uint8_t hex_byte(const char* digits) {
  const auto value = [](char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; };
  return static_cast<std::uint8_t>(value(digits[0]) * 16 + value(digits[1]));
}

/// The payloads of all packets, in order.
std::vector<Bytes> packets(const std::string& json) {
  static const std::string kKey = "\"tcp.payload\": \"";
  std::vector<Bytes> result;
  for (std::size_t at = json.find(kKey); at != std::string::npos; at = json.find(kKey, at)) {
    at += kKey.size();
    Bytes packet;
    while (json[at] != '"') {
      packet.push_back(hex_byte(&json[at]));
      at += json[at + 2] == ':' ? 3 : 2;
    }
    result.push_back(std::move(packet));
  }
  return result;
}

struct Tally {
  std::size_t telegrams = 0;
  std::size_t scans = 0;
  std::size_t beams = 0;  ///< in all scans
  std::set<std::size_t> sizes;
  std::size_t errors = 0;                       ///< sFA
  std::size_t unread = 0;                       ///< LMDscandata that was refused
  std::size_t impossible = 0;                   ///< ranges that no scanner measures
  std::uint64_t digest = 1469598103934665603U;  ///< of all scans

  void take(const Telegram& telegram) {
    ++telegrams;
    const auto message = open(telegram);
    if (!message) return;
    if (message->kind == "sFA") ++errors;
    if (message->name != "LMDscandata" || message->kind != "sSN") return;
    static ScanTelegram scan_telegram;
    static Scan scan;
    const Status status = read(*message, scan_telegram);
    if (!status || !to_scan(scan_telegram, Time(0), scan)) {
      ++unread;
      return;
    }
    ++scans;
    beams += scan.ranges.size();
    sizes.insert(scan.ranges.size());
    for (const float range : scan.ranges) {
      if (std::isfinite(range) && (range < 0.01F || range > 130.0F)) ++impossible;
      const auto millimeters = std::isfinite(range) ? std::lround(range * 1000.0F) : -1L;
      digest = (digest ^ static_cast<std::uint64_t>(millimeters)) * 1099511628211U;
    }
  }
};

Tally tally(const std::vector<Bytes>& packets, std::size_t piece = 0) {
  Bytes stream;
  for (const Bytes& packet : packets) stream.insert(stream.end(), packet.begin(), packet.end());
  Decoder decoder;
  Tally result;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t length = std::min(piece == 0 ? stream.size() : piece, stream.size() - at);
    std::span<const std::uint8_t> rest(stream.data() + at, length);
    while (!rest.empty()) {
      rest = rest.subspan(decoder.feed(rest));
      while (const auto telegram = decoder.next()) result.take(*telegram);
    }
    at += length;
  }
  EXPECT_EQ(decoder.bad_checksums(), 0U);
  EXPECT_EQ(decoder.skipped_bytes(), 0U);
  return result;
}

struct Capture {
  const char* file;
  std::size_t scans;
  std::size_t errors;
};
constexpr Capture kCaptures[] = {
    {"20210113_tim871s_elephant", 150, 0},
    {"20210125-tim781s-scandata", 140, 0},
    {"20210301_lms511", 136, 18},
    {"20210302_lms111", 175, 0},
    {"20210302_lms511", 174, 0},
    {"20210722_143600_ros2_mrs1104_sick_scan_xd", 96, 2},
    {"sopas_et_field_test_1_2_both_010", 139, 0},
};

TEST(Captures, EveryScanOfEveryScannerIsRead) {
  USHER_REQUIRE_DATA(folder, "sick");
  for (const Capture& capture : kCaptures) {
    SCOPED_TRACE(capture.file);
    const auto all = packets(read_gz(folder + "/" + capture.file + ".pcapng.json.gz"));
    ASSERT_FALSE(all.empty());
    const Tally whole = tally(all);
    EXPECT_EQ(whole.scans, capture.scans);
    EXPECT_EQ(whole.errors, capture.errors);
    EXPECT_EQ(whole.unread, 0U);
    EXPECT_EQ(whole.impossible, 0U);
    for (const std::size_t piece : {1U, 62U, 1460U}) {
      const Tally pieces = tally(all, piece);
      EXPECT_EQ(pieces.telegrams, whole.telegrams);
      EXPECT_EQ(pieces.digest, whole.digest) << "the same whatever the pieces";
    }
  }
}

TEST(Captures, TheLms111IsAsDescribed) {
  USHER_REQUIRE_DATA(path, "sick/20210302_lms111.pcapng.json.gz");
  std::vector<std::uint16_t> counters;
  int not_ready = 0;
  int checked = 0;
  for (const Bytes& packet : packets(read_gz(path))) {
    Decoder decoder;
    decoder.feed(packet);
    const auto telegram = decoder.next();
    const auto message = telegram ? open(*telegram) : std::nullopt;
    if (!message || message->kind != "sSN" || message->name != "LMDscandata") continue;
    ScanTelegram scan;
    ASSERT_TRUE(read(*message, scan));
    EXPECT_EQ(scan.serial_number, 18090362U);
    EXPECT_EQ(scan.scan_frequency, 5000U);
    EXPECT_EQ(scan.measurement_frequency, 360U);
    EXPECT_EQ(scan.channel_count, 1U);
    EXPECT_EQ(scan.channels[0].values.size(), 541U);
    if (scan.status[0] == 1) ++not_ready;
    if (counters.empty() || counters.back() != scan.scan_counter) {
      counters.push_back(scan.scan_counter);
    }
    if (scan.scan_counter == 34 && checked == 0) {
      ++checked;
      EXPECT_EQ(scan.telegram_counter, 63366);
      EXPECT_EQ(scan.scan_time, 1949414781U);
      EXPECT_EQ(scan.transmission_time, 1949417868U);
      const std::vector<std::uint16_t> head(scan.channels[0].values.begin(),
                                            scan.channels[0].values.begin() + 5);
      EXPECT_EQ(head, (std::vector<std::uint16_t>{99, 89, 92, 85, 79}));
    }
  }
  EXPECT_EQ(checked, 1);
  EXPECT_GE(not_ready, 7);
  for (std::size_t i = 1; i < counters.size(); ++i) {
    EXPECT_EQ(counters[i], counters[i - 1] + 1) << "no scan is lost";
  }
}

TEST(Captures, BothDialectsSayTheSame) {
  USHER_REQUIRE_DATA(binary_path, "hw/sick_lms111/messages_cola_b.txt");
  USHER_REQUIRE_DATA(text_path, "hw/sick_lms111/scans_transcribed_cola_a.txt");
  std::vector<std::vector<std::uint16_t>> texts;
  std::ifstream text(text_path);
  for (std::string line; std::getline(text, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.rfind("sSN", 0) != 0) continue;
    const Bytes payload(line.begin(), line.end());
    const auto message = open({Dialect::kAscii, payload});
    ASSERT_TRUE(message);
    ScanTelegram scan;
    const Status status = read(*message, scan);
    ASSERT_TRUE(status) << status.error();
    texts.push_back(scan.channels[0].values);
  }
  ASSERT_EQ(texts.size(), 20U);

  std::vector<std::vector<std::uint16_t>> binaries;
  std::ifstream binary(binary_path);
  std::uint32_t last_time = 0;
  for (std::string line; std::getline(binary, line) && binaries.size() < texts.size();) {
    if (line.empty() || line[0] == '#') continue;
    const std::string digits = line.substr(line.find_last_of(' ') + 1);
    Bytes frame;
    for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
      frame.push_back(hex_byte(&digits[i]));
    }
    Decoder decoder;
    decoder.feed(frame);
    const auto telegram = decoder.next();
    ASSERT_TRUE(telegram);
    const auto message = open(*telegram);
    ScanTelegram scan;
    if (!message || message->name != "LMDscandata" || !read(*message, scan)) continue;
    if (scan.scan_time == last_time) continue;  // a packet that was recorded twice
    last_time = scan.scan_time;
    binaries.push_back(scan.channels[0].values);
  }
  EXPECT_EQ(binaries, texts);
}

// Damaged real traffic never crashes, never gives a scan of impossible size, and most scans
// survive.
TEST(Captures, SurviveDamage) {
  USHER_REQUIRE_DATA(path, "sick/20210302_lms111.pcapng.json.gz");
  Bytes stream;
  for (const Bytes& packet : packets(read_gz(path))) {
    stream.insert(stream.end(), packet.begin(), packet.end());
  }
  Random random(2);
  for (int run = 0; run < 20; ++run) {
    Bytes damaged = stream;
    for (int i = 0; i < 40; ++i) {
      damaged[random.below(damaged.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    const auto cut = static_cast<std::ptrdiff_t>(random.below(damaged.size() - 5000));
    damaged.erase(damaged.begin() + cut,
                  damaged.begin() + cut + static_cast<std::ptrdiff_t>(random.below(3000)));
    Decoder decoder;
    Tally result;
    std::span<const std::uint8_t> rest(damaged);
    while (!rest.empty()) {
      rest = rest.subspan(decoder.feed(rest));
      while (const auto telegram = decoder.next()) result.take(*telegram);
    }
    EXPECT_GE(result.scans, 175U - 2U * 44U) << "run " << run;
    EXPECT_GT(decoder.skipped_bytes(), 0U);
  }
}

}  // namespace
}  // namespace usher::lms100
