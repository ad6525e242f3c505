#include "drivers/sensor_board/device_real/component.hpp"

namespace usher::sensor_board {

namespace {
constexpr auto kTick = std::chrono::milliseconds(20);
}

SensorBoardComponent::SensorBoardComponent(runtime::Host& host)
    : host_(host),
      publisher_(host, [this](double tilt) { link_.set_tilt(tilt); }),
      lost_(host.health().counter("messages: lost")),
      damaged_(host.health().counter("frames: damaged")) {
  const std::string line =
      host.parameters().text("address", "serial:///dev/ttyACM0?baud=115200", "The board's line.");
  stream_ = &host.open_stream(
      line, {.on_open = [this] { link_.opened(now()); },
             .on_bytes =
                 [this](std::span<const std::uint8_t> bytes) {
                   link_.received(bytes, now(),
                                  [this](const Reading& reading) { publisher_.publish(reading); });
                 },
             .on_close =
                 [this](const std::string& reason) {
                   link_.closed();
                   host_.health().set(runtime::HealthState::kDegraded, reason);
                 }});
  timer_ = host.timer("tick", kTick, [this](auto) { tick(); });
}

void SensorBoardComponent::tick() {
  link_.tick(now());
  const auto output = link_.take_output();
  if (!output.empty()) stream_->write(output);
  lost_ = link_.dialogue().lost_messages();
  damaged_ = link_.dialogue().damaged();
  const std::string reason = link_.reason(now());
  host_.health().set(reason.empty() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
                     reason);
}

}  // namespace usher::sensor_board
