#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "navigation/navigator/core/navigator.hpp"

namespace usher::navigator {

using geometry::Pose2;

inline Locations site() {
  return *Locations::create(
      {{"lab", "Lab", {8.0, 0.0, 0.0}}, {"kitchen", "Kitchen", {0.0, 5.0, 0.0}}});
}

/// A navigator between a planner and a follower that do as the test says, at 10 Hz.
struct Rig {
  Navigator navigator;
  Situation s;
  std::vector<PlanRequest> plans;  // distinct ones
  std::vector<Motion> motions;     // distinct ones
  std::vector<NavigationStatus> asides;
  int costmap_clears = 0;
  int plan_messages = 0;
  bool follower_hears = true;
  std::function<void(Rig&, const PlanRequest&)> answer = straight_path;
  std::function<void(Rig&)> drive = [](Rig&) {};

  explicit Rig(const NavigatorConfig& config = {})
      : navigator(std::move(Navigator::create(config, site())).value()) {
    s.localization = Localization::kGood;
    s.pose = Pose2{};
  }

  static void straight_path(Rig& rig, const PlanRequest& request) {
    PlanReply reply{request.id, "", {}};
    const int pieces =
        std::max(1, static_cast<int>(geometry::distance(request.start, request.goal) / 0.05));
    for (int i = 0; i <= pieces; ++i)
      reply.path.push_back(
          geometry::interpolate(request.start, request.goal, static_cast<double>(i) / pieces));
    reply.path.back().yaw = request.goal.yaw;
    rig.navigator.plan_reply(reply);
  }
  static void no_path(Rig& rig, const PlanRequest& request) {
    rig.navigator.plan_reply({request.id, "no path joins start and goal", {}});
  }
  static void silence(Rig&, const PlanRequest&) {}

  /// The follower drives along +x at 0.5 m/s when it has a path.
  static void drive_on(Rig& rig) {
    if (rig.navigator.motion().mode != MotionMode::kFollow) {
      rig.s.velocity = {};
      return;
    }
    const double left = rig.navigator.path().back().x - rig.s.pose->x;
    const double step = std::min(0.05, left);
    rig.s.pose->x += step;
    rig.s.velocity.v = step * 10.0;
    rig.s.follow.state = left > 1e-9 ? GoalState::kActive : GoalState::kSucceeded;
  }
  /// The follower stands before an obstacle; recovery motions succeed at once.
  static void stand_blocked(Rig& rig) {
    rig.s.velocity = {};
    rig.s.follow.reason = "an obstacle 0.4 m ahead";
    rig.s.follow.state = rig.navigator.motion().mode == MotionMode::kFollow ? GoalState::kWaiting
                                                                            : GoalState::kSucceeded;
  }

  Decision step() {
    s.time += 0.1;
    drive(*this);
    Decision decision = navigator.step(s);
    if (decision.motion) {
      if (motions.empty() || motions.back().id != decision.motion->id)
        motions.push_back(*decision.motion);
      if (follower_hears && s.follow.id != decision.motion->id) {
        s.follow = {.id = decision.motion->id,
                    .state = decision.motion->mode == MotionMode::kFollow ? GoalState::kActive
                                                                          : GoalState::kIdle,
                    .reason = "",
                    .obstacle_distance = s.follow.obstacle_distance};
      }
    }
    if (decision.plan) {
      ++plan_messages;
      if (plans.empty() || plans.back().id != decision.plan->id) {
        plans.push_back(*decision.plan);
        answer(*this, plans.back());
      }
    }
    costmap_clears += decision.clear_costmap ? 1 : 0;
    asides.insert(asides.end(), decision.asides.begin(), decision.asides.end());
    return decision;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 10.0)); ++i) step();
  }
  /// Steps until the goal has an outcome; returns how long that took, or NaN.
  double run_to_end(double at_most) {
    const double begin = s.time;
    while (s.time - begin < at_most) {
      step();
      if (status().state != GoalState::kActive && status().state != GoalState::kWaiting)
        return s.time - begin;
    }
    return std::nan("");
  }
  void go(double x = 8.0, std::uint64_t id = 1) {
    navigator.request({id, "test", "", {x, 0.0, 0.0}, 0.0});
  }
  void go_to(const std::string& location, std::uint64_t id = 1) {
    navigator.request({id, "test", location, {}, 0.0});
  }
  const NavigationStatus& status() const { return navigator.status(); }
};

}  // namespace usher::navigator
