#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "operations/experiments/commanded_robot.hpp"
#include "usher_msgs.h"

namespace usher::operations {

/// An operator who sends the robot to one location: has the supervisor start the navigation, tells
/// the navigator the goal, and waits for its word. Knows no transport and no clock: what to send
/// goes through functions, answers come through take().
class Errand {
 public:
  struct Ways {
    std::function<void(const usher_msgs::msg::SupervisorRequest&)> ask;
    std::function<void(const usher_msgs::msg::NavigateGoal&)> tell;
  };
  /// Refused requests are asked anew so many steps, then it has failed.
  static constexpr int kPatience = 150;
  static constexpr const char* kClient = "operator";

  /// Ids count up from `first_id`; leave 1000 for each errand of a robot.
  Errand(std::string location, std::uint64_t first_id, Ways ways);

  void take(const usher_msgs::msg::SupervisorStatus& status);
  void take(const usher_msgs::msg::NavigateStatus& status);
  /// Sends what is not answered yet; five times a second.
  void step();

  bool over() const { return stage_ == Stage::kSucceeded || stage_ == Stage::kFailed; }
  bool succeeded() const { return stage_ == Stage::kSucceeded; }
  /// Why it failed, or what it waits for.
  const std::string& reason() const { return reason_; }

 private:
  enum class Stage { kStart, kGo, kGoal, kDriving, kSucceeded, kFailed };
  void fail(const std::string& reason);

  std::string location_;
  Ways ways_;
  Stage stage_ = Stage::kStart;
  std::uint64_t id_;  ///< of the request or goal that waits for its answer
  int steps_ = 0;     ///< in this stage
  std::string reason_;
};

/// What became of an errand that ended or ran out of time [s].
Arrival arrival(const Errand& errand, double longest);

}  // namespace usher::operations
