#include "interaction/speech/shell/stream_microphone.hpp"

namespace usher::speech {

SoundCard::Opening StreamMicrophone::to_open_microphone(const std::string& device) {
  if (!device.starts_with("tcp://") && !device.starts_with("listen://"))
    return card_->to_open_microphone(device);
  if (device_.empty()) {
    device_ = device;
    host_.open_stream(device,
                      {.on_open =
                           [this] {
                             there_ = true;
                             half_ = false;
                           },
                       .on_bytes = [this](std::span<const std::uint8_t> bytes) { take(bytes); },
                       .on_close = [this](const std::string&) { there_ = false; }});
  }
  waiting_.clear();
  return [status = there_ ? Status{} : nobody()] { return status; };
}

void StreamMicrophone::take(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (half_) waiting_.push_back(static_cast<std::int16_t>(low_ | (byte << 8U)));
    low_ = byte;
    half_ = !half_;
  }
  while (waiting_.size() > kMostWaiting) waiting_.pop_front();
}

Status StreamMicrophone::read(std::vector<std::int16_t>& samples) {
  if (device_.empty()) return card_->read(samples);
  if (!there_) return nobody();
  samples.insert(samples.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
  return {};
}

}  // namespace usher::speech
