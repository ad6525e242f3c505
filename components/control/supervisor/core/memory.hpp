#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "control/supervisor/core/fault_log.hpp"
#include "foundation/result/result.hpp"

namespace usher::supervisor {

/// What a supervisor must not forget when it is restarted: a lower epoch would be ignored by the
/// base, and a restart must not end what only an operator, or whoever asked for a stop, may end.
struct Memory {
  std::uint64_t epoch = 0;              ///< the highest that was ever granted
  std::vector<Fault> latched;           ///< active latched faults
  std::vector<std::string> stopped_by;  ///< clients that hold a stop; at most kMostStops
  bool manual = false;                  ///< an operator drives: nobody else may begin to

  bool operator==(const Memory&) const = default;
};

inline constexpr std::size_t kMostStops = 32;

/// One line for the epoch, one where an operator drives, one for each stop and fault; tabs between
/// the fields.
std::string to_text(const Memory& memory);

/// The inverse. Refuses anything else with the line and what was expected there.
Result<Memory> memory_from_text(std::span<const std::uint8_t> bytes);

}  // namespace usher::supervisor
