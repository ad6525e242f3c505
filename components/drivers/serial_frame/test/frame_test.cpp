#include "drivers/serial_frame/core/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "support/bytes.hpp"

namespace usher::serial_frame {
namespace {

using test::Bytes;
using test::hex;

std::vector<Bytes> decode(FrameDecoder& decoder, std::span<const std::uint8_t> stream) {
  std::vector<Bytes> contents;
  decoder.feed(stream, [&](std::span<const std::uint8_t> content) {
    contents.emplace_back(content.begin(), content.end());
  });
  return contents;
}

TEST(Frame, HasTheChecksumOfTheStandard) {
  const std::string check = "123456789";
  EXPECT_EQ(crc16({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0x29B1);
  EXPECT_EQ(crc16({}), 0xFFFF);
}

TEST(Frame, MatchesTheWorkedExamples) {
  EXPECT_EQ(hex(encode(Bytes{0x21, 2}).span()), "05 21 02 9A 08 00");
  EXPECT_EQ(hex(encode(Bytes{0x20, 1, 0x38, 0xFF}).span()), "07 20 01 38 FF 72 16 00");
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
  EXPECT_EQ(decode(decoder, encode(Bytes{1}).span()).size(), 1U);
}

TEST(Frame, DamageCostsOneFrame) {
  Random random(2);
  for (int run = 0; run < 500; ++run) {
    Bytes stream;
    for (int i = 0; i < 50; ++i) {
      Bytes content(20);
      for (auto& byte : content) byte = static_cast<std::uint8_t>(random.below(4));
      const Frame frame = encode(content);
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
  const Frame frame = encode(Bytes{0x10, 1, 64, 226, 1, 0, 246, 4, 255, 255, 236, 9, 0, 0, 4, 5});
  Bytes stream(frame.span().begin() + 9, frame.span().end());
  const Frame second = encode(Bytes{0x21, 2});
  stream.insert(stream.end(), second.span().begin(), second.span().end());
  FrameDecoder decoder;
  EXPECT_EQ(decode(decoder, stream).size(), 1U);
}

}  // namespace
}  // namespace usher::serial_frame
