#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace usher::tablet {

struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Color&) const = default;
};

/// Relative luminance and contrast ratio of WCAG 2.2 (1..21).
double luminance(const Color& color);
double contrast(const Color& a, const Color& b);

/// The colors of the thesis, section 7.2.1: vibrant buttons on dark grey. Dark text on them: white
/// would miss WCAG's AAA.
struct Palette {
  Color background{0x24, 0x26, 0x2b};
  Color surface{0x33, 0x36, 0x3d};  ///< map, bars, keys
  Color title{0xff, 0xff, 0xff};
  Color text{0xe6, 0xe8, 0xec};
  Color status{0xc2, 0xc6, 0xce};
  Color yes{0x5c, 0xd6, 0x7e};
  Color no{0xff, 0x8a, 0x80};
  Color option{0x7c, 0xb9, 0xff};
  Color service{0xd5, 0xd9, 0xe0};
  Color ink{0x10, 0x12, 0x16};  ///< on buttons
  Color focus{0xff, 0xd5, 0x4f};
  Color wall{0xe6, 0xe8, 0xec};
  Color floor{0x45, 0x49, 0x52};
  Color unknown{0x24, 0x26, 0x2b};
  Color route{0x7c, 0xb9, 0xff};
  Color robot{0xff, 0xd5, 0x4f};
  Color goal{0x5c, 0xd6, 0x7e};
};
inline constexpr Palette kPalette{};

/// Sizes on the thesis' display: 2160 x 1440 pixels on 12 inch (8.5 pixels a millimetre), scaled
/// with the window. Its units of text are 1/96 inch at that tablet's scaling of 150 %.
struct Sizes {
  static constexpr double kWidth = 2160.0, kHeight = 1440.0;
  static constexpr double kTextUnit = 1.5;            ///< [px]
  static constexpr double kButtonWidth = 383.0;       ///< 45 mm
  static constexpr double kButtonHeight = 187.0;      ///< 22 mm
  static constexpr double kTitle = 72.0 * kTextUnit;  ///< [px]
  static constexpr double kButtonText = 60.0 * kTextUnit;
  static constexpr double kStatus = 50.0 * kTextUnit;
  static constexpr double kMapName = 56.0;  ///< [px] of places; small letters of 3.6 mm
};

}  // namespace usher::tablet
