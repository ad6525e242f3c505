// The guard process: usher-guard DESCRIPTOR SAFE_HEX SILENCE_MS ADDRESS
//
// Started by a driver's host with one end of a socket pair of whole messages. It opens the port,
// writes the safe bytes and answers with one message: a zero octet, or a one octet and why it could
// not. From then on it passes messages both ways (guard.hpp). Each begins with one octet, the
// driver's with its kind (outbox.hpp), its own with zero; nothing but that is a sign of life, and
// its own comes every 30 ms. It ends when the driver's end of the pair is closed, as soon as the
// driver's will is done or the next guard knocks (tenure.hpp), when the port fails, and by no
// signal that can be ignored; a driver that sees no life kills it.

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <string>

#include "runtime/guard/guard.hpp"
#include "runtime/guard/port.hpp"
#include "runtime/guard/tenure.hpp"

namespace usher::runtime {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Time = Guard::Time;
constexpr int kConnectMs = 3000;
constexpr auto kLineAgain = std::chrono::milliseconds(2);
/// Five in the silence after which the driver takes its guard for hung (dds/streams.cpp).
constexpr auto kLifeEvery = std::chrono::milliseconds(30);
/// A port that takes nothing must not hold the guard, and with it the port, for ever; shorter than
/// that silence too.
constexpr auto kLongestFarewell = std::chrono::milliseconds(100);

Time now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

template <class Number>
bool read_number(std::string_view text, Number& value, int base = 10) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return error == std::errc{} && end == text.data() + text.size();
}

bool read_hex(std::string_view text, Bytes& bytes) {
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    std::uint8_t byte = 0;
    if (!read_number(text.substr(i, 2), byte, 16)) return false;
    bytes.push_back(byte);
  }
  return text.size() % 2 == 0 && !bytes.empty();
}

/// Why a port that was just opened is none; zero: it is one. A driver that ends meanwhile is
/// followed by another one, which wants it.
int failure_of(int port, const StreamAddress& address, int driver) {
  if (port < 0) return errno;
  if (address.kind != StreamAddress::Kind::kTcp) return 0;
  std::array<pollfd, 2> entries{{{port, POLLOUT, 0}, {driver, 0, 0}}};
  if (::poll(entries.data(), entries.size(), kConnectMs) <= 0) return ETIMEDOUT;
  if ((entries[1].revents & POLLHUP) != 0) return ECANCELED;
  int error = 0;
  socklen_t size = sizeof(error);
  return ::getsockopt(port, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

class Process {
 public:
  Process(int driver, int port, const Tenure& tenure, Guard guard)
      : driver_(driver), port_(port), tenure_(tenure), guard_(std::move(guard)) {}

  /// The safe bytes are on their way before the driver knows of the port. False when it failed.
  bool greet() {
    guard_.greet();
    return to_port();
  }

  /// Exit code.
  int run() {
    while (!guard_.finished()) {
      if (gone_ && now() > guard_.farewell_at() + kLongestFarewell) return 1;
      wait();
      if (tenure_.take_knock()) guard_.port_wanted(now());
      if (!from_driver() || !from_port()) return 1;
      show_life();
      guard_.tick(now());
      if (!to_port()) return 1;
    }
    return 0;
  }

 private:
  void wait() {
    entries_[0] = {gone_ ? -1 : driver_, POLLIN, 0};
    entries_[1] = {port_, static_cast<short>(guard_.output().empty() ? POLLIN : POLLIN | POLLOUT),
                   0};
    entries_[2] = {tenure_.descriptor(), POLLIN, 0};
    Time due = gone_ ? guard_.farewell_at() + kLongestFarewell : life_at_;
    if (const auto tick = guard_.due()) due = std::min(due, *tick);
    if (line_full_) {
      entries_[1].events = POLLIN;
      due = std::min<Time>(due, now() + kLineAgain);
    }
    const auto rest = std::max<std::int64_t>(0, (due - now()).count());
    const timespec timeout{static_cast<time_t>(rest / 1'000'000'000),
                           static_cast<long>(rest % 1'000'000'000)};
    if (::ppoll(entries_.data(), entries_.size(), &timeout, nullptr) < 0) {
      entries_[0].revents = entries_[1].revents = 0;
    }
  }

  bool from_driver() {
    if (entries_[0].revents == 0) return true;
    // All that waits, so that the port gets the newest of it; and no more than that before the
    // clock is looked at again, so that a flood cannot hold the guard.
    for (std::size_t i = 0; i < Outbox::kMostMessages; ++i) {
      const ssize_t count = ::recv(driver_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return true;
      // Told first of a driver that ended without reading all: what it said last still waits.
      if (count < 0 && errno == ECONNRESET) continue;
      if (count <= 0) {
        gone_ = true;
        guard_.gone(now());
        return true;
      }
      const std::span message(buffer_.data() + 1, static_cast<std::size_t>(count) - 1);
      if (buffer_[0] == static_cast<std::uint8_t>(Outbox::Kind::kWill)) {
        take_will(message);
        continue;
      }
      const auto kind = buffer_[0] == 0 ? Outbox::Kind::kEach : Outbox::Kind::kLatest;
      if (!guard_.heard(kind, message, now())) return complain("the port takes nothing");
    }
    return true;
  }

  /// Two octets of milliseconds, the low one first, then the bytes.
  void take_will(std::span<const std::uint8_t> message) {
    if (message.size() < 2) return;
    guard_.will(message.subspan(2), std::chrono::milliseconds(message[0] | message[1] << 8));
  }

  bool from_port() {
    if ((entries_[1].revents & (POLLIN | POLLHUP | POLLERR)) == 0) return true;
    buffer_[0] = 0;
    const ssize_t count = ::read(port_, buffer_.data() + 1, 4096);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return true;
    if (count == 0) return complain("closed by the other side");
    if (count < 0) return complain(std::strerror(errno));
    tell_driver(static_cast<std::size_t>(count) + 1);
    return true;
  }

  void show_life() {
    if (now() < life_at_) return;
    buffer_[0] = 0;
    tell_driver(1);
  }

  /// A driver that does not read loses what it does not read; the port is never held up.
  void tell_driver(std::size_t size) {
    life_at_ = now() + kLifeEvery;
    if (gone_) return;
    static_cast<void>(!::send(driver_, buffer_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL));
  }

  bool to_port() {
    line_full_ = false;
    while (!guard_.output().empty()) {
      line_full_ = line_full(port_);
      if (line_full_) return true;
      const auto output = guard_.output();
      const ssize_t count = ::write(port_, output.data(), output.size());
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return true;
      if (count < 0) return complain(std::strerror(errno));
      guard_.sent(static_cast<std::size_t>(count));
    }
    return true;
  }

  static bool complain(const char* why) {
    const int error = errno;
    std::fprintf(stderr, "guard: the port failed: %s\n", why);
    errno = error;
    return false;
  }

  const int driver_;
  const int port_;
  const Tenure& tenure_;
  Guard guard_;
  bool gone_ = false;  // the driver
  Time life_at_{};
  bool line_full_ = false;
  std::array<pollfd, 3> entries_{};
  std::array<std::uint8_t, Outbox::kMostBytes + 1> buffer_{};
};

/// Tells the driver that it has the port, or why not; the exit code.
int answer(int driver, const std::string& failure) {
  const std::string message = (failure.empty() ? '\0' : '\1') + failure;
  const bool heard = ::send(driver, message.data(), message.size(), MSG_NOSIGNAL) > 0;
  return heard && failure.empty() ? 0 : 1;
}

int guard_main(int argc, char** argv) {
  int driver = -1;
  int silence_ms = 0;
  Bytes safe;
  if (argc != 5 || !read_number(argv[1], driver) || !read_hex(argv[2], safe) ||
      !read_number(argv[3], silence_ms) || silence_ms < 1) {
    std::fprintf(stderr, "started by the host of a driver: usher-guard FD SAFE_HEX MS ADDRESS\n");
    return 2;
  }
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGUSR1, SIGUSR2})
    ::signal(number, SIG_IGN);
  ::prctl(PR_SET_TIMERSLACK, 1000UL);
  // The driver's sockets, which its successor needs.
  ::close_range(static_cast<unsigned>(driver) + 1, ~0U, 0);
  const auto address = StreamAddress::parse(argv[4]);
  if (!address) return answer(driver, address.error());
  const std::string cannot = std::string("cannot open ") + argv[4] + ": ";
  const auto tenure = Tenure::begin(*address);
  if (!tenure) return answer(driver, cannot + tenure.error());
  const int port = open_port(*address);
  if (const int error = failure_of(port, *address, driver); error != 0)
    return answer(driver, cannot + std::strerror(error));
  ::fcntl(port, F_SETFL, O_NONBLOCK);
  static Process process(driver, port, *tenure,
                         Guard(std::move(safe), std::chrono::milliseconds(silence_ms)));
  if (!process.greet())
    return answer(driver, std::string("writing to ") + argv[4] + ": " + std::strerror(errno));
  return answer(driver, "") == 0 ? process.run() : 1;
}

}  // namespace
}  // namespace usher::runtime

int main(int argc, char** argv) { return usher::runtime::guard_main(argc, argv); }
