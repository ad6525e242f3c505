#include "runtime/dds/rtps_message.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <utility>
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

TEST(RtpsMessage, IsForSomebodyElseWhenTheAddresseeIsAnother) {
  const auto step = [](std::uint8_t addressee, const Bytes& writer) {
    Bytes bytes = data(writer);
    bytes.resize(4 + 24 + 48);
    append(bytes, Bytes(12, addressee));
    append(bytes, Bytes(8, 0));
    bytes[2] = static_cast<std::uint8_t>(bytes.size() - 4);
    return bytes;
  };
  const Bytes to = submessage(0x0e, 0, Bytes(12, 5));
  EXPECT_FALSE(is_for_somebody_else(message({to, step(5, kAuthenticator)})));
  EXPECT_TRUE(is_for_somebody_else(message({to, step(6, kAuthenticator), statistics()})));
  EXPECT_FALSE(is_for_somebody_else(message({to, step(6, kUserWriter)}))) << "no authentication";
  EXPECT_FALSE(is_for_somebody_else(message({step(6, kAuthenticator)}))) << "to everybody";
  EXPECT_FALSE(is_for_somebody_else(message({to, data(kAuthenticator)}))) << "too short";
  EXPECT_FALSE(is_for_somebody_else({}));
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

/// Of a user's writer, with little endian numbers.
bool is_malformed(const Bytes& part, const Bytes& next = {}) {
  return classify(message({part, next})) == MessageKind::kMalformed;
}
Bytes changed(Bytes bytes, std::size_t at, const Bytes& by) {
  std::ranges::copy(by, bytes.begin() + static_cast<std::ptrdiff_t>(at));
  return bytes;
}

TEST(RtpsMessage, IsMalformedWhenTheNextPartWouldBeSoughtElsewhere) {
  EXPECT_FALSE(is_malformed(submessage(0x01, 0, Bytes(4, 0)), data(kUserWriter)));
  EXPECT_TRUE(is_malformed(submessage(0x01, 0, Bytes(3, 0)), data(kUserWriter)));
  EXPECT_FALSE(is_malformed(submessage(0x01, 0, Bytes(3, 0)))) << "nothing follows";
}

TEST(RtpsMessage, IsMalformedWhenASampleDoesNotFitIntoItsPart) {
  constexpr std::size_t kOffsetAt = 6;
  const Bytes good = data(kUserWriter);
  EXPECT_FALSE(is_malformed(good));
  EXPECT_FALSE(is_malformed(changed(good, kOffsetAt, {20, 0}))) << "with something before it";
  for (const Bytes& offset : {Bytes{15, 0}, Bytes{21, 0}, Bytes{0, 4}, Bytes{0xf0, 0xff}})
    EXPECT_TRUE(is_malformed(changed(good, kOffsetAt, offset))) << int{offset[0]};
  EXPECT_TRUE(is_malformed(submessage(kData, kWithData, Bytes(19, 0))));
  EXPECT_TRUE(is_malformed(data(kUserWriter, kWithData | 0x08))) << "sample and key";
  EXPECT_FALSE(is_malformed(data(kUserWriter, kWithData | kWithQos, joined(kRelated, kEnd))));
  const Bytes endless{0x0f, 0x80, 0x04, 0x00, 0, 0, 0, 0};
  EXPECT_TRUE(is_malformed(data(kUserWriter, kWithData | kWithQos, endless)));
  EXPECT_TRUE(is_malformed(data(kUserWriter, kWithData | kWithQos, {0x0f, 0x80, 0xff, 0x7f})));
  EXPECT_TRUE(is_malformed(data(kUserWriter, kWithData | kWithQos,
                                {0x0f, 0x80, 0x02, 0x00, 0, 0, 0x01, 0x00, 0x00, 0x00})));
}

TEST(RtpsMessage, IsMalformedWhenFragmentsDoNotMakeUpTheirSample) {
  // Fragments 3 and 4, of 8 bytes each, of a sample of 30 bytes.
  Bytes body(20, 0);
  body[2] = 28;
  append(body, {3, 0, 0, 0, 2, 0, 8, 0, 30, 0, 0, 0});
  append(body, Bytes(14, 1));
  const Bytes good = submessage(0x16, 0, body);
  EXPECT_FALSE(is_malformed(good));
  EXPECT_TRUE(is_malformed(changed(good, 24, {0}))) << "the first is 1";
  EXPECT_TRUE(is_malformed(changed(good, 24, {4}))) << "there is no fifth";
  EXPECT_TRUE(is_malformed(changed(good, 28, {0}))) << "none";
  EXPECT_TRUE(is_malformed(changed(good, 30, {0}))) << "of no length";
  EXPECT_TRUE(is_malformed(changed(good, 30, {10}))) << "then there are three";
  EXPECT_TRUE(is_malformed(changed(good, 32, {32}))) << "more than is there";
  EXPECT_TRUE(is_malformed(changed(good, 24, {0, 0, 0, 0x80})));
  EXPECT_TRUE(is_malformed(changed(good, 32, {0, 0, 0, 0x80}))) << "2 GB";
  EXPECT_TRUE(is_malformed(changed(good, 1, {0x05}))) << "key only";
}

TEST(RtpsMessage, IsMalformedWhenNumbersAreMissing) {
  const auto set = [](std::size_t before, std::uint8_t bits, std::size_t after) {
    Bytes body(before, 0);
    append(body, {bits, 0, 0, 0});
    append(body, Bytes(after, 0));
    return body;
  };
  EXPECT_FALSE(is_malformed(submessage(0x06, 0, set(16, 33, 8 + 4))));
  EXPECT_TRUE(is_malformed(submessage(0x06, 0, set(16, 33, 8))));
  EXPECT_TRUE(is_malformed(submessage(0x06, 0, Bytes(20, 0))));
  EXPECT_FALSE(is_malformed(submessage(0x08, 0, set(24, 32, 4))));
  EXPECT_TRUE(is_malformed(submessage(0x08, 0, set(24, 33, 4))));
  EXPECT_FALSE(is_malformed(submessage(0x12, 0, set(20, 32, 4 + 4))));
  EXPECT_TRUE(is_malformed(submessage(0x12, 0, set(20, 33, 4 + 4))));
  const Bytes many = changed(submessage(0x06, 0, set(16, 0, 120)), 20, {1, 1});
  EXPECT_TRUE(is_malformed(many)) << "257 bits";
  for (const auto& [id, size] : std::vector<std::pair<std::uint8_t, std::size_t>>{
           {0x07, 28}, {0x13, 24}, {0x0e, 12}, {0x0c, 20}, {0x09, 8}}) {
    EXPECT_FALSE(is_malformed(submessage(id, 0, Bytes(size, 0)))) << int{id};
    EXPECT_TRUE(is_malformed(submessage(id, 0, Bytes(size - 4, 0)))) << int{id};
  }
  EXPECT_FALSE(is_malformed(submessage(0x09, 0x02, {}), data(kUserWriter))) << "no time";
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
    is_for_somebody_else(std::vector<std::uint8_t>(bytes));
  }
}

}  // namespace
}  // namespace usher::runtime
