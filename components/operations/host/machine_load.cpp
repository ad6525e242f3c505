#include "operations/host/machine_load.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>

namespace usher::operations {

MachineLoad::MachineLoad()
    : MachineLoad(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

void MachineLoad::sample() {
  // "0.20 0.18 0.12 3/411 29733": the fourth says how many run or wait right now, this one too.
  std::ifstream file("/proc/loadavg");
  double minute = 0.0, five = 0.0, fifteen = 0.0;
  int running = 0;
  if (file >> minute >> five >> fifteen >> running) sample(std::max(0, running - 1));
}

void MachineLoad::sample(double load) {
  sum_ += load;
  ++samples_;
}

void MachineLoad::stopped(const std::string& reason) {
  ++stops_;
  last_stop_ = reason;
}

std::string MachineLoad::verdict() const {
  if (!too_busy()) return {};
  char load[64];
  std::snprintf(load, sizeof(load), "%.0f tasks for %d core%s", mean(), cores_,
                cores_ == 1 ? "" : "s");
  std::string text = "this machine is too busy for the demo: " + std::string(load);
  if (stops_ > 0) {
    text += "; the robot was stopped " + std::to_string(stops_) +
            (stops_ == 1 ? " time" : " times") + ", last by: " + last_stop_;
  }
  return text + "; run it again when less is running";
}

}  // namespace usher::operations
