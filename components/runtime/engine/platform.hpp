#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "foundation/result/result.hpp"
#include "runtime/api/host.hpp"

namespace usher::runtime {

struct Resources {
  float cpu_percent = 0.0F;        ///< of one core, since the last call
  std::uint64_t memory_bytes = 0;  ///< resident
};

/// Where the bytes of a stream go. Any thread, in the order in which things happened.
struct StreamSink {
  std::function<void()> opened;
  /// False when the component is too far behind: keep these bytes and offer them again later (10 ms
  /// will do).
  std::function<bool(std::span<const std::uint8_t>)> received;
  std::function<void(const std::string& reason)> closed;
  StreamGuard guard{};
};

/// What an Engine needs of its host besides the Transport. It outlives the engine.
class Platform {
 public:
  virtual ~Platform() = default;

  /// The host's clock (monotonic plus anchor); never goes back. Any thread.
  virtual Time now() const = 0;
  /// A stopwatch for the time that handlers take; only differences count. Dispatcher thread.
  virtual Duration work_time() const = 0;
  /// has_work() has become true. Any thread, under a lock of the engine: it must not call the
  /// engine and not block.
  virtual void wake() = 0;
  /// For the heartbeat; the dispatcher thread calls it once per heartbeat.
  virtual Resources resources() = 0;

  /// Runs `job` beside the handlers (in simulation after `declared`), then `finished`. Neither
  /// throws. Jobs of one component run in order of submission. Dispatcher thread calls it, any
  /// thread may run the two.
  virtual void offload(Duration declared, std::function<void()> job,
                       std::function<void()> finished) = 0;

  /// Opens a device and keeps it open: after a failure anew each second. Lives as long as the
  /// platform.
  virtual Stream& open_stream(const std::string& uri, StreamSink sink) = 0;

  virtual Status keep(const std::string& key, std::span<const std::uint8_t> bytes) = 0;
  virtual Result<std::optional<Bytes>> kept(const std::string& key) = 0;
};

}  // namespace usher::runtime
