#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/base_obedience/core/base_obedience.hpp"

namespace usher::supervisor {

using drive::Time;
using drive::WriterId;

/// What the loss of a component means. The numbers are those on the wire; the zero is the safe one.
enum class Criticality : std::uint8_t {
  kStop = 0,     ///< nobody may drive without it
  kDegrade = 1,  ///< the robot goes on, slower
  kNotify = 2,   ///< the robot goes on and says so
};

/// What a component says of itself.
enum class Reported : std::uint8_t { kStarting = 0, kOk = 1, kDegraded = 2, kFault = 3 };

/// What the supervisor thinks of it.
enum class Health : std::uint8_t {
  kMissing = 0,  ///< never heard, still starting, or silent for longer than its time-out
  kOk = 1,
  kDegraded = 2,  ///< works with less
  kFault = 3,     ///< says that it failed, or two participants speak in its name
  kWrongIdl = 4,  ///< built from another wire contract: its messages cannot be trusted
};

/// One line of the manifest.
struct WatchedComponent {
  std::string name;
  Criticality criticality = Criticality::kStop;
  Time timeout = std::chrono::milliseconds(100);  ///< {> 0} silence that counts as its loss
};

struct Heartbeat {
  std::string_view component;  ///< name in the manifest
  WriterId writer{};           ///< of the heartbeat, from the middleware
  std::uint64_t idl_digest = 0;
  Reported state = Reported::kStarting;
  std::string_view reason;  ///< empty when it is well
  std::string_view host;    ///< where it runs, self-declared
  Time longest_handler{};   ///< {>= 0} since its last heartbeat
};

struct ComponentHealth {
  std::string name;
  Criticality criticality = Criticality::kStop;
  Health health = Health::kMissing;
  std::optional<Time> heard_at;  ///< nothing: never
  std::string reason;            ///< empty when it is well
  std::string host;              ///< where it runs; empty: never heard
  Time longest_handler{};        ///< in its last heartbeat
  std::uint32_t restarts = 0;    ///< how often it came back as another process

  /// Whether its work gets done, though perhaps with less.
  bool able() const { return health == Health::kOk || health == Health::kDegraded; }
};

/// Who lives, and how well: the heartbeats of the manifest's components against their time-outs.
class HeartbeatTable {
 public:
  HeartbeatTable(std::vector<WatchedComponent> components, std::uint64_t idl_digest);

  /// A heartbeat arrived at `now`. False when the manifest does not know the component.
  bool hear(const Heartbeat& heartbeat, Time now);

  /// Brings every health up to `now`. Allocates only where a health changes.
  void judge(Time now);

  /// In the manifest's order; as of the last judge().
  const std::vector<ComponentHealth>& components() const { return health_; }
  const ComponentHealth* find(std::string_view name) const;

  /// The first component of that criticality that is not able; null when all are.
  const ComponentHealth* first_lost(Criticality criticality) const;

  /// Whether something that matters for the speed is not well.
  bool degraded() const;

  Time timeout(std::string_view name) const;  ///< zero for an unknown component

 private:
  struct Record {
    Time timeout{};
    WriterId writer{};
    std::array<WriterId, 8> earlier_writers{};  ///< a ring
    std::size_t next_earlier = 0;
    std::optional<Time> conflict_at;  ///< when several writers were last heard in turn
    Reported reported = Reported::kStarting;
    std::uint64_t idl_digest = 0;
    std::string reason;
  };
  void set(ComponentHealth& entry, Health health, std::string_view reason);

  std::uint64_t idl_digest_;
  std::vector<Record> records_;
  std::vector<ComponentHealth> health_;
};

}  // namespace usher::supervisor
