#include "simulation/rendering/core/clothes.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace usher::rendering {

namespace {

struct Kind {
  double share;
  Clothes::Color color;
};

constexpr double kShade = 0.15;  // by which the lightness of a kind differs, relative
constexpr double kTint = 6.0;    // {0..255} and each of its channels

constexpr std::array<Kind, 14> kUppers{{{0.20, {28, 28, 30}},
                                        {0.09, {70, 72, 76}},
                                        {0.08, {150, 150, 152}},
                                        {0.13, {215, 213, 208}},
                                        {0.12, {30, 40, 72}},
                                        {0.08, {70, 105, 170}},
                                        {0.05, {140, 175, 215}},
                                        {0.06, {165, 35, 40}},
                                        {0.04, {95, 25, 45}},
                                        {0.05, {50, 95, 60}},
                                        {0.04, {105, 105, 65}},
                                        {0.03, {215, 175, 60}},
                                        {0.02, {110, 70, 135}},
                                        {0.01, {220, 140, 160}}}};
constexpr std::array<Kind, 8> kLegs{{{0.28, {30, 30, 33}},
                                     {0.24, {48, 66, 100}},
                                     {0.10, {95, 120, 160}},
                                     {0.11, {32, 40, 66}},
                                     {0.11, {75, 76, 80}},
                                     {0.08, {165, 145, 115}},
                                     {0.05, {95, 75, 55}},
                                     {0.03, {85, 90, 65}}}};

Clothes::Color draw(std::span<const Kind> kinds, Random& random) {
  double left = random.uniform();
  const Kind* kind = &kinds.back();
  for (const Kind& each : kinds) {
    if (left < each.share) {
      kind = &each;
      break;
    }
    left -= each.share;
  }
  const double shade = std::exp(random.gaussian(0.0, kShade));
  Clothes::Color color{};
  for (std::size_t k = 0; k < color.size(); ++k) {
    const double value = shade * kind->color[k] + random.gaussian(0.0, kTint);
    color[k] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 8.0, 235.0)));
  }
  return color;
}

}  // namespace

Clothes draw_clothes(Random& random) {
  Clothes clothes;
  clothes.upper = draw(kUppers, random);
  clothes.legs = draw(kLegs, random);
  return clothes;
}

}  // namespace usher::rendering
