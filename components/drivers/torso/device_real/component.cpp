#include "drivers/torso/device_real/component.hpp"

namespace usher::torso {

TorsoComponent::TorsoComponent(runtime::Host& host)
    : host_(host),
      driver_(host),
      lost_(host.health().counter("messages: lost")),
      damaged_(host.health().counter("frames: damaged")),
      senseless_(host.health().counter("messages: rejected")) {
  const std::string line = host.parameters().text("address", "serial:///dev/ttyACM1?baud=115200",
                                                  "The line of the torso's board.");
  stream_ =
      &host.open_stream(line, {.on_open = [this] { link_.opened(now()); },
                               .on_bytes =
                                   [this](std::span<const std::uint8_t> bytes) {
                                     link_.received(bytes, now(), [this](const Reading& reading) {
                                       driver_.measured(reading, link_.reason(now()));
                                     });
                                   },
                               .on_close =
                                   [this](const std::string& reason) {
                                     link_.closed();
                                     driver_.lost(reason);
                                   }});
  timer_ = host.timer("tick", kTick, [this](auto) { tick(); });
}

void TorsoComponent::tick() {
  if (link_.healthy(now())) {
    if (const auto frame = driver_.step()) link_.show(*frame);
  } else {
    driver_.lost(link_.reason(now()));
  }
  link_.tick(now());
  const auto output = link_.take_output();
  if (!output.empty()) stream_->write(output);
  lost_ = link_.dialogue().lost_messages();
  damaged_ = link_.dialogue().damaged();
  senseless_ = link_.dialogue().rejected();
}

}  // namespace usher::torso
