// Any bytes from the scanner: the whole way from stream to scan, in both dialects.
#include <cmath>
#include <cstdlib>
#include <span>

#include "drivers/lms100/core/session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::lms100;
  std::span<const std::uint8_t> bytes(data, size);

  // Without the dialogue in front of it: every telegram as a scan.
  Decoder decoder;
  ScanTelegram telegram;
  Scan scan;
  usher::estimation::DeviceClock clock(kCounter);
  for (auto rest = bytes; !rest.empty();) {
    rest = rest.subspan(decoder.feed(rest));
    while (const auto frame = decoder.next()) {
      const auto message = open(*frame);
      if (!message || !read(*message, telegram)) continue;
      const Time arrival = std::chrono::milliseconds(20);
      if (!to_scan(telegram, measured_at(telegram, arrival, clock), scan)) continue;
      if (scan.ranges.empty() || !std::isfinite(scan.angle_min) || scan.angle_increment <= 0.0) {
        std::abort();
      }
    }
  }

  Session session;
  session.opened(Time(0));
  Time now{};
  while (!bytes.empty()) {  // in pieces of a length that the input chooses
    const std::size_t piece = std::min<std::size_t>(bytes.size(), bytes[0] + std::size_t{1});
    session.received(bytes.first(piece), now, [](const Scan&) {});
    bytes = bytes.subspan(piece);
    now += std::chrono::milliseconds(20);
    session.tick(now);
    session.take_output();
  }
  return 0;
}
