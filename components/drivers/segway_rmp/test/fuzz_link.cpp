// Any bytes from the base.
#include <cmath>
#include <cstdlib>

#include "drivers/segway_rmp/core/link.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::segway_rmp;
  Link link;
  link.opened(Time(0));
  Time now = std::chrono::seconds(1);
  double last_left = 0.0;
  for (std::size_t at = 0; at < size; at += 62) {  // as the USB bridge delivers
    const std::size_t length = size - at < 62 ? size - at : 62;
    link.received({data + at, length}, now, [&last_left](const SegwayFeedback& feedback) {
      const bool sound = std::isfinite(feedback.pitch) && std::isfinite(feedback.left_velocity) &&
                         std::abs(feedback.left_travel - last_left) <= 1.0 * 64.0;
      if (!sound) std::abort();
      last_left = feedback.left_travel;
    });
    now += std::chrono::milliseconds(10);
    if (link.cycle({0.5, 0.1}, now).size() != kPacketSize) std::abort();
  }
  return 0;
}
