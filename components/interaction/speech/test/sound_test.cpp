#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "foundation/random/random.hpp"
#include "interaction/speech/core/loudness.hpp"
#include "interaction/speech/core/noise_suppressor.hpp"
#include "interaction/speech/core/player.hpp"
#include "interaction/speech/core/resample.hpp"
#include "interaction/speech/core/tones.hpp"
#include "interaction/speech/core/voice_activity.hpp"
#include "interaction/speech/core/wav_file.hpp"

namespace usher::speech {
namespace {

constexpr double kPi = std::numbers::pi;

Sound sine(double frequency, double duration, int rate, double peak = 10000.0) {
  Sound sound{rate, {}};
  for (int i = 0; i < static_cast<int>(duration * rate); ++i)
    sound.samples.push_back(
        static_cast<std::int16_t>(std::lround(peak * std::sin(2.0 * kPi * frequency * i / rate))));
  return sound;
}

/// Power of one frequency, against that of a full sine of this peak.
double share(const Sound& sound, double frequency, double peak = 10000.0) {
  double re = 0.0, im = 0.0;
  const auto n = static_cast<double>(sound.samples.size());
  for (std::size_t i = 0; i < sound.samples.size(); ++i) {
    const double phase = 2.0 * kPi * frequency * static_cast<double>(i) / sound.rate;
    re += sound.samples[i] * std::cos(phase);
    im += sound.samples[i] * std::sin(phase);
  }
  return 2.0 * std::hypot(re, im) / n / peak;
}

TEST(WavFile, ReadsWhatItWrote) {
  const Sound sound = sine(440.0, 0.3, 22050);
  const auto read = parse_wav(write_wav(sound));
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(read->rate, 22050);
  EXPECT_EQ(read->samples, sound.samples);
}

TEST(WavFile, AveragesChannelsAndTakesWhatIsThereOfACutFile) {
  auto bytes = write_wav({16000, {100, 300, -50, -150, 7, 9}});
  bytes[22] = 2;  // channels
  bytes.resize(bytes.size() - 1);
  const auto read = parse_wav(bytes);
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(read->samples, (std::vector<std::int16_t>{200, -100}));
}

TEST(WavFile, RefusesWhatItCannotReadAndSaysWhy) {
  auto bytes = write_wav(sine(440.0, 0.1, 16000));
  EXPECT_NE(parse_wav({}).error().find("RIFF"), std::string::npos);
  EXPECT_FALSE(parse_wav(std::span(bytes).first(40)).ok());
  auto coding = bytes;
  coding[20] = 3;  // floating point
  EXPECT_NE(parse_wav(coding).error().find("16 bit"), std::string::npos);
  auto channels = bytes;
  channels[22] = 0;
  EXPECT_NE(parse_wav(channels).error().find("channels"), std::string::npos);
  auto rate = bytes;
  rate[24] = 1, rate[25] = 0;
  EXPECT_NE(parse_wav(rate).error().find("rate"), std::string::npos);
  EXPECT_NE(read_wav_file("/nowhere.wav").error().find("/nowhere.wav"), std::string::npos);
}

TEST(WavFile, SurvivesEveryCutAndManyWrongBytes) {
  const auto bytes = write_wav(sine(440.0, 0.01, 16000));
  for (std::size_t n = 0; n < bytes.size(); ++n)
    static_cast<void>(parse_wav(std::span(bytes).first(n)).ok());
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    auto wrong = bytes;
    wrong[random.below(44)] = static_cast<std::uint8_t>(random.below(256));
    static_cast<void>(parse_wav(wrong).ok());
  }
}

TEST(Resample, KeepsTonesAndRemovesWhatTheNewRateCannotHold) {
  for (const int rate : {8000, 22050, 44100, 48000}) {
    const Sound out = resampled(sine(1000.0, 0.5, rate), 16000);
    EXPECT_EQ(out.rate, 16000);
    EXPECT_NEAR(out.duration(), 0.5, 1e-3) << rate;
    EXPECT_NEAR(share(out, 1000.0), 1.0, 0.02) << rate;
  }
  const Sound low = resampled(sine(6000.0, 0.5, 16000), 8000);
  EXPECT_LT(rms(low.samples), 0.003);  // of 0.216
  EXPECT_TRUE(resampled({8000, {}}, 16000).samples.empty());
}

TEST(Resample, GivesATelephoneBandItsMirrorOnly) {
  const Sound narrow = for_recognizer(sine(1000.0, 0.5, 8000));
  EXPECT_NEAR(share(narrow, 1000.0), 1.0, 0.03);
  EXPECT_NEAR(20.0 * std::log10(share(narrow, 7000.0)), -25.0, 1.5);
  EXPECT_LT(share(for_recognizer(sine(1000.0, 0.5, 22050)), 7000.0), 0.002);
}

TEST(Loudness, IsThatOfASine) {
  EXPECT_NEAR(loudness_db(sine(500.0, 0.1, 16000, 32767.0).samples), -3.01, 0.05);
  EXPECT_EQ(loudness_db({}), -100.0);
  EXPECT_EQ(level_of(-100.0), 0.0);
  EXPECT_EQ(level_of(0.0), 1.0);
  EXPECT_NEAR(level_of(-30.0), 0.5, 1e-12);
}

TEST(Tones, AreShortBoundedAndDifferent) {
  EXPECT_TRUE(tone(Tone::kNone, 22050).samples.empty());
  std::vector<Sound> all;
  for (int i = 1; i <= 5; ++i) {
    all.push_back(tone(static_cast<Tone>(i), 22050));
    const Sound& sound = all.back();
    EXPECT_GT(sound.duration(), 0.1);
    EXPECT_LT(sound.duration(), 0.6);
    EXPECT_LT(std::abs(sound.samples.front()), 50);
    EXPECT_LT(std::abs(sound.samples.back()), 50);
    int peak = 0;
    for (const auto sample : sound.samples) peak = std::max(peak, std::abs(int{sample}));
    EXPECT_NEAR(peak, 8231, 200);
    for (std::size_t k = 0; k + 1 < all.size(); ++k) EXPECT_NE(all[k].samples, sound.samples);
  }
}

Utterance utterance(std::uint64_t id, double seconds) {
  Utterance made;
  made.id = id;
  made.sentence = "Hello you";
  made.sound = sine(300.0, seconds, 8000);
  made.words = {{0, 5, 0.0}, {6, 3, seconds / 2}};
  return made;
}

void run(Player& player, double seconds) {
  std::vector<std::int16_t> part(80);
  for (int i = 0; i < static_cast<int>(std::lround(seconds * 100.0)); ++i) player.take(part);
}

TEST(Player, SaysOneAfterTheOtherAndTellsTheWordAndTheEnd) {
  Player player(8000);
  player.add(utterance(3, 1.0));
  player.add(utterance(4, 1.0));
  run(player, 0.3);
  ASSERT_TRUE(player.caption(0).has_value());
  EXPECT_EQ(player.caption(0)->id, 3U);
  EXPECT_EQ(player.caption(0)->word_begin, 0U);
  EXPECT_EQ(player.finished(0), 0U);
  EXPECT_NEAR(player.loudness(0), -13.3, 0.5);
  run(player, 0.4);
  EXPECT_EQ(player.caption(0)->word_begin, 6U);
  EXPECT_EQ(player.caption(4000)->word_begin, 0U) << "half a second is still on its way";
  run(player, 0.4);
  EXPECT_EQ(player.caption(0)->id, 4U);
  EXPECT_EQ(player.finished(0), 3U);
  EXPECT_EQ(player.finished(4000), 0U);
  run(player, 1.0);
  EXPECT_FALSE(player.caption(0).has_value());
  EXPECT_EQ(player.finished(0), 4U);
  EXPECT_FALSE(player.sounds(0));
  EXPECT_TRUE(player.sounds(4000));
}

TEST(Player, BreaksOffAtOnceAndDucks) {
  Player player(8000);
  player.add(utterance(3, 1.0));
  player.add(utterance(4, 1.0));
  run(player, 0.2);
  player.set_gain(0.25);
  run(player, 0.2);
  EXPECT_NEAR(player.loudness(0), -13.3 - 12.0, 0.5);
  player.break_off();
  run(player, 0.1);
  EXPECT_FALSE(player.sounds(0));
  EXPECT_EQ(player.finished(0), 3U);
  EXPECT_LT(player.loudness(0), -90.0);
}

TEST(Player, IsBoundedAndTakesEmptySounds) {
  Player player(8000);
  for (std::uint64_t i = 1; i < 1000; ++i) player.add(utterance(i, 0.0));
  player.add(utterance(1000, 0.1));
  run(player, 0.2);
  EXPECT_EQ(player.finished(0), 1000U);
  EXPECT_FALSE(player.busy());
}

/// A room: noise, and a voice or the robot in it.
class Room {
 public:
  std::optional<Sound> run(VoiceActivity& activity, double seconds, double voice_peak,
                           double robot_db, double coupling_db) {
    std::optional<Sound> ended;
    std::vector<std::int16_t> part(320);
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 50.0)); ++i) {
      const double robot =
          robot_db > -60.0 ? 32768.0 * std::pow(10.0, (robot_db + coupling_db) / 20.0) * 1.41 : 0.0;
      for (auto& sample : part) {
        ++at_;
        const double value = random_.uniform(-100.0, 100.0) +
                             voice_peak * std::sin(2.0 * kPi * 210.0 * at_ / 16000.0) +
                             robot * std::sin(2.0 * kPi * 330.0 * at_ / 16000.0);
        sample = static_cast<std::int16_t>(value);
      }
      if (auto utterance = activity.hear(part, robot_db)) ended = std::move(utterance);
    }
    return ended;
  }

 private:
  Random random_{1};
  double at_ = 0.0;
};

TEST(VoiceActivity, CutsAnUtteranceWithItsBeginningOutOfNoise) {
  VoiceActivity activity;
  Room room;
  EXPECT_FALSE(room.run(activity, 3.0, 0.0, -100.0, 0.0).has_value());
  EXPECT_FALSE(room.run(activity, 0.8, 4000.0, -100.0, 0.0).has_value());
  EXPECT_TRUE(activity.voice());
  const auto utterance = room.run(activity, 0.6, 0.0, -100.0, 0.0);
  ASSERT_TRUE(utterance.has_value());
  EXPECT_GT(utterance->duration(), 0.8 + 0.25);
  EXPECT_LT(utterance->duration(), 0.8 + 0.25 + 0.3 + 0.5);
}

TEST(VoiceActivity, TakesNoClickForAVoiceAndEndsAnEndlessOne) {
  VoiceActivity activity;
  Room room;
  room.run(activity, 1.0, 0.0, -100.0, 0.0);
  room.run(activity, 0.06, 9000.0, -100.0, 0.0);
  EXPECT_FALSE(room.run(activity, 1.0, 0.0, -100.0, 0.0).has_value());
  const auto endless = room.run(activity, 6.0, 9000.0, -100.0, 0.0);
  ASSERT_TRUE(endless.has_value());
  EXPECT_LE(endless->duration(), VoiceActivity::kLongest + 0.02);
}

TEST(VoiceActivity, DoesNotHearTheRobotButWhoSpeaksOverIt) {
  VoiceActivity activity;
  Room room;
  room.run(activity, 2.0, 0.0, -100.0, 0.0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(room.run(activity, 1.0, 0.0, -20.0, -15.0).has_value());
    EXPECT_FALSE(activity.voice());
  }
  EXPECT_NEAR(activity.echo_db(), -15.0, 1.5) << "learnt while it spoke";
  room.run(activity, 0.5, 9000.0, -20.0, -15.0);
  EXPECT_TRUE(activity.voice());
}

/// Noise that is stronger at low frequencies, as fans make it, a sine of 700 Hz in it.
std::optional<Sound> hear_in_noise(VoiceActivity& activity, Random& random, double seconds,
                                   double noise_peak, double voice_peak) {
  std::optional<Sound> ended;
  std::vector<std::int16_t> part(320);
  double at = 0.0, noise = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds * 50.0)); ++i) {
    for (auto& sample : part) {
      at += 1.0;
      noise = 0.9 * noise + random.uniform(-noise_peak, noise_peak);
      sample = static_cast<std::int16_t>(noise +
                                         voice_peak * std::sin(2.0 * kPi * 700.0 * at / 16000.0));
    }
    if (auto utterance = activity.hear(part, -100.0)) ended = std::move(utterance);
  }
  return ended;
}

double first_loudness(const Sound& sound) {
  return loudness_db(std::span(sound.samples).first(kSpeechRate / 8));
}

TEST(NoiseSuppressor, PressesDownWhatIsSteady) {
  NoiseSuppressor suppressor;
  Random random(1);
  std::vector<std::int16_t> block(NoiseSuppressor::kBlock);
  double before = 0.0;
  for (int i = 0; i < 150; ++i) {
    for (auto& sample : block) sample = static_cast<std::int16_t>(random.uniform(-3000.0, 3000.0));
    before = loudness_db(block);
    suppressor.suppress(block);
  }
  EXPECT_LT(loudness_db(block), before - 15.0);
}

TEST(VoiceActivity, HearsAVoiceFiveDecibelsAboveTheNoiseAndItsEnd) {
  VoiceActivity activity;
  Random random(1);
  EXPECT_FALSE(hear_in_noise(activity, random, 4.0, 1000.0, 0.0).has_value());
  EXPECT_FALSE(hear_in_noise(activity, random, 0.5, 1000.0, 3300.0).has_value());
  EXPECT_TRUE(activity.voice());
  const auto utterance = hear_in_noise(activity, random, 0.5, 1000.0, 0.0);
  ASSERT_TRUE(utterance.has_value());
  EXPECT_LT(utterance->duration(), 0.5 + 0.25 + 0.3 + 0.4);
}

TEST(VoiceActivity, SuppressesTheNoiseAroundAVoiceThatIsNotFarAboveIt) {
  Random random(1);
  for (const double voice : {5000.0, 30000.0}) {
    VoiceActivity activity;
    const double noise_peak = voice == 5000.0 ? 900.0 : 100.0;
    const double noise = 20.0 * std::log10(noise_peak * 2.294 / std::sqrt(3.0) / 32768.0);
    hear_in_noise(activity, random, 4.0, noise_peak, 0.0);
    hear_in_noise(activity, random, 0.5, noise_peak, voice);
    const auto utterance = hear_in_noise(activity, random, 0.6, noise_peak, 0.0);
    ASSERT_TRUE(utterance.has_value());
    if (voice == 5000.0)
      EXPECT_LT(first_loudness(*utterance), noise - 12.0);
    else
      EXPECT_NEAR(first_loudness(*utterance), noise, 1.0) << "as it was heard";
    if (voice == 5000.0)
      EXPECT_GT(utterance->duration(), 0.5 + 0.25 + 0.25) << "fricatives are hidden around it";
    else
      EXPECT_NEAR(utterance->duration(), 0.5 + 0.2 + 0.15, 0.06) << "with little of the room";
  }
}

TEST(VoiceActivity, TakesTheRobotsOwnVoiceForNoBackground) {
  VoiceActivity activity;
  Room room;
  room.run(activity, 2.0, 0.0, -100.0, 0.0);
  const double background = activity.background_db();
  room.run(activity, 6.0, 0.0, -20.0, -15.0);
  EXPECT_NEAR(activity.background_db(), background, 0.5);
  room.run(activity, 0.8, 0.0, -100.0, 0.0);
  room.run(activity, 0.4, 1000.0, -100.0, 0.0);
  EXPECT_TRUE(activity.voice()) << "who answers right after the question";
}

}  // namespace
}  // namespace usher::speech
