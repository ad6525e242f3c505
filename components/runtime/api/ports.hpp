#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "idl/topic.hpp"
#include "runtime/api/message_type.hpp"
#include "runtime/api/time.hpp"

namespace usher::runtime {

/// RTPS GUID: 12 bytes of participant, 4 bytes of entity.
using Guid = std::array<std::uint8_t, 16>;

/// What is known of a sample besides its content.
struct SampleInfo {
  Guid writer{};
  Time arrival{};            ///< on the reader's clock
  std::uint64_t number = 0;  ///< of the writer, from 1
  bool same_host = false;    ///< the writer's stamps are on the reader's clock
  /// When the content was true as far as this host can tell: the message's own stamp where it comes
  /// from the same host and is not in the future, else the arrival. Ages count from here.
  Time effective{};
};

/// A writer of a topic, seen by discovery.
struct WriterInfo {
  Guid guid{};
  std::string topic;
  std::string participant;  ///< name in the manifest, self-declared
  std::string host;         ///< name in the manifest, self-declared
  bool alive = false;       ///< false in the event that reports its end
  Time since{};
};

using topics::Qos;

// --- Type-erased ports: between Host and its implementations; components use the templates below.
// -----------------

class InputPort {
 public:
  struct Sample {
    std::shared_ptr<const void> message;
    SampleInfo info;
  };
  virtual ~InputPort() = default;
  virtual const Sample* latest() const = 0;  ///< null before the first
  virtual const Sample* fresh()
      const = 0;  ///< null when there is none or it is older than declared
  /// The newest of each writer that is not older than declared, in the order of their arrival;
  /// where the input was declared with `each_writer`.
  virtual std::vector<const Sample*> fresh_of_each() const = 0;
  virtual std::vector<WriterInfo> writers() const = 0;
  virtual std::uint64_t lost() const = 0;  ///< overwritten in the mailbox before a handler saw them
  virtual std::uint64_t rejected() const = 0;  ///< not a message of this type
};

class OutputPort {
 public:
  virtual ~OutputPort() = default;
  virtual void publish(const void* message) = 0;
  virtual std::size_t reader_count() const = 0;
  virtual Guid guid() const = 0;
};

class TimerPort {
 public:
  virtual ~TimerPort() = default;
  virtual void restart(Duration period) = 0;
  virtual void stop() = 0;
};

struct InputDeclaration {
  std::string topic;
  const MessageType* type = nullptr;
  Qos qos;
  Duration max_age{};        ///< zero = never stale
  std::string on_loss;       ///< what the component does then, for contract and documentation
  double rate_hz = 0.0;      ///< nominal rate of the topic, 0 = on occasion
  bool optional = false;     ///< `usher check` accepts a manifest without a writer
  bool each_writer = false;  ///< the newest sample of each writer is kept
  bool one_writer = false;   ///< nobody else is heard while the newest sample is fresh
  bool late_too = false;     ///< a sample that is too old when it comes runs the handler, too
  topics::Scope scope = topics::Scope::kRobot;
  std::function<void(const InputPort::Sample&)> on_sample;
  std::function<void()> on_stale;
};

struct OutputDeclaration {
  std::string topic;
  const MessageType* type = nullptr;
  Qos qos;
  double rate_hz = 0.0;
  topics::Scope scope = topics::Scope::kRobot;
};

struct TimerDeclaration {
  std::string name;
  Duration period{};
  std::function<void(std::uint64_t skipped)> on_due;
};

// --- What a component holds
// -------------------------------------------------------------------------------------------

/// The typed end of a topic that a component reads. Cheap to copy; lives as long as its host.
template <class Message>
class Input {
 public:
  Input() = default;
  explicit Input(InputPort* port) : port_(port) {}

  /// The newest sample that this component was given; null before the first. Valid until the
  /// handler returns.
  const Message* latest() const { return message(port_->latest()); }
  /// The same, but null when it is older than the age that the input declared.
  const Message* fresh() const { return message(port_->fresh()); }
  /// Where the input was declared with `each_writer`: the newest sample of every writer that is not
  /// older than declared. The one way to notice the silence of one writer among many.
  std::vector<const Message*> fresh_of_each() const {
    const auto samples = port_->fresh_of_each();
    std::vector<const Message*> all;
    all.reserve(samples.size());
    for (const auto* sample : samples) all.push_back(message(sample));
    return all;
  }
  /// The newest sample, to keep beyond the handler without a copy; null before the first.
  std::shared_ptr<const Message> share() const {
    const auto* sample = port_->latest();
    return sample ? std::static_pointer_cast<const Message>(sample->message) : nullptr;
  }
  /// About the newest sample; null before the first.
  const SampleInfo* info() const {
    const auto* sample = port_->latest();
    return sample ? &sample->info : nullptr;
  }
  std::vector<WriterInfo> writers() const { return port_->writers(); }
  std::uint64_t lost() const { return port_->lost(); }
  std::uint64_t rejected() const { return port_->rejected(); }

 private:
  static const Message* message(const InputPort::Sample* sample) {
    return sample ? static_cast<const Message*>(sample->message.get()) : nullptr;
  }
  InputPort* port_ = nullptr;
};

/// The typed end of a topic that a component writes.
template <class Message>
class Output {
 public:
  Output() = default;
  explicit Output(OutputPort* port) : port_(port) {}

  /// Leaves when the running handler returns without a fault: all samples of a handler or none.
  void publish(const Message& message) { port_->publish(&message); }
  /// How many readers are matched; for expensive outputs that nobody may want.
  std::size_t reader_count() const { return port_->reader_count(); }
  Guid guid() const { return port_->guid(); }

 private:
  OutputPort* port_ = nullptr;
};

/// A periodic timer. It does not drift; when the component was late it fires once and says how many
/// it skipped.
class Timer {
 public:
  Timer() = default;
  explicit Timer(TimerPort* port) : port_(port) {}
  /// First due one period from now.
  void restart(Duration period) { port_->restart(period); }
  void stop() { port_->stop(); }

 private:
  TimerPort* port_ = nullptr;
};

}  // namespace usher::runtime
