#include "interaction/speech/engine/pocketsphinx.hpp"

#include <pocketsphinx.h>
#include <sphinxbase/err.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <sstream>

#include "interaction/speech/core/resample.hpp"

namespace usher::speech {

namespace {

constexpr const char* kScreen = "screen";
constexpr const char* kSounds = "sounds";
constexpr int kMostPaths = 200;              // of the list of best paths
constexpr std::size_t kMostCandidates = 12;  // three buttons with four ways to say each
constexpr double kShortest = 0.1;            // [s] of an utterance

constexpr std::array kPhones{"AA", "AE", "AH", "AO", "AW", "AY", "B",  "CH", "D",  "DH",
                             "EH", "ER", "EY", "F",  "G",  "HH", "IH", "IY", "JH", "K",
                             "L",  "M",  "N",  "NG", "OW", "OY", "P",  "R",  "S",  "SH",
                             "T",  "TH", "UH", "UW", "V",  "W",  "Y",  "Z",  "ZH"};

struct Decoded {
  std::string words;
  double score = 0.0;  ///< of the whole path
  int frames = 0;      ///< of words, silence left out
};

/// "four(2) one" -> "four one": without the numbers of the pronunciations.
std::string plain(const char* hypothesis) {
  std::string text;
  for (const char* c = hypothesis; *c != '\0'; ++c) {
    if (*c == '(') {
      while (*c != '\0' && *c != ')') ++c;
      if (*c == '\0') break;
    } else {
      text += *c;
    }
  }
  return text;
}

class PocketSphinx final : public Recognizer {
 public:
  explicit PocketSphinx(std::string models) : models_(std::move(models)) {}
  PocketSphinx(const PocketSphinx&) = delete;
  PocketSphinx& operator=(const PocketSphinx&) = delete;
  ~PocketSphinx() override {
    if (decoder_ != nullptr) ps_free(decoder_);
    if (config_ != nullptr) cmd_ln_free_r(config_);
  }

  Status load() override {
    const std::string acoustic = models_ + "/en-us";
    const std::string dictionary = models_ + "/cmudict-en-us.dict";
    for (const std::string& path : {acoustic + "/mdef", dictionary}) {
      if (!std::filesystem::exists(path))
        return Error{"expected a model of PocketSphinx, got no " + path +
                     " (package pocketsphinx-en-us)"};
    }
    err_set_logfp(nullptr);
    // All senones are computed, so that the scores of two searches have one measure.
    config_ =
        cmd_ln_init(nullptr, ps_args(), TRUE, "-hmm", acoustic.c_str(), "-dict", dictionary.c_str(),
                    "-logfn", "/dev/null", "-bestpath", "no", "-compallsen", "yes", "-silprob",
                    "0.1", "-remove_silence", "no", nullptr);
    if (config_ != nullptr) decoder_ = ps_init(config_);
    if (decoder_ == nullptr) return Error{"PocketSphinx does not take the models in " + models_};
    std::string loop;
    for (const char* phone : kPhones) {
      const std::string word = std::string("_") + phone;
      ps_add_word(decoder_, word.c_str(), phone, FALSE);
      loop += (loop.empty() ? "" : " | ") + word;
    }
    return use(kSounds, "#JSGF V1.0;\ngrammar sounds;\npublic <sounds> = (" + loop + ")+;\n");
  }

  Result<Hearing> hear(const Sound& sound, std::span<const Phrase> phrases) override {
    if (decoder_ == nullptr) return Error{"PocketSphinx has no models yet"};
    if (Status listening = listen_for(phrases); !listening) return Error{listening.error()};
    Hearing hearing;
    hearing.in_noise = sound.suppressed;
    if (understood_.empty() || sound.duration() < kShortest) return hearing;
    const auto samples = for_recognizer(sound).samples;
    if (Status decoded = decode(kSounds, samples); !decoded) return Error{decoded.error()};
    const double any_sounds = path().score;
    if (Status decoded = decode(kScreen, samples); !decoded) return Error{decoded.error()};
    const Decoded best = path();
    if (best.words.empty() || best.frames == 0) return hearing;
    const double frames = std::max(1, ps_get_n_frames(decoder_));
    const double fit = (best.score - any_sounds) / best.frames;
    std::map<std::size_t, double> scores = alternatives(best);
    const auto first = understood_.find(best.words);
    if (first == understood_.end()) return hearing;
    scores[first->second] = best.score;
    for (const auto& [phrase, score] : scores) {
      const double behind = std::max(0.0, (best.score - score) / frames);
      hearing.candidates.push_back({phrase, fit - behind * frames / best.frames, behind});
    }
    std::sort(hearing.candidates.begin(), hearing.candidates.end(),
              [&](const auto& a, const auto& b) {
                if (a.behind != b.behind) return a.behind < b.behind;
                return (a.phrase == first->second) > (b.phrase == first->second);
              });
    if (hearing.candidates.size() > kMostCandidates) hearing.candidates.resize(kMostCandidates);
    return hearing;
  }

 private:
  Status use(const char* name, const std::string& grammar) {
    if (ps_set_jsgf_string(decoder_, name, grammar.c_str()) != 0)
      return Error{"PocketSphinx does not take the grammar '" + std::string(name) + "'"};
    return {};
  }

  bool known(const std::string& words) {
    std::istringstream list(words);
    for (std::string word; list >> word;) {
      char* pronunciation = ps_lookup_word(decoder_, word.c_str());
      if (pronunciation == nullptr) return false;
      ckd_free(pronunciation);
    }
    return true;
  }

  Status listen_for(std::span<const Phrase> phrases) {
    if (std::equal(phrases.begin(), phrases.end(), phrases_.begin(), phrases_.end())) return {};
    phrases_.assign(phrases.begin(), phrases.end());
    understood_.clear();
    std::vector<Phrase> usable;
    for (std::size_t i = 0; i < phrases_.size(); ++i) {
      if (!known(phrases_[i].words)) continue;
      usable.push_back(phrases_[i]);
      understood_.emplace(phrases_[i].words, i);
    }
    return usable.empty() ? Status{} : use(kScreen, jsgf(usable));
  }

  Status decode(const char* search, const std::vector<std::int16_t>& samples) {
    if (ps_set_search(decoder_, search) != 0 || ps_start_utt(decoder_) != 0 ||
        ps_process_raw(decoder_, samples.data(), samples.size(), FALSE, TRUE) < 0 ||
        ps_end_utt(decoder_) != 0)
      return Error{"PocketSphinx failed in the search '" + std::string(search) + "'"};
    return {};
  }

  Decoded path() {
    Decoded decoded;
    std::int32_t score = 0;
    const char* hypothesis = ps_get_hyp(decoder_, &score);
    if (hypothesis == nullptr) return decoded;
    decoded.words = plain(hypothesis);
    decoded.score = score;
    for (ps_seg_t* segment = ps_seg_iter(decoder_); segment != nullptr;
         segment = ps_seg_next(segment)) {
      int begin = 0, end = 0;
      ps_seg_frames(segment, &begin, &end);
      const char first = ps_seg_word(segment)[0];
      if (first != '<' && first != '[' && first != '(') decoded.frames += end - begin + 1;
    }
    return decoded;
  }

  /// Scores of other phrases, moved so that the best path has its own.
  std::map<std::size_t, double> alternatives(const Decoded& best) {
    std::map<std::size_t, double> scores;
    ps_nbest_t* paths = ps_nbest(decoder_);
    for (int i = 0; paths != nullptr && i < kMostPaths; ++i) {
      std::int32_t score = 0;
      const char* hypothesis = ps_nbest_hyp(paths, &score);
      const auto found =
          hypothesis == nullptr ? understood_.end() : understood_.find(plain(hypothesis));
      if (found != understood_.end()) {
        const auto [entry, added] = scores.emplace(found->second, score);
        if (!added) entry->second = std::max(entry->second, static_cast<double>(score));
      }
      paths = ps_nbest_next(paths);
    }
    if (paths != nullptr) ps_nbest_free(paths);
    const auto own = understood_.find(best.words);
    double reference = best.score;
    if (own != understood_.end() && scores.count(own->second) > 0) reference = scores[own->second];
    for (auto& [phrase, score] : scores) score += best.score - reference;
    return scores;
  }

  std::string models_;
  cmd_ln_t* config_ = nullptr;
  ps_decoder_t* decoder_ = nullptr;
  std::vector<Phrase> phrases_;
  std::map<std::string, std::size_t> understood_;  ///< words to places in phrases_
};

}  // namespace

std::unique_ptr<Recognizer> make_pocketsphinx(const std::string& models) {
  return std::make_unique<PocketSphinx>(models);
}

}  // namespace usher::speech
