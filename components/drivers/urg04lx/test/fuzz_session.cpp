// Any bytes from the scanner: first after a dialogue that went well, so that scans are looked at
// too.
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "drivers/urg04lx/core/session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::urg04lx;
  constexpr std::string_view kDialogue =
      "QT\n00P\n\nSCIP2.0\n0Ee\n\nPP\n00P\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\nAMIN:44;7\n"
      "AMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\nMD0044072501000\n00P\n\n";
  Session session;
  session.opened(Time(0));
  session.received({reinterpret_cast<const std::uint8_t*>(kDialogue.data()), kDialogue.size()},
                   Time(0), [](const Scan&) {});
  if (session.state() != Session::State::kStreaming) std::abort();
  Time now{};
  std::span<const std::uint8_t> bytes(data, size);
  while (!bytes.empty()) {  // in pieces of a length that the input chooses
    const std::size_t piece =
        bytes.size() < bytes[0] + std::size_t{1} ? bytes.size() : bytes[0] + std::size_t{1};
    session.received(bytes.first(piece), now, [](const Scan& scan) {
      if (scan.ranges.empty() || !std::isfinite(scan.angle_min) || scan.angle_increment <= 0.0)
        std::abort();
    });
    bytes = bytes.subspan(piece);
    now += std::chrono::milliseconds(20);
    session.tick(now);
    session.take_output();
  }
  return 0;
}
