#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/launcher/launcher.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// MARVIN as real processes, with the base's real driver and guard in front of an emulated base
/// (deploy/marvin-emulated.yaml), driven by an operator's gamepad; and a judge who sees what
/// reaches the wheels. For experiments that break it.
class AttackedRobot {
 public:
  using Clock = std::chrono::steady_clock;
  using Instant = Clock::time_point;

  /// A command as it reached the wheels.
  struct Wheels {
    Instant at;
    double v = 0.0, w = 0.0;
    bool off = false;  ///< an emergency stop
    /// Told to stand; a turn rate may still keep it on its arc while it rolls out.
    bool zero() const { return v == 0.0; }
    /// Told neither to drive nor to turn.
    bool still() const { return v == 0.0 && w == 0.0; }
  };
  struct Motion {
    Instant at;
    geometry::Pose2 pose;
    double v = 0.0, w = 0.0;
    std::uint32_t contacts = 0;
  };

  static Result<std::unique_ptr<AttackedRobot>> launch(const Installation& installation,
                                                       const std::string& run_directory,
                                                       std::uint32_t domain);
  ~AttackedRobot();

  /// What the operator's hand does from now on: holds the button and the sticks, or lets go.
  void hold(double v, double w);
  void release();
  /// Has it search by turning on the spot where it seeks visitors, or face nobody and stand there,
  /// from now on. Until the first call the robot decides.
  void let_it_search(bool search);
  /// Puts a finger on a button of the tablet, if it is drawn; returns at once.
  Status touch(const std::string& button);
  /// Sends it to a place while the supervisor lets the navigation drive; true once it drives.
  bool set_out(const std::string& place, std::chrono::milliseconds patience);
  void call_off();
  /// Asks the supervisor until it agrees.
  bool ask(std::uint8_t command, std::chrono::milliseconds patience);

  /// Waits for a condition that is asked every millisecond or two.
  template <class Condition>
  bool wait_for(Condition condition, std::chrono::milliseconds limit) {
    const Instant until = Clock::now() + limit;
    std::unique_lock lock(mutex_);
    while (!condition()) {
      if (Clock::now() >= until) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(2));
    }
    return true;
  }

  // To be asked inside of wait_for(), or between locked() ... calls.
  bool all_well() const;  ///< every component is ok, the robot may drive
  bool drives(double v) const { return !motions_.empty() && motions_.back().v > v; }
  bool stands() const;  ///< for a tenth of a second
  /// Likewise, and its wheels were told neither to drive nor to turn for two tenths: what rolls out
  /// of an earlier drive is nobody else's.
  bool stays() const;
  /// How it moves, and what its wheels were told last. Locks by itself.
  std::string motion_story();
  const std::vector<Wheels>& wheels() const { return wheels_; }
  const std::vector<Motion>& motions() const { return motions_; }
  const std::optional<usher_msgs::msg::SupervisorStatus>& status() const { return status_; }
  Instant status_at() const { return status_at_; }
  /// How much what is counted (see count()) has grown since forget(), by a heartbeat that was
  /// written while the robot had the right to drive: by the robot's own stamps, however late they
  /// were heard here.
  std::uint64_t counted_with_the_right() const;
  std::optional<runtime::Guid> life_of(const std::string& component) const;
  std::uint64_t grants_lost() const { return grants_lost_; }
  std::unique_lock<std::mutex> locked() { return std::unique_lock(mutex_); }
  /// Forgets what the judge noted so far.
  void forget();
  /// From now on adds up what this component counts under these names in its heartbeats; false when
  /// none is heard.
  bool count(const std::string& component, std::vector<std::string> names);

  /// Process of a component; 0 when it does not run.
  pid_t process(const std::string& component);
  runtime::Observer& observer() { return *observer_; }
  std::uint32_t domain() const { return domain_; }
  std::string complaints();
  std::vector<std::string> components(const std::string& criticality) const;

 private:
  /// What a component had counted when it wrote a heartbeat.
  struct Count {
    runtime::Time at;
    std::uint64_t number = 0;
  };

  AttackedRobot(Launcher launcher, Deployment deployment, std::uint32_t domain);
  Status listen();
  void note_count(const usher_msgs::msg::Heartbeat& heartbeat);
  void note_grant(const usher_msgs::msg::DriveGrant& grant, const runtime::Guid& writer);
  void note_withdrawn(runtime::Time at);
  void run();
  void send_joy();
  void send_target();

  Launcher launcher_;
  const Deployment deployment_;
  const std::uint32_t domain_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Wheels> wheels_;
  std::vector<Motion> motions_;
  std::optional<usher_msgs::msg::SupervisorStatus> status_;
  Instant status_at_{};
  std::optional<runtime::Time> granted_until_;  ///< the end of the newest grant's life
  std::optional<runtime::Time> withdrawn_;  ///< when the right to drive ended first, since forget()
  std::string counted_component_;
  std::vector<std::string> counted_names_;
  std::vector<Count> counts_;  ///< the first is the last one before forget()
  std::map<std::string, runtime::Guid> lives_;
  std::map<std::string, Instant> heard_;
  bool granted_ = false;
  std::uint64_t grants_lost_ = 0;
  std::uint64_t screen_ = 0;  ///< that the tablet shows
  bool held_ = false;
  float forward_ = 0.0F, turn_ = 0.0F;
  std::optional<std::uint8_t> facing_;  ///< mode of interaction/target
  std::vector<std::string> events_;

  std::unique_ptr<runtime::Observer> observer_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::BaseCommand>> wheels_reader_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truth_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::SupervisorStatus>> status_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::DriveGrant>> grant_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::Heartbeat>> heartbeat_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::DialogueScreen>> screen_reader_;
  std::optional<runtime::Observer::Writer<sensor_msgs::msg::Joy>> joy_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::FaceTarget>> target_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::SupervisorRequest>> request_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::NavigateGoal>> goal_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::GoalCancel>> cancel_;
  std::uint64_t goal_id_ = 0;
  int finger_ = -1;  ///< the line to the tablet; under the mutex
  std::atomic<bool> ends_{false};
  std::thread hand_;  ///< launches, and moves the sticks
};

}  // namespace usher::operations
