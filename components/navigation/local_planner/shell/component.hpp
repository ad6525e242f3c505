#pragma once

#include "navigation/local_planner/shell/follower.hpp"

namespace usher::local_planner {

/// Follows the path with the dynamic window, or trajectory rollout.
class LocalPlannerComponent final : public FollowerComponent {
 public:
  explicit LocalPlannerComponent(runtime::Host& host);

 private:
  LocalPlannerComponent(runtime::Host& host, const DynamicWindowConfig& config);
};

}  // namespace usher::local_planner
