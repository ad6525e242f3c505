#include "drivers/lms100/device_real/component.hpp"

namespace usher::lms100 {

namespace {
constexpr auto kTick = std::chrono::milliseconds(50);
constexpr auto kReopen = std::chrono::seconds(1);
}  // namespace

Session::Parameters Lms100Component::read_parameters(runtime::Parameters& parameters) {
  Session::Parameters p;
  p.dialect =
      parameters.choice("dialect", {"binary", "ascii"}, "binary", "CoLa-B or CoLa-A.") == "ascii"
          ? Dialect::kAscii
          : Dialect::kBinary;
  p.intensities = parameters.flag("intensities", p.intensities, "Ask for remission values too.");
  return p;
}

Lms100Component::Lms100Component(runtime::Host& host)
    : host_(host),
      publisher_(host),
      session_(read_parameters(host.parameters())),
      lost_(host.health().counter("scans: lost")),
      rejected_(host.health().counter("telegrams: rejected")) {
  const std::string address =
      host.parameters().text("address", "tcp://192.168.0.1:2112", "Where the scanner listens.");
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
    report();
  });
}

void Lms100Component::flush() {
  const auto output = session_.take_output();
  if (!output.empty()) stream_->write(output);
  if (session_.state() == Session::State::kFailed) stream_->reopen(kReopen);
}

void Lms100Component::report() {
  lost_ = session_.lost_scans();
  rejected_ = session_.rejected();
  host_.health().set(
      session_.healthy() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
      session_.reason());
}

}  // namespace usher::lms100
