#include "wire/appearance.hpp"

#include <algorithm>
#include <cmath>

namespace usher::wire {

namespace {

using imaging::ClothesColor;

constexpr float kLightest = 100.0F;
constexpr float kMostChroma = 128.0F;

usher_msgs::msg::ClothesColor to_message(const ClothesColor& clothes) {
  usher_msgs::msg::ClothesColor message;
  message.lightness(static_cast<float>(clothes.color.lightness));
  message.a(static_cast<float>(clothes.color.a));
  message.b(static_cast<float>(clothes.color.b));
  message.images(static_cast<std::uint8_t>(clothes.images));
  return message;
}

ClothesColor from_message(const usher_msgs::msg::ClothesColor& message) {
  const bool sane = message.lightness() >= 0.0F && message.lightness() <= kLightest &&
                    std::abs(message.a()) <= kMostChroma && std::abs(message.b()) <= kMostChroma;
  if (!sane) return {};
  return {{static_cast<double>(message.lightness()), static_cast<double>(message.a()),
           static_cast<double>(message.b())},
          std::min<int>(message.images(), ClothesColor::kImages)};
}

}  // namespace

usher_msgs::msg::Appearance to_message(const imaging::Appearance& appearance) {
  usher_msgs::msg::Appearance message;
  message.upper(to_message(appearance.upper));
  message.legs(to_message(appearance.legs));
  return message;
}

imaging::Appearance from_message(const usher_msgs::msg::Appearance& message) {
  return {from_message(message.upper()), from_message(message.legs())};
}

}  // namespace usher::wire
