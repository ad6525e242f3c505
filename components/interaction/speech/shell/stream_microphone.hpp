#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "interaction/speech/shell/equipment.hpp"
#include "runtime/api/host.hpp"

namespace usher::speech {

/// A sound card whose microphone may also be at the end of a stream ("listen://127.0.0.1:7432",
/// "tcp://...") into which another program plays: one channel of 16 bit little-endian samples at
/// kSpeechRate, as fast as time passes. Everything else is the card's. Whoever plays may come and
/// go: without him there is no microphone.
class StreamMicrophone final : public SoundCard {
 public:
  StreamMicrophone(runtime::Host& host, std::unique_ptr<SoundCard> card)
      : host_(host), card_(std::move(card)) {}

  Opening to_open_loudspeaker(const std::string& device, int rate) override {
    return card_->to_open_loudspeaker(device, rate);
  }
  Opening to_open_microphone(const std::string& device) override;
  std::size_t room() override { return card_->room(); }
  Status write(std::span<const std::int16_t> samples) override { return card_->write(samples); }
  std::uint64_t unheard() override { return card_->unheard(); }
  Status read(std::vector<std::int16_t>& samples) override;

 private:
  /// More is too old to be answered: the oldest is forgotten.
  static constexpr std::size_t kMostWaiting = kSpeechRate;

  void take(std::span<const std::uint8_t> bytes);
  Error nobody() const { return Error{"nobody plays into the microphone " + device_}; }

  runtime::Host& host_;
  std::unique_ptr<SoundCard> card_;
  std::string device_;  ///< empty: the card's microphone
  bool there_ = false;
  bool half_ = false;  ///< of a sample has come
  std::uint8_t low_ = 0;
  std::deque<std::int16_t> waiting_;
};

}  // namespace usher::speech
