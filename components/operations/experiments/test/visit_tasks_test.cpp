#include "operations/experiments/visit_tasks.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

using States = std::vector<std::pair<double, std::string>>;

States study() {
  const std::vector<std::string> way{"initialise",    "inactive",      "introduction",
                                     "location_ask",  "location_show", "guide_ask",
                                     "guide_options", "guide_start",   "guide_active",
                                     "guide_success", "end_ask",       "location_ask",
                                     "guide_options", "guide_start",   "guide_active",
                                     "guide_success", "end_ask",       "end"};
  States states;
  for (const auto& state : way) states.emplace_back(static_cast<double>(states.size()), state);
  return states;
}

TEST(VisitTasks, AreDoneOneAfterTheOther) {
  EXPECT_EQ(tasks_done(study()), (std::vector<double>{3, 5, 7, 9, 13, 15, 17}));
}

TEST(VisitTasks, OneThatWasNotDoneEndsTheCount) {
  States states = study();
  std::erase_if(states, [](const auto& state) { return state.second == "location_show"; });
  EXPECT_EQ(tasks_done(states).size(), 1U);
  EXPECT_TRUE(tasks_done({}).empty());
}

TEST(VisitTasks, AFailedJourneyThatWasTriedAgainCounts) {
  States states = study();
  states.insert(
      states.begin() + 9,
      {{8.2, "guide_error"}, {8.3, "guide_options"}, {8.5, "guide_start"}, {8.6, "guide_active"}});
  EXPECT_EQ(tasks_done(states).size(), 7U);
}

TEST(VisitTasks, TheThesisHasThirteenStatements) { EXPECT_EQ(table_7_1().size(), 13U); }

}  // namespace
}  // namespace usher::operations
