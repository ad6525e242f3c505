#include <cstdlib>

#include "drivers/gamepad/core/joystick.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  usher::gamepad::Joystick pad;
  pad.received({data, size});
  for (const float axis : pad.axes()) {
    if (!(axis >= -1.0F && axis <= 1.0F)) std::abort();
  }
  for (const auto button : pad.buttons()) {
    if (button != 0 && button != 1) std::abort();
  }
  if (pad.axes().size() > pad.kMostAxes || pad.buttons().size() > pad.kMostButtons) std::abort();
  return 0;
}
