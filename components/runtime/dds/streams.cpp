#include "runtime/dds/streams.hpp"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "runtime/guard/outbox.hpp"
#include "runtime/guard/port.hpp"

namespace usher::runtime {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kReopenAfter = std::chrono::seconds(1);
/// After a guard or the one who called has gone: the next one is there at once.
constexpr auto kReopenSoon = std::chrono::milliseconds(50);
/// After a guard that served for kServed: the base drives on until the next one's first word.
constexpr auto kReplaceGuard = std::chrono::milliseconds(5);
constexpr auto kServed = std::chrono::seconds(1);
constexpr auto kConnectTimeout = std::chrono::seconds(3);
constexpr auto kGuardStart = std::chrono::seconds(1);
/// A guard shows life five times in this; a longer silence, or a longer farewell, is a hang.
constexpr auto kGuardSilence = std::chrono::milliseconds(150);
/// Who looks so late was held up as well, and what the guard sent may not be there yet: it gets
/// kGrace more.
constexpr auto kLate = std::chrono::milliseconds(30);
constexpr auto kGrace = kGuardSilence / 2;
constexpr auto kOfferAgain = std::chrono::milliseconds(10);
constexpr auto kLineAgain = std::chrono::milliseconds(2);

std::string reason(const std::string& what) { return what + ": " + std::strerror(errno); }

/// The program beside this one.
std::string guard_program() {
  std::array<char, 4096> path{};
  const ssize_t size = ::readlink("/proc/self/exe", path.data(), path.size());
  const std::string_view self(path.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  const std::string folder(self.substr(0, self.rfind('/') + 1));
  // The build tree keeps test programs in a folder of their own.
  const std::string beside = folder + "usher-guard";
  return ::access(beside.c_str(), X_OK) == 0 ? beside : folder + "../bin/usher-guard";
}

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) text.append({kDigits[byte >> 4], kDigits[byte & 15]});
  return text;
}

/// Starts a guard that owns the port: our end of the pair of sockets, or -1 and errno. In a process
/// group of its own, so that nothing that ends this one by its group ends the guard too.
int start_guard(const std::string& uri, const StreamGuard& guard, pid_t& pid) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return -1;
  constexpr int kGuardsEnd = 3;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (ends[1] == kGuardsEnd) {
    ::fcntl(ends[1], F_SETFD, 0);  // a duplicate onto itself would stay close-on-exec
  } else {
    posix_spawn_file_actions_adddup2(&actions, ends[1], kGuardsEnd);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string program = guard_program();
  std::string safe = hexadecimal(guard.safe);
  std::string silence =
      std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(guard.silence).count());
  std::string number = std::to_string(kGuardsEnd);
  std::string address = uri;
  std::array<char*, 6> words{program.data(), number.data(),  safe.data(),
                             silence.data(), address.data(), nullptr};
  const int error =
      ::posix_spawn(&pid, program.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error == 0) return ends[0];
  ::close(ends[0]);
  pid = 0;
  errno = error;
  return -1;
}

/// One stream. write(), open() and reopen() belong to the component, everything else to the I/O
/// thread.
class Connection final : public Stream {
 public:
  Connection(std::string uri, Result<StreamAddress> address, StreamSink sink, int wake)
      : uri_(std::move(uri)), address_(std::move(address)), sink_(std::move(sink)), wake_(wake) {}
  ~Connection() override {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (listener_ >= 0) ::close(listener_);
    reap();
  }

  // --- Stream ---
  bool write(std::span<const std::uint8_t> bytes) override {
    return put(Outbox::Kind::kEach, bytes);
  }
  bool write_latest(std::span<const std::uint8_t> bytes) override {
    return put(Outbox::Kind::kLatest, bytes);
  }
  void last_will(std::span<const std::uint8_t> message, Duration lasts) override {
    if (!guarded()) return;
    using Milliseconds = std::chrono::duration<std::uint16_t, std::milli>;
    const auto most = std::clamp<Duration>(lasts, Duration::zero(), Milliseconds::max());
    const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(most).count();
    will_.assign({static_cast<std::uint8_t>(count & 0xFF), static_cast<std::uint8_t>(count >> 8)});
    will_.insert(will_.end(), message.begin(), message.end());
    put(Outbox::Kind::kWill, will_);
  }
  bool open() const override {
    const std::scoped_lock lock(mutex_);
    return state_ == State::kOpen;
  }
  void reopen(Duration delay) override {
    const std::scoped_lock lock(mutex_);
    reopen_asked_ = true;
    reopen_delay_ = std::max(delay, Duration{});
    wake();
  }

  // --- I/O thread ---
  /// What to poll; a negative descriptor when nothing.
  pollfd interest() const {
    const std::scoped_lock lock(mutex_);
    pollfd entry{-1, 0, 0};
    if (state_ == State::kListening) entry = {listener_, POLLIN, 0};
    if (state_ == State::kConnecting) {
      entry = {descriptor_, static_cast<short>(guarded() ? POLLIN : POLLOUT), 0};
    }
    if (state_ == State::kOpen) {
      // While the component refuses bytes, nothing is read and a hang-up has to wait with them.
      if (held_.empty()) entry = {descriptor_, POLLIN, 0};
      if (!outbox_.empty() && !line_full_)
        entry = {descriptor_, static_cast<short>(entry.events | POLLOUT), 0};
    }
    return entry;
  }
  /// When to call advance() without any event.
  Clock::time_point due() const {
    const std::scoped_lock lock(mutex_);
    auto due = due_;
    if (state_ == State::kListening) due = Clock::time_point::max();
    if (state_ == State::kOpen && held_.empty())
      due = guarded() ? guard_silent_at_ : Clock::time_point::max();
    return line_full_ ? std::min(due, Clock::now() + kLineAgain) : due;
  }

  void advance(short events, Clock::time_point now) {
    Outcome outcome;
    {
      const std::scoped_lock lock(mutex_);
      if (reopen_asked_) {
        reopen_asked_ = false;
        events = 0;  // of the descriptor that is closed now
        if (state_ == State::kOpen) outcome.closed = uri_ + ": reopened by the component";
        if (state_ != State::kDead) close_until(now + reopen_delay_);
      } else if (state_ == State::kWaiting) {
        if (now >= due_) begin(now, outcome);
      } else if (state_ == State::kListening) {
        accept(now, outcome);
      } else if (state_ == State::kConnecting) {
        if (guarded()) {
          hear_guard(events, now, outcome);
        } else {
          connect(events, now, outcome);
        }
      } else if (state_ == State::kOpen && guard_hangs(events, now)) {
        outcome.closed = uri_ + ": its guard hung and was killed";
        ::kill(guard_pid_, SIGKILL);
        close_until(now + replacement_delay(now));
      } else if (state_ == State::kOpen && ((events & POLLOUT) != 0 || line_full_)) {
        drain(now, outcome);
      }
    }
    if (outcome.opened) sink_.opened();
    if (!outcome.closed.empty()) {
      held_.clear();
      sink_.closed(outcome.closed);
    } else if ((events & (POLLIN | POLLHUP | POLLERR)) != 0 || !held_.empty()) {
      receive(now);
    }
  }

 private:
  enum class State { kWaiting, kListening, kConnecting, kOpen, kDead };
  struct Outcome {
    bool opened = false;
    std::string closed;
  };

  void wake() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(wake_, &one, sizeof(one)));
  }
  bool put(Outbox::Kind kind, std::span<const std::uint8_t> bytes) {
    const std::scoped_lock lock(mutex_);
    if (state_ != State::kOpen) return false;
    // Straight to the device when nothing waits: a drive command must not wait for another thread.
    const bool straight = outbox_.empty();
    if (!outbox_.push(kind, guarded() ? for_guard(kind, bytes) : bytes)) return false;
    if (straight) send_waiting();
    if (!outbox_.empty()) wake();
    return true;
  }
  /// What the guard process takes: the kind, then the bytes.
  std::span<const std::uint8_t> for_guard(Outbox::Kind kind, std::span<const std::uint8_t> bytes) {
    message_.assign(1, static_cast<std::uint8_t>(kind));
    message_.insert(message_.end(), bytes.begin(), bytes.end());
    return message_;
  }
  /// False when the port failed, for errno.
  bool send_waiting() {
    while (!outbox_.empty()) {
      line_full_ = address_->kind == StreamAddress::Kind::kSerial && line_full(descriptor_);
      if (line_full_) return true;
      const auto bytes = guarded() ? outbox_.first() : outbox_.waiting();
      const ssize_t count = address_->socket() || guarded()
                                ? ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                : ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0) return errno == EAGAIN || errno == EINTR;
      outbox_.sent(static_cast<std::size_t>(count));
    }
    return true;
  }
  bool guarded() const { return !sink_.guard.safe.empty(); }
  void reap() {
    if (guard_pid_ > 0 && ::waitpid(guard_pid_, nullptr, WNOHANG) == guard_pid_) guard_pid_ = 0;
  }
  /// Nothing came from it for too long.
  bool guard_hangs(short events, Clock::time_point now) {
    if (!guarded() || now < guard_silent_at_) return false;
    // What it sends is not read while the component refuses what came before.
    if ((events & (POLLIN | POLLHUP | POLLERR)) != 0 || !held_.empty()) return false;
    if (now < guard_silent_at_ + kLate) return true;
    guard_silent_at_ = now + kGrace;
    return false;
  }
  /// One that never serves for long is not started hundreds of times a second.
  Clock::duration replacement_delay(Clock::time_point now) const {
    return guarded() && now - opened_at_ >= kServed ? kReplaceGuard : kReopenSoon;
  }
  /// The former guard has ended, and with it its hold of the port; one that does not end is killed.
  bool former_guard_gone(Clock::time_point now) {
    reap();
    if (guard_pid_ == 0) return true;
    if (now >= guard_silent_at_) ::kill(guard_pid_, SIGKILL);
    return false;
  }
  void close_until(Clock::time_point due) {
    if (descriptor_ >= 0 && guarded()) {  // whoever still moves the device decides himself
      constexpr std::array<std::uint8_t, 3> kNoWill{static_cast<std::uint8_t>(Outbox::Kind::kWill)};
      static_cast<void>(::send(descriptor_, kNoWill.data(), kNoWill.size(), MSG_NOSIGNAL));
    }
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    outbox_.clear();
    line_full_ = false;
    state_ = State::kWaiting;
    due_ = due;
    guard_silent_at_ = Clock::now() + kGuardSilence;
  }
  void begin(Clock::time_point now, Outcome& outcome) {
    if (!address_) {
      state_ = State::kDead;
      due_ = Clock::time_point::max();
      outcome.closed = address_.error();
      return;
    }
    const bool listens = address_->kind == StreamAddress::Kind::kListen;
    int& descriptor = listens && !guarded() ? listener_ : descriptor_;
    if (guarded() && !former_guard_gone(now)) {
      due_ = now + kReplaceGuard;
      return;
    }
    if (descriptor < 0)
      descriptor = guarded() ? start_guard(uri_, sink_.guard, guard_pid_) : open_port(*address_);
    if (descriptor < 0) {
      outcome.closed = reason("cannot open " + uri_);
      close_until(now + kReopenAfter);
    } else if (!guarded() && listens) {
      state_ = State::kListening;
    } else if (!guarded() && address_->kind != StreamAddress::Kind::kTcp) {
      state_ = State::kOpen;
      outcome.opened = true;
    } else {
      state_ = State::kConnecting;
      due_ = now + kConnectTimeout + kGuardStart;
    }
  }
  void accept(Clock::time_point now, Outcome& outcome) {
    descriptor_ = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (descriptor_ >= 0) {
      const int yes = 1;
      ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
      state_ = State::kOpen;
      outcome.opened = true;
    } else if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED) {
      outcome.closed = reason("listening at " + uri_);
      ::close(listener_);
      listener_ = -1;
      close_until(now + kReopenAfter);
    }
  }
  /// The guard's first message says whether it has the port.
  void hear_guard(short events, Clock::time_point now, Outcome& outcome) {
    if (events == 0 && now < due_) return;
    std::array<char, 1024> answer{};
    const ssize_t count =
        events == 0 ? 0 : ::recv(descriptor_, answer.data(), answer.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count > 0 && answer[0] == '\0') {
      state_ = State::kOpen;
      opened_at_ = now;
      guard_silent_at_ = now + kGuardSilence;
      outcome.opened = true;
      return;
    }
    outcome.closed =
        count > 1 ? std::string(answer.data() + 1, static_cast<std::size_t>(count - 1))
                  : "cannot open " + uri_ + ": the guard " + guard_program() + " does not answer";
    close_until(now + kReopenAfter);
  }
  void connect(short events, Clock::time_point now, Outcome& outcome) {
    if (events == 0 && now < due_) return;
    int error = events == 0 ? ETIMEDOUT : 0;
    socklen_t size = sizeof(error);
    if (error == 0) ::getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error == 0) {
      state_ = State::kOpen;
      outcome.opened = true;
      return;
    }
    errno = error;
    outcome.closed = reason("cannot open " + uri_);
    close_until(now + kReopenAfter);
  }
  void drain(Clock::time_point now, Outcome& outcome) {
    if (send_waiting()) return;
    outcome.closed = reason("writing to " + uri_);
    close_until(now + kReopenAfter);
  }
  /// Offers what the component refused last time, then at most one buffer more.
  void receive(Clock::time_point now) {
    guard_silent_at_ = now + kGuardSilence;
    if (held_.empty()) {
      std::array<std::uint8_t, 16384> buffer;
      const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
      if (count <= 0) {
        const std::string text =
            count == 0 ? uri_ + ": closed by the other side" : reason("reading from " + uri_);
        {
          const std::scoped_lock lock(mutex_);
          const bool at_once = guarded() || address_->kind == StreamAddress::Kind::kListen;
          close_until(now + (at_once ? replacement_delay(now) : kReopenAfter));
        }
        sink_.closed(text);
        return;
      }
      // A guard's messages begin with an octet; one without more is a sign of life.
      held_.assign(buffer.begin() + (guarded() ? 1 : 0), buffer.begin() + count);
      if (held_.empty()) return;
    }
    if (sink_.received(held_)) {
      held_.clear();
    } else {
      const std::scoped_lock lock(mutex_);
      due_ = now + kOfferAgain;
    }
  }

  const std::string uri_;
  const Result<StreamAddress> address_;
  const StreamSink sink_;
  const int wake_;
  mutable std::mutex mutex_;
  State state_ = State::kWaiting;
  Clock::time_point due_ = Clock::time_point::min();
  int descriptor_ = -1;                  // changed by the I/O thread only
  int listener_ = -1;                    // I/O thread only
  pid_t guard_pid_ = 0;                  // I/O thread only
  Clock::time_point guard_silent_at_{};  // I/O thread only: from then on it hangs
  Clock::time_point opened_at_{};        // I/O thread only: by the present guard
  Outbox outbox_;
  Bytes message_;  // of the guard, reused
  Bytes will_;     // the component's handlers only
  bool line_full_ = false;
  std::vector<std::uint8_t> held_;  // I/O thread only
  bool reopen_asked_ = false;
  Duration reopen_delay_{};
};

}  // namespace

class Streams::Implementation {
 public:
  Implementation() : wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) { assert(wake_ >= 0); }
  ~Implementation() {
    stop_ = true;
    const std::uint64_t one = 1;
    static_cast<void>(!::write(wake_, &one, sizeof(one)));
    if (thread_.joinable()) thread_.join();
    connections_.clear();
    ::close(wake_);
  }

  Stream& open(const std::string& uri, StreamSink sink) {
    const std::scoped_lock lock(mutex_);
    connections_.push_back(
        std::make_unique<Connection>(uri, StreamAddress::parse(uri), std::move(sink), wake_));
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    const std::uint64_t one = 1;
    static_cast<void>(!::write(wake_, &one, sizeof(one)));
    return *connections_.back();
  }

 private:
  void run() {
    std::vector<Connection*> connections;
    std::vector<pollfd> entries;
    while (!stop_) {
      {
        const std::scoped_lock lock(mutex_);
        connections.clear();
        for (const auto& connection : connections_) connections.push_back(connection.get());
      }
      entries.assign(1, {wake_, POLLIN, 0});
      Clock::time_point due = Clock::time_point::max();
      for (const Connection* connection : connections) {
        entries.push_back(connection->interest());
        due = std::min(due, connection->due());
      }
      wait(entries, due);
      std::uint64_t ignored = 0;
      static_cast<void>(!::read(wake_, &ignored, sizeof(ignored)));
      const Clock::time_point now = Clock::now();
      for (std::size_t i = 0; i < connections.size(); ++i)
        connections[i]->advance(entries[i + 1].revents, now);
    }
  }

  static void wait(std::vector<pollfd>& entries, Clock::time_point due) {
    timespec timeout{};
    if (due != Clock::time_point::max()) {
      const auto rest = due == Clock::time_point::min()
                            ? Duration{}
                            : std::max(Duration{due - Clock::now()}, Duration{});
      timeout.tv_sec = rest.count() / 1'000'000'000;
      timeout.tv_nsec = rest.count() % 1'000'000'000;
    }
    if (::ppoll(entries.data(), entries.size(),
                due == Clock::time_point::max() ? nullptr : &timeout, nullptr) < 0) {
      for (pollfd& entry : entries) entry.revents = 0;
    }
  }

  const int wake_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::vector<std::unique_ptr<Connection>> connections_;
  std::thread thread_;
};

Streams::Streams() : implementation_(std::make_unique<Implementation>()) {}
Streams::~Streams() = default;

Stream& Streams::open(const std::string& uri, StreamSink sink) {
  return implementation_->open(uri, std::move(sink));
}

}  // namespace usher::runtime
