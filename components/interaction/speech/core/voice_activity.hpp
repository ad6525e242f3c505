#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

/// Cuts utterances out of what a microphone hears, and tells a voice from the robot's own by its
/// loudness: what the loudspeaker explains is no visitor.
///
/// A frame of 10 ms is voice when it is `over_noise` louder than the background (the quietest of
/// the last 3 s) and `over_echo` louder than the loudspeaker through the room; how much of it comes
/// back is learnt while the robot speaks. Memory is bounded by kLongest.
class VoiceActivity {
 public:
  struct Settings {
    double over_noise = 9.0;    ///< [dB]
    double over_echo = 8.0;     ///< [dB]
    double least_voice = 0.12;  ///< [s] of voice within 0.3 s that begin an utterance
    double pause = 0.45;        ///< [s] of no voice that end it
    double before = 0.25;       ///< [s] that are kept before its first voice
  };
  static constexpr double kLongest = 5.0;  ///< [s] an utterance is ended then
  static constexpr int kFrame = kSpeechRate / 100;

  VoiceActivity() : VoiceActivity(Settings{}) {}
  explicit VoiceActivity(const Settings& settings);

  /// What the microphone heard, at 16 kHz, while the loudspeaker had this loudness (dB below full
  /// scale; -100 = silent). Returns an utterance when one ended.
  std::optional<Sound> hear(std::span<const std::int16_t> samples, double loudspeaker_db);
  /// Somebody speaks now.
  bool voice() const { return speaking_; }
  /// Forgets what was heard; the background stays known.
  void restart();

  double background_db() const { return background_; }
  double echo_db() const { return echo_; }

 private:
  std::optional<Sound> frame(double loudspeaker_db);
  bool is_voice(double loudness, double loudspeaker_db);

  Settings settings_;
  double background_ = -60.0;     ///< [dB]
  double echo_ = -6.0;            ///< [dB] microphone over loudspeaker
  double loudspeaker_ = -100.0;   ///< [dB] with what the room still holds
  std::vector<double> quietest_;  ///< [dB] of each of the last six half seconds
  double quietest_now_ = 0.0;
  int frames_ = 0;
  std::vector<std::int16_t> part_;  ///< of a frame
  std::vector<std::int16_t> kept_;
  std::uint32_t recent_ = 0;  ///< one bit for each of the last 30 frames
  int silent_ = 0;            ///< frames since the last voice
  bool speaking_ = false;
};

}  // namespace usher::speech
