#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "foundation/result/result.hpp"
#include "idl/topic.hpp"
#include "runtime/api/message_type.hpp"
#include "runtime/api/ports.hpp"
#include "runtime/dds/discovery.hpp"

namespace usher::runtime {

/// A participant for tools and tests: sees who is in the domain, reads and writes any topic.
/// Thread-safe. Callbacks run in the middleware's threads, for one subscription one at a time; they
/// must be quick and may not destroy what calls them.
class Observer {
 public:
  struct Options {
    std::string name = "operator";
    std::string host;  ///< as in the manifest; empty = the machine's name
    std::uint32_t domain = 0;
    std::vector<std::string> peers;
    std::int64_t clock_anchor = 0;  ///< [ns] as the launcher's; 0 = wall clock now
    std::string discovery_server;   ///< "10.0.0.1:11811"; empty = everybody announces to everybody
    std::string identity;           ///< folder of `usher keys`; empty = without security
  };
  /// A sample as it came, of whatever type. The bytes are gone when the callback returns.
  struct RawSample {
    std::span<const std::uint8_t> cdr;
    Guid writer{};
    std::uint64_t number = 0;
    Time arrival{};
    bool same_host = false;
    std::optional<Duration> latency;  ///< arrival minus stamp, of known types from the same host
  };
  /// What was counted on a subscription since it was made.
  struct Statistics {
    std::uint64_t samples = 0;
    std::uint64_t bytes = 0;
    std::uint64_t malformed = 0;  ///< not messages of the type, where the type is known
    std::uint64_t missed = 0;     ///< gaps in the writers' numbers
    double rate_hz = 0.0;         ///< over the last 32 samples, 0 when they have stopped coming
    Duration latency_p50{};       ///< over the last 256 samples with a latency; zero = none
    Duration latency_p99{};
  };

  /// Ends when it is destroyed, before the observer's end.
  class Subscription {
   public:
    virtual ~Subscription() = default;
    virtual Statistics statistics() const = 0;
    virtual std::size_t writer_count() const = 0;  ///< matched
  };

  template <class Message>
  class Reader;
  template <class Message>
  class Writer;
  /// Writes bytes as they are. Must end before its observer.
  class RawWriter {
   public:
    virtual ~RawWriter() = default;
    virtual bool write(std::span<const std::uint8_t> cdr) = 0;
    virtual std::size_t reader_count() const = 0;
    virtual bool wait_for_readers(std::size_t count, Duration limit) const = 0;
    virtual Guid guid() const = 0;
  };
  /// What a foreign participant can do: any quality of service. For attacks in tests.
  struct Foreign {
    bool best_effort = false;
    bool latched = false;
    bool exclusive = false;      ///< exclusive ownership ...
    std::uint32_t strength = 0;  ///< ... of this strength
  };

  static Result<std::unique_ptr<Observer>> create(const Options& options);
  ~Observer();

  Guid guid() const;
  Time now() const;

  /// This observer and its endpoints are listed too.
  std::vector<ParticipantInfo> participants() const;
  std::vector<EndpointInfo> endpoints() const;
  /// Who was kept out, and whose messages were dropped.
  std::vector<Refusal> refusals() const;
  /// First what is already there, then every change. Callbacks may ask the observer but not
  /// subscribe.
  void watch(DiscoveryBook::ParticipantEvent participant, DiscoveryBook::EndpointEvent endpoint);
  /// False when the condition is not met in time; asks it anew after each change in the domain.
  bool wait_for(const std::function<bool(const Observer&)>& condition, Duration limit) const;

  /// Any topic by its wire name ("rt/scan") and type name. One observer reads a topic with one
  /// type.
  Result<std::unique_ptr<Subscription>> subscribe(const std::string& topic, const std::string& type,
                                                  const Qos& qos,
                                                  std::function<void(const RawSample&)> on_sample);

  /// A topic of the catalogue. `on_sample` may be empty: then samples wait for take() and wait().
  template <class Message>
  Result<Reader<Message>> reader(
      const topics::Topic<Message>& topic,
      std::type_identity_t<std::function<void(const Message&, const RawSample&)>> on_sample = {});
  template <class Message>
  Result<Writer<Message>> writer(const topics::Topic<Message>& topic);
  /// Any topic by its wire name and type name.
  Result<std::unique_ptr<RawWriter>> foreign_writer(const std::string& topic,
                                                    const std::string& type,
                                                    const Foreign& foreign);

 private:
  class Implementation;
  class Inbox;
  explicit Observer(std::unique_ptr<Implementation> implementation);
  Result<std::unique_ptr<RawWriter>> raw_writer(const std::string& topic, const std::string& type,
                                                const Qos& qos);
  Result<std::pair<std::shared_ptr<Inbox>, std::unique_ptr<Subscription>>> inbox(
      const std::string& topic, const MessageType& type, const Qos& qos,
      std::function<void(const void*, const RawSample&)> on_sample);
  static std::shared_ptr<const void> take(Inbox& inbox, Duration limit);

  std::unique_ptr<Implementation> implementation_;
};

/// Samples of a catalogue topic; without callback the last 1024 wait to be taken. Must end before
/// its observer.
template <class Message>
class Observer::Reader {
 public:
  /// The oldest sample that waits, null when none comes within `limit`.
  std::shared_ptr<const Message> take(Duration limit = {}) {
    return std::static_pointer_cast<const Message>(Observer::take(*inbox_, limit));
  }
  Statistics statistics() const { return subscription_->statistics(); }
  std::size_t writer_count() const { return subscription_->writer_count(); }

 private:
  friend class Observer;
  std::shared_ptr<Inbox> inbox_;
  std::unique_ptr<Subscription> subscription_;
};

/// Writes a catalogue topic. Must end before its observer.
template <class Message>
class Observer::Writer {
 public:
  bool write(const Message& message) {
    Bytes cdr;
    return message_type<Message>().serialize(&message, cdr) && raw_->write(cdr);
  }
  /// Bytes as they are, for tests of what a component does with them.
  bool write_raw(std::span<const std::uint8_t> cdr) { return raw_->write(cdr); }
  std::size_t reader_count() const { return raw_->reader_count(); }
  bool wait_for_readers(std::size_t count, Duration limit) const {
    return raw_->wait_for_readers(count, limit);
  }
  Guid guid() const { return raw_->guid(); }

 private:
  friend class Observer;
  std::unique_ptr<RawWriter> raw_;
};

template <class Message>
Result<Observer::Reader<Message>> Observer::reader(
    const topics::Topic<Message>& topic,
    std::type_identity_t<std::function<void(const Message&, const RawSample&)>> on_sample) {
  std::function<void(const void*, const RawSample&)> erased;
  if (on_sample) {
    erased = [on_sample = std::move(on_sample)](const void* message, const RawSample& sample) {
      on_sample(*static_cast<const Message*>(message), sample);
    };
  }
  auto made = inbox("rt/" + std::string(topic.name), message_type<Message>(), topic.reader_qos(),
                    std::move(erased));
  if (!made) return Error{made.error()};
  Reader<Message> reader;
  reader.inbox_ = std::move(made->first);
  reader.subscription_ = std::move(made->second);
  return reader;
}

template <class Message>
Result<Observer::Writer<Message>> Observer::writer(const topics::Topic<Message>& topic) {
  auto made = raw_writer("rt/" + std::string(topic.name), std::string(message_type<Message>().name),
                         topic.writer_qos());
  if (!made) return Error{made.error()};
  Writer<Message> writer;
  writer.raw_ = std::move(made).value();
  return writer;
}

}  // namespace usher::runtime
