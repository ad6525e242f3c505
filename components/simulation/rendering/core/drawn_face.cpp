#include <algorithm>
#include <array>
#include <cmath>

#include "foundation/random/random.hpp"
#include "simulation/rendering/core/texture.hpp"

namespace usher::rendering {

namespace {

/// What makes one drawn face differ from another; lengths in halves of the picture.
struct Look {
  Texture::Color skin{}, hair{}, lips{}, iris{};
  float eyes = 0.32F;       // from the middle
  float brow = 0.045F;      // half its thickness
  float mouth = 0.24F;      // half its width
  float nose = 0.13F;       // half its width
  float width = 0.74F;      // of the oval
  float hairline = -0.62F;  // above it is hair
  float light = 0.0F;       // from the side
};

constexpr std::array<Texture::Color, 5> kSkins{
    {{236, 196, 170}, {222, 178, 146}, {198, 150, 116}, {168, 118, 88}, {240, 208, 188}}};
constexpr std::array<Texture::Color, 5> kHairs{
    {{52, 38, 30}, {28, 24, 24}, {96, 66, 40}, {120, 110, 104}, {70, 42, 28}}};

Look look_of(std::uint64_t number) {
  Random random(stream_seed(number, "drawn face"));
  const auto vary = [&](double middle, double by) {
    return static_cast<float>(random.uniform(middle - by, middle + by));
  };
  Look look;
  look.skin = kSkins[random.below(kSkins.size())];
  look.hair = kHairs[random.below(kHairs.size())];
  look.lips = {0.80F * look.skin[0], 0.55F * look.skin[1], 0.55F * look.skin[2]};
  look.iris = {48, 40, 36};
  look.eyes = vary(0.32, 0.02);
  look.brow = vary(0.045, 0.012);
  look.mouth = vary(0.24, 0.04);
  look.nose = vary(0.13, 0.02);
  look.width = vary(0.74, 0.03);
  look.hairline = vary(-0.62, 0.05);
  look.light = vary(0.0, 0.12);
  return look;
}

/// 1 inside an ellipse, 0 outside, with a soft edge.
float ellipse(float x, float y, float half_width, float half_height, float soft = 0.25F) {
  const float r = std::hypot(x / half_width, y / half_height);
  const float t = std::clamp((1.0F + soft - r) / (2.0F * soft), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

float bump(float x, float y, float width, float height) {
  return std::exp(-0.5F * (x * x / (width * width) + y * y / (height * height)));
}

void blend(Texture::Color& color, const Texture::Color& with, float share) {
  for (std::size_t k = 0; k < 3; ++k) color[k] += share * (with[k] - color[k]);
}

void shade(Texture::Color& color, float factor) {
  for (float& value : color) value *= factor;
}

/// How light falls on the skin: sockets, bridge and wings of the nose, cheeks, chin.
float relief(const Look& look, float x, float y) {
  const float side = std::abs(x);
  float light = 1.0F - 0.28F * (x * x / (look.width * look.width)) - 0.10F * y * y;
  light += look.light * x;
  light -= 0.30F * bump(side - look.eyes, y + 0.14F, 0.17F, 0.09F);
  light += 0.12F * bump(x, y - 0.02F, 0.06F, 0.22F);
  light -= 0.22F * bump(x, y - 0.27F, look.nose, 0.035F);
  light -= 0.08F * bump(side - 0.10F, y - 0.05F, 0.03F, 0.16F);
  light += 0.07F * bump(side - 0.40F, y - 0.18F, 0.14F, 0.14F);
  light += 0.06F * bump(x, y + 0.45F, 0.35F, 0.12F);
  light -= 0.14F * bump(x, y - 0.66F, 0.20F, 0.04F);
  return light;
}

Texture::Color color_at(const Look& look, float x, float y) {
  const float side = std::abs(x);
  Texture::Color skin = look.skin;
  blend(skin, look.lips, 0.75F * ellipse(x, y - 0.50F, look.mouth, 0.07F));
  shade(skin, relief(look, x, y));
  blend(skin, {235, 230, 226}, 0.7F * ellipse(side - look.eyes, y + 0.12F, 0.11F, 0.045F));
  blend(skin, look.iris, ellipse(side - look.eyes, y + 0.12F, 0.055F, 0.055F));
  blend(skin, look.iris, 0.7F * ellipse(side - look.eyes, y + 0.165F, 0.13F, 0.02F));
  blend(
      skin, look.hair,
      0.85F * ellipse(side - look.eyes, y + 0.30F + 0.35F * (side - look.eyes) * (side - look.eyes),
                      0.19F, look.brow));
  blend(skin, {70, 40, 36}, 0.8F * ellipse(side - 0.065F, y - 0.255F, 0.03F, 0.02F));
  blend(skin, {84, 40, 40}, 0.85F * ellipse(x, y - 0.49F, look.mouth, 0.018F));

  Texture::Color color = look.hair;
  blend(color, skin, ellipse(x, y - 0.08F, look.width, 0.92F, 0.05F));
  const float line = look.hairline + 0.25F * x * x;
  const float hair = std::clamp((line - y) / 0.08F + 0.5F, 0.0F, 1.0F);
  blend(color, look.hair, hair);
  return color;
}

}  // namespace

Texture drawn_face(std::uint64_t number, int side) {
  const Look look = look_of(number);
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto at = [&](int index) {
        return (2.0F * static_cast<float>(index) + 1.0F) / static_cast<float>(side) - 1.0F;
      };
      for (const float value : color_at(look, at(column), at(row)))
        rgb.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F)));
    }
  }
  return Texture::make(side, rgb).value();
}

}  // namespace usher::rendering
