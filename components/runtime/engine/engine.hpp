#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"
#include "runtime/api/host.hpp"
#include "runtime/engine/platform.hpp"
#include "runtime/engine/transport.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

/// One component and everything that the host laws promise it: mailboxes, turns, ages, timers,
/// staged outputs, health, heartbeats, parameters, random streams. Shared by all hosts; they add a
/// clock (Platform) and a network (Transport).
///
/// A host does:
///
///     Engine engine(file, platform, transport);
///     const Status status = engine.construct(factory);   // failed: exit code engine.faulted() ? 3
///     : 2 while (!asked_to_stop) {
///       wait until engine.has_work() or engine.next_due();
///       if (!engine.run_turn()) break;                    // exit code 3, engine.fault_reason()
///       says why
///     }
///     engine.stop();
///
/// Threads: one dispatcher thread calls construct, next_due, run_turn, fail, stop and the
/// destructor; what the engine gave to the transport and the platform (Deliver, StreamSink,
/// `finished`), post and has_work may be called on any thread, also after stop and after the
/// engine's end, when they do nothing.
///
/// A turn takes what has arrived when it begins, at most `depth` samples per input and writer, and
/// reads the clock once. It runs samples and posted events in order of arrival (ties: posted events
/// first, then inputs by declaration), then what is due: losses of freshness, so that no timer
/// finds an input stale before its loss is told, then timers and the heartbeat; each in order of
/// time, ties by declaration, at most once.
class Engine final : public Host {
 public:
  /// Events waiting for a turn (discovery, streams, offloaded jobs); one more is a fault.
  static constexpr std::size_t kMaxPosted = 4096;
  /// Jobs under way; one more is a fault.
  static constexpr std::size_t kMaxJobs = 64;
  /// Received bytes of one stream that wait for a turn; then StreamSink::received refuses more.
  static constexpr std::size_t kMaxStreamBytes = std::size_t{256} * 1024;
  /// Writers remembered per input; beyond, the one not heard for longest is forgotten.
  static constexpr std::size_t kMaxWriters = 256;

  /// Both must outlive the engine (their ports and streams are used until its end).
  Engine(ParameterFile file, Platform& platform, Transport& transport);
  ~Engine() override;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Makes the component. Only when that succeeded, the ports are opened in order of declaration
  /// (output "heartbeat" last), what the constructor published leaves, and timers and ages start to
  /// count. An error lists every wrong parameter, one a line, or says why the constructor ended the
  /// component (then faulted()).
  Status construct(const ComponentFactory& factory);

  /// A turn would run a sample or a posted event now. Samples of inputs without handler wait for
  /// the next turn.
  bool has_work() const;
  /// When the next turn is needed without new work; Time::max() after the end. Valid until the next
  /// turn.
  Time next_due() const;
  /// False when the component has ended: by a fault or by stop().
  bool run_turn();

  /// An event to run in a later turn as a handler of the component.
  void post(std::function<void()> handler);

  /// Ends the component from outside of its handlers, as Host::fault does inside.
  void fail(const std::string& reason);
  /// No handler runs after this; nothing is written.
  void stop();

  bool faulted() const;
  const std::string& fault_reason() const;
  const ParameterFile& file() const;
  /// Handlers entered since the start, the constructor not counted.
  std::uint64_t handlers_run() const;

  // --- Host ---
  Time now() const override;
  const std::string& name() const override;
  const std::string& host_name() const override;
  const std::string& robot_name() const override;
  Parameters& parameters() override;
  Health& health() override;
  Random random(std::string_view stream) override;
  void offload(Duration declared, std::function<void()> job, std::function<void()> done) override;
  Stream& open_stream(const std::string& uri, StreamHandlers handlers) override;
  Status keep(const std::string& key, std::span<const std::uint8_t> bytes) override;
  Result<std::optional<Bytes>> kept(const std::string& key) override;
  void watch_writers(const std::string& topic,
                     std::function<void(const WriterInfo&)> handler) override;
  [[noreturn]] void fault(const std::string& reason) override;

 protected:
  /// Ports and timers are declared in the component's constructor only; later ones are a fault. An
  /// output's guid is zero until the constructor has returned.
  InputPort& declare(InputDeclaration declaration) override;
  OutputPort& declare(OutputDeclaration declaration) override;
  TimerPort& declare(TimerDeclaration declaration) override;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace usher::runtime
