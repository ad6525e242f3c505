#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"
#include "idl/topic.hpp"
#include "runtime/api/parameters.hpp"
#include "runtime/api/ports.hpp"
#include "runtime/api/time.hpp"

namespace usher::runtime {

enum class HealthState : std::uint8_t { kStarting = 0, kOk = 1, kDegraded = 2, kFault = 3 };

/// How a component says how it is; the host puts it into the heartbeats.
class Health {
 public:
  virtual ~Health() = default;
  /// kStarting until the first call. kFault only through Host::fault.
  virtual void set(HealthState state, std::string reason = {}) = 0;
  /// A counter of the component, for example "scan: rejected"; the reference stays valid.
  virtual std::uint64_t& counter(const std::string& name) = 0;
};

/// Options of an input; the catalogue gives topic, type, rate and the writer's quality of service.
struct InputOptions {
  Duration max_age{};  ///< zero = never stale
  const char* on_loss =
      "";  ///< what the component does when it is stale or was never there; required with max_age
  int depth = 0;  ///< zero = the catalogue's; a topic with many writers needs depth per writer
  bool optional = false;     ///< the component works without any writer
  bool each_writer = false;  ///< for Input::fresh_of_each
  /// Who is heard keeps the input until it has been silent for max_age; another writer's samples
  /// are dropped and counted. For what moves the robot: who is foreign is known a moment later
  /// only.
  bool one_writer = false;
  /// A sample that is older than max_age when it comes runs no handler and is counted; here it runs
  /// it where none is fresh, and is not fresh itself. For what counts at any age: a press of Stop.
  bool late_too = false;
};

/// A byte stream to a device (serial line, TCP). Owned by the host.
class Stream {
 public:
  virtual ~Stream() = default;
  /// Queues the bytes; false when the stream is closed, or 64 kB or 1024 writes are already
  /// waiting.
  virtual bool write(std::span<const std::uint8_t> bytes) = 0;
  /// The same, in the place of what an earlier write_latest left waiting: for commands of which
  /// only the newest counts. What has begun to go out goes out whole.
  virtual bool write_latest(std::span<const std::uint8_t> bytes) = 0;
  virtual bool open() const = 0;
  /// Closes and opens anew after `delay`.
  virtual void reopen(Duration delay) = 0;
  /// What the guard shall send for so long, a second at most, before `safe`, when this component is
  /// silent or ends: one whole message, for example "stand, and turn on while you roll". The newest
  /// counts, and nothing where there is no guard, or where the component reopens the stream.
  virtual void last_will(std::span<const std::uint8_t> /*message*/, Duration /*lasts*/) {}
};
/// A guard process beside the driver: it owns the port, so that the device hears something safe
/// though the driver dies or hangs. It sends `safe` (first the driver's last will) at once when the
/// driver ends, and thrice in a `silence` while it has written nothing for that long; before the
/// driver's first write only twice, as its first words to the port. A guard that ends is replaced
/// at once, one that shows no life for 0.15 s is killed first; the stream is closed meanwhile. One
/// guard at a time has a port: that of a driver that ended leaves it to the next one at once.
struct StreamGuard {
  Bytes safe;  ///< one whole message to the device, for example "velocity zero"; empty = no guard
  Duration silence{};  ///< {>= 1 ms}
};
struct StreamHandlers {
  std::function<void()> on_open;
  std::function<void(std::span<const std::uint8_t>)> on_bytes;
  std::function<void(const std::string& reason)>
      on_close;  ///< also when opening failed; the host opens anew each second
  StreamGuard guard{};
};

/// Everything that a component may ask for. Called only from the component's constructor and
/// handlers; keep() from the constructor and from the jobs of offload().
///
/// Laws (tests/conformance proves them for every host): handlers of one component never overlap;
/// now() is constant inside a handler and never goes back; each turn runs at most `depth` samples
/// per input and writer, ordered by arrival and then by declaration, then what is due, losses
/// before timers, by time and then by declaration; a latched input gets a living writer's last
/// value however late it starts; timers do not drift and count what they skipped; outputs leave
/// when the handler returns without a fault, all or none; none waits for a disk (keep() is a fault
/// there); after a fault no handler runs; random streams have names, seeded from (world seed, robot
/// of a fleet, component, stream); topics of a fleet reach all of it, all others stay with one.
class Host {
 public:
  virtual ~Host() = default;

  virtual Time now() const = 0;
  /// Name of this component in the manifest, and of the host that it runs on.
  virtual const std::string& name() const = 0;
  virtual const std::string& host_name() const = 0;
  /// Name of this robot in its fleet. Empty: it belongs to none, and ports of fleet topics neither
  /// give nor take anything, nor grow stale.
  virtual const std::string& robot_name() const = 0;
  virtual Parameters& parameters() = 0;
  virtual Health& health() = 0;
  virtual Random random(std::string_view stream) = 0;

  /// A topic that this component reads. `handler(message, info)` runs for every sample; leave it
  /// out to poll the newest.
  template <class Message>
  Input<Message> input(
      const topics::Topic<Message>& topic, const InputOptions& options,
      std::type_identity_t<std::function<void(const Message&, const SampleInfo&)>> handler = {},
      std::function<void()> on_stale = {}) {
    InputDeclaration declaration;
    declaration.topic = topic.name;
    declaration.type = &message_type<Message>();
    declaration.qos = topic.reader_qos();
    if (options.depth > 0) declaration.qos.depth = options.depth;
    declaration.rate_hz = topic.rate_hz;
    declaration.max_age = options.max_age;
    declaration.on_loss = options.on_loss;
    declaration.optional = options.optional;
    declaration.each_writer = options.each_writer;
    declaration.one_writer = options.one_writer;
    declaration.late_too = options.late_too;
    declaration.scope = topic.scope;
    if (handler) {
      declaration.on_sample = [handler = std::move(handler)](const InputPort::Sample& sample) {
        handler(*static_cast<const Message*>(sample.message.get()), sample.info);
      };
    }
    declaration.on_stale = std::move(on_stale);
    return Input<Message>(&declare(std::move(declaration)));
  }

  /// A topic that this component writes.
  template <class Message>
  Output<Message> output(const topics::Topic<Message>& topic) {
    return Output<Message>(
        &declare(OutputDeclaration{std::string(topic.name), &message_type<Message>(),
                                   topic.writer_qos(), topic.rate_hz, topic.scope}));
  }

  /// A periodic timer, first due one period after the start; a period of zero makes a stopped
  /// timer.
  Timer timer(const std::string& name, Duration period,
              std::function<void(std::uint64_t skipped)> on_due) {
    return Timer(&declare(TimerDeclaration{name, period, std::move(on_due)}));
  }

  /// Blocking or long work: `job` runs beside the handlers and touches nothing of the component,
  /// `done` is a handler that runs after it. `declared` is how long the job takes in simulation.
  virtual void offload(Duration declared, std::function<void()> job,
                       std::function<void()> done) = 0;

  /// "tcp://192.168.1.2:2112", "serial:///dev/ttyUSB0?baud=115200", "device:///dev/input/js0" or,
  /// to be called instead, "listen://127.0.0.1:2112". In simulation there is none: the handlers get
  /// a close with that reason.
  virtual Stream& open_stream(const std::string& uri, StreamHandlers handlers) = 0;

  /// Memory over restarts, at most 1 MB a value; a boot ends that of "session.*". Nothing: nothing
  /// was kept; an error: there may be something, and it cannot be read. See wire::Keeper.
  virtual Status keep(const std::string& key, std::span<const std::uint8_t> bytes) = 0;
  virtual Result<std::optional<Bytes>> kept(const std::string& key) = 0;

  /// Every writer of the topic that discovery sees, of whatever type and quality, before its first
  /// sample; also its end. Topics of the own robot only.
  virtual void watch_writers(const std::string& topic,
                             std::function<void(const WriterInfo&)> handler) = 0;

  /// Ends the component: no handler runs after this one, nothing that it published leaves, the last
  /// heartbeat says why.
  [[noreturn]] virtual void fault(const std::string& reason) = 0;

 protected:
  virtual InputPort& declare(InputDeclaration declaration) = 0;
  virtual OutputPort& declare(OutputDeclaration declaration) = 0;
  virtual TimerPort& declare(TimerDeclaration declaration) = 0;
};

/// A component: an ordinary object that declares ports, parameters and timers in its constructor
/// and is entered only through their handlers. It owns no thread, never sleeps or blocks, reads no
/// clock, no environment.
class Component {
 public:
  virtual ~Component() = default;
};

/// How a program, a test or the simulation makes a component of a type.
struct ComponentFactory {
  std::string type;  ///< name of the component's folder, for example "amcl"
  std::function<std::unique_ptr<Component>(Host&)> make;
};

template <class C>
ComponentFactory component_factory(std::string type) {
  return {std::move(type),
          [](Host& host) { return std::unique_ptr<Component>(std::make_unique<C>(host)); }};
}

}  // namespace usher::runtime
