#include "runtime/guard/outbox.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace usher::runtime {
namespace {

using Kind = Outbox::Kind;

std::span<const std::uint8_t> bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
std::string text(std::span<const std::uint8_t> content) { return {content.begin(), content.end()}; }

TEST(Outbox, KeepsOrderAndBounds) {
  Outbox box;
  EXPECT_TRUE(box.push(Kind::kEach, bytes("one")));
  EXPECT_TRUE(box.push(Kind::kEach, bytes("two")));
  EXPECT_EQ(text(box.waiting()), "onetwo");
  EXPECT_EQ(text(box.first()), "one");
  box.sent(4);
  EXPECT_EQ(text(box.first()), "wo");
  box.sent(2);
  EXPECT_TRUE(box.empty());
  EXPECT_FALSE(box.push(Kind::kEach, bytes(std::string(Outbox::kMostBytes + 1, 'x'))));
  for (std::size_t i = 0; i < Outbox::kMostMessages; ++i) box.push(Kind::kEach, bytes("x"));
  EXPECT_FALSE(box.push(Kind::kEach, bytes("x")));
}

TEST(Outbox, TheNewestTakesThePlaceOfWhatWasNotBegun) {
  Outbox box;
  box.push(Kind::kLatest, bytes("1.0"));
  box.push(Kind::kEach, bytes("setting"));
  box.push(Kind::kLatest, bytes("0.5"));
  EXPECT_EQ(text(box.waiting()), "setting0.5") << "settings stay, the older velocity is gone";
  box.push(Kind::kLatest, bytes("0.0"));
  EXPECT_EQ(text(box.waiting()), "setting0.0");
}

TEST(Outbox, AMessageThatIsOnItsWayIsNeverCut) {
  Outbox box;
  box.push(Kind::kLatest, bytes("1.0"));
  box.sent(1);
  box.push(Kind::kLatest, bytes("0.5"));
  box.push(Kind::kLatest, bytes("0.0"));
  EXPECT_EQ(text(box.waiting()), ".00.0");
  box.drop_unsent();
  EXPECT_EQ(text(box.waiting()), ".0");
  box.sent(2);
  EXPECT_TRUE(box.empty());
}

TEST(Outbox, AFloodOfVelocitiesNeverFillsIt) {
  Outbox box;
  box.push(Kind::kLatest, bytes("velocity"));
  box.sent(3);
  for (int i = 0; i < 100000; ++i) ASSERT_TRUE(box.push(Kind::kLatest, bytes("velocity")));
  EXPECT_EQ(box.waiting().size(), 13U);
}

}  // namespace
}  // namespace usher::runtime
