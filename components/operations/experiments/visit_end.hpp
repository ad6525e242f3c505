#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "idl/topics.hpp"
#include "operations/results/result_sheet.hpp"

namespace usher::operations {

/// How a visit stands that has not ended long after it should have.
struct OpenVisit {
  bool stands = false;                                          ///< the robot, for a while
  std::optional<usher_msgs::msg::SupervisorStatus> supervisor;  ///< its newest word
};

/// Who holds the robot that stands, other than the guide, whose questions all have a time-out.
/// Nothing: it is a dead end.
std::optional<std::string> waits_safely_for(const OpenVisit& visit);

/// What a visitor wants of a visit.
enum class Wish {
  kToArrive,
  kToLead,        ///< the robot, to where he says "done"
  kToBreakOff,    ///< on the way
  kToFallSilent,  ///< at a question
};

struct VisitEnd {
  Wish wish = Wish::kToArrive;
  bool ended = false;        ///< and the robot is free for the next one
  std::uint8_t outcome = 0;  ///< {GuideVisit_Constants OUTCOME_*}
};

/// Whether the visit ended in the way that the visitor chose; also where the robot arrived before
/// he could break off or fall silent.
bool ended_as_wished(const VisitEnd& visit);

/// The shares of those who want to arrive, and of those who want to lead, that did, and how many of
/// the others ended in another way than theirs, with what is asked of each. Nothing is asked about
/// those of whom there are none.
void judge_ends(std::span<const VisitEnd> visits, ResultSheet& sheet);

}  // namespace usher::operations
