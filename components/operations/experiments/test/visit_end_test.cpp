#include "operations/experiments/visit_end.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace usher::operations {
namespace {

namespace state = usher_msgs::msg::SupervisorStatus_Constants;
namespace outcome = usher_msgs::msg::GuideVisit_Constants;

usher_msgs::msg::SupervisorStatus well() {
  usher_msgs::msg::SupervisorStatus status;
  status.state(state::STATE_NAVIGATION_ACTIVE);
  status.granted(true);
  return status;
}

TEST(VisitEnd, ARobotThatStandsForNoReasonIsADeadEnd) {
  EXPECT_FALSE(waits_safely_for({true, well()}));
  EXPECT_FALSE(waits_safely_for({true, std::nullopt}));
}

TEST(VisitEnd, WaitsForWhoStoppedIt) {
  auto held = well();
  held.stopped_by({"guide"});
  EXPECT_FALSE(waits_safely_for({true, held})) << "its own stop";
  held.stopped_by({"guide", "operator"});
  EXPECT_TRUE(waits_safely_for({true, held}));
  held = well();
  held.granted(false);
  EXPECT_TRUE(waits_safely_for({true, held}));
  held = well();
  held.state(state::STATE_FAULT);
  EXPECT_TRUE(waits_safely_for({true, held}));
}

TEST(VisitEnd, NobodyWaitsSafelyWhileItMoves) {
  auto held = well();
  held.stopped_by({"operator"});
  EXPECT_FALSE(waits_safely_for({false, held}));
}

TEST(VisitEnd, IsAsTheVisitorWishedOrAnArrival) {
  const auto as_wished = [](Wish wish, std::uint8_t end) {
    return ended_as_wished({wish, true, end});
  };
  for (const Wish wish : {Wish::kToArrive, Wish::kToLead, Wish::kToBreakOff, Wish::kToFallSilent}) {
    EXPECT_TRUE(as_wished(wish, outcome::OUTCOME_ARRIVED));
    EXPECT_FALSE(as_wished(wish, outcome::OUTCOME_ENDED)) << "said goodbye without a journey";
    EXPECT_FALSE(ended_as_wished({wish, false, outcome::OUTCOME_ARRIVED})) << "goes on";
  }
  EXPECT_FALSE(as_wished(Wish::kToArrive, outcome::OUTCOME_GIVEN_UP));
  EXPECT_FALSE(as_wished(Wish::kToArrive, outcome::OUTCOME_LEFT));
  EXPECT_FALSE(as_wished(Wish::kToLead, outcome::OUTCOME_GIVEN_UP)) << "the robot lost him";
  EXPECT_TRUE(as_wished(Wish::kToBreakOff, outcome::OUTCOME_GIVEN_UP));
  EXPECT_FALSE(as_wished(Wish::kToBreakOff, outcome::OUTCOME_LEFT)) << "there was no journey";
  EXPECT_TRUE(as_wished(Wish::kToFallSilent, outcome::OUTCOME_LEFT));
  EXPECT_FALSE(as_wished(Wish::kToFallSilent, outcome::OUTCOME_GIVEN_UP));
}

TEST(VisitEnd, NoRobotPassesWithWhichNobodyArrives) {
  const VisitEnd there{Wish::kToArrive, true, outcome::OUTCOME_ARRIVED};
  const VisitEnd off{Wish::kToBreakOff, true, outcome::OUTCOME_GIVEN_UP};
  std::vector<VisitEnd> visits(100, there);
  visits.resize(120, off);
  const auto passes = [&] {
    ResultSheet sheet;
    judge_ends(visits, sheet);
    return sheet.pass();
  };
  visits[0].outcome = outcome::OUTCOME_GIVEN_UP;
  EXPECT_TRUE(passes()) << "1 of 100";
  visits[1].outcome = outcome::OUTCOME_GIVEN_UP;
  EXPECT_FALSE(passes());
  visits[1] = there;
  visits[110].outcome = outcome::OUTCOME_LEFT;
  EXPECT_FALSE(passes()) << "who wanted to break off had no journey";
  visits.assign(100, {Wish::kToArrive, true, outcome::OUTCOME_LEFT});
  EXPECT_FALSE(passes());
  visits.assign(10, {Wish::kToLead, true, outcome::OUTCOME_ARRIVED});
  visits[0].outcome = outcome::OUTCOME_GIVEN_UP;
  EXPECT_TRUE(passes()) << "1 of 10 leaders lost";
  visits[1].outcome = outcome::OUTCOME_GIVEN_UP;
  EXPECT_FALSE(passes());
  visits.assign(20, off);
  EXPECT_TRUE(passes()) << "nobody wanted to arrive";
}

}  // namespace
}  // namespace usher::operations
