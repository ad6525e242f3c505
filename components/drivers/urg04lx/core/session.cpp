#include "drivers/urg04lx/core/session.hpp"

#include <cstdio>
#include <utility>

namespace usher::urg04lx {

void Session::opened(Time now) {
  reader_.reset();
  clock_.reset();
  output_.clear();
  reason_ = "waiting for the scanner to answer";
  enter(State::kStopping, now);
}

void Session::closed(const std::string& reason) {
  if (state_ != State::kFailed) reason_ = reason;  // a failure closes the line: that is why
  state_ = State::kClosed;
  output_.clear();
}

std::string Session::take_output() { return std::exchange(output_, {}); }

std::string Session::command() const {
  switch (state_) {
    case State::kStopping:
      return "QT";
    case State::kSwitching:
      return "SCIP2.0";
    case State::kAsking:
      return "PP";
    case State::kStarting: {
      char text[24];  // all steps, one by one, every scan, endless
      std::snprintf(text, sizeof(text), "MD%04d%04d01000", specification_.first_step,
                    specification_.last_step);
      return text;
    }
    default:
      return {};
  }
}

void Session::enter(State state, Time now) {
  state_ = state;
  attempts_ = 0;
  send(now);
}

void Session::send(Time now) {
  const std::string text = command();
  if (text.empty()) return;
  output_ += text + "\n";
  sent_ = now;
  ++attempts_;
}

bool Session::handle(const Answer& answer, Time now) {
  if (state_ == State::kClosed || state_ == State::kFailed) return false;
  if (answer.status == "99" && answer.echo.starts_with("MD")) return handle_scan(answer, now);
  if (!answer.echo.starts_with(command()) || command().empty()) {
    // Noise, or the end of what ran before.
    if (state_ == State::kStreaming && answer.echo.starts_with("MD")) {
      reason_ = "the scanner reports status " + std::string(answer.status);
    }
    return false;
  }
  switch (state_) {
    case State::kStopping:
      enter(State::kSwitching, now);
      break;
    case State::kSwitching:  // "0E" says that it was 2.0 already
      enter(State::kAsking, now);
      break;
    case State::kAsking:
      if (const auto specification = parse_specification(answer)) {
        specification_ = *specification;
        enter(State::kStarting, now);
      } else {
        ++rejected_;
        state_ = State::kFailed;
        reason_ = "the scanner's answer to PP makes no sense";
      }
      break;
    case State::kStarting:
      if (answer.status == "00") {
        state_ = State::kStreaming;
        reason_ = "waiting for the first scan";
        last_scan_ = now;
      } else {
        state_ = State::kFailed;
        reason_ = "the scanner refused MD: status " + std::string(answer.status);
      }
      break;
    default:
      break;
  }
  return false;
}

bool Session::handle_scan(const Answer& answer, Time now) {
  if (state_ != State::kStreaming) return false;
  std::uint32_t counter = 0;
  if (!parse_scan(answer, specification_, scan_, counter)) {
    ++rejected_;
    return false;
  }
  // The counter is that of step 0, and the answer leaves no sooner than the last step is measured:
  // that is what the clock makes of the counter.
  const int steps = specification_.last_step - specification_.first_step;
  scan_.stamp = clock_.stamp(counter, now) -
                Time(static_cast<std::int64_t>(1e9 * scan_.time_increment * steps));
  last_scan_ = now;
  reason_.clear();
  return true;
}

void Session::tick(Time now) {
  switch (state_) {
    case State::kClosed:
    case State::kFailed:
      break;
    case State::kStreaming:
      if (now - last_scan_ >= parameters_.restart) {
        reason_ = "no scans";
        enter(State::kStopping, now);
      } else if (now - last_scan_ >= parameters_.silence) {
        reason_ = "scans are missing";
      }
      break;
    default:
      if (now - sent_ < parameters_.answer) break;
      // A scanner with SCIP 1.1 does not know QT.
      if (state_ == State::kStopping && attempts_ > 1) {
        enter(State::kSwitching, now);
      } else if (attempts_ < parameters_.attempts) {
        send(now);
      } else {
        reason_ = "no answer to " + command();
        state_ = State::kFailed;
      }
      break;
  }
}

}  // namespace usher::urg04lx
