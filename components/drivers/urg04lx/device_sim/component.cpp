#include "drivers/urg04lx/device_sim/component.hpp"

#include "wire/conversions.hpp"

namespace usher::urg04lx {

namespace {
constexpr auto kSilence = std::chrono::milliseconds(300);
}

Urg04lxSimComponent::Urg04lxSimComponent(runtime::Host& host) : host_(host), publisher_(host) {
  input_ = host.input(
      topics::kSimScan, {.max_age = kSilence, .on_loss = "publishes no scans and says so"},
      [this](const auto& message, const auto&) {
        scan_.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
        scan_.angle_min = message.angle_min();
        scan_.angle_increment = message.angle_increment();
        scan_.scan_time = message.scan_time();
        scan_.time_increment = message.time_increment();
        scan_.ranges = message.ranges();
        publisher_.publish(scan_);
        host_.health().set(runtime::HealthState::kOk);
      },
      [this] { host_.health().set(runtime::HealthState::kDegraded, "the scanner is silent"); });
}

}  // namespace usher::urg04lx
