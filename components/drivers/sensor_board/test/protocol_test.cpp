#include "drivers/sensor_board/core/protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/bytes.hpp"

namespace usher::sensor_board {
namespace {

using test::Bytes;
using test::hex;

std::vector<Bytes> decode(serial_frame::FrameDecoder& decoder,
                          std::span<const std::uint8_t> stream) {
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

TEST(Protocol, MatchesTheWorkedExamples) {
  EXPECT_EQ(hex(to_frame({0x2A, example()}).span()),
            "06 10 2A 40 E2 01 08 F6 04 FF FF EC 09 98 01 01 04 05 6A FF 03 B5 1D 00");
  EXPECT_EQ(hex(set_tilt(1, -200).span()), "07 20 01 38 FF 72 16 00");
}

TEST(Protocol, ReadsWhatItWrites) {
  serial_frame::FrameDecoder decoder;
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
      const bool right = (type == 0x10 && length == 20) || (type == 0x11 && length == 8) ||
                         (type == 0x60 && length == 4) || (type == 0x61 && length == 5);
      EXPECT_EQ(parse(content).has_value(), right) << type << " " << length;
    }
  }
}

}  // namespace
}  // namespace usher::sensor_board
