#pragma once

#include <string>

namespace usher::operations {

/// How busy this machine was during a run whose robot lives on it: components that wait for a
/// processor speak late, and a robot whose components speak late is stopped.
class MachineLoad {
 public:
  /// So many tasks for each core are more than a robot with a heartbeat limit of 0.12 s bears.
  static constexpr double kTooMuch = 3.0;

  /// `cores` at least 1.
  explicit MachineLoad(int cores) : cores_(cores) {}
  /// Of this machine.
  MachineLoad();

  /// Reads the load of this moment (Linux: tasks that run or wait, /proc/loadavg); call it about
  /// once a second.
  void sample();
  /// The same, given.
  void sample(double load);
  /// The robot lost its right to drive, and why.
  void stopped(const std::string& reason);

  double mean() const { return samples_ > 0 ? sum_ / samples_ : 0.0; }
  double per_core() const { return mean() / cores_; }
  int stops() const { return stops_; }
  bool too_busy() const { return per_core() > kTooMuch; }

  /// For an operator, after a run that failed: names the load and what it did; empty when the
  /// machine was not too busy.
  std::string verdict() const;

 private:
  int cores_;
  int samples_ = 0;
  double sum_ = 0.0;
  int stops_ = 0;
  std::string last_stop_;
};

}  // namespace usher::operations
