// How long a sample takes to its handler, between processes: judged beside what the same path costs
// without us.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "echo_component.hpp"
#include "runtime/dds/host_clock.hpp"
#include "runtime/dds/observer.hpp"
#include "support/folder.hpp"
#include "support/process.hpp"
#include "support/test_domain.hpp"

namespace usher::runtime {
namespace {

using namespace std::chrono_literals;

struct Percentiles {
  double p50 = 0.0, p99 = 0.0;
  explicit Percentiles(std::vector<double> values) {
    std::ranges::sort(values);
    p50 = values[values.size() / 2];
    p99 = values[values.size() * 99 / 100];
  }
};

/// Waking a sleeping thread of this machine through a pair of sockets and back, in microseconds.
Percentiles wake_up_round_trip() {
  std::array<int, 2> pair{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM, 0, pair.data()), 0);
  std::thread other([&] {
    char byte = 0;
    while (::read(pair[1], &byte, 1) == 1 && byte != 'e')
      static_cast<void>(!::write(pair[1], &byte, 1));
  });
  std::vector<double> times;
  char byte = 'x';
  for (int i = 0; i < 500; ++i) {
    std::this_thread::sleep_for(1ms);
    const auto begin = std::chrono::steady_clock::now();
    static_cast<void>(!::write(pair[0], &byte, 1));
    static_cast<void>(!::read(pair[0], &byte, 1));
    times.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
            .count());
  }
  byte = 'e';
  static_cast<void>(!::write(pair[0], &byte, 1));
  other.join();
  ::close(pair[0]);
  ::close(pair[1]);
  return Percentiles(times);
}

TEST(Latency, FromWriteToHandlerIsNearTheCostOfWakingUp) {
  const auto anchor = MonotonicClock::read(CLOCK_REALTIME) - MonotonicClock::read(CLOCK_MONOTONIC);
  const usher::test::Folder folder;
  const std::string path = folder.file(
      "echo.yaml",
      "component: echo\nname: echo\nhost: nuc\ndomain: " + std::to_string(test_domain()) +
          "\nclock_anchor: " + std::to_string(anchor.count()) + "\n");
  const usher::test::Process child(
      {USHER_BINARY_DIR "/tests/usher-test-echo", "--parameters", path});
  auto out = std::move(Observer::create({.name = "operator",
                                         .host = "nuc",
                                         .domain = test_domain(),
                                         .peers = {},
                                         .clock_anchor = anchor.count()}))
                 .value();
  auto answers = out->reader(topics::kCmdVelInteraction);
  auto questions = out->writer(topics::kCmdVelManual);
  ASSERT_TRUE(questions.ok() && answers.ok());
  ASSERT_TRUE(questions->wait_for_readers(1, 10s));
  // On an idle machine it is below 100 us; where waking up takes longer, because others compete, so
  // may this. A machine that is slow for some seconds is measured again.
  constexpr int kTries = 3;
  double found = 0.0, wanted = 0.0;
  for (int tries = 0; tries < kTries && !(found < wanted); ++tries) {
    std::vector<double> to_handler;
    std::vector<double> round_trip;
    for (int i = 0; i < 2000; ++i) {
      std::this_thread::sleep_for(
          1ms);  // the pace of a sensor: the other side sleeps when the sample comes
      const Time begin = out->now();
      questions->write(test::question(begin, 1.0));
      const auto answer = answers->take(100ms);
      if (answer == nullptr) continue;
      round_trip.push_back(1e6 * seconds(out->now() - begin));
      to_handler.push_back(1e6 * answer->twist().linear().y());
    }
    ASSERT_GT(to_handler.size(), 1900U);
    const Percentiles handler(to_handler);
    const Percentiles trip(round_trip);
    const Percentiles reference = wake_up_round_trip();
    std::printf(
        "write to handler: p50 %.0f us, p99 %.0f us; round trip: p50 %.0f us, p99 %.0f us; "
        "waking a thread and back: p50 %.0f us, p99 %.0f us\n",
        handler.p50, handler.p99, trip.p50, trip.p99, reference.p50, reference.p99);
    found = handler.p50;
    wanted = std::max(150.0, 10.0 * reference.p50);
  }
  EXPECT_LT(found, wanted);
}

}  // namespace
}  // namespace usher::runtime
