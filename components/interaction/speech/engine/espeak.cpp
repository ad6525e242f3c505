#include "interaction/speech/engine/espeak.hpp"

#include <espeak-ng/speak_lib.h>

#include <algorithm>
#include <cmath>

namespace usher::speech {

namespace {

constexpr std::size_t kMostText = 2000;  // [byte]
constexpr double kLongestSpeech = 60.0;  // [s]
constexpr int kNormalVolume = 100;

struct Collected {
  Utterance* utterance = nullptr;
  std::string_view text;
};

/// The place of a word that espeak-ng counts in letters, from 1.
std::size_t byte_of_letter(std::string_view text, int letter) {
  std::size_t at = 0;
  for (int i = 1; i < letter && at < text.size(); ++i) {
    ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U) ++at;
  }
  return at;
}

int collect(short* samples, int count, espeak_EVENT* events) {
  Collected* collected = nullptr;
  for (espeak_EVENT* event = events; event->type != espeakEVENT_LIST_TERMINATED; ++event) {
    if (event->user_data != nullptr) collected = static_cast<Collected*>(event->user_data);
  }
  if (collected == nullptr && events->user_data != nullptr)
    collected = static_cast<Collected*>(events->user_data);
  if (collected == nullptr) return 0;
  Utterance& utterance = *collected->utterance;
  for (espeak_EVENT* event = events; event->type != espeakEVENT_LIST_TERMINATED; ++event) {
    if (event->type != espeakEVENT_WORD) continue;
    const auto begin = byte_of_letter(collected->text, event->text_position);
    const auto end = byte_of_letter(collected->text, event->text_position + event->length);
    utterance.words.push_back({static_cast<std::uint32_t>(begin),
                               static_cast<std::uint32_t>(end - begin),
                               1e-3 * event->audio_position});
  }
  if (samples != nullptr && count > 0)
    utterance.sound.samples.insert(utterance.sound.samples.end(), samples, samples + count);
  return utterance.sound.duration() > kLongestSpeech ? 1 : 0;
}

class Espeak final : public Synthesizer {
 public:
  explicit Espeak(int rate) : rate_(rate) { espeak_SetSynthCallback(collect); }
  Espeak(const Espeak&) = delete;
  Espeak& operator=(const Espeak&) = delete;
  ~Espeak() override { espeak_Terminate(); }

  int rate() const override { return rate_; }

  Result<Utterance> say(const std::string& text, const std::string& language,
                        const Settings& settings) override {
    std::string voice = language == "en" ? "en-us" : language;
    if (!settings.voice.empty()) voice += "+" + settings.voice;
    if (espeak_SetVoiceByName(voice.c_str()) != EE_OK) {
      return Error{"expected a voice of espeak-ng, got '" + voice + "'"};
    }
    espeak_SetParameter(espeakRATE, static_cast<int>(settings.words_per_minute), 0);
    espeak_SetParameter(espeakPITCH, static_cast<int>(settings.pitch), 0);
    espeak_SetParameter(espeakVOLUME, kNormalVolume, 0);
    Utterance utterance;
    utterance.sentence = text.substr(0, kMostText);
    utterance.sound.rate = rate_;
    Collected collected{&utterance, utterance.sentence};
    const auto said = espeak_Synth(utterance.sentence.c_str(), utterance.sentence.size() + 1, 0,
                                   POS_CHARACTER, 0, espeakCHARS_UTF8, nullptr, &collected);
    if (said != EE_OK || utterance.sound.samples.empty())
      return Error{"espeak-ng gave no sound for \"" + utterance.sentence + "\""};
    return utterance;
  }

 private:
  int rate_;
};

}  // namespace

Result<std::unique_ptr<Synthesizer>> make_espeak() {
  const int rate =
      espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, 0, nullptr, espeakINITIALIZE_DONT_EXIT);
  if (rate <= 0) return Error{"espeak-ng found no data; expected the package espeak-ng-data"};
  return std::unique_ptr<Synthesizer>(std::make_unique<Espeak>(rate));
}

}  // namespace usher::speech
