#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "deployment/running_robot.hpp"

namespace usher::test {

/// MARVIN as processes, with the base's real driver and guard in front of an emulated base, that
/// drives from place to place of the office by `usher goto` while a test attacks it; and a judge at
/// its wheels.
class DrivenRobot {
 public:
  using Clock = std::chrono::steady_clock;

  /// `more` are lines of the manifest's components.
  explicit DrivenRobot(const std::string& more = {});
  ~DrivenRobot();
  RunningRobot* operator->() { return robot_.get(); }

  /// Writes a request of the operator, once; its answer is in the status.
  void ask(std::uint8_t command);
  /// It has the right to drive, and every component works, be it degraded.
  bool may_drive() const;
  /// Waits until it may, clearing faults as an operator would.
  bool is_ready();
  /// A line for each fault that had to be cleared.
  const std::string& cleared() const { return cleared_; }
  /// Sends it there; it drives when this returns true.
  bool sets_out(const std::string& place);
  /// The errand's exit code, -1 when it does not end within `limit`.
  int errand(std::chrono::seconds limit) { return errand_->wait(limit); }
  std::string errand_story() const { return errand_->output() + errand_->errors(); }
  /// True while it has neither arrived nor failed.
  bool under_way() const;

  /// [m/s] in the world's truth.
  double speed() const;
  std::uint32_t contacts() const;
  /// A line for each contact: with what, where, at what speed.
  std::string contact_story() const;
  /// Forgets what the judge noted.
  void forget();
  /// The first command to stand that reached the wheels since `from`.
  std::optional<Clock::time_point> zero_since(Clock::time_point from) const;
  /// How long after the last living grant the wheels were told to go on, at the most [s].
  double longest_without_grant() const;
  /// The highest speeds that the wheels were told [m/s], [rad/s].
  double fastest() const;
  double fastest_turn() const;
  /// Why it may not drive, says the supervisor; empty when it may.
  std::string reason() const;

 private:
  void judge_wheels(double v, double w);
  /// Under the mutex.
  void note_contact(const usher_sim_msgs::msg::GroundTruth& truth);

  std::unique_ptr<RunningRobot> robot_;
  std::unique_ptr<Process> errand_;
  std::string cleared_;

  mutable std::mutex mutex_;
  double speed_ = 0.0;
  std::uint32_t contacts_ = 0;
  std::string contact_story_;
  Clock::time_point last_grant_{};
  std::vector<Clock::time_point> zeros_;
  double longest_without_grant_ = 0.0, fastest_ = 0.0, fastest_turn_ = 0.0;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::BaseCommand>> wheels_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truths_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::DriveGrant>> grants_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::SupervisorRequest>> requests_;
  std::uint64_t request_id_ = 0;
};

}  // namespace usher::test
