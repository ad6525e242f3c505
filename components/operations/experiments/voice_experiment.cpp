#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <optional>

#include "foundation/random/random.hpp"
#include "interaction/speech/core/conversation.hpp"
#include "interaction/speech/core/loudness.hpp"
#include "interaction/speech/core/resample.hpp"
#include "interaction/speech/core/voice_activity.hpp"
#include "interaction/speech/core/wav_file.hpp"
#include "interaction/speech/engine/espeak.hpp"
#include "interaction/speech/engine/pocketsphinx.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/only.hpp"
#include "tasks/guide/core/texts.hpp"

namespace usher::operations {

namespace {

using namespace speech;
namespace fs = std::filesystem;

// A voice of 62.5 dB at 1.25 m (the thesis gives 60 to 65 dB at 1 to 1.5 m for the robot's own; who
// talks to it is as loud) against the 52 dB that the thesis measures while the torso moves.
constexpr double kFar = 10.5;  // [dB] of the voice over the noise
// The same voice from 0.6 m, where the nominal zone begins and the screen is touched.
constexpr double kNear = 16.9;       // [dB]
constexpr double kRoom = 20.5;       // [dB] over a room of 42 dB: no clip's own noise is louder
constexpr double kRoomBefore = 2.0;  // [s] in which the room alone is heard
constexpr double kRoomAfter = 1.0;   // [s]
constexpr int kMostReplies = 2;      ///< to questions back: yes, or no and yes, or yes said again
constexpr double kShortest = 0.1;    // [s] the collection has cuts of 30 ms, too

constexpr std::array kCommands{"one",   "two",  "three", "four",  "five",
                               "front", "back", "left",  "right", "stop"};
constexpr std::array kDigits{"zero", "one", "two",   "three", "four",
                             "five", "six", "seven", "eight", "nine"};
constexpr std::array kYesNo{"yes", "no"};
constexpr std::array kVoices{"", "m3", "f2", "m7", "f5"};
/// What may be said while the guide drives or waits for its visitor, and what stands there besides.
constexpr std::array<std::string_view, 3> kOnTheWay{"stop", "cancel", "stay"};
constexpr std::string_view kOnTheWayToo = "repeat";

struct Clip {
  std::string label;      ///< an option's id; no option of the grammar: foreign
  bool held_out = false;  ///< no parameter was chosen with its help
  Sound sound;
};

/// Filtered noise as fans and motors make it: equal power in each octave, a hum of 120 Hz on it.
std::vector<double> motor_noise(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> noise(count);
  std::array<double, 3> state{};
  for (std::size_t i = 0; i < count; ++i) {
    const double white = random.gaussian();
    // Three poles approximate a slope of 3 dB an octave.
    state[0] = 0.99765 * state[0] + 0.0990460 * white;
    state[1] = 0.96300 * state[1] + 0.2965164 * white;
    state[2] = 0.57000 * state[2] + 1.0526913 * white;
    const double t = static_cast<double>(i) / kSpeechRate;
    noise[i] = state[0] + state[1] + state[2] + 0.1848 * white +
               1.5 * std::sin(2.0 * std::numbers::pi * 120.0 * t);
  }
  return noise;
}

/// How a clip comes to the microphone.
struct Room {
  std::string name;
  std::optional<double> voice_over_noise;  ///< [dB] none: only the clip's own noise
};

/// What the microphone hears: the room, the clip in it, the room. The loudest fifth of a second is
/// taken for the level of the voice. Without noise the room goes on at the level of the quietest
/// 20 ms of the clip.
std::vector<std::int16_t> at_microphone(const Sound& clip, const Room& room, std::uint64_t seed) {
  const Sound said = for_recognizer(clip);
  const auto extreme = [&](std::size_t part, bool loudest) {
    double level = rms(said.samples);
    for (std::size_t i = 0; i + part <= said.samples.size(); i += part / 4) {
      const double here = rms({&said.samples[i], part});
      level = loudest ? std::max(level, here) : std::min(level, here);
    }
    return 32768.0 * level;
  };
  const double voice = extreme(kSpeechRate / 5, true);
  const auto under = [&](double decibels) { return voice * std::pow(10.0, -decibels / 20.0); };
  const double level = room.voice_over_noise
                           ? under(*room.voice_over_noise)
                           : std::clamp(extreme(kSpeechRate / 50, false), 1.0, under(kRoom));
  const auto before = static_cast<std::size_t>(kRoomBefore * kSpeechRate);
  const std::size_t end = before + said.samples.size();
  const auto noise = motor_noise(end + static_cast<std::size_t>(kRoomAfter * kSpeechRate), seed);
  double power = 0.0;
  for (const double value : noise) power += value * value;
  const double gain = level / std::sqrt(power / static_cast<double>(noise.size()));
  std::vector<std::int16_t> heard(noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const bool inside = i >= before && i < end;
    double value = inside && !room.voice_over_noise ? 0.0 : gain * noise[i];
    if (inside) value += said.samples[i - before];
    heard[i] = static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0, 32767.0)));
  }
  return heard;
}

/// The utterance that the component cuts out of it, the longest when it hears several; nothing when
/// it hears none.
std::optional<Sound> utterance_of(std::span<const std::int16_t> heard) {
  VoiceActivity activity;
  constexpr std::size_t kStep = kSpeechRate / 50;
  constexpr double kLoudspeakerOff = -100.0;  // [dB]
  std::optional<Sound> longest;
  for (std::size_t i = 0; i + kStep <= heard.size(); i += kStep) {
    auto ended = activity.hear(heard.subspan(i, kStep), kLoudspeakerOff);
    if (ended && (!longest || ended->duration() > longest->duration())) longest = std::move(ended);
  }
  return longest;
}

struct Score {
  int words = 0, first = 0, acted_right = 0, acted_wrong = 0, after_questions = 0, asked = 0;
  int unheard = 0;  ///< words that no utterance was cut out for
  int foreign = 0, foreign_acted = 0, foreign_asked = 0, foreign_confirmed = 0, foreign_stopped = 0;

  Score& operator+=(const Score& other) {
    words += other.words;
    first += other.first;
    acted_right += other.acted_right;
    acted_wrong += other.acted_wrong;
    after_questions += other.after_questions;
    asked += other.asked;
    unheard += other.unheard;
    foreign += other.foreign;
    foreign_acted += other.foreign_acted;
    foreign_asked += other.foreign_asked;
    foreign_confirmed += other.foreign_confirmed;
    foreign_stopped += other.foreign_stopped;
    return *this;
  }
  double share_understood() const {
    return words > 0 ? static_cast<double>(acted_right + after_questions) / words : 0.0;
  }
  double share_first() const { return words > 0 ? static_cast<double>(first) / words : 0.0; }
  double share_foreign() const {
    return foreign > 0 ? static_cast<double>(foreign_acted + foreign_confirmed) / foreign : 0.0;
  }
};

bool offers(std::span<const Phrase> phrases, const std::string& label) {
  return std::any_of(phrases.begin(), phrases.end(),
                     [&](const Phrase& phrase) { return phrase.option_id == label; });
}

template <std::size_t N>
std::vector<Option> options_of(const std::array<const char*, N>& words) {
  std::vector<Option> options;
  options.reserve(words.size());
  for (const char* word : words) options.push_back({word, word, false});
  return options;
}

/// These words and no others.
std::vector<Phrase> phrases_of(std::span<const Option> words) {
  std::vector<Phrase> phrases;
  phrases.reserve(words.size());
  for (const Option& word : words) phrases.push_back({word.id, word.label, word.label});
  return phrases;
}

/// Every WAV file below the folder, in order; each second one of a set is held out.
Result<std::vector<Clip>> read_clips(const fs::path& folder, bool label_is_folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.path().extension() == ".wav") paths.push_back(entry.path());
  }
  if (paths.empty()) return Error{"expected recordings in " + folder.string() + ", got none"};
  std::sort(paths.begin(), paths.end());
  std::vector<Clip> clips;
  for (const fs::path& path : paths) {
    auto sound = read_wav_file(path.string());
    if (!sound) return Error{sound.error()};
    const std::string name = path.filename().string();
    std::string label =
        label_is_folder ? path.parent_path().filename().string() : name.substr(0, name.find('_'));
    if (label.size() == 1 && label[0] >= '0' && label[0] <= '9')
      label = kDigits[static_cast<std::size_t>(label[0] - '0')];
    clips.push_back({label, clips.size() % 2 == 1, std::move(sound).value()});
  }
  return clips;
}

struct Set {
  std::string name;
  std::vector<Phrase> phrases;
  std::vector<Option> options;  ///< of the screen that they are for
  std::vector<const Clip*> clips;
  Room room;
  bool listens = true;  ///< the screen waits for an answer
};

void add(Set& set, const std::vector<Clip>& clips) {
  for (const Clip& clip : clips) {
    if (clip.sound.duration() >= kShortest) set.clips.push_back(&clip);
  }
}
/// Only what the set's grammar has no word for.
void add_foreign(Set& set, const std::vector<Clip>& clips) {
  for (const Clip& clip : clips) {
    if (clip.sound.duration() >= kShortest && !offers(set.phrases, clip.label))
      set.clips.push_back(&clip);
  }
}

/// The texts of buttons by several voices of espeak-ng. Where two buttons are called the same, the
/// first is meant.
Result<std::vector<Clip>> synthesized(Synthesizer& synthesizer, std::span<const Option> options) {
  const auto phrases = phrases_for(options);
  std::vector<Clip> clips;
  for (const Option& option : options) {
    const std::string words = spoken_words(option.label);
    const auto meant = std::find_if(phrases.begin(), phrases.end(),
                                    [&](const Phrase& phrase) { return phrase.words == words; });
    if (meant == phrases.end()) continue;
    for (const char* voice : kVoices) {
      Synthesizer::Settings settings;
      settings.voice = voice;
      auto said = synthesizer.say(option.label, "en", settings);
      if (!said) return Error{said.error()};
      clips.push_back({meant->option_id, true, std::move(said->sound)});
    }
  }
  return clips;
}

/// Everything that stands on a button of the guide, in one list: more than any of its screens has.
Result<std::vector<Option>> read_buttons(const std::string& path) {
  std::vector<Option> buttons;
  try {
    const YAML::Node texts = YAML::LoadFile(path)["guide"];
    for (std::size_t i = 0; i < guide::kTextKeys.size(); ++i) {
      if (!guide::labels_button(static_cast<guide::Text>(i))) continue;
      const std::string id(guide::kTextKeys[i]);
      buttons.push_back({id, texts[id].as<std::string>(), false});
    }
  } catch (const YAML::Exception& error) {
    return Error{path + ": " + error.what()};
  }
  return buttons;
}

struct Heard {
  Hearing hearing;
  bool cut = false;         ///< an utterance was cut out
  double worked = 0.0;      ///< [s] of the processor
  double recognized = 0.0;  ///< [s] of it in the recognizer
};

Result<Heard> hear(Recognizer& recognizer, const Clip& clip, const Room& room, std::uint64_t seed,
                   std::span<const Phrase> phrases) {
  const auto since = [](std::clock_t then) {
    return static_cast<double>(std::clock() - then) / CLOCKS_PER_SEC;
  };
  const auto microphone = at_microphone(clip.sound, room, seed);
  Heard heard;
  const std::clock_t begin = std::clock();
  const auto utterance = utterance_of(microphone);
  heard.cut = utterance.has_value();
  const std::clock_t ended = std::clock();
  if (utterance) {
    auto hearing = recognizer.hear(*utterance, phrases);
    if (!hearing) return Error{hearing.error()};
    heard.hearing = one_for_each_option(*hearing, phrases);
  }
  heard.recognized = since(ended);
  heard.worked = since(begin);
  return heard;
}

/// What was done then: the option that was answered, "stop" when the robot was halted, or nothing.
std::string deed(const Wishes& wishes) {
  if (wishes.halt) return std::string(kStop);
  return wishes.answer ? wishes.answer->option_id : "";
}

/// Who plays what when the robot asks back: the visitor answers truly, in the voices by turns;
/// foreign clips go on, the next one of the set.
class Replies {
 public:
  Replies(const Set& set, const std::vector<Clip>& yes_no) : set_(set) {
    for (const Clip& clip : yes_no) (clip.label == kYes ? yes_ : no_).push_back(&clip);
  }
  const Clip& true_one(const std::string& label, const std::string& asked, std::uint64_t turn) {
    const auto meant = std::find_if(set_.options.begin(), set_.options.end(),
                                    [&](const Option& option) { return option.id == label; });
    const auto& clips = meant != set_.options.end() && meant->label == asked ? yes_ : no_;
    return *clips[turn % clips.size()];
  }
  const Clip& foreign_after(std::size_t place) const {
    for (std::size_t i = 1; i < set_.clips.size(); ++i) {
      const Clip& clip = *set_.clips[(place + i) % set_.clips.size()];
      if (!offers(set_.phrases, clip.label)) return clip;
    }
    return *set_.clips[place];
  }

 private:
  const Set& set_;
  std::vector<const Clip*> yes_, no_;
};

/// A clip comes to a screen, through the conversation as it is in the component.
Status judge_clip(Score& score, const Set& set, std::size_t place, const Heard& first,
                  Replies& replies, Recognizer& recognizer) {
  const Clip& clip = *set.clips[place];
  const bool foreign = !offers(set.phrases, clip.label);
  Conversation talk{DecisionRule{}};
  talk.can_understand(true);
  talk.set_sentences({"{answer}", "", ""});
  Screen screen;
  screen.id = 1;
  screen.language = "en";
  screen.listens = set.listens;
  screen.options = set.options;
  talk.take(screen, {});
  static_cast<void>(talk.take_wishes());
  talk.heard(first.hearing, set.phrases, talk.phrases_id(), {});
  const bool asked = talk.asks();
  const std::string at_once = deed(talk.take_wishes());
  std::string after;
  std::size_t at = place;
  for (int i = 0; talk.asks() && i < kMostReplies; ++i) {
    const std::uint64_t turn = place + static_cast<std::uint64_t>(i);
    const Clip* reply = nullptr;
    if (foreign) {
      reply = &replies.foreign_after(at);
      at = static_cast<std::size_t>(std::find(set.clips.begin(), set.clips.end(), reply) -
                                    set.clips.begin());
    } else {
      reply = &replies.true_one(clip.label, talk.hint(), turn);
    }
    const auto phrases = talk.phrases();
    const auto heard = hear(recognizer, *reply, set.room, 1000 + turn, phrases);
    if (!heard) return Error{heard.error()};
    talk.heard(heard->hearing, phrases, talk.phrases_id(), {});
    after = deed(talk.take_wishes());
  }
  if (foreign) {
    ++score.foreign;
    score.foreign_acted += !at_once.empty();
    score.foreign_asked += asked;
    score.foreign_confirmed += !after.empty();
    score.foreign_stopped += at_once == kStop || after == kStop;
    return {};
  }
  ++score.words;
  score.unheard += !first.cut;
  const auto& guesses = first.hearing.candidates;
  score.first += !guesses.empty() && set.phrases[guesses[0].phrase].option_id == clip.label;
  score.acted_right += at_once == clip.label;
  score.acted_wrong +=
      (!at_once.empty() && at_once != clip.label) || (!after.empty() && after != clip.label);
  score.asked += asked;
  score.after_questions += after == clip.label;
  return {};
}

std::string ratio(int part, int whole) {
  if (whole == 0) return "";
  return std::to_string(part) + " of " + std::to_string(whole) +
         format(" (%.3f)", static_cast<double>(part) / whole);
}

void add_row(Table& table, const std::string& name, const Score& score) {
  table.add({name, ratio(score.first, score.words),
             ratio(score.acted_right + score.after_questions, score.words),
             std::to_string(score.unheard), std::to_string(score.acted_right),
             std::to_string(score.acted_wrong), std::to_string(score.asked),
             ratio(score.foreign_acted + score.foreign_confirmed, score.foreign),
             std::to_string(score.foreign_stopped), std::to_string(score.foreign_asked),
             std::to_string(score.foreign_confirmed)});
}

}  // namespace

Result<ResultSheet> run_voice_experiment(const ExperimentOptions& options) {
  if (options.data.empty())
    return Error{"no recordings: USHER_TEST_DATA must name a folder with speech/"};
  const fs::path folder = fs::path(options.data) / "speech";
  const auto commands = read_clips(folder / "commands", true);
  const auto digits = read_clips(folder / "fsdd", false);
  const auto micro = read_clips(folder / "micro_speech", false);
  for (const auto* clips : {&commands, &digits, &micro}) {
    if (!clips->ok()) return Error{clips->error()};
  }
  auto synthesizer = make_espeak();
  if (!synthesizer) return Error{synthesizer.error()};
  const auto recognizer = make_pocketsphinx(kSphinxModels);
  if (const Status loaded = recognizer->load(); !loaded) return Error{loaded.error()};
  const auto buttons = read_buttons(options.installation.share + "/config/dialogue/en.yaml");
  if (!buttons) return Error{buttons.error()};
  const auto said = synthesized(**synthesizer, *buttons);
  const Option yes_no[] = {{"yes", "Yes", false}, {"no", "No", false}};
  const auto said_yes_no = synthesized(**synthesizer, yes_no);
  std::vector<Option> on_the_way;
  for (const Option& button : *buttons) {
    if (std::find(kOnTheWay.begin(), kOnTheWay.end(), button.id) != kOnTheWay.end())
      on_the_way.push_back(button);
  }
  const auto said_on_the_way = synthesized(**synthesizer, on_the_way);
  for (const Option& button : *buttons) {
    if (button.id == kOnTheWayToo) on_the_way.push_back(button);
  }
  for (const auto* clips : {&said, &said_yes_no, &said_on_the_way}) {
    if (!clips->ok()) return Error{clips->error()};
  }

  std::vector<Set> sets;
  const Room rooms[] = {{"", {}}, {"_52dB", kFar}, {"_52dB_near", kNear}};
  for (const Room& room : rooms) {
    const auto add_set = [&](const char* name, std::vector<Option> screen) -> Set& {
      Set& set = sets.emplace_back();
      set.name = name + room.name;
      set.phrases = phrases_of(screen);
      set.options = std::move(screen);
      set.room = room;
      return set;
    };
    Set& ten = add_set("commands", options_of(kCommands));
    add(ten, *commands);
    add_foreign(ten, *micro);
    add_foreign(ten, *digits);
    Set& two = add_set("yes_no", options_of(kYesNo));
    add(two, *micro);
    add(two, *said_yes_no);
    add_foreign(two, *commands);
    Set& numbers = add_set("digits", options_of(kDigits));
    add(numbers, *digits);
    add_foreign(numbers, *commands);
    add_foreign(numbers, *micro);
    Set& all = add_set("buttons", *buttons);
    all.phrases = phrases_for(*buttons);
    add(all, *said);
    add_foreign(all, *commands);
    add_foreign(all, *micro);
    Set& way = add_set("on_the_way", on_the_way);
    way.phrases = phrases_for(on_the_way);
    way.listens = false;
    add(way, *said_on_the_way);
    add(way, *commands);  // a stop among them
    add_foreign(way, *micro);
  }
  const auto chosen = [&](const Set& set) { return set.name.starts_with(options.only); };
  if (std::none_of(sets.begin(), sets.end(), chosen))
    return wrong_only(options.only, names_of(sets));
  Table table({"set", "first guess", "understood", "not heard", "at once", "wrong", "asked back",
               "foreign acted on", "of them stops", "foreign asked", "foreign confirmed"});
  ResultSheet sheet;
  sheet.name = "voice";
  std::string csv = "set,held_out,label,heard,fit,second,behind\n";
  double seconds = 0.0, worked = 0.0;
  std::vector<double> latencies;
  for (const Set& set : sets) {
    if (!chosen(set)) continue;
    Score held_out, all;
    Replies replies(set, *said_yes_no);
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const Clip& clip = *set.clips[i];
      show_progress(set.name + " " + std::to_string(i + 1) + " of " +
                    std::to_string(set.clips.size()));
      const auto heard = hear(*recognizer, clip, set.room, i + 2, set.phrases);
      if (!heard) return Error{heard.error()};
      seconds += clip.sound.duration();
      worked += heard->worked;
      latencies.push_back(VoiceActivity::Settings{}.pause + heard->recognized);
      Score one;
      if (Status judged = judge_clip(one, set, i, *heard, replies, *recognizer); !judged)
        return Error{judged.error()};
      all += one;
      if (clip.held_out) held_out += one;
      const auto& candidates = heard->hearing.candidates;
      csv += set.name + (clip.held_out ? ",1," : ",0,") + clip.label + ",";
      if (!candidates.empty())
        csv += set.phrases[candidates[0].phrase].option_id + format(",%.2f", candidates[0].fit);
      else
        csv += ",";
      if (candidates.size() > 1)
        csv += "," + set.phrases[candidates[1].phrase].option_id +
               format(",%.2f", candidates[1].behind);
      else
        csv += ",,";
      csv += "\n";
    }
    add_row(table, set.name, all);
    if (held_out.words != all.words || held_out.foreign != all.foreign)
      add_row(table, set.name + ", held out", held_out);
    sheet.metrics[set.name + "_first"] = all.share_first();
    sheet.metrics[set.name + "_understood"] = all.share_understood();
    sheet.metrics[set.name + "_understood_held_out"] = held_out.share_understood();
    sheet.metrics[set.name + "_foreign_acted"] = all.share_foreign();
    sheet.targets[set.name + "_understood"] = {Bound::kAtLeast, 0.90};
    sheet.targets[set.name + "_foreign_acted"] = {Bound::kAtMost, 0.10};
  }
  show_progress("");
  sheet.metrics["core_seconds_per_second"] = worked / std::max(seconds, 1e-9);
  sheet.targets["core_seconds_per_second"] = {Bound::kAtMost, 0.3};
  if (!latencies.empty()) {
    std::sort(latencies.begin(), latencies.end());
    sheet.metrics["answer_after_p95"] =
        latencies[static_cast<std::size_t>(0.95 * static_cast<double>(latencies.size() - 1))];
    sheet.targets["answer_after_p95"] = {Bound::kAtMost, 0.5};
  }
  sheet.published["commands_first"] = 0.875;
  sheet.published["commands_foreign_acted"] = 0.62;
  sheet.input =
      "recordings of USHER_TEST_DATA/speech and five voices of espeak-ng, in a room that is heard "
      "2 s "
      "before and 1 s after, cut by VoiceActivity; noise: pink with a hum, 10.5 dB below the "
      "loudest "
      "0.2 s (62.5 dB at 1.25 m, noise 52 dB), near 16.9 dB (from 0.6 m); understood: at once or "
      "after at most two replies of a synthetic voice to questions back, heard in the same room; "
      "foreign acted on: at once, or asked about and then confirmed by the next foreign clips; "
      "answer_after: the pause that ends an utterance "
      "and the processor time of the recognizer";
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/sets.md", table.markdown());
  if (saved) saved = write_file(options.out + "/clips.csv", csv);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
