#include "interaction/speech/core/voice_activity.hpp"

#include <algorithm>
#include <bit>

#include "interaction/speech/core/loudness.hpp"

namespace usher::speech {

namespace {

constexpr int kHalfSecond = 50;                // [frames]
constexpr std::size_t kHalfSeconds = 6;        // that the background is the quietest of
constexpr std::uint32_t kWindow = 0x3FFFFFFF;  // 30 frames
constexpr double kSilence = -70.0;             // [dB] no background is taken for quieter
constexpr double kRoomDecay = 0.6;             // [dB] a frame, 60 dB in a second
constexpr double kEchoRate = 0.05;             // of the difference, each frame
constexpr double kLoudspeakerOff = -60.0;      // [dB]

std::size_t samples_of(double seconds) { return static_cast<std::size_t>(seconds * kSpeechRate); }

}  // namespace

VoiceActivity::VoiceActivity(const Settings& settings) : settings_(settings) {
  part_.reserve(kFrame);
  kept_.reserve(samples_of(kLongest) + kFrame);
}

void VoiceActivity::restart() {
  part_.clear();
  kept_.clear();
  recent_ = 0;
  silent_ = 0;
  speaking_ = false;
}

std::optional<Sound> VoiceActivity::hear(std::span<const std::int16_t> samples,
                                         double loudspeaker_db) {
  std::optional<Sound> utterance;
  for (const std::int16_t sample : samples) {
    part_.push_back(sample);
    if (part_.size() < static_cast<std::size_t>(kFrame)) continue;
    if (auto ended = frame(loudspeaker_db)) utterance = std::move(ended);
    part_.clear();
  }
  return utterance;
}

bool VoiceActivity::is_voice(double loudness, double loudspeaker_db) {
  loudspeaker_ = std::max(loudspeaker_db, loudspeaker_ - kRoomDecay);
  quietest_now_ = frames_ % kHalfSecond == 0 ? loudness : std::min(quietest_now_, loudness);
  if (++frames_ % kHalfSecond == 0) {
    if (quietest_.size() == kHalfSeconds) quietest_.erase(quietest_.begin());
    quietest_.push_back(quietest_now_);
  }
  double quietest = quietest_now_;
  for (const double each : quietest_) quietest = std::min(quietest, each);
  background_ = std::max(kSilence, quietest);
  if (loudspeaker_ > kLoudspeakerOff) {
    const double returned = loudness - loudspeaker_;
    if (returned > echo_ + settings_.over_echo) return true;
    // Only what is clearly louder than the background tells how much comes back.
    if (loudness > background_ + settings_.over_noise && loudspeaker_ == loudspeaker_db)
      echo_ += kEchoRate * (returned - echo_);
    return false;
  }
  return loudness > background_ + settings_.over_noise;
}

std::optional<Sound> VoiceActivity::frame(double loudspeaker_db) {
  const bool voice = is_voice(loudness_db(part_), loudspeaker_db);
  kept_.insert(kept_.end(), part_.begin(), part_.end());
  recent_ = ((recent_ << 1U) | (voice ? 1U : 0U)) & kWindow;
  silent_ = voice ? 0 : silent_ + 1;
  if (!speaking_) {
    speaking_ = std::popcount(recent_) >= static_cast<int>(settings_.least_voice * 100.0);
    const std::size_t most = samples_of(settings_.before + 0.3);
    if (!speaking_ && kept_.size() > most)
      kept_.erase(kept_.begin(), kept_.end() - static_cast<std::ptrdiff_t>(most));
    return std::nullopt;
  }
  const bool paused = silent_ >= static_cast<int>(settings_.pause * 100.0);
  if (!paused && kept_.size() < samples_of(kLongest)) return std::nullopt;
  Sound utterance{kSpeechRate, kept_};
  kept_.clear();
  recent_ = 0;
  speaking_ = false;
  return utterance;
}

}  // namespace usher::speech
