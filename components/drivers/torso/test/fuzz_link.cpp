// Any bytes from the torso's board, and any content with a right checksum.
#include <algorithm>
#include <cstdlib>

#include "drivers/torso/core/link.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher;
  torso::Link link;
  link.opened(torso::Time(0));
  torso::Time now{};
  const auto hear = [&](std::span<const std::uint8_t> bytes) {
    link.received(bytes, now, [](const torso::Reading& reading) {
      if (!kinematics::finite(reading.frame.joints)) std::abort();
      for (const double joint : reading.frame.joints) {
        if (joint < -3.2 || joint > 3.2) std::abort();
      }
    });
    now += std::chrono::milliseconds(50);
    link.tick(now);
    link.take_output();
  };
  hear(serial_frame::to_frame(0, {1, {}, 0, {7, 2}}).span());
  hear({data, size});
  const serial_frame::Frame frame =
      serial_frame::encode({data, std::min(size, serial_frame::kLongestContent)});
  hear(frame.span());
  torso::parse_command({data, size});
  return 0;
}
