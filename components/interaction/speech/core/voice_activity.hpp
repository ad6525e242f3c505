#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interaction/speech/core/noise_suppressor.hpp"
#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

/// Cuts utterances out of what a microphone hears, and tells a voice from the robot's own by its
/// loudness: what the loudspeaker explains is no visitor.
///
/// A frame of 10 ms is voice when it and the two before it are `over_noise` louder than the
/// background (the mean of the quietest half second of the last 3 s in which the robot was silent)
/// and `over_echo` louder than the loudspeaker through the room; how much of it comes back is
/// learnt while the robot speaks. Low sounds, a hum above all, count less than those of speech. An
/// utterance that is not far above the background comes with its noise suppressed, one that is
/// comes with little of the room around it. Memory is bounded by kLongest.
class VoiceActivity {
 public:
  struct Settings {
    double over_noise = 4.0;    ///< [dB]
    double over_echo = 8.0;     ///< [dB]
    double least_voice = 0.12;  ///< [s] of voice within 0.3 s that begin an utterance
    double pause = 0.3;         ///< [s] of no voice that end it
    double before = 0.25;       ///< [s] that are kept before its first voice
    double quiet_room = 20.0;   ///< [dB] of the loudest over the background; less is suppressed
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
  std::optional<Sound> frame(std::span<const std::int16_t> heard,
                             std::span<const std::int16_t> cleaned, double loudspeaker_db);
  bool is_voice(std::span<const std::int16_t> samples, double loudspeaker_db);
  void learn_background(double power);
  double weighted_power(std::span<const std::int16_t> samples);

  Settings settings_;
  NoiseSuppressor suppressor_;
  double background_ = -60.0;     ///< [dB] weighted
  double echo_ = -6.0;            ///< [dB] microphone over loudspeaker
  double loudspeaker_ = -100.0;   ///< [dB] with what the room still holds
  double loudest_ = -100.0;       ///< [dB] weighted, of the utterance
  std::vector<double> quietest_;  ///< [dB] weighted mean of each of the last six half seconds
  double half_second_ = 0.0;      ///< sum of the powers of this one
  int frames_ = 0;                ///< of it
  std::array<double, 3> powers_{};
  double sample_before_ = 0.0;
  std::vector<std::int16_t> block_;  ///< of the suppressor
  std::vector<std::int16_t> kept_, kept_cleaned_;
  std::uint32_t recent_ = 0;  ///< one bit for each of the last 30 frames
  int silent_ = 0;            ///< frames since the last voice
  int since_first_ = 0;       ///< frames since the first voice, with it; 0 = none yet
  bool speaking_ = false;
};

}  // namespace usher::speech
