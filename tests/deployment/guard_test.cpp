#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "drivers/p3dx/core/link.hpp"
#include "drivers/segway_rmp/core/protocol.hpp"
#include "runtime/dds/streams.hpp"
#include "support/process.hpp"

// What the guard of a base's line owes to the base: zero, soon, whatever becomes of the guard. With
// the words of the real drivers, on a pseudo terminal at whose other end the base would listen.

namespace usher {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
using runtime::Bytes;

constexpr int kTimes = 3;
/// From the guard's end, or hang, to the whole of the first zero at the base. Twice of what is
/// promised, since other programs may keep the machine busy.
constexpr Seconds kKilled{2 * 0.05};
constexpr Seconds kHung{2 * 0.2};

struct Base {
  const char* name;
  int baud;
  std::chrono::milliseconds cycle;
  Bytes zero;
  Bytes drive;
};

Base segway() {
  const auto zero = segway_rmp::command({}, segway_rmp::Calibration{});
  const auto drive = segway_rmp::command({0.5, 0.1}, segway_rmp::Calibration{});
  return {"Segway", 460800, 10ms, {zero.begin(), zero.end()}, {drive.begin(), drive.end()}};
}

Base pioneer() {
  Bytes drive;
  for (const auto& frame :
       {p3dx::encode(p3dx::Command::kVelocity, 500), p3dx::encode(p3dx::Command::kTurnRate, 6)})
    drive.insert(drive.end(), frame.span().begin(), frame.span().end());
  return {"Pioneer", 9600, 40ms, p3dx::Link::velocity({}), drive};
}

/// The base's end of the line: everything that it heard.
class Ear {
 public:
  Ear() {
    std::array<char, 128> name{};
    EXPECT_EQ(::openpty(&master_, &slave_, name.data(), nullptr, nullptr), 0);
    name_ = name.data();
    termios settings{};
    ::tcgetattr(slave_, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(slave_, TCSANOW, &settings);
    thread_ = std::thread([this] { listen(); });
  }
  ~Ear() {
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }

  const std::string& name() const { return name_; }
  /// A pseudo terminal stays exclusive after its owner has gone; a real port does not.
  void share() const { ::ioctl(slave_, TIOCNXCL); }
  void forget() {
    const std::scoped_lock lock(mutex_);
    heard_.clear();
  }
  /// When the whole of it was first heard since forget(); never after 10 s.
  std::optional<Clock::time_point> hears(const Bytes& word) {
    std::unique_lock lock(mutex_);
    std::optional<Clock::time_point> when;
    news_.wait_for(lock, 10s * test::kSanitizerFactor, [&] {
      const auto found = std::search(heard_.begin(), heard_.end(), word.begin(), word.end());
      if (found == heard_.end()) return false;
      when = Clock::now();
      return true;
    });
    return when;
  }
  /// What was heard since forget() before this word.
  Bytes before(const Bytes& word) {
    const std::scoped_lock lock(mutex_);
    return {heard_.begin(), std::search(heard_.begin(), heard_.end(), word.begin(), word.end())};
  }

 private:
  void listen() {
    std::array<std::uint8_t, 4096> buffer{};
    while (!stop_) {
      pollfd entry{master_, POLLIN, 0};
      if (::poll(&entry, 1, 20) <= 0) continue;
      const ssize_t count = ::read(master_, buffer.data(), buffer.size());
      if (count <= 0) continue;
      const std::scoped_lock lock(mutex_);
      heard_.insert(heard_.end(), buffer.begin(), buffer.begin() + count);
      news_.notify_all();
    }
  }

  int master_ = -1;
  int slave_ = -1;
  std::string name_;
  std::mutex mutex_;
  std::condition_variable news_;
  Bytes heard_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A driver that tells its base to drive, whatever happens.
class Driver {
 public:
  Driver(const Base& base, const std::string& port)
      : stream_(streams_.open("serial://" + port + "?baud=" + std::to_string(base.baud),
                              {.opened = [] {},
                               .received = [](auto) { return true; },
                               .closed = [](const std::string&) {},
                               .guard = {base.zero, 10s}})),
        thread_([this, base] {
          while (!stop_) {
            stream_.write_latest(base.drive);
            std::this_thread::sleep_for(base.cycle);
          }
        }) {}
  ~Driver() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_{false};
  runtime::Streams streams_;
  runtime::Stream& stream_;
  std::thread thread_;
};

/// The guard gets this signal while the base drives.
void hears_zero_soon(const Base& base, int signal, Seconds most) {
  Ear ear;
  const Driver driver(base, ear.name());
  ASSERT_TRUE(ear.hears(base.zero)) << "a guard's first word";
  for (int i = 0; i < kTimes; ++i) {
    ear.forget();
    ASSERT_TRUE(ear.hears(base.drive));
    std::this_thread::sleep_for(1100ms);
    ear.share();
    const pid_t guard = test::guard_of(::getpid());
    ASSERT_GT(guard, 0);
    ear.forget();
    const auto begin = Clock::now();
    ::kill(guard, signal);
    const auto zero = ear.hears(base.zero);
    ASSERT_TRUE(zero);
    const Seconds after = *zero - begin;
    std::printf("%s, guard %s: zero after %.0f ms\n", base.name,
                signal == SIGKILL ? "killed" : "stopped", 1e3 * after.count());
    EXPECT_LT(after, most * test::kSanitizerFactor);
    Bytes before = ear.before(base.zero);
    for (; before.size() >= base.drive.size();
         before.erase(before.begin(), before.begin() + std::ssize(base.drive)))
      ASSERT_TRUE(std::equal(base.drive.begin(), base.drive.end(), before.begin()));
    EXPECT_TRUE(before.empty()) << "nothing but zero after the last command that got through";
    EXPECT_TRUE(ear.hears(base.drive)) << "and the driver is heard again";
  }
}

TEST(GuardOfABase, ASegwayHearsZeroWhenItsGuardIsKilled) {
  hears_zero_soon(segway(), SIGKILL, kKilled);
}
TEST(GuardOfABase, ASegwayHearsZeroWhenItsGuardHangs) { hears_zero_soon(segway(), SIGSTOP, kHung); }
TEST(GuardOfABase, APioneerHearsZeroWhenItsGuardIsKilled) {
  hears_zero_soon(pioneer(), SIGKILL, kKilled);
}
TEST(GuardOfABase, APioneerHearsZeroWhenItsGuardHangs) {
  hears_zero_soon(pioneer(), SIGSTOP, kHung);
}

}  // namespace
}  // namespace usher
