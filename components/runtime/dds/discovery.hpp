#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/api/ports.hpp"
#include "runtime/api/time.hpp"

namespace usher::runtime {

/// What a participant says about itself in its USER_DATA; names as in the manifest. Identification,
/// not authentication.
struct Identity {
  std::string name;
  std::string host;              ///< empty = not one of ours
  std::uint64_t idl_digest = 0;  ///< 0 = not one of ours

  /// "usher;name=amcl;host=nuc;idl=00f1a2..."; names must not contain ';'.
  std::string user_data() const;
  /// Nothing when the text is not one of ours.
  static std::optional<Identity> parse(std::string_view user_data);
};

/// A participant of the domain that is alive.
struct ParticipantInfo {
  Guid guid{};          ///< 12 bytes of prefix, then the participant's entity
  Identity identity;    ///< of a foreign one only the name, as it announces it
  std::string address;  ///< where it says that it listens; empty = not known
  Time since{};
};

/// Somebody who was kept out.
struct Refusal {
  std::string name;     ///< that a participant without valid identity announces; empty = only
                        ///< messages were seen
  std::string address;  ///< IPv4
  std::uint64_t messages = 0;  ///< dropped: malformed or, with security, not signed by anybody of
                               ///< this robot
  Time since{};
};

/// "refused: intruder at 10.0.0.9 has no identity of this robot", for an operator.
std::string to_string(const Refusal& refusal);

/// A reader or writer of the domain that is alive.
struct EndpointInfo {
  Guid guid{};
  bool writer = false;
  std::string topic;  ///< on the wire: "rt/scan"
  std::string type;   ///< on the wire: "sensor_msgs::msg::dds_::LaserScan_"
  bool reliable = false;
  bool latched = false;  ///< transient local or stronger
  std::string participant, host;
  Time since{};
};

/// Who is in the domain, as discovery tells. Thread-safe. Observers are called one event at a time,
/// in order, on the thread that reported it, and may ask the book but not report to it.
class DiscoveryBook {
 public:
  using ParticipantEvent = std::function<void(const ParticipantInfo&, bool alive)>;
  using EndpointEvent = std::function<void(const EndpointInfo&, bool alive)>;

  /// `host`: where this process runs, as in the manifest.
  DiscoveryBook(std::string host, std::function<Time()> clock);

  void participant_seen(const Guid& guid, const Identity& identity, std::string address = {});
  /// With everything that it owned.
  void participant_gone(const Guid& guid);
  /// Reported once its participant is known too, with its name.
  void endpoint_seen(EndpointInfo endpoint);
  void endpoint_gone(const Guid& guid);
  /// A participant that could not prove who it is: no longer listed, but among the refusals.
  void participant_refused(const Guid& guid);
  /// A message from there was dropped.
  void message_refused(const std::string& address);

  /// First reports what is already there. A null event is left out.
  void observe(ParticipantEvent participant, EndpointEvent endpoint);

  std::vector<ParticipantInfo> participants() const;
  std::vector<EndpointInfo> endpoints() const;
  /// One for each name and address, at most kMaxRefusals; what comes after those is counted in the
  /// last one.
  std::vector<Refusal> refusals() const;
  static constexpr std::size_t kMaxRefusals = 64;
  static constexpr std::size_t kMaxNameless = 1024;
  /// A writer that has just been matched may not be in the book yet: then only its guid is known.
  WriterInfo writer(const Guid& guid) const;
  /// Whether the writer's stamps are on this host's clock: its participant names the same host. A
  /// participant that names none is judged by the host number in its guid (bytes 0 to 3), which
  /// `own` has too.
  bool same_host(const Guid& writer, const Guid& own) const;

  /// What all endpoints of a participant share.
  using Prefix = std::array<std::uint8_t, 12>;
  static Prefix prefix_of(const Guid& guid);

 private:
  void notify(const EndpointInfo& endpoint, bool alive) const;
  Refusal& refusal(const std::string& name, const std::string& address);

  const std::string host_;
  const std::function<Time()> clock_;
  std::mutex event_mutex_;  // one event at a time; taken before mutex_
  std::vector<ParticipantEvent> participant_events_;
  std::vector<EndpointEvent> endpoint_events_;
  mutable std::mutex mutex_;  // the maps; never held while somebody is called
  std::map<Prefix, ParticipantInfo> participants_;
  std::map<Guid, EndpointInfo> endpoints_;
  std::vector<EndpointInfo> nameless_;  ///< whose participants were not seen yet
  std::vector<Refusal> refusals_;
};

}  // namespace usher::runtime
