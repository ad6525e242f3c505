#pragma once

// Private to this folder: includes Fast DDS.

#include <atomic>
#include <cstddef>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/dds/discovery.hpp"
#include "runtime/dds/host_clock.hpp"
#include "runtime/dds/lease_check.hpp"
#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

struct ParticipantOptions {
  std::string name;
  std::string host;
  std::uint32_t domain = 0;
  std::vector<std::string> peers;  ///< numeric IPv4 addresses besides multicast
  std::string discovery_server;    ///< "10.0.0.1:11811"; empty = everybody announces to everybody
  std::string identity;            ///< folder of `usher keys`; empty = without security
  bool serves_discovery = false;   ///< this one is the server, at that address
};

/// How a writer may differ from ours; only what attacks the robot in tests does.
struct ForeignQuality {
  bool best_effort = false;
  bool exclusive = false;  ///< exclusive ownership, with a strength
  std::uint32_t strength = 0;
};

/// A DomainParticipant with the settings that hold everywhere (README.md says why), its discovery
/// book, and topics and endpoints by wire name. Everything it made goes with it. Thread-safe.
class Participant {
 public:
  static Result<std::unique_ptr<Participant>> create(const ParticipantOptions& options,
                                                     const MonotonicClock& clock);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Listeners must outlive the participant or the endpoint. Writers are RELIABLE; both KEEP_LAST.
  /// Fails when this participant already has the topic with another type.
  Result<eprosima::fastdds::dds::DataWriter*> create_writer(
      const std::string& topic, const std::string& type, const Qos& qos,
      eprosima::fastdds::dds::DataWriterListener* listener, const ForeignQuality& foreign = {});
  Result<eprosima::fastdds::dds::DataReader*> create_reader(
      const std::string& topic, const std::string& type, const Qos& qos,
      eprosima::fastdds::dds::DataReaderListener* listener);
  void delete_writer(eprosima::fastdds::dds::DataWriter* writer);
  void delete_reader(eprosima::fastdds::dds::DataReader* reader);

  DiscoveryBook& book() { return book_; }
  Guid guid() const { return guid_; }

 private:
  class Listener;
  class Greeted;
  Participant(const ParticipantOptions& options, const MonotonicClock& clock);
  Result<eprosima::fastdds::dds::Topic*> topic(const std::string& name, const std::string& type);
  /// With keys: tells every participant that this one has met that it lives, in a thread of its own
  /// (SignedPresence). The endpoints for that are made anew when others were made after them:
  /// discovery keeps the order, so who hears of them has heard of all others.
  Status greet_regularly();
  Status make_greeting();
  Error refusal(const std::string& what, const std::string& topic_name) const;

  DiscoveryBook book_;
  std::shared_ptr<SignedPresence> presence_;
  std::unique_ptr<Listener> listener_;
  std::unique_ptr<Greeted> greeted_;
  std::string identity_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  Guid guid_{};
  std::optional<LeaseCheck> lease_check_;
  std::mutex mutex_;
  std::map<std::string, eprosima::fastdds::dds::Topic*> topics_;
  std::atomic<std::size_t> made_{0};  ///< endpoints
  std::size_t greeted_at_ = 0;        ///< `made_` then
  eprosima::fastdds::dds::DataWriter* greeting_ = nullptr;
  eprosima::fastdds::dds::DataReader* heard_greetings_ = nullptr;
  std::jthread alive_;
};

Guid to_guid(const eprosima::fastrtps::rtps::GUID_t& guid);

}  // namespace usher::runtime
