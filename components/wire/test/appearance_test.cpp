#include "wire/appearance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::wire {
namespace {

TEST(Appearance, IsTheSameThereAndBack) {
  const imaging::Appearance dressed{{{42.0, 55.5, -20.25}, 2}, {{20.0, 0.0, 1.0}, 5}};
  const auto back = from_message(to_message(dressed));
  EXPECT_EQ(back.upper.color.lightness, 42.0);
  EXPECT_EQ(back.upper.color.a, 55.5);
  EXPECT_EQ(back.upper.color.b, -20.25);
  EXPECT_EQ(back.upper.images, 2);
  EXPECT_EQ(back.legs.color.b, 1.0);
  EXPECT_EQ(back.legs.images, 5);
}

TEST(Appearance, OfAMessageThatSaysNothingIsNotKnown) {
  EXPECT_FALSE(from_message(usher_msgs::msg::Appearance{}).known());
}

TEST(Appearance, ThatCannotBeIsNotKnown) {
  auto message = to_message({{{50.0, 10.0, 10.0}, 5}, {{50.0, 10.0, 10.0}, 5}});
  message.upper().a(std::nanf(""));
  EXPECT_FALSE(from_message(message).upper.known());
  EXPECT_TRUE(from_message(message).legs.known());
  message.legs().lightness(-3.0F);
  EXPECT_FALSE(from_message(message).known());
  message.upper().a(4.0F);
  message.upper().images(200);
  EXPECT_EQ(from_message(message).upper.images, imaging::ClothesColor::kImages);
}

}  // namespace
}  // namespace usher::wire
