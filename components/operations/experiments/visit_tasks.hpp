#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace usher::operations {

/// A task of the thesis' usability study (appendix B) as the states of the dialogue that show it;
/// the robot leads in between.
struct VisitTask {
  const char* text;
  std::vector<std::string> states;
};
std::span<const VisitTask> visit_tasks();

/// When each task was done that was done, one after the other: the times of the states that ended
/// them. `states` are those that the dialogue came to, in order, with their times [s].
std::vector<double> tasks_done(std::span<const std::pair<double, std::string>> states);

/// A statement of the questionnaire and what the thesis' 18 participants said (table 7.1): 1
/// strongly disagree .. 5 strongly agree.
struct Statement {
  const char* text;
  double mean, deviation;
};
std::span<const Statement> table_7_1();

}  // namespace usher::operations
