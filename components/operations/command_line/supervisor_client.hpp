#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "foundation/result/result.hpp"
#include "idl/topics.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// Who an operator's commands say that they are.
inline constexpr const char* kOperatorName = "operator";

/// Ids that differ between two runs of this program.
std::uint64_t fresh_id();

/// Asks the supervisor (SupervisorRequest_Constants COMMAND_*) until it answers; the error says why
/// it did not do it: after about 8 s, and after `stop_patience` for a stop, which it says on
/// stderr.
Status tell_supervisor(runtime::Observer& observer, std::uint8_t command,
                       const std::string& goal = {},
                       std::chrono::seconds stop_patience = std::chrono::seconds(25));

/// The newest that a reader has of it, waited for if there is none yet; null after `patience`.
std::shared_ptr<const usher_msgs::msg::SupervisorStatus> newest_status(
    runtime::Observer::Reader<usher_msgs::msg::SupervisorStatus>& reader,
    std::chrono::milliseconds patience);

/// Who holds a stop: "operator, tablet"; empty when nobody does.
std::string stopped_by(const usher_msgs::msg::SupervisorStatus& status);

}  // namespace usher::operations
