// Any bytes from the board, and any content with a right checksum.
#include <algorithm>
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
  hear(usher::serial_frame::to_frame(0, {1, {}, 0, {5, 8}}).span());
  hear({data, size});
  const Frame frame =
      usher::serial_frame::encode({data, std::min(size, usher::serial_frame::kLongestContent)});
  hear(frame.span());
  return 0;
}
