#include "drivers/lms100/core/session.hpp"

#include <array>
#include <utility>

namespace usher::lms100 {

namespace {

struct Step {
  const char* kind;
  const char* name;
  const char* answer;  ///< kind of the answer
};

// The order is the vendor's: settings are refused before the login, and Run ends it.
constexpr std::array<Step, 6> kSteps{{
    {"sMN", "SetAccessMode", "sAN"},
    {"sMN", "mLMPsetscancfg", "sAN"},
    {"sWN", "LMDscandatacfg", "sWA"},
    {"sWN", "LMPoutputRange", "sWA"},
    {"sMN", "LMCstartmeas", "sAN"},
    {"sMN", "Run", "sAN"},
}};

constexpr std::uint32_t kAuthorizedClient = 3;
constexpr std::uint32_t kPasswordHash = 0xF4724744;
constexpr std::int32_t kFirstAngle = -450000;  // [1e-4 deg]
constexpr std::int32_t kLastAngle = 2250000;
constexpr std::uint32_t kMeasuring = 7;

std::string_view config_error(std::uint32_t code) {
  switch (code) {
    case 1:
      return "frequency not allowed";
    case 2:
      return "resolution not allowed";
    case 3:
      return "frequency and resolution not allowed";
    case 4:
      return "scan area not allowed";
    default:
      return "refused";
  }
}

}  // namespace

Session::Session() : Session(Parameters{}) {}

Session::Session(const Parameters& parameters) : parameters_(parameters) {}

void Session::opened(Time now) {
  decoder_.reset();
  clock_.reset();
  last_counter_.reset();
  output_.clear();
  subscribed_ = false;
  step_ = 0;
  state_ = State::kConfiguring;
  reason_ = "configuring";
  opened_ = now;
  send_step(now);
}

void Session::closed(const std::string& reason) {
  if (state_ != State::kFailed) reason_ = reason;  // a failure closes the line: that is why
  state_ = State::kClosed;
  output_.clear();
}

void Session::fail(std::string reason) {
  state_ = State::kFailed;
  reason_ = std::move(reason);
}

std::vector<std::uint8_t> Session::take_output() { return std::exchange(output_, {}); }

void Session::send(const Command& command, Time now) {
  const std::vector<std::uint8_t> frame = command.frame();
  output_.insert(output_.end(), frame.begin(), frame.end());
  sent_ = now;
}

std::string_view Session::awaited() const {
  if (state_ == State::kConfiguring) return kSteps[step_].name;
  return state_ == State::kSpinningUp ? "STlms" : "LMDscandata";
}

void Session::send_step(Time now) {
  Command command(parameters_.dialect, kSteps[step_].kind, kSteps[step_].name);
  switch (step_) {
    case 0:
      command.number(kAuthorizedClient, 1).number(kPasswordHash, 4);
      break;
    case 1:
      command.number(parameters_.frequency, 4).number(1, 2).number(parameters_.resolution, 4);
      command.signed_number(kFirstAngle).signed_number(kLastAngle);
      break;
    case 2:
      command.number(1, 1).number(0, 1);                                // the first echo
      command.number(parameters_.intensities ? 1 : 0, 1).number(1, 1);  // remission, 16 bit
      command.number(0, 1).number(0, 1).number(0, 1);                   // unit, no encoder
      command.number(0, 1).number(0, 1).number(0, 1).number(0, 1);      // position .. time: none
      command.number(1, 2);                                             // every scan
      break;
    case 3:
      command.number(1, 2).number(parameters_.resolution, 4);
      command.signed_number(kFirstAngle).signed_number(kLastAngle);
      break;
    default:
      break;
  }
  send(command, now);
}

bool Session::handle(const Telegram& telegram, Time now) {
  if (state_ == State::kClosed || state_ == State::kFailed) return false;
  const auto message = open(telegram);
  if (!message) {
    ++rejected_;
    return false;
  }
  if (message->name == "LMDscandata" && (message->kind == "sSN" || message->kind == "sRA")) {
    return handle_scan(*message, now);
  }
  handle_answer(*message, now);
  return false;
}

bool Session::handle_scan(const Message& message, Time now) {
  // Scans of an older subscription may come before this one is set up.
  if (state_ != State::kStreaming) return false;
  if (!read(message, telegram_) ||
      !to_scan(telegram_, measured_at(telegram_, now, clock_), scan_)) {
    ++rejected_;
    return false;
  }
  if (last_counter_) {
    const auto gap = static_cast<std::uint16_t>(telegram_.scan_counter - *last_counter_);
    if (gap == 0) return false;  // the same scan again
    if (gap < 0x8000) lost_scans_ += gap - 1U;
  }
  last_counter_ = telegram_.scan_counter;
  last_scan_ = now;
  ++scans_;
  // 0 is well; 2 warns of pollution and still measures; all others are not to be trusted.
  const int status = telegram_.status[1];
  if (status == 0) {
    reason_.clear();
  } else if (status == 1) {
    reason_ = "the scanner reports an error";
  } else if (telegram_.polluted()) {
    reason_ = "the scanner's window is dirty";
  } else {
    reason_ = "the scanner reports status " + std::to_string(status);
  }
  return status == 0 || status == 2;
}

void Session::handle_answer(const Message& message, Time now) {
  FieldReader fields = message.fields;
  if (message.kind == "sFA") {
    // While streaming nothing is asked, so nothing can be refused that matters.
    if (state_ == State::kStreaming) return;
    const std::uint32_t code = fields.number(2);
    fail(std::string("the scanner refused ")
             .append(awaited())
             .append(": ")
             .append(error_text(code)));
    return;
  }
  if (state_ == State::kConfiguring) {
    const Step& step = kSteps[step_];
    if (message.kind != step.answer || message.name != step.name) return;
    if (step_ == 0 && fields.number(1) != 1) {
      fail("the scanner refused the login");
      return;
    }
    if (step_ == 1) {
      if (const std::uint32_t code = fields.number(1); code != 0) {
        fail(std::string("the scanner refused mLMPsetscancfg: ").append(config_error(code)));
        return;
      }
    }
    ++step_;
    if (step_ < kSteps.size()) {
      send_step(now);
      return;
    }
    state_ = State::kSpinningUp;
    reason_ = "waiting until the scanner measures";
    send(Command(parameters_.dialect, "sRN", "STlms"), now);
  } else if (state_ == State::kSpinningUp) {
    if (message.kind == "sRA" && message.name == "STlms" && !subscribed_) {
      if (fields.number(2) == kMeasuring && fields.ok()) {
        send(Command(parameters_.dialect, "sEN", "LMDscandata").number(1, 1), now);
        subscribed_ = true;
      }
    } else if (message.kind == "sEA" && message.name == "LMDscandata") {
      state_ = State::kStreaming;
      reason_ = "waiting for the first scan";
      last_scan_ = now;
    }
  }
}

void Session::tick(Time now) {
  switch (state_) {
    case State::kClosed:
    case State::kFailed:
      break;
    case State::kConfiguring:
      if (now - sent_ >= parameters_.answer) {
        fail(std::string("no answer to ").append(awaited()));
      }
      break;
    case State::kSpinningUp:
      if (now - opened_ >= parameters_.spin_up) {
        fail("the scanner does not begin to measure");
      } else if (subscribed_ && now - sent_ >= parameters_.answer) {
        fail("no answer to sEN LMDscandata");
      } else if (!subscribed_ && now - sent_ >= parameters_.status_poll) {
        send(Command(parameters_.dialect, "sRN", "STlms"), now);
      }
      break;
    case State::kStreaming:
      if (now - last_scan_ >= parameters_.reconnect) {
        fail("no scans");
      } else if (now - last_scan_ >= parameters_.silence) {
        reason_ = "scans are missing";
      }
      break;
  }
}

}  // namespace usher::lms100
