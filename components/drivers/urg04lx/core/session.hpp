#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "drivers/urg04lx/core/scip.hpp"

namespace usher::urg04lx {

/// The dialogue with one scanner (SCIP 2.0): end what ran before, leave SCIP 1.1 and the time mode,
/// ask for its facts, stream all steps, and watch that scans keep coming.
///
///   closed -> stopping (QT) -> switching (SCIP2.0) -> asking (PP) -> starting (MD) -> streaming
///   any    -> failed: the connection is to be closed and opened anew
class Session {
 public:
  struct Parameters {
    Time answer = std::chrono::seconds(1);           ///< per command
    Time silence = std::chrono::milliseconds(300);   ///< then scans are missing
    Time restart = std::chrono::milliseconds(1600);  ///< then the stream is started anew
    int attempts = 3;                                ///< of a command before it has failed
  };
  enum class State : std::uint8_t {
    kClosed,
    kStopping,
    kSwitching,
    kAsking,
    kStarting,
    kStreaming,
    kFailed
  };

  Session() : Session(Parameters{}) {}
  explicit Session(const Parameters& parameters) : parameters_(parameters) {}

  void opened(Time now);
  void closed(const std::string& reason = "not connected");

  /// Bytes arrived. Every scan that completes is given to `on_scan`; it is reused.
  template <class OnScan>
  void received(std::span<const std::uint8_t> bytes, Time now, OnScan&& on_scan) {
    reader_.feed(bytes, [&](const Answer& answer) {
      if (handle(answer, now)) on_scan(static_cast<const Scan&>(scan_));
    });
  }
  /// Time passed; call it at 10 Hz or more.
  void tick(Time now);
  /// What is to be sent; empties it.
  std::string take_output();

  State state() const { return state_; }
  /// Why it is not streaming well; empty when it is.
  const std::string& reason() const { return reason_; }
  bool healthy() const { return state_ == State::kStreaming && reason_.empty(); }
  std::uint64_t rejected() const { return rejected_ + reader_.damaged(); }
  const Specification& specification() const { return specification_; }

 private:
  bool handle(const Answer& answer, Time now);
  bool handle_scan(const Answer& answer, Time now);
  void enter(State state, Time now);
  void send(Time now);
  std::string command() const;

  Parameters parameters_;
  Reader reader_;
  State state_ = State::kClosed;
  Time sent_{};
  Time last_scan_{};
  int attempts_ = 0;
  std::string output_;
  std::string reason_ = "not connected";
  Specification specification_;
  Scan scan_;
  estimation::DeviceClock clock_{kCounter};
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::urg04lx
