#include "runtime/dds/participant.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "runtime/dds/bytes_type.hpp"
#include "runtime/dds/security.hpp"
#include "runtime/dds/signed_presence.hpp"
#include "runtime/dds/socket_buffers.hpp"

#if defined(__SANITIZE_ADDRESS__)
// The Debian build of Fast DDS deletes its statistics objects under another type than it makes
// them; without this every program that makes an endpoint would end there.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "new_delete_type_mismatch=0"; }
#endif

namespace usher::runtime {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::Duration_t;

namespace {

constexpr std::uint32_t kSocketBuffer = 4U << 20;
/// Participants per host that an initial peer is asked for; Fast DDS asks 4. One side has to ask
/// for the other, five times a second for each: more than the programs of a robot's largest host,
/// no more, since twice as many keep a small machine busy.
constexpr std::uint32_t kPeerRange = 32;
/// A received sample stays in the history only until the listener has taken it, but reliable ones
/// wait there for an earlier one that was lost; the depth that a component asked for is kept by its
/// mailbox.
constexpr int kReaderHistory = 32;

Duration_t milliseconds(std::uint32_t count) {
  return {static_cast<std::int32_t>(count / 1000), count % 1000 * 1'000'000};
}

/// Errors of the library on standard error, where they do not mix with what a program prints. Who
/// floods the network with nonsense shall not fill the disk: so many lines in a while, the rest is
/// counted.
class ErrorLog : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const auto now = std::chrono::steady_clock::now();
    if (now - window_ > kWindow) {
      if (lines_ > kLines)
        std::fprintf(stderr, "fast dds: %zu more messages like these\n", lines_ - kLines);
      window_ = now;
      lines_ = 0;
    }
    if (++lines_ > kLines) return;
    std::fprintf(stderr, "fast dds: %s: %s\n", entry.context.category, entry.message.c_str());
  }

 private:
  static constexpr std::chrono::seconds kWindow{10};
  static constexpr std::size_t kLines = 20;
  std::chrono::steady_clock::time_point window_{};
  std::size_t lines_ = 0;
};

/// The library reads profiles and discovery settings from the environment and the working
/// directory; what runs on a robot is decided by its manifest alone. Must happen before the factory
/// exists.
void isolate_library() {
  static const bool once = [] {
    for (const char* name :
         {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE", "ROS_DISCOVERY_SERVER",
          "FASTDDS_ENVIRONMENT_FILE", "FASTDDS_STATISTICS", "FASTDDS_BUILTIN_TRANSPORTS"}) {
      unsetenv(name);
    }
    setenv("SKIP_DEFAULT_XML_FILE", "1", 1);
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<ErrorLog>());
    dds::Log::SetVerbosity(dds::Log::Error);
    return true;
  }();
  static_cast<void>(once);
}

Status add_peers(const ParticipantOptions& options, dds::DomainParticipantQos& qos) {
  if (options.peers.empty()) return {};
  rtps::LocatorList_t& peers = qos.wire_protocol().builtin.initialPeersList;
  rtps::Locator_t multicast;  // a list that leaves it out would end discovery by multicast
  multicast.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(multicast, "239.255.0.1");
  peers.push_back(multicast);
  for (const std::string& address : options.peers) {
    rtps::Locator_t locator;
    locator.kind = LOCATOR_KIND_UDPv4;
    if (!rtps::IPLocator::isIPv4(address) || !rtps::IPLocator::setIPv4(locator, address)) {
      return Error{"peers of " + options.name + ": expected IPv4 addresses like 10.0.0.2, found '" +
                   address + "'"};
    }
    peers.push_back(locator);
  }
  return {};
}

/// The one server of a domain, by a prefix that all its clients know.
constexpr const char* kServerPrefix = "44.53.00.5f.45.50.52.4f.53.49.4d.41";

/// With a server, everybody tells it alone who is there, and hears everything from it: the
/// supervisor must see each writer of a command, also those that match none of its readers.
Status use_server(const ParticipantOptions& options, dds::DomainParticipantQos& qos) {
  if (options.discovery_server.empty()) return {};
  const auto colon = options.discovery_server.rfind(':');
  const std::string address = options.discovery_server.substr(0, colon);
  std::uint16_t port = 0;
  const char* end = options.discovery_server.data() + options.discovery_server.size();
  const bool numeric =
      colon != std::string::npos &&
      std::from_chars(options.discovery_server.data() + colon + 1, end, port).ptr == end;
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  if (!numeric || port == 0 || !rtps::IPLocator::isIPv4(address) ||
      !rtps::IPLocator::setIPv4(locator, address)) {
    return Error{"discovery server of " + options.name +
                 ": expected ADDRESS:PORT like 10.0.0.1:11811, found '" + options.discovery_server +
                 "'"};
  }
  locator.port = port;
  auto& builtin = qos.wire_protocol().builtin;
  if (options.serves_discovery) {
    qos.wire_protocol().prefix = {};
    std::istringstream(kServerPrefix) >> qos.wire_protocol().prefix;
    builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
    builtin.metatrafficUnicastLocatorList.push_back(locator);
    return {};
  }
  rtps::RemoteServerAttributes server;
  server.ReadguidPrefix(kServerPrefix);
  server.metatrafficUnicastLocatorList.push_back(locator);
  builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SUPER_CLIENT;
  builtin.discovery_config.m_DiscoveryServers.push_back(server);
  builtin.discovery_config.discoveryServer_client_syncperiod = milliseconds(200);
  return {};
}

Result<dds::DomainParticipantQos> participant_qos(const ParticipantOptions& options,
                                                  GuardOptions guard) {
  dds::DomainParticipantQos qos;
  qos.name(options.name.c_str());
  const std::string user_data = Identity{options.name, options.host, USHER_IDL_DIGEST}.user_data();
  qos.user_data() = std::vector<rtps::octet>(user_data.begin(), user_data.end());

  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->sendBufferSize = kSocketBuffer;
  udp->receiveBufferSize = kSocketBuffer;
  udp->maxInitialPeersRange = kPeerRange;
  qos.transport().use_builtin_transports = false;
  guard.only_signed = !options.identity.empty();
  // Clients hear of one another through the server, whose messages are its own.
  if (!options.discovery_server.empty()) guard.presence = nullptr;
  // Peers are asked where multicast does not go, perhaps on this very host.
  guard.announces_by_multicast =
      options.discovery_server.empty() && std::ranges::none_of(options.peers, [](const auto& peer) {
        return peer.starts_with("127.");
      });
  if (guard.only_signed) {
    if (auto status = apply_identity(options.identity, qos); !status) return Error{status.error()};
  }
  qos.transport().user_transports.push_back(guarded_transport(udp, std::move(guard)));
  qos.transport().send_socket_buffer_size = kSocketBuffer;
  qos.transport().listen_socket_buffer_size = kSocketBuffer;

  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::SIMPLE;
  // Who was killed keeps its right to write until then: its next start has to be heard within 1 s.
  discovery.leaseDuration = milliseconds(800);
  discovery.leaseDuration_announcementperiod = milliseconds(200);
  // Announcements are lost while the other side is still opening its sockets: several soon after
  // the start.
  discovery.initial_announcements.count = 10;
  discovery.initial_announcements.period = milliseconds(20);
  if (const Status status = add_peers(options, qos); !status) return Error{status.error()};
  if (const Status status = use_server(options, qos); !status) return Error{status.error()};
  return qos;
}

/// Where a participant says that it listens.
std::string address_of(const rtps::ParticipantProxyData& data) {
  for (const auto& locators : {data.default_locators, data.metatraffic_locators}) {
    if (!locators.unicast.empty()) return rtps::IPLocator::toIPv4string(*locators.unicast.begin());
  }
  return {};
}

template <class ProxyData>
EndpointInfo endpoint_info(const ProxyData& data, bool writer) {
  EndpointInfo info;
  info.guid = to_guid(data.guid());
  info.writer = writer;
  info.topic = data.topicName().to_string();
  info.type = data.typeName().to_string();
  info.reliable = data.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  info.latched = data.m_qos.m_durability.kind != dds::VOLATILE_DURABILITY_QOS;
  return info;
}

}  // namespace

Guid to_guid(const rtps::GUID_t& guid) {
  Guid result{};
  std::copy_n(guid.guidPrefix.value, 12, result.begin());
  std::copy_n(guid.entityId.value, 4, result.begin() + 12);
  return result;
}

/// Runs on the library's threads.
class Participant::Listener : public dds::DomainParticipantListener {
 public:
  Listener(DiscoveryBook& book, SignedPresence& presence) : book_(book), presence_(presence) {}

  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& event) override {
    using Event = rtps::ParticipantDiscoveryInfo;
    const Guid guid = to_guid(event.info.m_guid);
    if (event.status == Event::REMOVED_PARTICIPANT || event.status == Event::DROPPED_PARTICIPANT) {
      presence_.gone(DiscoveryBook::prefix_of(guid));
      book_.participant_gone(guid);
    } else if (event.status == Event::DISCOVERED_PARTICIPANT) {
      const auto& data = event.info.m_userData;
      auto identity = Identity::parse({reinterpret_cast<const char*>(data.data()), data.size()});
      if (!identity) identity = Identity{event.info.m_participantName.to_string(), {}, 0};
      book_.participant_seen(guid, *identity, address_of(event.info));
    }
  }
  void onParticipantAuthentication(dds::DomainParticipant*,
                                   rtps::ParticipantAuthenticationInfo&& event) override {
    if (event.status == rtps::ParticipantAuthenticationInfo::UNAUTHORIZED_PARTICIPANT)
      book_.participant_refused(to_guid(event.guid));
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& event) override {
    if (event.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
      book_.endpoint_gone(to_guid(event.info.guid()));
    } else {
      book_.endpoint_seen(endpoint_info(event.info, true));
    }
  }
  void on_subscriber_discovery(dds::DomainParticipant*,
                               rtps::ReaderDiscoveryInfo&& event) override {
    if (event.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
      book_.endpoint_gone(to_guid(event.info.guid()));
    } else {
      book_.endpoint_seen(endpoint_info(event.info, false));
    }
  }

 private:
  DiscoveryBook& book_;
  SignedPresence& presence_;
};

/// Hears that somebody has met us; on a thread of the library.
class Participant::Greeted : public dds::DataReaderListener, private PayloadSink {
 public:
  explicit Greeted(SignedPresence& presence) : presence_(presence) {}

  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(static_cast<PayloadSink*>(this), &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const Guid writer = to_guid(rtps::iHandle2GUID(info.publication_handle));
      presence_.met(DiscoveryBook::prefix_of(writer), MonotonicClock::read(CLOCK_MONOTONIC));
    }
  }

 private:
  void take(std::span<const std::uint8_t>) override {}

  SignedPresence& presence_;
};

Participant::Participant(const ParticipantOptions& options, const MonotonicClock& clock)
    : book_(options.host, [clock] { return clock.now(); }),
      presence_(std::make_shared<SignedPresence>()),
      listener_(std::make_unique<Listener>(book_, *presence_)),
      greeted_(std::make_unique<Greeted>(*presence_)),
      identity_(options.identity) {}

Result<std::unique_ptr<Participant>> Participant::create(const ParticipantOptions& options,
                                                         const MonotonicClock& clock) {
  // The library ends the process when the ports of a domain would not fit.
  if (options.domain > 232)
    return Error{"a DDS domain is 0..232, found " + std::to_string(options.domain)};
  isolate_library();
  std::unique_ptr<Participant> self(new Participant(options, clock));
  const auto open = std::make_shared<std::atomic<bool>>(false);
  GuardOptions guard;
  guard.refused = [book = &self->book_](const std::string& address) {
    book->message_refused(address);
  };
  guard.open = open;
  guard.presence = self->presence_;
  const auto qos = participant_qos(options, std::move(guard));
  if (!qos) return Error{qos.error()};
  auto* factory = dds::DomainParticipantFactory::get_instance();
  self->participant_ = factory->create_participant(options.domain, *qos, self->listener_.get(),
                                                   dds::StatusMask::none());
  if (self->participant_ == nullptr) {
    return Error{"no participant '" + options.name + "' in DDS domain " +
                 std::to_string(options.domain) +
                 (options.identity.empty()
                      ? " (it needs a network interface and free UDP ports)"
                      : " with the identity " + options.identity +
                            " (it needs a network interface, free UDP ports, and keys that are "
                            "valid in this domain)")};
  }
  self->guid_ = to_guid(self->participant_->guid());
  const auto prefix = DiscoveryBook::prefix_of(self->guid_);
  self->presence_->call_us(prefix);
  self->lease_check_.emplace(prefix, self->presence_);
  open->store(true);
  self->book_.participant_seen(self->guid_, Identity{options.name, options.host, USHER_IDL_DIGEST});
  self->publisher_ = self->participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  self->subscriber_ = self->participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (!options.identity.empty()) {
    if (const Status status = self->greet_regularly(); !status) return Error{status.error()};
  }
  warn_of_small_socket_buffers(options.domain, kSocketBuffer);
  return self;
}

Status Participant::make_greeting() {
  if (greeting_ != nullptr) delete_writer(greeting_);
  if (heard_greetings_ != nullptr) delete_reader(heard_greetings_);
  greeting_ = nullptr;
  heard_greetings_ = nullptr;
  greeted_at_ = made_ + 2;
  const auto writer = create_writer(kAliveTopic, kAliveTopic, {}, nullptr, {.best_effort = true});
  if (!writer) return Error{writer.error()};
  greeting_ = *writer;
  const auto reader = create_reader(kAliveTopic, kAliveTopic, {.reliable = false}, greeted_.get());
  if (!reader) return Error{reader.error()};
  heard_greetings_ = *reader;
  return {};
}

Status Participant::greet_regularly() {
  if (auto status = make_greeting(); !status) return status;
  alive_ = std::jthread([this](const std::stop_token& stop) {
    constexpr std::array<std::uint8_t, 4> kNothing{0, 1, 0, 0};
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      if (made_ != greeted_at_) static_cast<void>(make_greeting());
      std::span<const std::uint8_t> payload(kNothing);
      if (greeting_ != nullptr) greeting_->write(&payload);
      stopped.wait_for(lock, stop, SignedPresence::kAliveEvery, [] { return false; });
    }
  });
  return {};
}

Participant::~Participant() {
  if (participant_ == nullptr) return;
  alive_ = {};
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

Result<dds::Topic*> Participant::topic(const std::string& name, const std::string& type) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = topics_.find(name); found != topics_.end()) {
    if (found->second->get_type_name() == type) return found->second;
    return Error{"topic " + name + " is used here with type " + found->second->get_type_name() +
                 ", not " + type};
  }
  if (participant_->find_type(type).empty()) {
    participant_->register_type(dds::TypeSupport(new BytesType(type)), type);
  }
  dds::Topic* created = participant_->create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
  if (created == nullptr) return Error{"topic " + name + " of type " + type + " could not be made"};
  return topics_.emplace(name, created).first->second;
}

Error Participant::refusal(const std::string& what, const std::string& topic_name) const {
  if (identity_.empty()) return Error{"cannot " + what + " " + topic_name};
  return Error{"no permission to " + what + " " + topic_name + " (" + identity_ +
               "/permissions.smime)"};
}

Result<dds::DataWriter*> Participant::create_writer(const std::string& topic_name,
                                                    const std::string& type, const Qos& qos,
                                                    dds::DataWriterListener* listener,
                                                    const ForeignQuality& foreign) {
  const auto made = topic(topic_name, type);
  if (!made) return Error{made.error()};
  dds::DataWriterQos writer;
  writer.reliability().kind =
      foreign.best_effort ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
  if (foreign.exclusive) {
    writer.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
    writer.ownership_strength().value = foreign.strength;
  }
  writer.durability().kind =
      qos.latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  writer.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  writer.history().depth = qos.depth;
  writer.resource_limits().allocated_samples = 4;
  writer.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  writer.data_sharing().off();
  // A sample that the network lost is noticed by the next one or by the next heartbeat; 3 s would
  // be too late.
  writer.reliable_writer_qos().times.heartbeatPeriod = milliseconds(100);
  writer.reliable_writer_qos().times.nackResponseDelay = milliseconds(1);
  dds::DataWriter* created = publisher_->create_datawriter(*made, writer, listener);
  if (created == nullptr) return refusal("write", topic_name);
  ++made_;
  return created;
}

Result<dds::DataReader*> Participant::create_reader(const std::string& topic_name,
                                                    const std::string& type, const Qos& qos,
                                                    dds::DataReaderListener* listener) {
  const auto made = topic(topic_name, type);
  if (!made) return Error{made.error()};
  dds::DataReaderQos reader;
  reader.reliability().kind =
      qos.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  reader.durability().kind =
      qos.latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  reader.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  reader.history().depth = std::max(qos.depth, kReaderHistory);
  reader.resource_limits().allocated_samples = 4;
  reader.data_sharing().off();
  reader.reliable_reader_qos().times.heartbeatResponseDelay = milliseconds(1);
  reader.reliable_reader_qos().times.initialAcknackDelay = milliseconds(10);
  dds::DataReader* created = subscriber_->create_datareader(*made, reader, listener);
  if (created == nullptr) return refusal("read", topic_name);
  ++made_;
  return created;
}

void Participant::delete_writer(dds::DataWriter* writer) { publisher_->delete_datawriter(writer); }
void Participant::delete_reader(dds::DataReader* reader) { subscriber_->delete_datareader(reader); }

}  // namespace usher::runtime
