#pragma once

#include "idl/topics.hpp"

namespace usher::test {

/// Calls `take(topic)` for what the robot decides by, beside what moves it, scan and tf.
template <class Take>
void each_topic_that_it_decides_by(Take&& take) {
  take(topics::kJoy);
  take(topics::kBaseStatus);
  take(topics::kOdom);
  take(topics::kTfStatic);
  take(topics::kScanFiltered);
  take(topics::kUltrasonic);
  take(topics::kUltrasonicFiltered);
  take(topics::kWhiskers);
  take(topics::kPeople);
  take(topics::kPersonAhead);
  take(topics::kMap);
  take(topics::kAmclPose);
  take(topics::kLocalizationStatus);
  take(topics::kLocalCosts);
  take(topics::kGlobalCosts);
  take(topics::kCostmapRequest);
  take(topics::kPlanRequest);
  take(topics::kPlanReply);
  take(topics::kFollowGoal);
  take(topics::kFollowCancel);
  take(topics::kFollowStatus);
  take(topics::kNavigateStatus);
  take(topics::kNavigatePace);
  take(topics::kMovementStatus);
  take(topics::kSupervisorStatus);
  take(topics::kLocations);
  take(topics::kKinectTilt);
  take(topics::kInteractionTarget);
  take(topics::kTorsoFrame);
  take(topics::kTorsoStatus);
  take(topics::kVisitor);
  take(topics::kGuideStatus);
  take(topics::kDialogueScreen);
}

}  // namespace usher::test
