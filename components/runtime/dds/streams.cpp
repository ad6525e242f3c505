#include "runtime/dds/streams.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace usher::runtime {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kMaxQueued = 65536;
constexpr auto kReopenAfter = std::chrono::seconds(1);
constexpr auto kConnectTimeout = std::chrono::seconds(3);
constexpr auto kOfferAgain = std::chrono::milliseconds(10);

std::string reason(const std::string& what) { return what + ": " + std::strerror(errno); }

const std::map<int, speed_t>& baud_rates() {
  static const std::map<int, speed_t> rates = {
      {9600, B9600},     {19200, B19200},    {38400, B38400},   {57600, B57600},
      {115200, B115200}, {230400, B230400},  {460800, B460800}, {500000, B500000},
      {921600, B921600}, {1000000, B1000000}};
  return rates;
}

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// -1 and errno when it fails. A TCP connection may still be under way.
int open_descriptor(const StreamAddress& address) {
  if (!address.serial) {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0) return -1;
    const int yes = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(static_cast<std::uint16_t>(address.number));
    inet_pton(AF_INET, address.target.c_str(), &peer.sin_addr);
    if (::connect(descriptor, reinterpret_cast<sockaddr*>(&peer), sizeof(peer)) == 0 ||
        errno == EINPROGRESS) {
      return descriptor;
    }
    ::close(descriptor);
    return -1;
  }
  const int descriptor = ::open(address.target.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return -1;
  termios settings{};
  if (::ioctl(descriptor, TIOCEXCL) == 0 && ::tcgetattr(descriptor, &settings) == 0) {
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
    const speed_t speed = baud_rates().at(address.number);
    ::cfsetispeed(&settings, speed);
    ::cfsetospeed(&settings, speed);
    if (::tcsetattr(descriptor, TCSANOW, &settings) == 0) {
      ::tcflush(descriptor, TCIOFLUSH);
      return descriptor;
    }
  }
  const int error = errno;
  ::close(descriptor);
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
  }

  // --- Stream ---
  bool write(std::span<const std::uint8_t> bytes) override {
    const std::scoped_lock lock(mutex_);
    if (state_ != State::kOpen || queue_.size() + bytes.size() > kMaxQueued) return false;
    // Straight to the device when nothing waits: a drive command must not wait for another thread.
    if (queue_.empty()) {
      const ssize_t written = put(bytes);
      if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
      if (bytes.empty()) return true;
    }
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    wake();
    return true;
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
    if (state_ == State::kConnecting) entry = {descriptor_, POLLOUT, 0};
    if (state_ == State::kOpen) {
      // While the component refuses bytes, nothing is read and a hang-up has to wait with them.
      if (held_.empty()) entry = {descriptor_, POLLIN, 0};
      if (!queue_.empty()) entry = {descriptor_, static_cast<short>(entry.events | POLLOUT), 0};
    }
    return entry;
  }
  /// When to call advance() without any event.
  Clock::time_point due() const {
    const std::scoped_lock lock(mutex_);
    return state_ == State::kOpen && held_.empty() ? Clock::time_point::max() : due_;
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
      } else if (state_ == State::kConnecting) {
        connect(events, now, outcome);
      } else if (state_ == State::kOpen && (events & POLLOUT) != 0) {
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
  enum class State { kWaiting, kConnecting, kOpen, kDead };
  struct Outcome {
    bool opened = false;
    std::string closed;
  };

  void wake() const {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(wake_, &one, sizeof(one)));
  }
  ssize_t put(std::span<const std::uint8_t> bytes) const {
    return address_->serial ? ::write(descriptor_, bytes.data(), bytes.size())
                            : ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void close_until(Clock::time_point due) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    queue_.clear();
    state_ = State::kWaiting;
    due_ = due;
  }
  void begin(Clock::time_point now, Outcome& outcome) {
    if (!address_) {
      state_ = State::kDead;
      due_ = Clock::time_point::max();
      outcome.closed = address_.error();
      return;
    }
    descriptor_ = open_descriptor(*address_);
    if (descriptor_ < 0) {
      outcome.closed = reason("cannot open " + uri_);
      close_until(now + kReopenAfter);
    } else if (address_->serial) {
      state_ = State::kOpen;
      outcome.opened = true;
    } else {
      state_ = State::kConnecting;
      due_ = now + kConnectTimeout;
    }
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
    const ssize_t written = put(queue_);
    if (written > 0) {
      queue_.erase(queue_.begin(), queue_.begin() + written);
    } else if (written < 0 && errno != EAGAIN && errno != EINTR) {
      outcome.closed = reason("writing to " + uri_);
      close_until(now + kReopenAfter);
    }
  }
  /// Offers what the component refused last time, then at most one buffer more.
  void receive(Clock::time_point now) {
    if (held_.empty()) {
      std::array<std::uint8_t, 16384> buffer;
      const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
      if (count <= 0) {
        const std::string text =
            count == 0 ? uri_ + ": closed by the other side" : reason("reading from " + uri_);
        {
          const std::scoped_lock lock(mutex_);
          close_until(now + kReopenAfter);
        }
        sink_.closed(text);
        return;
      }
      held_.assign(buffer.begin(), buffer.begin() + count);
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
  int descriptor_ = -1;  // changed by the I/O thread only
  std::vector<std::uint8_t> queue_;
  std::vector<std::uint8_t> held_;  // I/O thread only
  bool reopen_asked_ = false;
  Duration reopen_delay_{};
};

}  // namespace

Result<StreamAddress> StreamAddress::parse(const std::string& uri) {
  const Error error{"a stream is tcp://ADDRESS:PORT or serial://DEVICE?baud=RATE, found '" + uri +
                    "'"};
  StreamAddress address;
  if (uri.starts_with("tcp://")) {
    const std::size_t colon = uri.rfind(':');
    if (colon <= 6) return error;
    address.target = uri.substr(6, colon - 6);
    if (address.target == "localhost") address.target = "127.0.0.1";
    in_addr ignored{};
    const auto port = whole_number(std::string_view(uri).substr(colon + 1));
    if (inet_pton(AF_INET, address.target.c_str(), &ignored) != 1 || !port || *port < 1 ||
        *port > 65535)
      return error;
    address.number = *port;
    return address;
  }
  if (uri.starts_with("serial://")) {
    address.serial = true;
    const std::size_t question = uri.find("?baud=");
    if (question == std::string::npos || question == 9) return error;
    address.target = uri.substr(9, question - 9);
    const auto baud = whole_number(std::string_view(uri).substr(question + 6));
    if (!baud || !baud_rates().contains(*baud)) return error;
    address.number = *baud;
    return address;
  }
  return error;
}

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
