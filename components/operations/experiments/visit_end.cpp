#include "operations/experiments/visit_end.hpp"

#include <algorithm>

namespace usher::operations {

namespace {

bool holds(const usher_msgs::msg::SupervisorStatus& status) {
  using namespace usher_msgs::msg::SupervisorStatus_Constants;
  const bool stopped = std::ranges::any_of(status.stopped_by(),
                                           [](const auto& client) { return client != "guide"; });
  return stopped || !status.granted() || status.state() == STATE_FAULT ||
         status.state() == STATE_MANUAL || status.state() == STATE_INACTIVE;
}

}  // namespace

std::optional<std::string> waits_safely_for(const OpenVisit& visit) {
  if (!visit.stands) return std::nullopt;
  if (visit.supervisor && holds(*visit.supervisor)) return "the supervisor";
  return std::nullopt;
}

}  // namespace usher::operations
