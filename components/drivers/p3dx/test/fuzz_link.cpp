// Any bytes from the base.
#include <cmath>
#include <cstdlib>

#include "drivers/p3dx/core/link.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::p3dx;
  Link link({});
  link.opened(Time(0));
  Time now{};
  std::span<const std::uint8_t> bytes(data, size);
  while (!bytes.empty()) {  // in pieces of a length that the input chooses
    const std::size_t piece =
        bytes.size() < bytes[0] + std::size_t{1} ? bytes.size() : bytes[0] + std::size_t{1};
    link.received(bytes.first(piece), now, [](const Feedback& feedback) {
      if (!feedback.pose.finite() || !feedback.twist.finite()) std::abort();
    });
    bytes = bytes.subspan(piece);
    now += std::chrono::milliseconds(20);
    if (link.cycle({0.5, 0.1}, now).size() > 4096) std::abort();
  }
  return 0;
}
