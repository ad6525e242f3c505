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
  EXPECT_FALSE(waits_safely_for({"guide_active", true, well()}));
  EXPECT_FALSE(waits_safely_for({"location_ask", true, well()}));
  EXPECT_FALSE(waits_safely_for({"inactive", true, std::nullopt}));
}

TEST(VisitEnd, WaitsForWhoStoppedItOrForAnAnswer) {
  EXPECT_TRUE(waits_safely_for({"guide_paused", true, well()}));
  EXPECT_TRUE(waits_safely_for({"guide_error", true, well()}));
  auto held = well();
  held.stopped_by({"guide"});
  EXPECT_FALSE(waits_safely_for({"guide_active", true, held})) << "its own stop";
  held.stopped_by({"guide", "operator"});
  EXPECT_TRUE(waits_safely_for({"guide_active", true, held}));
  held = well();
  held.granted(false);
  EXPECT_TRUE(waits_safely_for({"guide_active", true, held}));
  held = well();
  held.state(state::STATE_FAULT);
  EXPECT_TRUE(waits_safely_for({"guide_active", true, held}));
}

TEST(VisitEnd, NobodyWaitsSafelyWhileItMoves) {
  EXPECT_FALSE(waits_safely_for({"guide_paused", false, well()}));
}

}  // namespace
}  // namespace usher::operations
