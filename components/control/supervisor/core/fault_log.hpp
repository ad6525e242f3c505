#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/base_obedience/core/base_obedience.hpp"

namespace usher::supervisor {

using drive::Time;

enum class Cause : std::uint8_t {
  kComponentLost = 0,      ///< ends by itself when the component is back
  kBaseFallsShort = 1,     ///< ends by itself when the base follows again
  kForeignWriter = 2,      ///< latched
  kDisobeyingBase = 3,     ///< latched
  kEmergencyStop = 4,      ///< latched
  kBaseUnheard = 5,        ///< ends by itself when the base reports again
  kNotKept = 6,            ///< ends by itself when the memory is on the disk again
  kMovesWhileStopped = 7,  ///< latched
};

std::string_view text(Cause cause);

/// Whether only an operator ends it.
constexpr bool latches(Cause cause) {
  return (cause >= Cause::kForeignWriter && cause <= Cause::kEmergencyStop) ||
         cause == Cause::kMovesWhileStopped;
}

struct Fault {
  std::uint64_t id = 0;  ///< order of appearance, from 1
  Time at{};             ///< when it was noticed
  Cause cause = Cause::kComponentLost;
  std::string component;  ///< whom it concerns
  std::string detail;     ///< what happened, in words for an operator
  bool active = true;
  Time ended{};          ///< when it was over or cleared; zero while it is active
  std::string ended_by;  ///< the operator who cleared it; empty when it ended by itself

  bool latched() const { return latches(cause); }
  bool operator==(const Fault&) const = default;
};

/// The last faults, newest last. Active ones are never pushed out.
class FaultLog {
 public:
  static constexpr std::size_t kCapacity = 64;

  /// Notes a fault unless the same cause of the same component is active already.
  void raise(Cause cause, std::string_view component, std::string_view detail, Time now);
  /// An unlatched fault is over.
  void settle(Cause cause, std::string_view component, Time now);
  /// An operator ends all latched faults.
  void clear(std::string_view by, Time now);
  /// Faults of before a restart.
  void restore(std::vector<Fault> faults);

  /// The oldest active latched fault; null when there is none.
  const Fault* latched() const;
  bool active(Cause cause) const;
  const std::vector<Fault>& faults() const { return faults_; }

 private:
  std::uint64_t next_id_ = 1;
  std::vector<Fault> faults_;
};

}  // namespace usher::supervisor
