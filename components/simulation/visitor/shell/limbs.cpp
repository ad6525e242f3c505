#include "simulation/visitor/shell/limbs.hpp"

#include <algorithm>

namespace usher::visitor {

namespace {

constexpr auto kStep = std::chrono::milliseconds(20);
constexpr std::size_t kSamples = Mouth::kMouthRate / 50;  // of a step
constexpr std::uint64_t kMostSkipped = 50;                // steps: what is older, nobody hears
constexpr auto kSynthesisTime = std::chrono::milliseconds(30);

}  // namespace

Limbs::Limbs(runtime::Host& host, std::shared_ptr<Voice> voice, const std::string& finger,
             const std::string& mouth)
    : host_(host), voice_(std::move(voice)), room_(host.random("room")) {
  if (!finger.empty()) finger_ = &host.open_stream(finger, {});
  if (mouth.empty()) return;
  microphone_ = &host.open_stream(mouth, {});
  timer_ = host.timer("sound", kStep, [this](std::uint64_t skipped) { sound(skipped); });
}

void Limbs::tap(const finger::Tap& tap) {
  const std::string line = finger::to_line(tap);
  finger_->write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
}

void Limbs::say(const std::string& words) {
  const auto said = std::make_shared<Result<std::vector<std::int16_t>>>(Error{"nothing was said"});
  host_.offload(
      kSynthesisTime, [voice = voice_, said, words] { *said = voice->say(words); },
      [this, said] {
        trouble_ = said->ok() ? "" : said->error();
        if (said->ok()) mouth_.say(std::move(*said).value());
      });
}

void Limbs::sound(std::uint64_t skipped) {
  const std::uint64_t steps = 1 + std::min(skipped, kMostSkipped);
  microphone_->write(mouth_.next(steps * kSamples, room_));
}

}  // namespace usher::visitor
