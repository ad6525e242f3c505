#include "operations/experiments/visit_end.hpp"

#include <algorithm>

namespace usher::operations {

namespace {

constexpr double kLeastArrived = 0.99;  // of those who want to

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

bool ended_as_wished(const VisitEnd& visit) {
  using namespace usher_msgs::msg::GuideVisit_Constants;
  if (!visit.ended) return false;
  if (visit.outcome == OUTCOME_ARRIVED) return true;
  switch (visit.wish) {
    case Wish::kToArrive:
      return false;
    case Wish::kToBreakOff:
      return visit.outcome == OUTCOME_GIVEN_UP;
    case Wish::kToFallSilent:
      return visit.outcome == OUTCOME_LEFT;
  }
  return false;
}

void judge_ends(std::span<const VisitEnd> visits, ResultSheet& sheet) {
  double wanted = 0, arrived = 0, others = 0, otherwise = 0;
  for (const VisitEnd& visit : visits) {
    const bool as_wished = ended_as_wished(visit);
    if (visit.wish == Wish::kToArrive)
      ++wanted, arrived += as_wished ? 1 : 0;
    else
      ++others, otherwise += as_wished ? 0 : 1;
  }
  if (wanted > 0) {
    sheet.metrics["arrived_of_those_who_want_to"] = arrived / wanted;
    sheet.targets["arrived_of_those_who_want_to"] = {Bound::kAtLeast, kLeastArrived};
  }
  if (others > 0) {
    sheet.metrics["others_that_ended_otherwise"] = otherwise;
    sheet.targets["others_that_ended_otherwise"] = {Bound::kAtMost, 0.0};
  }
}

}  // namespace usher::operations
