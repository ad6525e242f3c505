#include "operations/experiments/visit_end.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

namespace state = usher_msgs::msg::SupervisorStatus_Constants;

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

}  // namespace
}  // namespace usher::operations
