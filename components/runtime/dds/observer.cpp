#include "runtime/dds/observer.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "runtime/dds/bytes_type.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"
#include "runtime/dds/participant.hpp"

namespace usher::runtime {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

Guid to_guid(const rtps::InstanceHandle_t& handle) {
  return usher::runtime::to_guid(rtps::iHandle2GUID(handle));
}

/// The last `Size` values, oldest overwritten.
template <class T, std::size_t Size>
class Ring {
 public:
  void push(T value) { values_[count_++ % Size] = value; }
  std::size_t size() const { return std::min(count_, Size); }
  T oldest() const { return values_[count_ < Size ? 0 : count_ % Size]; }
  T newest() const { return values_[(count_ - 1) % Size]; }
  std::vector<T> sorted() const {
    std::vector<T> result(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(size()));
    std::ranges::sort(result);
    return result;
  }

 private:
  std::array<T, Size> values_{};
  std::size_t count_ = 0;
};

/// Counts what Statistics reports.
class Counter {
 public:
  void add(const Observer::RawSample& sample, bool malformed) {
    ++counted_.samples;
    counted_.bytes += sample.cdr.size();
    if (malformed) ++counted_.malformed;
    std::uint64_t& last = numbers_[sample.writer];
    if (last != 0 && sample.number > last + 1) counted_.missed += sample.number - last - 1;
    last = std::max(last, sample.number);
    arrivals_.push(sample.arrival);
    if (sample.latency) latencies_.push(*sample.latency);
  }

  Observer::Statistics statistics(Time now) const {
    Observer::Statistics result = counted_;
    if (arrivals_.size() > 1) {
      const double intervals = static_cast<double>(arrivals_.size() - 1);
      const double span = seconds(arrivals_.newest() - arrivals_.oldest());
      // Four intervals of silence: they have stopped coming.
      if (span > 0.0 && seconds(now - arrivals_.newest()) < std::max(4.0 * span / intervals, 0.2)) {
        result.rate_hz = intervals / span;
      }
    }
    if (const auto sorted = latencies_.sorted(); !sorted.empty()) {
      result.latency_p50 = sorted[sorted.size() / 2];
      result.latency_p99 = sorted[sorted.size() * 99 / 100];
    }
    return result;
  }

 private:
  Observer::Statistics counted_;
  std::map<Guid, std::uint64_t> numbers_;
  Ring<Time, 32> arrivals_;
  Ring<Duration, 256> latencies_;
};

class ObserverSubscription final : public Observer::Subscription,
                                   private dds::DataReaderListener,
                                   private PayloadSink {
 public:
  using OnSample = std::function<void(const Observer::RawSample&)>;

  static Result<std::unique_ptr<Observer::Subscription>> create(
      Participant& participant, const MonotonicClock& clock, const std::string& topic,
      const std::string& type, const Qos& qos, OnSample on_sample) {
    std::unique_ptr<ObserverSubscription> self(new ObserverSubscription(
        participant, clock, message_type_by_name(type), std::move(on_sample)));
    const auto reader = participant.create_reader(topic, type, qos, self.get());
    if (!reader) return Error{reader.error()};
    self->reader_ = *reader;
    return std::unique_ptr<Observer::Subscription>(std::move(self));
  }
  ~ObserverSubscription() override {
    if (reader_ != nullptr) participant_.delete_reader(reader_);
  }

  Observer::Statistics statistics() const override {
    const std::scoped_lock lock(mutex_);
    return counter_.statistics(clock_.now());
  }
  std::size_t writer_count() const override { return writers_; }

 private:
  ObserverSubscription(Participant& participant, const MonotonicClock& clock,
                       const MessageType* type, OnSample on_sample)
      : participant_(participant), clock_(clock), type_(type), on_sample_(std::move(on_sample)) {}

  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(static_cast<PayloadSink*>(this), &info) ==
           ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      Observer::RawSample sample;
      sample.cdr = cdr_;
      sample.arrival = clock_.now();
      sample.writer = to_guid(info.publication_handle);
      const auto number = info.sample_identity.sequence_number().to64long();
      sample.number = number > 0 ? static_cast<std::uint64_t>(number) : 0;
      sample.same_host = participant_.book().same_host(sample.writer, participant_.guid());
      bool malformed = false;
      if (type_ != nullptr) {
        const auto message = type_->deserialize(cdr_);
        malformed = message == nullptr;
        const auto stamp = malformed ? std::nullopt : type_->stamp(message.get());
        if (stamp && sample.same_host) sample.latency = sample.arrival - *stamp;
      }
      {
        const std::scoped_lock lock(mutex_);
        counter_.add(sample, malformed);
      }
      if (on_sample_) on_sample_(sample);
    }
  }
  void take(std::span<const std::uint8_t> cdr) override { cdr_.assign(cdr.begin(), cdr.end()); }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    writers_ = static_cast<std::size_t>(status.current_count);
  }

  Participant& participant_;
  const MonotonicClock clock_;
  const MessageType* const type_;
  const OnSample on_sample_;
  Bytes cdr_;
  std::atomic<std::size_t> writers_{0};
  mutable std::mutex mutex_;
  Counter counter_;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace

class Observer::Implementation {
 public:
  explicit Implementation(const MonotonicClock& the_clock) : clock(the_clock) {}
  const MonotonicClock clock;
  std::mutex mutex;
  std::condition_variable changed;
  std::unique_ptr<Participant> participant;  // ends first: its events use the others
};

/// Where decoded samples wait for Reader::take.
class Observer::Inbox {
 public:
  static constexpr std::size_t kMax = 1024;
  std::mutex mutex;
  std::condition_variable arrived;
  std::deque<std::shared_ptr<const void>> waiting;
};

Observer::Observer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
Observer::~Observer() = default;

Result<std::unique_ptr<Observer>> Observer::create(const Options& options) {
  auto implementation = std::make_unique<Implementation>(MonotonicClock(options.clock_anchor));
  std::string host = options.host;
  if (host.empty()) {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    host = name.data();
  }
  auto participant = Participant::create({options.name, host, options.domain, options.peers,
                                          options.discovery_server, options.identity},
                                         implementation->clock);
  if (!participant) return Error{participant.error()};
  Implementation& state = *implementation;
  state.participant = std::move(participant).value();
  const auto notify = [&state] {
    { const std::scoped_lock lock(state.mutex); }
    state.changed.notify_all();
  };
  state.participant->book().observe([notify](const ParticipantInfo&, bool) { notify(); },
                                    [notify](const EndpointInfo&, bool) { notify(); });
  return std::unique_ptr<Observer>(new Observer(std::move(implementation)));
}

Guid Observer::guid() const { return implementation_->participant->guid(); }
Time Observer::now() const { return implementation_->clock.now(); }
std::vector<ParticipantInfo> Observer::participants() const {
  return implementation_->participant->book().participants();
}
std::vector<EndpointInfo> Observer::endpoints() const {
  return implementation_->participant->book().endpoints();
}
std::vector<Refusal> Observer::refusals() const {
  return implementation_->participant->book().refusals();
}

void Observer::watch(DiscoveryBook::ParticipantEvent participant,
                     DiscoveryBook::EndpointEvent endpoint) {
  implementation_->participant->book().observe(std::move(participant), std::move(endpoint));
}

bool Observer::wait_for(const std::function<bool(const Observer&)>& condition,
                        Duration limit) const {
  std::unique_lock lock(implementation_->mutex);
  return implementation_->changed.wait_for(lock, limit, [&] { return condition(*this); });
}

Result<std::unique_ptr<Observer::Subscription>> Observer::subscribe(
    const std::string& topic, const std::string& type, const Qos& qos,
    std::function<void(const RawSample&)> on_sample) {
  return ObserverSubscription::create(*implementation_->participant, implementation_->clock, topic,
                                      type, qos, std::move(on_sample));
}

Result<std::pair<std::shared_ptr<Observer::Inbox>, std::unique_ptr<Observer::Subscription>>>
Observer::inbox(const std::string& topic, const MessageType& type, const Qos& qos,
                std::function<void(const void*, const RawSample&)> on_sample) {
  auto box = std::make_shared<Inbox>();
  auto subscription =
      subscribe(topic, std::string(type.name), qos,
                [box, &type, on_sample = std::move(on_sample)](const RawSample& sample) {
                  auto message = type.deserialize(sample.cdr);
                  if (message == nullptr) return;
                  if (on_sample) return on_sample(message.get(), sample);
                  const std::scoped_lock lock(box->mutex);
                  if (box->waiting.size() == Inbox::kMax) box->waiting.pop_front();
                  box->waiting.push_back(std::move(message));
                  box->arrived.notify_all();
                });
  if (!subscription) return Error{subscription.error()};
  return std::pair(std::move(box), std::move(subscription).value());
}

std::shared_ptr<const void> Observer::take(Inbox& inbox, Duration limit) {
  std::unique_lock lock(inbox.mutex);
  if (!inbox.arrived.wait_for(lock, limit, [&] { return !inbox.waiting.empty(); })) return nullptr;
  auto message = std::move(inbox.waiting.front());
  inbox.waiting.pop_front();
  return message;
}

namespace {

template <class Base>
class ObserverWriter final : public Base, private dds::DataWriterListener {
 public:
  explicit ObserverWriter(Participant& participant) : participant_(participant) {}
  ~ObserverWriter() override {
    if (writer_ != nullptr) participant_.delete_writer(writer_);
  }
  Status open(const std::string& topic, const std::string& type, const Qos& qos,
              const ForeignQuality& foreign = {}) {
    const auto made = participant_.create_writer(topic, type, qos, this, foreign);
    if (!made) return Error{made.error()};
    writer_ = *made;
    return {};
  }

  bool write(std::span<const std::uint8_t> cdr) override { return writer_->write(&cdr); }
  std::size_t reader_count() const override {
    const std::scoped_lock lock(mutex_);
    return readers_;
  }
  bool wait_for_readers(std::size_t count, Duration limit) const override {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return readers_ >= count; });
  }
  Guid guid() const override { return usher::runtime::to_guid(writer_->guid()); }

 private:
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    {
      const std::scoped_lock lock(mutex_);
      readers_ = static_cast<std::size_t>(status.current_count);
    }
    changed_.notify_all();
  }

  Participant& participant_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::size_t readers_ = 0;
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<Observer::RawWriter>> Observer::raw_writer(const std::string& topic,
                                                                  const std::string& type,
                                                                  const Qos& qos) {
  auto writer = std::make_unique<ObserverWriter<RawWriter>>(*implementation_->participant);
  if (const Status status = writer->open(topic, type, qos); !status) return Error{status.error()};
  return std::unique_ptr<RawWriter>(std::move(writer));
}

Result<std::unique_ptr<Observer::RawWriter>> Observer::foreign_writer(const std::string& topic,
                                                                      const std::string& type,
                                                                      const Foreign& foreign) {
  auto writer = std::make_unique<ObserverWriter<RawWriter>>(*implementation_->participant);
  const Status status = writer->open(topic, type, {!foreign.best_effort, foreign.latched, 1},
                                     {foreign.best_effort, foreign.exclusive, foreign.strength});
  if (!status) return Error{status.error()};
  return std::unique_ptr<RawWriter>(std::move(writer));
}

}  // namespace usher::runtime
