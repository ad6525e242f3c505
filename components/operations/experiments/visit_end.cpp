#include "operations/experiments/visit_end.hpp"

#include <algorithm>

namespace usher::operations {

namespace {

constexpr double kLeastArrived = 0.99;
constexpr double kLeastLed = 0.9;  // a leader walks out of sight round a corner

struct Tally {
  double all = 0, as_wished = 0;
};

void ask_for_share(const Tally& tally, const char* name, double least, ResultSheet& sheet) {
  if (tally.all == 0) return;
  sheet.metrics[name] = tally.as_wished / tally.all;
  sheet.targets[name] = {Bound::kAtLeast, least};
}

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
    case Wish::kToLead:
      return false;
    case Wish::kToBreakOff:
      return visit.outcome == OUTCOME_GIVEN_UP;
    case Wish::kToFallSilent:
      return visit.outcome == OUTCOME_LEFT;
  }
  return false;
}

void judge_ends(std::span<const VisitEnd> visits, ResultSheet& sheet) {
  Tally guided, led, others;
  for (const VisitEnd& visit : visits) {
    Tally& tally = visit.wish == Wish::kToArrive ? guided
                   : visit.wish == Wish::kToLead ? led
                                                 : others;
    ++tally.all;
    tally.as_wished += ended_as_wished(visit) ? 1 : 0;
  }
  ask_for_share(guided, "arrived_of_those_who_are_guided", kLeastArrived, sheet);
  ask_for_share(led, "arrived_of_those_who_lead", kLeastLed, sheet);
  if (others.all == 0) return;
  sheet.metrics["others_that_ended_otherwise"] = others.all - others.as_wished;
  sheet.targets["others_that_ended_otherwise"] = {Bound::kAtMost, 0.0};
}

}  // namespace usher::operations
