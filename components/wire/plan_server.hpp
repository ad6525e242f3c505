#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

struct PlannedPath {
  std::vector<geometry::Pose2> poses;  ///< in map, from the start to the goal
  double length = 0.0;                 ///< [m]
};

/// The answering side of plan/request, for whatever plans. Replies to each request; one that its
/// client repeats gets the reply that it had. Publishes each path for who looks on, too, and counts
/// plans and failures.
class PlanServer {
 public:
  /// Start and goal are finite and in map. The error says why there is no path.
  using Planner =
      std::function<Result<PlannedPath>(const geometry::Pose2& start, const geometry::Pose2& goal)>;

  /// Declares the ports and counters of a planner.
  PlanServer(runtime::Host& host, Planner planner);
  PlanServer(const PlanServer&) = delete;
  PlanServer& operator=(const PlanServer&) = delete;

 private:
  void answer(const usher_msgs::msg::PlanRequest& request);
  Result<PlannedPath> plan(const usher_msgs::msg::PlanRequest& request) const;

  runtime::Host& host_;
  Planner planner_;
  usher_msgs::msg::PlanReply last_reply_;
  std::string last_client_;  ///< who was given it
  std::uint64_t& plans_;
  std::uint64_t& failures_;
  runtime::Input<usher_msgs::msg::PlanRequest> request_;
  runtime::Output<usher_msgs::msg::PlanReply> reply_;
  runtime::Output<nav_msgs::msg::Path> view_;
};

}  // namespace usher::wire
