#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "interaction/speech/core/wav_file.hpp"
#include "interaction/speech/engine/espeak.hpp"
#include "interaction/speech/engine/pocketsphinx.hpp"
#include "interaction/speech/engine/sound_cards.hpp"

namespace usher::speech {
namespace {

/// Both engines are slow to load: once for all tests.
class Engines : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto made = make_espeak();
    ASSERT_TRUE(made.ok()) << made.error();
    voice_ = std::move(made).value().release();
    ear_ = make_pocketsphinx(kSphinxModels).release();
    const Status loaded = ear_->load();
    ASSERT_TRUE(loaded.ok()) << loaded.error();
  }
  static void TearDownTestSuite() {
    delete voice_;
    delete ear_;
  }
  static Sound say(const std::string& text, const std::string& language = "en") {
    auto said = voice_->say(text, language, {});
    EXPECT_TRUE(said.ok()) << said.error();
    return said.ok() ? std::move(said->sound) : Sound{};
  }
  static std::string heard(const std::string& text, std::span<const Phrase> phrases) {
    const auto hearing = ear_->hear(say(text), phrases);
    EXPECT_TRUE(hearing.ok()) << hearing.error();
    if (!hearing.ok() || hearing->candidates.empty()) return "";
    return phrases[hearing->candidates.front().phrase].option_id;
  }

  static Synthesizer* voice_;
  static Recognizer* ear_;
};
Synthesizer* Engines::voice_ = nullptr;
Recognizer* Engines::ear_ = nullptr;

TEST_F(Engines, SayEveryLanguageWithWordsInOrder) {
  for (const char* language : {"en", "de", "fr", "mi"}) {
    const std::string text = "Tēnā koe, MARVIN 42.";
    const auto said = voice_->say(text, language, {});
    ASSERT_TRUE(said.ok()) << said.error();
    EXPECT_GT(said->sound.duration(), 0.5) << language;
    ASSERT_GE(said->words.size(), 4U) << language;
    EXPECT_EQ(text.substr(said->words[0].begin, said->words[0].length), "Tēnā") << language;
    double time = 0.0;
    for (const Word& word : said->words) {
      EXPECT_LE(word.begin + word.length, text.size());
      EXPECT_GE(word.time, time);
      time = word.time;
    }
    EXPECT_LT(time, said->sound.duration());
  }
  EXPECT_NE(voice_->say("Hello", "xx", {}).error().find("xx"), std::string::npos);
}

TEST_F(Engines, SpeakFasterWhenAsked) {
  Synthesizer::Settings fast;
  fast.words_per_minute = 250.0;
  const auto slow_one = voice_->say("Where would you like to go?", "en", {});
  const auto fast_one = voice_->say("Where would you like to go?", "en", fast);
  ASSERT_TRUE(slow_one.ok() && fast_one.ok());
  EXPECT_LT(fast_one->sound.duration(), 0.75 * slow_one->sound.duration());
}

TEST_F(Engines, UnderstandOneAnother) {
  const Option options[] = {{"guide", "Guide me", false},
                            {"where", "Where is …", false},
                            {"lab", "Robotics lab", false},
                            {"yes", "Yes", false},
                            {"cancel", "Cancel", false}};
  const auto phrases = phrases_for(options);
  EXPECT_EQ(heard("Guide me", phrases), "guide");
  EXPECT_EQ(heard("Robotics lab", phrases), "lab");
  EXPECT_EQ(heard("Yes", phrases), "yes");
  EXPECT_EQ(heard("Cancel", phrases), "cancel");
  EXPECT_EQ(heard("Stop", phrases), "stop");
}

TEST_F(Engines, TellForeignWordsFromAnswers) {
  const Option options[] = {{"lab", "Robotics lab", false}, {"cancel", "Cancel", false}};
  const auto phrases = phrases_for(options);
  const auto right = ear_->hear(say("Robotics lab"), phrases);
  const auto wrong = ear_->hear(say("It will be rainy tomorrow"), phrases);
  ASSERT_TRUE(right.ok() && wrong.ok());
  ASSERT_FALSE(right->candidates.empty());
  EXPECT_NE(judge(*wrong, DecisionRule{}), Verdict::kAct);
  if (!wrong->candidates.empty()) {
    EXPECT_LT(wrong->candidates.front().fit, right->candidates.front().fit - 10.0);
  }
}

TEST_F(Engines, AreSilentAboutNothing) {
  const Option options[] = {{"lab", "Robotics lab", false}};
  const auto phrases = phrases_for(options);
  for (const double duration : {0.0, 0.01, 0.05, 1.0}) {
    const Sound silence{16000,
                        std::vector<std::int16_t>(static_cast<std::size_t>(16000 * duration))};
    const auto hearing = ear_->hear(silence, phrases);
    ASSERT_TRUE(hearing.ok()) << hearing.error();
    EXPECT_NE(judge(*hearing, DecisionRule{}), Verdict::kAct) << duration;
  }
  EXPECT_TRUE(ear_->hear(say("Yes"), {})->candidates.empty());
  const Phrase unknown[] = {{"x", "Xqzt", "xqzt"}};
  EXPECT_TRUE(ear_->hear(say("Yes"), unknown)->candidates.empty()) << "no such word in English";
}

TEST(PocketSphinx, SaysWhichModelIsMissing) {
  const Status status = make_pocketsphinx("/nowhere")->load();
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().find("/nowhere"), std::string::npos);
  EXPECT_FALSE(make_pocketsphinx("/nowhere")->hear({}, {}).ok());
}

TEST(SoundCard, IsTwoFilesWhereNoneIsWanted) {
  const auto folder = std::filesystem::path(testing::TempDir());
  const std::string microphone = folder / "usher_microphone.wav";
  const std::string loudspeaker = folder / "usher_loudspeaker.wav";
  const std::vector<std::int16_t> said(500, 1234);
  ASSERT_TRUE(write_wav_file(microphone, {16000, said}).ok());
  {
    const auto card = make_sound_card();
    ASSERT_TRUE(card->to_open_microphone(microphone)().ok());
    ASSERT_TRUE(card->to_open_loudspeaker(loudspeaker, 22050)().ok());
    std::vector<std::int16_t> heard;
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(card->read(heard).ok());
    ASSERT_EQ(heard.size(), 960U) << "20 ms each time";
    EXPECT_EQ(heard[499], 1234);
    EXPECT_EQ(heard[500], 0);
    EXPECT_EQ(card->room(), 441U);
    ASSERT_TRUE(card->write(said).ok());
  }
  const auto written = read_wav_file(loudspeaker);
  ASSERT_TRUE(written.ok()) << written.error();
  EXPECT_EQ(written->samples, said);
  EXPECT_EQ(written->rate, 22050);
}

TEST(SoundCard, NamesTheDeviceThatIsNotThere) {
  const auto card = make_sound_card();
  EXPECT_NE(card->to_open_microphone("hw:77")().error().find("hw:77"), std::string::npos);
  EXPECT_NE(card->to_open_loudspeaker("hw:77", 22050)().error().find("hw:77"), std::string::npos);
  EXPECT_FALSE(card->to_open_microphone("none")().ok());
  EXPECT_FALSE(card->to_open_microphone("/nowhere.wav")().ok());
  EXPECT_TRUE(card->to_open_loudspeaker("none", 22050)().ok());
}

}  // namespace
}  // namespace usher::speech
