#include "runtime/dds/dds_host.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

#include "idl/topics.hpp"
#include "runtime/dds/dds_transport.hpp"
#include "runtime/dds/file_store.hpp"
#include "runtime/dds/host_clock.hpp"
#include "runtime/dds/streams.hpp"
#include "runtime/dds/worker.hpp"

namespace usher::runtime {
namespace {

int make_event() {
  const int descriptor = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  assert(descriptor >= 0);
  return descriptor;
}
void signal_event(int descriptor) {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(descriptor, &one, sizeof(one)));
}

Duration processor_time() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto total = [](const timeval& time) {
    return std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_usec);
  };
  return total(usage.ru_utime) + total(usage.ru_stime);
}

/// /proc/self/statm: "size resident shared ...", in pages.
std::uint64_t resident_bytes(int statm) {
  std::array<char, 128> text{};
  const ssize_t size = ::pread(statm, text.data(), text.size(), 0);
  if (size <= 0) return 0;
  const char* end = text.data() + size;
  const char* second = std::find(static_cast<const char*>(text.data()), end, ' ');
  std::uint64_t pages = 0;
  if (second != end) std::from_chars(second + 1, end, pages);
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// The world of one component, apart from the network.
class DdsPlatform final : public Platform {
 public:
  DdsPlatform(const ParameterFile& file, const MonotonicClock& clock)
      : clock_(clock),
        wake_(make_event()),
        statm_(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC)),
        store_(file.run_directory.empty() ? "" : file.run_directory + "/kept/" + file.name),
        measured_(clock.now()),
        processor_(processor_time()) {}
  ~DdsPlatform() override {
    ::close(wake_);
    if (statm_ >= 0) ::close(statm_);
  }

  Time now() const override { return clock_.now(); }
  Duration work_time() const override { return MonotonicClock::read(CLOCK_MONOTONIC); }
  void wake() override { signal_event(wake_); }

  Resources resources() override {
    const Time now = clock_.now();
    const Duration processor = processor_time();
    Resources result;
    if (now > measured_) {
      result.cpu_percent =
          static_cast<float>(100.0 * seconds(processor - processor_) / seconds(now - measured_));
    }
    result.memory_bytes = resident_bytes(statm_);
    measured_ = now;
    processor_ = processor;
    return result;
  }

  void offload(Duration, std::function<void()> job, std::function<void()> finished) override {
    worker_.submit([job = std::move(job), finished = std::move(finished)] {
      job();
      finished();
    });
  }
  Stream& open_stream(const std::string& uri, StreamSink sink) override {
    return streams_.open(uri, std::move(sink));
  }
  Status keep(const std::string& key, std::span<const std::uint8_t> bytes) override {
    return store_.keep(key, bytes);
  }
  Result<std::optional<Bytes>> kept(const std::string& key) override { return store_.kept(key); }

  int wake_descriptor() const { return wake_; }
  void stop_jobs() { worker_.stop(); }

 private:
  const MonotonicClock clock_;
  const int wake_;
  const int statm_;
  const FileStore store_;
  Time measured_;
  Duration processor_;
  Streams streams_;
  Worker worker_;
};

}  // namespace

StopFlag::StopFlag() : descriptor_(make_event()) {}
StopFlag::~StopFlag() { ::close(descriptor_); }
void StopFlag::set() { signal_event(descriptor_); }

class DdsHost::Implementation {
 public:
  Implementation(ParameterFile file, const MonotonicClock& clock,
                 std::unique_ptr<DdsTransport> given, const StopFlag& stop_flag)
      : stop(stop_flag),
        platform(file, clock),
        transport(std::move(given)),
        engine(std::move(file), platform, *transport) {}
  /// A job may still keep() through the engine.
  ~Implementation() { platform.stop_jobs(); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  /// Until there is work, the next turn is due, or the host shall stop.
  void wait() {
    std::array<pollfd, 2> entries{
        {{platform.wake_descriptor(), POLLIN, 0}, {stop.descriptor(), POLLIN, 0}}};
    const Time due = engine.next_due();
    timespec timeout{};
    if (due != Time::max()) {
      const auto rest = std::max(due - platform.now(), Duration{}).count();
      timeout = {static_cast<time_t>(rest / 1'000'000'000),
                 static_cast<long>(rest % 1'000'000'000)};
    }
    ::ppoll(entries.data(), entries.size(), due == Time::max() ? nullptr : &timeout, nullptr);
    std::uint64_t ignored = 0;
    static_cast<void>(!::read(platform.wake_descriptor(), &ignored, sizeof(ignored)));
  }

  bool asked_to_stop() const {
    pollfd entry{stop.descriptor(), POLLIN, 0};
    return ::poll(&entry, 1, 0) > 0;
  }

  /// Sees the last heartbeat off, which the engine has just written.
  void say_why() { transport->farewell(std::string(topics::kHeartbeat.name)); }

  const StopFlag& stop;
  // The engine ends first, then the network and the threads that may still call into what is left
  // of it.
  DdsPlatform platform;
  std::unique_ptr<DdsTransport> transport;
  Engine engine;
};

DdsHost::DdsHost(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
DdsHost::~DdsHost() = default;

Result<std::unique_ptr<DdsHost>> DdsHost::create(ParameterFile file, const StopFlag& stop) {
  const MonotonicClock clock(file.clock_anchor);
  auto transport = DdsTransport::create({file.name,
                                         file.host,
                                         file.domain,
                                         file.peers,
                                         file.discovery_server,
                                         file.identity,
                                         {file.robot, file.fleet_domain, file.fleet_peers}},
                                        clock);
  if (!transport) return Error{transport.error()};
  return std::unique_ptr<DdsHost>(new DdsHost(std::make_unique<Implementation>(
      std::move(file), clock, std::move(transport).value(), stop)));
}

Status DdsHost::construct(const ComponentFactory& factory) {
  Status status = implementation_->engine.construct(factory);
  if (implementation_->engine.faulted()) implementation_->say_why();
  return status;
}

int DdsHost::run() {
  ::prctl(PR_SET_TIMERSLACK, 1000UL);  // [ns] a turn begins when it is due, not up to 50 us later
  Engine& engine = implementation_->engine;
  while (!implementation_->asked_to_stop()) {
    if (!engine.has_work()) implementation_->wait();
    if (engine.has_work() || engine.next_due() <= implementation_->platform.now()) {
      if (!engine.run_turn()) break;
    }
  }
  const bool faulted = engine.faulted();
  if (faulted) implementation_->say_why();
  engine.stop();
  return faulted ? 3 : 0;
}

Engine& DdsHost::engine() { return implementation_->engine; }

}  // namespace usher::runtime
