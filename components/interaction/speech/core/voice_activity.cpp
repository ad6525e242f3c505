#include "interaction/speech/core/voice_activity.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "interaction/speech/core/loudness.hpp"

namespace usher::speech {

namespace {

constexpr int kHalfSecond = 50;                // [frames]
constexpr std::size_t kHalfSeconds = 6;        // that the background is the quietest of
constexpr int kFirstFrames = 10;               // that are enough for a first background
constexpr std::uint32_t kWindow = 0x3FFFFFFF;  // 30 frames
constexpr double kSilence = -70.0;             // [dB] no background is taken for quieter
constexpr double kRoomDecay = 0.6;             // [dB] a frame, 60 dB in a second
constexpr double kEchoRate = 0.05;             // of the difference, each frame
constexpr double kLoudspeakerOff = -60.0;      // [dB]
// Of the sample before, taken away. More, 0.95 as recognizers do, hides vowels in noise.
constexpr double kLowCut = 0.5;
// Of the room around a voice far above it: more moves the mean that recognizers take away. Around
// one in noise everything stays, since its fricatives are below the noise and cannot be found.
constexpr double kRoomBefore = 0.2;  // [s]
constexpr double kRoomAfter = 0.15;  // [s]

std::size_t samples_of(double seconds) { return static_cast<std::size_t>(seconds * kSpeechRate); }

double decibels(double power) { return 10.0 * std::log10(std::max(power, 1e-10)); }

}  // namespace

VoiceActivity::VoiceActivity(const Settings& settings) : settings_(settings) {
  block_.reserve(NoiseSuppressor::kBlock);
  kept_.reserve(samples_of(kLongest) + kFrame);
  kept_cleaned_.reserve(samples_of(kLongest) + kFrame);
}

void VoiceActivity::restart() {
  kept_.clear();
  kept_cleaned_.clear();
  recent_ = 0;
  silent_ = 0;
  since_first_ = 0;
  loudest_ = -100.0;
  speaking_ = false;
}

std::optional<Sound> VoiceActivity::hear(std::span<const std::int16_t> samples,
                                         double loudspeaker_db) {
  std::optional<Sound> utterance;
  for (const std::int16_t sample : samples) {
    block_.push_back(sample);
    if (block_.size() < static_cast<std::size_t>(NoiseSuppressor::kBlock)) continue;
    std::vector<std::int16_t> cleaned = block_;
    suppressor_.suppress(cleaned);
    const std::span<const std::int16_t> heard = block_;
    for (std::size_t at = 0; at < block_.size(); at += kFrame) {
      if (auto ended =
              frame(heard.subspan(at, kFrame),
                    std::span<const std::int16_t>(cleaned).subspan(at, kFrame), loudspeaker_db))
        utterance = std::move(ended);
    }
    block_.clear();
  }
  return utterance;
}

double VoiceActivity::weighted_power(std::span<const std::int16_t> samples) {
  double sum = 0.0;
  for (const std::int16_t sample : samples) {
    const double value = sample - kLowCut * sample_before_;
    sample_before_ = sample;
    sum += value * value;
  }
  return sum / static_cast<double>(samples.size()) / (32768.0 * 32768.0);
}

void VoiceActivity::learn_background(double power) {
  half_second_ += power;
  ++frames_;
  if (quietest_.empty() && frames_ < kFirstFrames) return;
  double quietest = decibels(half_second_ / frames_);
  if (frames_ == kHalfSecond) {
    if (quietest_.size() == kHalfSeconds) quietest_.erase(quietest_.begin());
    quietest_.push_back(quietest);
    half_second_ = 0.0;
    frames_ = 0;
  }
  // A few frames of the newest half second are no mean yet.
  if (!quietest_.empty()) quietest = *std::min_element(quietest_.begin(), quietest_.end());
  background_ = std::max(kSilence, quietest);
}

bool VoiceActivity::is_voice(std::span<const std::int16_t> samples, double loudspeaker_db) {
  loudspeaker_ = std::max(loudspeaker_db, loudspeaker_ - kRoomDecay);
  std::rotate(powers_.begin(), powers_.begin() + 1, powers_.end());
  powers_.back() = weighted_power(samples);
  const double level = decibels((powers_[0] + powers_[1] + powers_[2]) / 3.0);
  loudest_ = std::max(loudest_, level);
  const bool loud = level > background_ + settings_.over_noise;
  if (loudspeaker_ > kLoudspeakerOff) {
    const double returned = loudness_db(samples) - loudspeaker_;
    // While the room still holds what was said, steady noise is louder than that, too.
    if (returned > echo_ + settings_.over_echo) return loud;
    // Only what is clearly louder than the background tells how much comes back.
    if (loud && loudspeaker_ == loudspeaker_db) echo_ += kEchoRate * (returned - echo_);
    return false;
  }
  learn_background(powers_.back());
  return loud;
}

std::optional<Sound> VoiceActivity::frame(std::span<const std::int16_t> heard,
                                          std::span<const std::int16_t> cleaned,
                                          double loudspeaker_db) {
  const bool voice = is_voice(heard, loudspeaker_db);
  kept_.insert(kept_.end(), heard.begin(), heard.end());
  kept_cleaned_.insert(kept_cleaned_.end(), cleaned.begin(), cleaned.end());
  recent_ = ((recent_ << 1U) | (voice ? 1U : 0U)) & kWindow;
  silent_ = voice ? 0 : silent_ + 1;
  if (voice || since_first_ > 0) ++since_first_;
  if (!speaking_) {
    speaking_ = std::popcount(recent_) >= static_cast<int>(settings_.least_voice * 100.0);
    if (recent_ == 0) {
      loudest_ = -100.0;
      since_first_ = 0;
    }
    const std::size_t most = samples_of(settings_.before + 0.3);
    for (auto* kept : {&kept_, &kept_cleaned_}) {
      if (!speaking_ && kept->size() > most)
        kept->erase(kept->begin(), kept->end() - static_cast<std::ptrdiff_t>(most));
    }
    return std::nullopt;
  }
  const bool paused = silent_ >= static_cast<int>(settings_.pause * 100.0);
  if (!paused && kept_.size() < samples_of(kLongest)) return std::nullopt;
  const bool noisy = loudest_ < background_ + settings_.quiet_room;
  Sound utterance{kSpeechRate, noisy ? kept_cleaned_ : kept_, noisy};
  if (!noisy) {
    const auto room = [](int frames, double kept) {
      const auto samples = static_cast<std::ptrdiff_t>(frames) * kFrame;
      return std::max<std::ptrdiff_t>(0, samples - static_cast<std::ptrdiff_t>(samples_of(kept)));
    };
    auto& samples = utterance.samples;
    samples.erase(samples.end() - room(silent_, kRoomAfter), samples.end());
    const int before = static_cast<int>(kept_.size()) / kFrame - since_first_;
    samples.erase(samples.begin(), samples.begin() + room(before, kRoomBefore));
  }
  restart();
  return utterance;
}

}  // namespace usher::speech
