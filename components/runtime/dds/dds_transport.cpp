#include "runtime/dds/dds_transport.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "runtime/dds/bytes_type.hpp"
#include "runtime/dds/participant.hpp"

namespace usher::runtime {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

Guid to_guid(const rtps::InstanceHandle_t& handle) {
  return usher::runtime::to_guid(rtps::iHandle2GUID(handle));
}

std::string name_of(const ReturnCode_t& code) {
  switch (code()) {
    case ReturnCode_t::RETCODE_ERROR:
      return "RETCODE_ERROR";
    case ReturnCode_t::RETCODE_BAD_PARAMETER:
      return "RETCODE_BAD_PARAMETER";
    case ReturnCode_t::RETCODE_PRECONDITION_NOT_MET:
      return "RETCODE_PRECONDITION_NOT_MET";
    case ReturnCode_t::RETCODE_OUT_OF_RESOURCES:
      return "RETCODE_OUT_OF_RESOURCES";
    case ReturnCode_t::RETCODE_NOT_ENABLED:
      return "RETCODE_NOT_ENABLED";
    case ReturnCode_t::RETCODE_TIMEOUT:
      return "RETCODE_TIMEOUT";
    default:
      return "return code " + std::to_string(code());
  }
}

/// Ports are declared by the component's code and checked by its tests, and the wire types are our
/// own: that one cannot be made is a programming error or an exhausted machine, and a component
/// without its ports is of no use.
template <class T>
T* require(Result<T*> result) {
  if (result) return result.value();
  std::fprintf(stderr, "fatal: %s\n", result.error().c_str());
  std::abort();
}

class DdsReader final : public Transport::Reader,
                        private dds::DataReaderListener,
                        private PayloadSink {
 public:
  DdsReader(Participant& participant, const InputDeclaration& declaration,
            Transport::Deliver deliver)
      : participant_(participant), type_(*declaration.type), deliver_(std::move(deliver)) {
    require(participant.create_reader("rt/" + declaration.topic, std::string(type_.name),
                                      declaration.qos, this));
  }

  std::vector<WriterInfo> writers() const override {
    std::set<Guid> matched;
    {
      const std::scoped_lock lock(mutex_);
      matched = matched_;
    }
    std::vector<WriterInfo> result;
    result.reserve(matched.size());
    for (const Guid& guid : matched) result.push_back(participant_.book().writer(guid));
    return result;
  }

 private:
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(static_cast<PayloadSink*>(this), &info) ==
           ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const Guid writer = to_guid(info.publication_handle);
      const auto number = info.sample_identity.sequence_number().to64long();
      deliver_(std::move(message_), writer, number > 0 ? static_cast<std::uint64_t>(number) : 0,
               participant_.book().same_host(writer, participant_.guid()));
    }
  }
  void take(std::span<const std::uint8_t> cdr) override { message_ = type_.deserialize(cdr); }

  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    const Guid writer = to_guid(status.last_publication_handle);
    const std::scoped_lock lock(mutex_);
    if (status.current_count_change > 0) {
      matched_.insert(writer);
    } else {
      matched_.erase(writer);
    }
  }

  Participant& participant_;
  const MessageType& type_;
  const Transport::Deliver deliver_;
  std::shared_ptr<const void>
      message_;  // between take() and deliver_, which the library serialises per reader
  mutable std::mutex mutex_;
  std::set<Guid> matched_;
};

class DdsWriter final : public Transport::Writer, private dds::DataWriterListener {
 public:
  DdsWriter(Participant& participant, const OutputDeclaration& declaration)
      : topic_(declaration.topic),
        writer_(require(participant.create_writer("rt/" + declaration.topic,
                                                  std::string(declaration.type->name),
                                                  declaration.qos, this))),
        guid_(usher::runtime::to_guid(writer_->guid())) {}

  bool write(std::shared_ptr<const Bytes> cdr) override {
    last_ = cdr;
    std::span<const std::uint8_t> payload(*cdr);
    const ReturnCode_t code = writer_->write(&payload, rtps::c_InstanceHandle_Unknown);
    if (code == ReturnCode_t::RETCODE_OK) return true;
    if (const auto cause = 1U << std::min(code(), 31U); (told_ & cause) == 0) {
      told_ |= cause;
      std::fprintf(stderr, "warning: %zu bytes on rt/%s could not be written: %s\n", payload.size(),
                   topic_.c_str(), name_of(code).c_str());
    }
    return false;
  }
  std::size_t reader_count() const override { return readers_.load(std::memory_order_relaxed); }
  Guid guid() const override { return guid_; }

  const std::string& topic() const { return topic_; }
  /// Writes the last sample again.
  void repeat() {
    if (last_ != nullptr) write(last_);
  }

 private:
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    readers_.store(static_cast<std::size_t>(status.current_count), std::memory_order_relaxed);
  }

  const std::string topic_;
  // Before writer_: the listener may be called while it is being made.
  std::atomic<std::size_t> readers_{0};
  std::shared_ptr<const Bytes> last_;
  dds::DataWriter* writer_;
  Guid guid_;
  std::uint32_t told_ = 0;  ///< causes for which one was not written, a bit each
};

}  // namespace

class DdsTransport::Implementation {
 public:
  MonotonicClock clock;
  Time begin;
  // The participants go first: they end the callbacks into the ports.
  std::vector<std::unique_ptr<DdsReader>> readers;
  std::vector<std::unique_ptr<DdsWriter>> writers;
  std::unique_ptr<Participant> participant;
  ParticipantOptions fleet;
  std::unique_ptr<Participant> in_fleet{};  ///< null until there is a port for it

  Participant& of(topics::Scope scope) {
    if (scope == topics::Scope::kRobot) return *participant;
    if (!in_fleet) {
      auto made = Participant::create(fleet, clock);
      // As a port that cannot be made.
      if (!made) {
        std::fprintf(stderr, "fatal: the fleet: %s\n", made.error().c_str());
        std::abort();
      }
      in_fleet = std::move(made).value();
    }
    return *in_fleet;
  }
};

DdsTransport::DdsTransport(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
DdsTransport::~DdsTransport() = default;

Result<std::unique_ptr<DdsTransport>> DdsTransport::create(const Options& options,
                                                           const MonotonicClock& clock) {
  if (!options.fleet.robot.empty() && !options.identity.empty())
    return Error{
        "a fleet and security do not go together: nothing on the fleet's domain is signed"};
  auto participant = Participant::create({options.name, options.host, options.domain, options.peers,
                                          options.discovery_server, options.identity},
                                         clock);
  if (!participant) return Error{participant.error()};
  ParticipantOptions fleet;
  fleet.name = options.fleet.robot + "/" + options.name;
  // What one robot calls "laptop" is not the "laptop" of another: their clocks differ.
  fleet.host = options.fleet.robot + "/" + options.host;
  fleet.domain = options.fleet.domain;
  fleet.peers = options.fleet.peers;
  auto implementation = std::make_unique<Implementation>(
      Implementation{clock, clock.now(), {}, {}, std::move(participant).value(), std::move(fleet)});
  return std::unique_ptr<DdsTransport>(new DdsTransport(std::move(implementation)));
}

Transport::Reader& DdsTransport::open_reader(const InputDeclaration& declaration, Deliver deliver) {
  implementation_->readers.push_back(std::make_unique<DdsReader>(
      implementation_->of(declaration.scope), declaration, std::move(deliver)));
  return *implementation_->readers.back();
}

Transport::Writer& DdsTransport::open_writer(const OutputDeclaration& declaration) {
  implementation_->writers.push_back(
      std::make_unique<DdsWriter>(implementation_->of(declaration.scope), declaration));
  return *implementation_->writers.back();
}

void DdsTransport::watch_writers(const std::string& topic,
                                 std::function<void(const WriterInfo&)> event) {
  const MonotonicClock clock = implementation_->clock;
  implementation_->participant->book().observe(
      {}, [topic = "rt/" + topic, event = std::move(event), clock](const EndpointInfo& endpoint,
                                                                   bool alive) {
        if (!endpoint.writer || endpoint.topic != topic) return;
        event({endpoint.guid, topic.substr(3), endpoint.participant, endpoint.host, alive,
               alive ? endpoint.since : clock.now()});
      });
}

void DdsTransport::farewell(const std::string& topic) {
  constexpr Duration kDiscovery = std::chrono::milliseconds(500);
  constexpr Duration kBetween = std::chrono::milliseconds(50);
  constexpr int kTimes = 3;
  for (const auto& writer : implementation_->writers) {
    if (writer->topic() != topic) continue;
    std::this_thread::sleep_for(implementation_->begin + kDiscovery - implementation_->clock.now());
    for (int i = 0; i < kTimes; ++i) {
      writer->repeat();
      std::this_thread::sleep_for(kBetween);
    }
  }
}

}  // namespace usher::runtime
