#include "drivers/urg04lx/device_real/component.hpp"

namespace usher::urg04lx {

namespace {
constexpr auto kTick = std::chrono::milliseconds(50);
constexpr auto kReopen = std::chrono::seconds(1);
}  // namespace

Urg04lxComponent::Urg04lxComponent(runtime::Host& host)
    : host_(host), publisher_(host), rejected_(host.health().counter("answers: rejected")) {
  const std::string address =
      host.parameters().text("address", "serial:///dev/ttyACM0?baud=115200", "The scanner's line.");
  stream_ = &host.open_stream(
      address, {.on_open =
                    [this] {
                      session_.opened(now());
                      flush();
                    },
                .on_bytes =
                    [this](std::span<const std::uint8_t> bytes) {
                      session_.received(bytes, now(),
                                        [this](const Scan& scan) { publisher_.publish(scan); });
                      flush();
                    },
                .on_close =
                    [this](const std::string& reason) {
                      session_.closed();
                      host_.health().set(runtime::HealthState::kDegraded, reason);
                    }});
  timer_ = host.timer("tick", kTick, [this](auto) {
    session_.tick(now());
    flush();
    rejected_ = session_.rejected();
    host_.health().set(
        session_.healthy() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
        session_.reason());
  });
}

void Urg04lxComponent::flush() {
  const std::string output = session_.take_output();
  if (!output.empty())
    stream_->write({reinterpret_cast<const std::uint8_t*>(output.data()), output.size()});
  if (session_.state() == Session::State::kFailed) stream_->reopen(kReopen);
}

}  // namespace usher::urg04lx
