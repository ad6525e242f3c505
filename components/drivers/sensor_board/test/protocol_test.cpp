#include "drivers/sensor_board/core/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "drivers/sensor_board/core/median_filter.hpp"
#include "foundation/random/random.hpp"

namespace usher::sensor_board {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char two[4];
    std::snprintf(two, sizeof two, "%02X ", byte);
    text += two;
  }
  return text.empty() ? text : text.substr(0, text.size() - 1);
}

std::vector<Bytes> decode(FrameDecoder& decoder, std::span<const std::uint8_t> stream) {
  std::vector<Bytes> contents;
  decoder.feed(stream, [&](std::span<const std::uint8_t> content) {
    contents.emplace_back(content.begin(), content.end());
  });
  return contents;
}

Sensors example() {
  Sensors sensors;
  sensors.time_ms = 123456;
  sensors.ranges_mm = {1270, 0xFFFF, 2540, 152, 0};
  sensors.whisker_mask = 0x05;
  sensors.tilt = -150;
  return sensors;
}

TEST(Frame, HasTheChecksumOfTheStandard) {
  const std::string check = "123456789";
  EXPECT_EQ(crc16({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0x29B1);
  EXPECT_EQ(crc16({}), 0xFFFF);
}

TEST(Frame, MatchesTheWorkedExamples) {
  EXPECT_EQ(hex(to_frame({0x2A, example()}).span()),
            "06 10 2A 40 E2 01 08 F6 04 FF FF EC 09 98 01 01 04 05 6A FF 03 B5 1D 00");
  EXPECT_EQ(hex(set_tilt(1, -200).span()), "07 20 01 38 FF 72 16 00");
  EXPECT_EQ(hex(heartbeat(2).span()), "05 21 02 9A 08 00");
}

TEST(Frame, CarriesAnyContent) {
  Random random(1);
  for (int run = 0; run < 2000; ++run) {
    Bytes content(1 + random.below(kLongestContent));
    const bool zeros = random.below(2) == 0;
    for (auto& byte : content) {
      byte = zeros && random.below(2) == 0 ? std::uint8_t{0}
                                           : static_cast<std::uint8_t>(random.below(256));
    }
    const Frame frame = encode(content);
    EXPECT_EQ(std::count(frame.span().begin(), frame.span().end(), 0), 1) << "only at its end";
    FrameDecoder decoder;
    const auto contents = decode(decoder, frame.span());
    ASSERT_EQ(contents.size(), 1U);
    EXPECT_EQ(contents[0], content);
  }
}

TEST(Frame, DecodesABlockOf254WithoutAZeroBehindIt) {
  // Another encoder's frame: too long for this protocol, but not to crash on.
  Bytes stream(300, 0x11);
  stream[0] = 0xFF;
  stream.push_back(0);
  FrameDecoder decoder;
  EXPECT_TRUE(decode(decoder, stream).empty());
  EXPECT_EQ(decoder.damaged(), 1U);
  EXPECT_EQ(decode(decoder, heartbeat(1).span()).size(), 1U);
}

TEST(Frame, DamageCostsOneFrame) {
  Random random(2);
  for (int run = 0; run < 500; ++run) {
    Bytes stream;
    for (int i = 0; i < 50; ++i) {
      Sensors sensors = example();
      sensors.time_ms = static_cast<std::uint32_t>(random.next());
      const Frame frame = to_frame({static_cast<std::uint8_t>(i), sensors});
      stream.insert(stream.end(), frame.span().begin(), frame.span().end());
    }
    const std::size_t at = random.below(stream.size());
    switch (random.below(3)) {
      case 0:
        stream[at] ^= static_cast<std::uint8_t>(1 + random.below(255));
        break;
      case 1:
        stream.erase(stream.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      default:
        stream.insert(stream.begin() + static_cast<std::ptrdiff_t>(at), 0x55);
    }
    FrameDecoder decoder;
    EXPECT_GE(decode(decoder, stream).size(), 48U) << "a lost end joins two";
    EXPECT_LE(decoder.damaged(), 2U);
  }
}

TEST(Frame, JoinsInTheMiddle) {
  const Frame frame = to_frame({1, example()});
  Bytes stream(frame.span().begin() + 9, frame.span().end());
  const Frame second = heartbeat(2);
  stream.insert(stream.end(), second.span().begin(), second.span().end());
  FrameDecoder decoder;
  EXPECT_EQ(decode(decoder, stream).size(), 1U);
}

TEST(Protocol, ReadsWhatItWrites) {
  FrameDecoder decoder;
  const auto through = [&decoder](const BoardMessage& message) {
    const auto contents = decode(decoder, to_frame(message).span());
    return contents.size() == 1 ? parse(contents[0]) : std::nullopt;
  };
  auto back = through({7, example()});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sequence, 7);
  const auto& sensors = std::get<Sensors>(back->content);
  EXPECT_EQ(sensors.time_ms, 123456U);
  EXPECT_EQ(sensors.ranges_mm, example().ranges_mm);
  EXPECT_EQ(sensors.whisker_mask, 5);
  EXPECT_EQ(sensors.tilt, -150);

  back = through({8, Hello{1, {2, 3, 4}, 0xCAFEBABE, 5, 8}});
  ASSERT_TRUE(back);
  EXPECT_EQ(std::get<Hello>(back->content).serial_number, 0xCAFEBABEU);
  EXPECT_EQ(std::get<Hello>(back->content).firmware[2], 4);
  EXPECT_EQ(std::get<Hello>(back->content).whiskers, 8);

  back = through({9, WhiskerChange{99, 0x80, 0x81}});
  ASSERT_TRUE(back);
  EXPECT_EQ(std::get<WhiskerChange>(back->content).changed, 0x81);

  back = through({10, Verdict{false, 0x20, 3, 2}});
  ASSERT_TRUE(back);
  EXPECT_FALSE(std::get<Verdict>(back->content).accepted);
  EXPECT_EQ(std::get<Verdict>(back->content).reason, 2);
  back = through({11, Verdict{true, 0x20, 3, 0}});
  ASSERT_TRUE(back);
  EXPECT_TRUE(std::get<Verdict>(back->content).accepted);
}

TEST(Protocol, RefusesUnknownTypesAndWrongLengths) {
  EXPECT_FALSE(parse({}));
  const Bytes only_type{0x10};
  EXPECT_FALSE(parse(only_type));
  for (unsigned type = 0; type < 256; ++type) {
    for (std::size_t length = 2; length < 40; ++length) {
      Bytes content(length, 1);
      content[0] = static_cast<std::uint8_t>(type);
      const bool right = (type == 0x01 && length == 12) || (type == 0x10 && length == 20) ||
                         (type == 0x11 && length == 8) || (type == 0x60 && length == 4) ||
                         (type == 0x61 && length == 5);
      EXPECT_EQ(parse(content).has_value(), right) << type << " " << length;
    }
  }
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct MedianRow {
  std::vector<float> in;
  float out;
};

TEST(MedianFilter, TakesTheMiddleOfTheLastThree) {
  const MedianRow rows[] = {
      {{1.0F}, 1.0F},
      {{1.0F, 3.0F}, 1.0F},
      {{1.0F, 9.0F, 1.1F}, 1.1F},
      {{9.0F, 9.0F, 9.0F, 1.0F}, 9.0F},
      {{9.0F, 9.0F, 9.0F, 1.0F, 1.2F}, 1.2F},
      {{1.0F, kInfinity, kInfinity}, kInfinity},
      {{1.0F, kInfinity, 2.0F}, 2.0F},
      {{kNan}, kNan},
      {{kNan, 2.0F, kNan}, 2.0F},
      {{kNan, 2.0F, 1.0F}, 1.0F},
      {{2.0F, kNan, kNan, kNan}, kNan},
  };
  for (const MedianRow& row : rows) {
    MedianFilter filter(3);
    float out = 0.0F;
    for (const float range : row.in) out = filter.update(range);
    if (std::isnan(row.out)) {
      EXPECT_TRUE(std::isnan(out));
    } else {
      EXPECT_EQ(out, row.out);
    }
  }
}

}  // namespace
}  // namespace usher::sensor_board
