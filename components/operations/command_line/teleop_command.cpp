#include <poll.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "control/manual_control/core/manual_control.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
using namespace usher_msgs::msg;

constexpr auto kRound = milliseconds(20);
constexpr auto kJoyPeriod = milliseconds(40);
constexpr auto kLinePeriod = milliseconds(200);
constexpr float kFinest = 0.1F, kCoarsest = 1.0F, kStep = 0.1F;
constexpr const char* kHelp =
    "w/s or up/down drive, a/d or left/right turn, q/e drive and turn; hold the key: the robot "
    "stops when it is released\n"
    "space stops, +/- pace, x ends\n";

std::atomic<bool> interrupted{false};

/// Keys one at a time, unseen; the terminal is as it was when this ends.
class RawTerminal {
 public:
  RawTerminal() {
    valid_ = tcgetattr(STDIN_FILENO, &before_) == 0;
    if (!valid_) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawTerminal() {
    if (valid_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  termios before_{};
  bool valid_ = false;
};

/// The next key; arrows as the letters that mean the same. Nothing when none comes in time.
std::optional<char> next_key(milliseconds limit) {
  pollfd entry{STDIN_FILENO, POLLIN, 0};
  if (::poll(&entry, 1, static_cast<int>(limit.count())) <= 0) return std::nullopt;
  char bytes[3] = {};
  if (::read(STDIN_FILENO, bytes, 1) != 1) return 'x';  // nobody is there any more
  if (bytes[0] != '\033') return bytes[0];
  if (::poll(&entry, 1, 5) <= 0 || ::read(STDIN_FILENO, bytes + 1, 2) != 2) return std::nullopt;
  constexpr std::string_view kArrows = "ABCD", kMeaning = "wsda";
  const auto arrow = kArrows.find(bytes[2]);
  return arrow == std::string_view::npos ? std::nullopt : std::optional(kMeaning[arrow]);
}

struct Sticks {
  float forward = 0.0F, turn = 0.0F;
};

std::optional<Sticks> sticks_of(char key) {
  switch (key) {
    case 'w':
      return Sticks{1, 0};
    case 's':
      return Sticks{-1, 0};
    case 'a':
      return Sticks{0, 1};
    case 'd':
      return Sticks{0, -1};
    case 'q':
      return Sticks{1, 1};
    case 'e':
      return Sticks{1, -1};
    default:
      return std::nullopt;
  }
}

/// A keyboard as a gamepad: a key that repeats is a stick that is held, and the dead-man button.
class Keyboard {
 public:
  explicit Keyboard(milliseconds hold) : hold_(hold) {}

  void press(char key, Clock::time_point now) {
    if (const auto sticks = sticks_of(key)) {
      sticks_ = *sticks;
      held_until_ = now + hold_;
    } else if (key == ' ') {
      held_until_ = {};
    } else if (key == '+' || key == '=') {
      pace_ = std::min(kCoarsest, pace_ + kStep);
    } else if (key == '-') {
      pace_ = std::max(kFinest, pace_ - kStep);
    }
  }
  bool held(Clock::time_point now) const { return now < held_until_; }
  float pace() const { return pace_; }

  sensor_msgs::msg::Joy joy(Clock::time_point now, runtime::Time stamp) const {
    const bool down = held(now);
    sensor_msgs::msg::Joy message;
    message.header(wire::header(stamp, ""));
    constexpr auto& kMap = manual_control::kKeyboardMapping;
    std::vector<float> axes(std::max(kMap.forward_axis, kMap.turn_axis) + 1, 0.0F);
    std::vector<std::int32_t> buttons(kMap.dead_man + 1, 0);
    if (down) {
      axes[kMap.forward_axis] = pace_ * sticks_.forward;
      axes[kMap.turn_axis] = pace_ * sticks_.turn;
      buttons[kMap.dead_man] = 1;
    }
    message.axes(axes);
    message.buttons(buttons);
    return message;
  }

 private:
  const milliseconds hold_;
  Sticks sticks_;
  float pace_ = 0.5F;
  Clock::time_point held_until_{};
};

void show(const Keyboard& keyboard, const std::optional<MovementStatus>& movement,
          Clock::time_point now) {
  std::string line = keyboard.held(now) ? "driving " : "standing";
  line += "  pace " + format("%3.0f %%", keyboard.pace() * 100.0);
  if (movement) {
    line += "  commanded " + format("%5.2f m/s", movement->velocity_current_linear()) +
            format(" %5.2f rad/s", movement->velocity_current_angular()) + "  measured " +
            format("%5.2f m/s", movement->velocity_measured_linear());
    if (!movement->limit_reason().empty()) line += "  " + movement->limit_reason();
  }
  std::cout << "\r" << line << "\033[K" << std::flush;
}

int teleop(std::uint32_t domain, milliseconds hold) {
  static_assert(manual_control::kKeyboard == kOperatorName);
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  auto joy = (*observer)->writer(topics::kJoy);
  auto movement = (*observer)->reader(topics::kMovementStatus);
  if (!joy) return fail(joy.error());
  if (!movement) return fail(movement.error());
  if (!joy->wait_for_readers(1, std::chrono::seconds(3)))
    return fail(nobody_there("manual_control", domain));
  if (const auto told = tell_supervisor(**observer, SupervisorRequest_Constants::COMMAND_MANUAL_ON);
      !told)
    return fail(told.error());

  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
  std::cout << kHelp << std::flush;
  const RawTerminal terminal;
  Keyboard keyboard(hold);
  std::optional<MovementStatus> status;
  auto next_joy = Clock::now(), next_line = next_joy;
  while (!interrupted) {
    const auto key = next_key(kRound);
    const auto now = Clock::now();
    if (key == 'x' || key == '\004') break;
    if (key) keyboard.press(*key, now);
    if (key || now >= next_joy) {
      next_joy = now + kJoyPeriod;
      joy->write(keyboard.joy(now, (*observer)->now()));
    }
    while (const auto news = movement->take()) status = *news;
    if (now >= next_line) {
      next_line = now + kLinePeriod;
      show(keyboard, status, now);
    }
  }
  joy->write(Keyboard(hold).joy(Clock::now(), (*observer)->now()));
  std::cout << "\n";
  if (const auto told =
          tell_supervisor(**observer, SupervisorRequest_Constants::COMMAND_MANUAL_OFF);
      !told)
    return fail("the robot stands, but the manual mode could not be ended: " + told.error());
  return 0;
}

}  // namespace

void add_teleop_command(CLI::App& app, int& exit_code) {
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  auto hold = std::make_shared<int>(500);
  auto* command = app.add_subcommand(
      "teleop", "Drive from the keyboard while a key is held; needs manual_control");
  add_domain_option(*command, *domain);
  command
      ->add_option("--hold", *hold,
                   "How long a key counts as held after its last repeat [ms]; longer than the "
                   "keyboard's delay before it repeats")
      ->check(within(100, 1000))
      ->capture_default_str();
  command->callback([=, &exit_code] {
    exit_code = isatty(STDIN_FILENO) == 0
                    ? fail("teleop needs a terminal: it reads the keys from standard input")
                    : teleop(meant_domain(*domain), milliseconds(*hold));
  });
}

}  // namespace usher::operations
