#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

/// A word of a sentence, and when it is said.
struct Word {
  std::uint32_t begin = 0;   ///< [byte] into the sentence
  std::uint32_t length = 0;  ///< [byte]
  double time = 0.0;         ///< [s] from the sentence's beginning
};

/// Something to be heard: a sentence, or a tone (a sound without a sentence).
struct Utterance {
  std::uint64_t id = 0;  ///< the dialogue's spoken_id; 0 = a tone or a question of our own
  std::string sentence;
  Sound sound;              ///< at the player's rate
  std::vector<Word> words;  ///< by time
};

/// What is heard at a moment.
struct Caption {
  std::uint64_t id = 0;
  std::string sentence;
  std::uint32_t word_begin = 0, word_length = 0;  ///< [byte]; length 0 = no word yet
  bool operator==(const Caption&) const = default;
};

/// The queue of utterances in front of a loudspeaker that is given samples ahead of time. Places in
/// the stream of samples are counted from the start, so that what was given and what was heard can
/// be told apart.
class Player {
 public:
  static constexpr std::size_t kMostWaiting = 8;  ///< the oldest that has not begun makes room

  explicit Player(int rate) : rate_(rate) {}

  int rate() const { return rate_; }
  void add(Utterance utterance);
  /// Forgets all of it; samples that were given already will still be heard. An utterance that had
  /// begun counts as finished.
  void break_off();
  /// Loudness of what is given from now on, {0..1}; changes within 10 ms without a click.
  void set_gain(double gain) { gain_ = gain; }

  /// The next samples for the loudspeaker; silence when there is nothing to say.
  void take(std::span<std::int16_t> samples);
  /// Whether anything waits or is not wholly given.
  bool busy() const { return !waiting_.empty(); }

  /// `unheard`: samples that were given and are still on their way to the ear.
  std::optional<Caption> caption(std::uint64_t unheard) const;
  /// Loudness of the last 40 ms that were heard, in dB below full scale.
  double loudness(std::uint64_t unheard) const;
  /// Whether anything but silence is heard, or will be without a pause.
  bool sounds(std::uint64_t unheard) const;
  /// Newest utterance with an id that was heard to its end or broken off.
  std::uint64_t finished(std::uint64_t unheard) const;

 private:
  struct Given {
    Caption caption;
    std::vector<Word> words;
    std::uint64_t begin = 0, end = 0;  ///< places; end grows while it is given
    bool whole = false;
  };
  static constexpr std::size_t kMostGiven = 32;
  static constexpr std::size_t kFrame = 256;  ///< [samples] of the record of loudness
  static constexpr std::size_t kFrames = 512;

  std::uint64_t heard(std::uint64_t unheard) const { return place_ - std::min(place_, unheard); }
  void record(std::span<const std::int16_t> samples);

  int rate_;
  double gain_ = 1.0, gain_now_ = 1.0;
  std::deque<Utterance> waiting_;
  std::size_t position_ = 0;  ///< in the first of them
  std::deque<Given> given_;
  std::uint64_t place_ = 0;
  std::vector<double> loudness_ = std::vector<double>(kFrames, -100.0);
  std::vector<std::int16_t> frame_;
};

}  // namespace usher::speech
