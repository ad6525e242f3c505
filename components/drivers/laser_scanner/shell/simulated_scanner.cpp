#include "drivers/laser_scanner/shell/simulated_scanner.hpp"

#include "wire/conversions.hpp"

namespace usher::laser_scanner {

SimulatedScanner::SimulatedScanner(runtime::Host& host, const Model& model)
    : host_(host), publisher_(host, model) {
  input_ = host.input(
      topics::kSimScan, {.max_age = model.silence, .on_loss = "publishes no scans and says so"},
      [this](const auto& message, const auto&) { take(message); },
      [this] { host_.health().set(runtime::HealthState::kDegraded, "the scanner is silent"); });
}

void SimulatedScanner::take(const sensor_msgs::msg::LaserScan& message) {
  scan_.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  scan_.angle_min = message.angle_min();
  scan_.angle_increment = message.angle_increment();
  scan_.scan_time = message.scan_time();
  scan_.time_increment = message.time_increment();
  scan_.ranges = message.ranges();
  publisher_.publish(scan_);
  const bool repeats = publisher_.repeats();
  host_.health().set(repeats ? runtime::HealthState::kDegraded : runtime::HealthState::kOk,
                     repeats ? ScanPublisher::kRepeats : "");
}

}  // namespace usher::laser_scanner
