#include "runtime/dds/rtps_message.hpp"

#include <gmock/gmock.h>

#include <random>
#include <vector>

namespace usher::runtime {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, const Bytes& more) {
  for (const std::uint8_t byte : more) bytes.push_back(byte);
}

Bytes header() {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  append(bytes, Bytes(12, 7));
  return bytes;
}
Bytes submessage(std::uint8_t id, std::uint8_t flags, const Bytes& body) {
  Bytes bytes{id, static_cast<std::uint8_t>(flags | 1U), static_cast<std::uint8_t>(body.size()), 0};
  append(bytes, body);
  return bytes;
}
Bytes message(const std::vector<Bytes>& parts) {
  Bytes bytes = header();
  for (const Bytes& part : parts) append(bytes, part);
  return bytes;
}

const Bytes kAnnouncer{0x00, 0x01, 0x00, 0xc2};
const Bytes kAuthenticator{0x00, 0x02, 0x01, 0xc3};
const Bytes kUserWriter{0x00, 0x00, 0x01, 0x03};
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kWithData = 0x04;
constexpr std::uint8_t kWithQos = 0x02;

/// A data submessage of a writer; `qos` are inline parameters.
Bytes data(const Bytes& writer, std::uint8_t flags = kWithData, const Bytes& qos = {}) {
  Bytes body{0, 0, 16, 0, 0, 0, 0, 0};
  append(body, writer);
  append(body, {0, 0, 0, 0, 1, 0, 0, 0});
  append(body, qos);
  append(body, {0, 1, 0, 0, 1, 2, 3, 4});
  return submessage(kData, flags, body);
}
Bytes statistics(std::size_t length = 56) { return submessage(0x80, 0, Bytes(length, 0)); }
Bytes signed_part(const Bytes& inside = data(kUserWriter)) {
  Bytes bytes = submessage(0x33, 0, Bytes(20, 1));
  append(bytes, inside);
  append(bytes, submessage(0x34, 0, Bytes(20, 2)));
  return bytes;
}
const Bytes kEnd{0x01, 0x00, 0x00, 0x00};
const Bytes kDisposed{0x71, 0x00, 0x04, 0x00, 0, 0, 0, 3};
const Bytes kRelated{0x0f, 0x80, 0x04, 0x00, 0, 0, 0, 0};
Bytes joined(Bytes first, const Bytes& second) {
  append(first, second);
  return first;
}

TEST(RtpsMessage, IsSignedWhenTheSignatureSpansIt) {
  EXPECT_EQ(classify(message({signed_part()})), MessageKind::kSigned);
  EXPECT_EQ(classify(message({signed_part(), statistics()})), MessageKind::kSigned);
}

TEST(RtpsMessage, IsUnsignedWhenAnythingLiesOutsideTheSignature) {
  EXPECT_EQ(classify(message({signed_part(), data(kUserWriter)})), MessageKind::kUnsigned);
  EXPECT_EQ(classify(message({data(kUserWriter), signed_part()})), MessageKind::kUnsigned);
  EXPECT_EQ(classify(message({data(kUserWriter)})), MessageKind::kUnsigned);
  EXPECT_EQ(classify(message({submessage(0x33, 0, Bytes(20, 1)), data(kUserWriter)})),
            MessageKind::kUnsigned)
      << "a signature that never ends";
  EXPECT_EQ(classify(message({submessage(0x0c, 0, Bytes(20, 1)), data(kAnnouncer)})),
            MessageKind::kUnsigned)
      << "in somebody else's name";
}

TEST(RtpsMessage, MayAnnounceAndAuthenticateInTheClear) {
  EXPECT_EQ(classify(message({submessage(0x09, 0, Bytes(8, 0)), data(kAnnouncer)})),
            MessageKind::kAnnouncement);
  EXPECT_EQ(classify(message({data(kAnnouncer, kWithData | kWithQos, joined(kRelated, kEnd))})),
            MessageKind::kAnnouncement);
  EXPECT_EQ(classify(message({data(kAuthenticator), statistics()})), MessageKind::kHandshake);
  EXPECT_EQ(classify(message({submessage(0x31, 0, Bytes(16, 0)), submessage(0x30, 0, Bytes(64, 0)),
                              submessage(0x32, 0, Bytes(20, 0))})),
            MessageKind::kHandshake);
  EXPECT_EQ(classify(message({submessage(0x31, 0, Bytes(16, 0)), data(kUserWriter),
                              submessage(0x32, 0, Bytes(20, 0))})),
            MessageKind::kUnsigned)
      << "a signed submessage may not hide one that Fast DDS takes for itself";
}

TEST(RtpsMessage, IsAFarewellHoweverItSaysSo) {
  EXPECT_EQ(classify(message({data(kAnnouncer, kWithQos, joined(kDisposed, kEnd))})),
            MessageKind::kFarewell);
  EXPECT_EQ(classify(message({data(kAnnouncer, kWithData | kWithQos, joined(kDisposed, kEnd))})),
            MessageKind::kFarewell);
  EXPECT_EQ(classify(message({data(kAnnouncer, kWithData | kWithQos,
                                   joined(joined(kRelated, kDisposed), kEnd))})),
            MessageKind::kFarewell);
  EXPECT_EQ(classify(message({data(kAnnouncer, 0x08)})), MessageKind::kFarewell) << "key only";
}

TEST(RtpsMessage, IsMalformedWhenFastDdsWouldNotSurviveIt) {
  EXPECT_EQ(classify(message({statistics(), data(kUserWriter)})), MessageKind::kMalformed);
  EXPECT_EQ(classify(message({signed_part(), statistics(), data(kUserWriter)})),
            MessageKind::kMalformed);
  EXPECT_EQ(classify(message({data(kUserWriter), statistics(12)})), MessageKind::kMalformed);
  Bytes other_vendor = message({submessage(0x80, 0, Bytes(12, 0)), data(kUserWriter)});
  other_vendor[7] = 16;
  EXPECT_EQ(classify(other_vendor), MessageKind::kUnsigned) << "there it means something else";
}

TEST(RtpsMessage, IsMalformedWhenItIsNone) {
  EXPECT_EQ(classify({}), MessageKind::kMalformed);
  EXPECT_EQ(classify(Bytes(64, 0)), MessageKind::kMalformed);
  Bytes cut = message({data(kUserWriter)});
  for (std::size_t size = header().size() + 1; size < cut.size(); ++size) {
    EXPECT_EQ(classify(std::span(cut).first(size)), MessageKind::kMalformed) << size;
  }
}

TEST(RtpsMessage, SurvivesAnyBytes) {
  std::mt19937 random(1);
  const Bytes good = message({data(kAnnouncer, kWithData | kWithQos, joined(kRelated, kEnd)),
                              signed_part(), statistics()});
  for (int i = 0; i < 200'000; ++i) {
    Bytes bytes = good;
    for (int change = 0; change < 4; ++change) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    bytes.resize(random() % (bytes.size() + 1));
    classify(std::vector<std::uint8_t>(bytes));
  }
}

}  // namespace
}  // namespace usher::runtime
