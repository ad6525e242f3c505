#pragma once

#include <array>
#include <cstdint>

#include "foundation/random/random.hpp"

namespace usher::rendering {

/// What somebody wears, in sRGB as even white light shows it.
struct Clothes {
  using Color = std::array<std::uint8_t, 3>;
  Color upper{128, 128, 128};
  Color legs{64, 64, 64};
};

/// As people dress indoors: most in black, grey, navy, white and jeans, some in colors.
Clothes draw_clothes(Random& random);

}  // namespace usher::rendering
