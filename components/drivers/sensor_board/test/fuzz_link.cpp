// Any bytes from the board, and any content with a right checksum.
#include <cstdlib>

#include "drivers/sensor_board/core/link.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::sensor_board;
  Link link;
  link.opened(Time(0));
  Time now{};
  const auto hear = [&](std::span<const std::uint8_t> bytes) {
    link.received(bytes, now, [](const Reading& reading) {
      for (const float range : reading.ranges) {
        if (range < 0.0F) std::abort();
      }
    });
    now += std::chrono::milliseconds(50);
    link.tick(now);
    link.take_output();
  };
  hear({data, size});
  const Frame frame = encode({data, size < kLongestContent ? size : kLongestContent});
  hear(frame.span());
  return 0;
}
