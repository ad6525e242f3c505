#include <cstdint>
#include <cstdlib>

#include "drivers/kinect/core/recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const bool little_endian : {false, true}) {
    const auto frame = usher::kinect::parse_pgm({data, size}, little_endian);
    if (!frame) continue;
    const auto pixels =
        static_cast<std::size_t>(frame->width) * static_cast<std::size_t>(frame->height);
    if (frame->millimeters.size() != pixels || 2 * pixels > size) std::abort();
  }
  if (const auto color = usher::kinect::parse_ppm({data, size})) {
    const auto pixels =
        static_cast<std::size_t>(color->width) * static_cast<std::size_t>(color->height);
    if (color->rgb.size() != 3 * pixels || 3 * pixels > size) std::abort();
  }
  return 0;
}
