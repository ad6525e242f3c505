#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/lms100/core/cola.hpp"
#include "drivers/lms100/core/device.hpp"
#include "drivers/lms100/core/scan_telegram.hpp"

namespace usher::lms100 {

/// The dialogue with one scanner: log in, configure, start, wait until it measures, subscribe, and
/// watch that scans keep coming. Bytes and time go in; bytes to send, scans and a verdict come out.
///
///   closed -> configuring (six commands) -> waiting for status 7 -> streaming
///   any    -> failed: the connection is to be closed and opened anew
class Session {
 public:
  struct Parameters {
    Dialect dialect = Dialect::kBinary;
    std::uint32_t frequency = 5000;   ///< [0.01 Hz] 2500 or 5000
    std::uint32_t resolution = 5000;  ///< [1e-4 deg] 2500 or 5000
    bool intensities = false;
    Time answer = std::chrono::seconds(5);  ///< per command; starting takes its time
    Time status_poll = std::chrono::seconds(1);
    Time spin_up = std::chrono::seconds(120);       ///< the motor after power-on
    Time silence = std::chrono::milliseconds(200);  ///< then scans are missing
    Time reconnect = std::chrono::seconds(2);       ///< then the connection is given up
  };

  enum class State : std::uint8_t { kClosed, kConfiguring, kSpinningUp, kStreaming, kFailed };

  Session();
  explicit Session(const Parameters& parameters);

  /// The connection is open. Bytes to send are waiting afterwards.
  void opened(Time now);
  /// The connection is gone, for whatever reason.
  void closed(const std::string& reason = "not connected");

  /// Bytes arrived. Every scan that completes is given to `on_scan`, in order; it is reused.
  template <class OnScan>
  void received(std::span<const std::uint8_t> bytes, Time now, OnScan&& on_scan) {
    while (!bytes.empty()) {
      bytes = bytes.subspan(decoder_.feed(bytes));
      while (const auto telegram = decoder_.next()) {
        if (handle(*telegram, now)) on_scan(static_cast<const Scan&>(scan_));
      }
    }
  }

  /// Time passed; call it at 10 Hz or more.
  void tick(Time now);

  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output();

  State state() const { return state_; }
  /// Why it is not streaming well, in words for an operator; empty when it is.
  const std::string& reason() const { return reason_; }
  /// Streaming, and scans come as they should.
  bool healthy() const { return state_ == State::kStreaming && reason_.empty(); }

  std::uint64_t scans() const { return scans_; }
  std::uint64_t lost_scans() const { return lost_scans_; }  ///< by the scan counter
  std::uint64_t rejected() const { return rejected_; }      ///< telegrams that made no sense
  const Decoder& decoder() const { return decoder_; }

 private:
  bool handle(const Telegram& telegram, Time now);
  bool handle_scan(const Message& message, Time now);
  void handle_answer(const Message& message, Time now);
  void send_step(Time now);
  void send(const Command& command, Time now);
  void fail(std::string reason);
  std::string_view awaited() const;

  Parameters parameters_;
  Decoder decoder_;
  State state_ = State::kClosed;
  std::size_t step_ = 0;  ///< of the configuration
  Time sent_{};           ///< the last command
  Time opened_{};
  Time last_scan_{};
  bool subscribed_ = false;
  std::vector<std::uint8_t> output_;
  std::string reason_ = "not connected";
  ScanTelegram telegram_;
  Scan scan_;
  estimation::DeviceClock clock_{kCounter};
  std::optional<std::uint16_t> last_counter_;
  std::uint64_t scans_ = 0;
  std::uint64_t lost_scans_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::lms100
