#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "drivers/laser_scanner/shell/scan_publisher.hpp"

namespace usher::laser_scanner {

/// A scanner at the other end of a stream: feeds a Session with what arrives, sends what it wants
/// to say, publishes its scans, opens the line anew when it gave up, reports how it is.
///
/// A Session is a driver's core: opened, closed, received, tick, take_output, state, healthy,
/// reason (see lms100/core/session.hpp).
template <class Session>
class ScannerLine {
 public:
  struct Options {
    std::string address;  ///< default of the parameter of this name
    std::string text;     ///< of that parameter
    std::function<void(const Session&)>
        count;  ///< takes over the session's counts, 20 times a second
  };

  ScannerLine(runtime::Host& host, const Model& model, Session session, Options options)
      : host_(host),
        publisher_(host, model),
        session_(std::move(session)),
        count_(std::move(options.count)) {
    stream_ = &host.open_stream(host.parameters().text("address", options.address, options.text),
                                {.on_open =
                                     [this] {
                                       session_.opened(now());
                                       flush();
                                     },
                                 .on_bytes = [this](auto bytes) { take(bytes); },
                                 .on_close = [this](const std::string& reason) { lost(reason); }});
    timer_ = host.timer("tick", kTick, [this](auto) { tick(); });
  }

 private:
  static constexpr auto kTick = std::chrono::milliseconds(50);
  static constexpr auto kReopen = std::chrono::seconds(1);

  Time now() const { return host_.now().time_since_epoch(); }
  void take(std::span<const std::uint8_t> bytes) {
    session_.received(bytes, now(), [this](const Scan& scan) { publisher_.publish(scan); });
    flush();
  }
  void lost(const std::string& reason) {
    session_.closed(reason);
    host_.health().set(runtime::HealthState::kDegraded, session_.reason());
  }
  void tick() {
    session_.tick(now());
    flush();
    count_(session_);
    const bool repeats = session_.healthy() && publisher_.repeats();
    host_.health().set(session_.healthy() && !repeats ? runtime::HealthState::kOk
                                                      : runtime::HealthState::kDegraded,
                       repeats ? ScanPublisher::kRepeats : session_.reason());
  }
  void flush() {
    const auto output = session_.take_output();
    if (!output.empty())
      stream_->write({reinterpret_cast<const std::uint8_t*>(output.data()), output.size()});
    if (session_.state() == Session::State::kFailed) stream_->reopen(kReopen);
  }

  runtime::Host& host_;
  ScanPublisher publisher_;
  Session session_;
  std::function<void(const Session&)> count_;
  runtime::Stream* stream_ = nullptr;
  runtime::Timer timer_;
};

}  // namespace usher::laser_scanner
