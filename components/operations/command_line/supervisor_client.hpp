#pragma once

#include <cstdint>
#include <string>

#include "foundation/result/result.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// Who an operator's commands say that they are.
inline constexpr const char* kOperatorName = "operator";

/// Ids that differ between two runs of this program.
std::uint64_t fresh_id();

/// Asks the supervisor (SupervisorRequest_Constants COMMAND_*) until it answers; the error says why
/// it did not do it. At most about 6 s.
Status tell_supervisor(runtime::Observer& observer, std::uint8_t command,
                       const std::string& goal = {});

}  // namespace usher::operations
