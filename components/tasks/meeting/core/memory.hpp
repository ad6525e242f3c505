#pragma once

#include <string>
#include <string_view>

#include "foundation/result/result.hpp"
#include "tasks/meeting/core/meeting.hpp"

namespace usher::meeting {

/// What an assistant that is restarted must know of the mission that ended with it: id, client,
/// room and how many were brought. One line for each.
std::string to_text(const Report& report);
/// The inverse. Refuses anything else with the line and what was expected there.
Result<Report> report_from_text(std::string_view text);

}  // namespace usher::meeting
