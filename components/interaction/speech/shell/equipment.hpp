#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "interaction/speech/core/grammar.hpp"
#include "interaction/speech/core/hearing.hpp"
#include "interaction/speech/core/player.hpp"

namespace usher::speech {

/// Microphone and loudspeaker, each by itself. Called in handlers every 20 ms, and does at once
/// what can be done at once; only an Opening may block.
class SoundCard {
 public:
  /// Opens a device. Runs on any thread, while nothing else is asked of this half of the card.
  using Opening = std::function<Status()>;

  virtual ~SoundCard() = default;
  /// How to open what is named; "" = none. May be called again after a failure.
  virtual Opening to_open_loudspeaker(const std::string& device, int rate) = 0;
  virtual Opening to_open_microphone(const std::string& device) = 0;  ///< kSpeechRate, one channel
  /// Samples that can be written now without more than 120 ms waiting.
  virtual std::size_t room() = 0;
  /// An error means that the device is gone; it is closed then.
  virtual Status write(std::span<const std::int16_t> samples) = 0;
  virtual std::uint64_t unheard() = 0;  ///< samples that are written and not heard yet
  /// Appends what was heard since the last call. An error means that the device is gone.
  virtual Status read(std::vector<std::int16_t>& samples) = 0;
};

/// Text to sound. One call at a time, on any thread.
class Synthesizer {
 public:
  struct Settings {
    std::string voice;  ///< variant, "" = the language's own
    double words_per_minute = 150.0;
    double pitch = 50.0;  ///< {0..100}
  };
  virtual ~Synthesizer() = default;
  virtual int rate() const = 0;  ///< [Hz]
  virtual Result<Utterance> say(const std::string& text, const std::string& language,
                                const Settings& settings) = 0;
};

/// Sound to phrases. One call at a time, on any thread.
class Recognizer {
 public:
  virtual ~Recognizer() = default;
  /// Reads the models, which may take a second; before it nothing is understood.
  virtual Status load() = 0;
  /// What it makes of the sound, given that one of the phrases may have been said. The sound has
  /// some of the room before and after what was said, as VoiceActivity cuts it.
  virtual Result<Hearing> hear(const Sound& sound, std::span<const Phrase> phrases) = 0;
};

struct Equipment {
  std::unique_ptr<SoundCard> card;
  std::unique_ptr<Synthesizer> synthesizer;
  std::unique_ptr<Recognizer> recognizer;  ///< null: nothing is understood
};

/// Nothing at all that sounds: 20 ms pass with every call. For simulation in one thread.
class NullSoundCard final : public SoundCard {
 public:
  Opening to_open_loudspeaker(const std::string&, int rate) override {
    rate_ = static_cast<std::size_t>(rate);
    return [] { return Status{}; };
  }
  Opening to_open_microphone(const std::string&) override {
    return [] { return Status{Error{"there is no microphone"}}; };
  }
  std::size_t room() override { return rate_ / 50; }
  Status write(std::span<const std::int16_t>) override { return {}; }
  std::uint64_t unheard() override { return 0; }
  Status read(std::vector<std::int16_t>&) override { return Error{"there is no microphone"}; }

 private:
  std::size_t rate_ = 16000;
};

/// Silence that lasts as long as a voice would: 65 ms for each letter.
class NullSynthesizer final : public Synthesizer {
 public:
  int rate() const override { return 8000; }
  Result<Utterance> say(const std::string& text, const std::string&, const Settings&) override {
    Utterance utterance;
    utterance.sentence = text;
    utterance.sound = {8000,
                       std::vector<std::int16_t>(520 * std::min<std::size_t>(text.size(), 400))};
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find(' ', begin), text.size());
      utterance.words.push_back({static_cast<std::uint32_t>(begin),
                                 static_cast<std::uint32_t>(end - begin),
                                 0.065 * static_cast<double>(begin)});
      begin = end + 1;
    }
    return utterance;
  }
};

}  // namespace usher::speech
