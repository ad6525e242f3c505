#include "interaction/speech/shell/component.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "interaction/speech/core/loudness.hpp"
#include "interaction/speech/shell/stream_microphone.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::speech {
namespace {

using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace state = usher_msgs::msg::SpeechStatus_Constants;

/// What the test hears and says; outlives the component.
struct Room {
  bool microphone = true, loudspeaker = true, models = true;
  int opened = 0;           ///< devices, or tried to
  int asked_too_early = 0;  ///< while that half of the card is being opened
  double voice = 0.0;       ///< {0..1} loudness of a visitor
  double hum = 20.0;        ///< peak of what always sounds
  Hearing hearing;          ///< what the recognizer will make of it
  std::vector<Phrase> listened_for;
  Sound recognized;         ///< the newest sound that the recognizer got
  double heard_peak = 0.0;  ///< of the loudspeaker
};

class FakeCard final : public SoundCard {
 public:
  explicit FakeCard(Room& room) : room_(room) {}
  Opening to_open_loudspeaker(const std::string&, int rate) override {
    rate_ = static_cast<std::size_t>(rate);
    loudspeaker_waits_ = true;
    return [this] {
      loudspeaker_waits_ = false;
      ++room_.opened;
      return room_.loudspeaker ? Status{} : Error{"no loudspeaker here"};
    };
  }
  Opening to_open_microphone(const std::string&) override {
    microphone_waits_ = true;
    return [this] {
      microphone_waits_ = false;
      ++room_.opened;
      return room_.microphone ? Status{} : Error{"no microphone here"};
    };
  }
  std::size_t room() override {
    room_.asked_too_early += loudspeaker_waits_ ? 1 : 0;
    return rate_ / 50;
  }
  Status write(std::span<const std::int16_t> samples) override {
    for (const auto sample : samples)
      room_.heard_peak = std::max(room_.heard_peak, std::abs(double{1} * sample));
    return {};
  }
  std::uint64_t unheard() override {
    room_.asked_too_early += loudspeaker_waits_ ? 1 : 0;
    return 0;
  }
  Status read(std::vector<std::int16_t>& samples) override {
    room_.asked_too_early += microphone_waits_ ? 1 : 0;
    if (!room_.microphone) return Error{"no microphone here"};
    for (int i = 0; i < 320; ++i) {
      samples.push_back(static_cast<std::int16_t>(room_.hum * std::sin(0.9 * at_) +
                                                  32000.0 * room_.voice * std::sin(0.1 * at_)));
      at_ += 1.0;
    }
    return {};
  }

 private:
  Room& room_;
  bool loudspeaker_waits_ = false, microphone_waits_ = false;  ///< to be open
  std::size_t rate_ = 8000;
  double at_ = 0.0;
};

class FakeRecognizer final : public Recognizer {
 public:
  explicit FakeRecognizer(Room& room) : room_(room) {}
  Status load() override { return room_.models ? Status{} : Error{"no models here"}; }
  Result<Hearing> hear(const Sound& sound, std::span<const Phrase> phrases) override {
    room_.recognized = sound;
    room_.listened_for.assign(phrases.begin(), phrases.end());
    return room_.hearing;
  }

 private:
  Room& room_;
};

class Speech : public testing::Test {
 protected:
  void start(double time = 2.0) {
    host_ = std::make_unique<runtime::TestHost>(
        runtime::ComponentFactory{"speech",
                                  [this](runtime::Host& host) {
                                    Equipment equipment{std::make_unique<FakeCard>(room_),
                                                        std::make_unique<NullSynthesizer>(),
                                                        std::make_unique<FakeRecognizer>(room_)};
                                    return std::unique_ptr<runtime::Component>(
                                        std::make_unique<SpeechComponent>(host,
                                                                          std::move(equipment)));
                                  }},
        "texts: " USHER_SOURCE_DIR "/config/dialogue/en.yaml");
    pass(time);
  }
  void pass(double time) {
    for (int i = 0; i < static_cast<int>(std::lround(time * 10.0)); ++i) {
      if (guide_) {
        usher_msgs::msg::GuideStatus guide;
        guide.header(wire::header(host_->now(), ""));
        guide.serves(serves_);
        host_->publish(topics::kGuideStatus, guide, "guide");
      }
      host_->run_for(milliseconds(100));
    }
  }
  void show(std::uint64_t id, const std::vector<std::string>& options,
            const std::string& spoken = "Where to?", const std::string& language = "en") {
    usher_msgs::msg::DialogueScreen screen;
    screen.id(id);
    screen.language(language);
    screen.spoken(spoken);
    screen.spoken_id(id);
    screen.listens(waits_);
    for (const auto& option : options) {
      auto& entry = screen.options().emplace_back();
      entry.id(option);
      entry.label(option);
    }
    host_->publish(topics::kDialogueScreen, screen, "guide");
    pass(0.1);
  }
  /// A visitor says something that the recognizer will take for this phrase.
  void say(std::size_t phrase, double fit) {
    room_.hearing = {{{phrase, fit, 0.0}, {phrase + 1, fit - 10.0, 10.0}}};
    room_.voice = 0.3;
    pass(0.6);
    room_.voice = 0.0;
    pass(1.0);
  }
  usher_msgs::msg::SpeechStatus status() { return host_->last(topics::kSpeechStatus).value(); }
  std::vector<usher_msgs::msg::DialogueAnswer> answers() {
    return host_->written(topics::kDialogueAnswer);
  }

  Room room_;
  bool guide_ = true, serves_ = false, waits_ = true;
  std::unique_ptr<runtime::TestHost> host_;
};

/// Somebody who plays into the microphone from the other end of a line, cut anywhere.
class Mouth final : public runtime::LockstepDevice {
 public:
  explicit Mouth(Room& room) : room_(room) {}
  runtime::Bytes answer(std::span<const std::uint8_t>) override { return {}; }
  runtime::Bytes speak(runtime::Time) override {
    runtime::Bytes bytes;
    for (int i = 0; i < 160; ++i) {  // of each 10 ms
      const auto sample =
          static_cast<std::uint16_t>(std::lround(32000.0 * room_.voice * std::sin(0.1 * at_)));
      bytes.push_back(static_cast<std::uint8_t>(sample & 0xFFU));
      bytes.push_back(static_cast<std::uint8_t>(sample >> 8U));
      at_ += 1.0;
    }
    const auto odd = static_cast<std::ptrdiff_t>(at_ / 160.0) % 2;
    runtime::Bytes now = std::exchange(kept_, {});
    now.insert(now.end(), bytes.begin(), bytes.end() - odd);
    kept_.assign(bytes.end() - odd, bytes.end());
    return now;
  }

 private:
  Room& room_;
  double at_ = 0.0;
  runtime::Bytes kept_;
};

TEST(SpeechWithAStream, HearsWhoPlaysIntoItAndGoesOnWithoutHim) {
  Room room;
  const auto mouth = std::make_shared<Mouth>(room);
  runtime::TestHost host(
      {"speech",
       [&](runtime::Host& made) {
         Equipment equipment{
             std::make_unique<StreamMicrophone>(made, std::make_unique<FakeCard>(room)),
             std::make_unique<NullSynthesizer>(), std::make_unique<FakeRecognizer>(room)};
         return std::unique_ptr<runtime::Component>(
             std::make_unique<SpeechComponent>(made, std::move(equipment)));
       }},
      "texts: " USHER_SOURCE_DIR "/config/dialogue/en.yaml\nmicrophone: listen://127.0.0.1:7432",
      mouth);
  const auto pass = [&](int tenths) {
    for (int i = 0; i < tenths; ++i) {
      usher_msgs::msg::GuideStatus guide;
      guide.header(wire::header(host.now(), ""));
      host.publish(topics::kGuideStatus, guide, "guide");
      host.run_for(milliseconds(100));
    }
  };
  pass(70);
  usher_msgs::msg::DialogueScreen screen;
  screen.id(5);
  screen.language("en");
  screen.listens(true);
  screen.options().emplace_back().id("yes");
  screen.options().back().label("Yes");
  host.publish(topics::kDialogueScreen, screen, "guide");
  pass(30);
  EXPECT_EQ(host.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
  room.hearing = {{{0, -10.0, 0.0}, {1, -20.0, 10.0}}};
  room.voice = 0.3;
  pass(6);
  room.voice = 0.0;
  pass(10);
  ASSERT_FALSE(host.written(topics::kDialogueAnswer).empty());
  EXPECT_EQ(host.written(topics::kDialogueAnswer)[0].option_id(), "yes");

  mouth->plugged = false;
  pass(10);
  EXPECT_FALSE(host.last(topics::kSpeechStatus)->understands());
  EXPECT_NE(host.heartbeat().reason().find("listen://127.0.0.1:7432"), std::string::npos)
      << host.heartbeat().reason();
  mouth->plugged = true;
  pass(70);
  EXPECT_TRUE(host.last(topics::kSpeechStatus)->understands()) << "whoever plays is back";
}

TEST_F(Speech, SaysTheScreenWithCaptionsAndTellsWhenItIsFinished) {
  start();
  show(5, {"yes", "no"}, "Would you like to see our location?");
  pass(0.3);
  EXPECT_EQ(status().state(), state::STATE_SPEAKING);
  EXPECT_EQ(status().spoken_id(), 5U);
  EXPECT_FALSE(status().finished());
  EXPECT_EQ(status().sentence(), "Would you like to see our location?");
  EXPECT_GT(status().word_length(), 0U);
  const auto word = status().word_begin();
  pass(1.0);
  EXPECT_GT(status().word_begin(), word);
  pass(2.0);
  EXPECT_TRUE(status().finished());
  EXPECT_EQ(status().sentence(), "");
  EXPECT_EQ(status().state(), state::STATE_LISTENING);
  EXPECT_GT(room_.heard_peak, 3000.0) << "the tone that says: I listen";
}

TEST_F(Speech, SpeaksAsFastAsTimePassesOnABusyMachine) {
  start();
  show(5, {"yes", "no"}, "Would you like to see our location?");  // 2.3 s
  for (int i = 0; i < 14; ++i) {
    host_->world().hang("speech", milliseconds(150));
    pass(0.2);
  }
  EXPECT_TRUE(status().finished());
}

TEST_F(Speech, TellsTheLevelWhileItSounds) {
  start();
  show(5, {"yes"}, "Hm");
  host_->clear();
  pass(1.0);
  float loudest = 0.0F;
  for (const auto& level : host_->written(topics::kSpeechLevel))
    loudest = std::max(loudest, level.level());
  EXPECT_GT(loudest, 0.5F) << "the tone";
  EXPECT_EQ(host_->last(topics::kSpeechLevel)->level(), 0.0F);
}

TEST_F(Speech, AnswersAsATouchWouldAndRepeatsUntilTheScreenNamesIt) {
  start();
  show(5, {"yes", "no"}, "Go?");
  pass(1.0);
  say(0, 0.0);
  ASSERT_FALSE(answers().empty());
  const auto answer = answers().back();
  EXPECT_EQ(answer.option_id(), "yes");
  EXPECT_EQ(answer.screen_id(), 5U);
  EXPECT_EQ(answer.client(), "speech");
  EXPECT_EQ(answer.input(), usher_msgs::msg::DialogueAnswer_Constants::INPUT_VOICE);
  EXPECT_EQ(status().heard(), "yes");
  const auto before = answers().size();
  EXPECT_GT(before, 2U) << "5 Hz";
  usher_msgs::msg::DialogueScreen reply;
  reply.id(6);
  reply.language("en");
  reply.answer_client("speech");
  reply.answer_id(answer.id());
  host_->publish(topics::kDialogueScreen, reply, "guide");
  pass(0.2);
  host_->clear();
  pass(1.0);
  EXPECT_TRUE(answers().empty());
}

TEST_F(Speech, AsksBackWhenUnsure) {
  start();
  show(5, {"library", "cafe"}, "Go?");
  pass(1.0);
  say(0, -25.0);
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(status().state(), state::STATE_ASKING);
  EXPECT_EQ(status().hint(), "Did you say \"library\"?");
  pass(3.0);
  ASSERT_EQ(room_.listened_for.front().option_id, "library");
  say(0, 0.0);  // the first phrase is "yes" now
  EXPECT_EQ(room_.listened_for.front().option_id, "yes");
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().back().option_id(), "library");
}

TEST_F(Speech, IgnoresForeignWords) {
  start();
  show(5, {"library", "cafe"}, "Go?");
  pass(1.0);
  say(0, -100.0);
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(status().state(), state::STATE_LISTENING);
  EXPECT_EQ(host_->counter("answers: ignored"), 1U);
}

TEST_F(Speech, BreaksOffItsSentenceWhenItUnderstoodSomebody) {
  start();
  show(5, {"yes", "no"}, std::string(200, 'a'));
  pass(1.0);
  EXPECT_EQ(status().state(), state::STATE_SPEAKING);
  say(0, 0.0);
  EXPECT_TRUE(status().finished());
  EXPECT_NE(status().state(), state::STATE_SPEAKING);
}

TEST_F(Speech, TellsThatItHearsAVoiceWhileItSpeaks) {
  start();
  show(5, {"yes", "no"}, std::string(200, 'a'));
  pass(1.0);
  EXPECT_FALSE(status().hears());
  room_.voice = 0.3;
  pass(0.3);
  EXPECT_EQ(status().state(), state::STATE_SPEAKING);
  EXPECT_TRUE(status().hears());
  room_.voice = 0.0;
  pass(0.6);
  EXPECT_FALSE(status().hears());
  room_.voice = 0.3;
  pass(0.3);
  EXPECT_TRUE(status().hears());
  room_.microphone = false;
  pass(0.1);
  EXPECT_FALSE(status().hears()) << "nobody is heard any more";
}

TEST_F(Speech, TellsOfNoVoiceWhereItDoesNotListen) {
  start();
  show(5, {"yes", "no"}, "Los?", "de");
  room_.voice = 0.3;
  pass(1.0);
  EXPECT_FALSE(status().listens());
  EXPECT_FALSE(status().hears());
}

TEST_F(Speech, StopsThroughTheSupervisorWhenTheGuideIsGone) {
  start();
  show(5, {"stop"}, "Go.");
  guide_ = false;
  pass(4.0);
  say(0, -25.0);
  const auto requests = host_->written(topics::kSupervisorRequest);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests.back().command(), command::COMMAND_STOP);
  EXPECT_TRUE(answers().empty());
}

TEST_F(Speech, RepeatsAStopUntilTheSupervisorIsBack) {
  start();
  show(5, {"stop"}, "Go.");
  guide_ = false;
  pass(4.0);
  say(0, -25.0);
  pass(3.0);
  const auto asked = host_->written(topics::kSupervisorRequest);
  ASSERT_GT(asked.size(), 10U);
  EXPECT_EQ(asked.front(), asked.back()) << "the same one";
  EXPECT_EQ(status().hint(), "Stopped. Say Start to go on.");
  usher_msgs::msg::SupervisorStatus supervisor;
  supervisor.last_request(asked.back().id());
  supervisor.last_request_client("speech");
  supervisor.stopped_by({"speech"});
  host_->publish(topics::kSupervisorStatus, supervisor, "supervisor");
  pass(0.5);
  host_->clear();
  pass(2.0);
  EXPECT_TRUE(host_->written(topics::kSupervisorRequest).empty());
}

TEST_F(Speech, StopsThroughTheSupervisorUnlessTheDialogueHasDoneIt) {
  namespace result = usher_msgs::msg::DialogueScreen_Constants;
  for (const auto what : {result::RESULT_DONE, result::RESULT_LATE}) {
    start();
    show(5, {"stop", "done"}, "Go.");
    pass(2.0);
    room_.hearing = {{{0, 0.0, 0.0}, {1, -10.0, 10.0}}};
    room_.voice = 0.3;
    pass(0.6);
    room_.voice = 0.0;
    for (int i = 0; i < 10 && answers().empty(); ++i) pass(0.1);
    ASSERT_FALSE(answers().empty());
    usher_msgs::msg::DialogueScreen reply;
    reply.id(6);
    reply.language("en");
    reply.answer_client("speech");
    reply.answer_id(answers().back().id());
    reply.answer_result(what);
    host_->publish(topics::kDialogueScreen, reply, "guide");
    pass(1.0);
    const auto requests = host_->written(topics::kSupervisorRequest);
    EXPECT_EQ(requests.empty(), what == result::RESULT_DONE) << "the robot has arrived before";
  }
}

TEST_F(Speech, HearsAStopThoughNoAnswerIsWaitedFor) {
  start();
  waits_ = false;
  show(5, {"stop", "library"}, "Go.");
  pass(2.0);
  EXPECT_EQ(status().state(), state::STATE_SILENT) << "whoever makes noise may";
  EXPECT_TRUE(status().listens());
  EXPECT_TRUE(status().understands());
  say(1, -25.0);
  say(1, 0.0);
  EXPECT_TRUE(answers().empty()) << "bystanders are left alone";
  EXPECT_EQ(status().state(), state::STATE_SILENT);
  say(0, -25.0);
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().back().option_id(), "stop");
}

TEST_F(Speech, ShowsItsStopAndLiftsItAtTheEndOfTheVisit) {
  start();
  serves_ = true;
  show(5, {"yes", "no"}, "Go?");
  pass(1.0);
  say(0, -100.0);
  ASSERT_FALSE(room_.listened_for.empty());
  const std::size_t last = room_.listened_for.size() - 1;
  ASSERT_EQ(room_.listened_for[last].option_id, "stop");
  say(last, -25.0);
  ASSERT_FALSE(host_->written(topics::kSupervisorRequest).empty());
  EXPECT_EQ(host_->last(topics::kSupervisorRequest)->command(), command::COMMAND_STOP);
  EXPECT_EQ(status().hint(), "Stopped. Say Start to go on.");
  host_->world().kill("speech");
  host_->world().start("speech");
  pass(3.0);
  show(5, {"yes", "no"}, "Go?");
  EXPECT_EQ(status().hint(), "Stopped. Say Start to go on.") << "a restart is no answer";
  EXPECT_EQ(host_->last(topics::kSupervisorRequest)->command(), command::COMMAND_STOP);
  serves_ = false;
  pass(1.0);
  EXPECT_EQ(host_->last(topics::kSupervisorRequest)->command(), command::COMMAND_MOVEMENT_ON);
  EXPECT_EQ(status().hint(), "");
}

TEST_F(Speech, SpeaksWithoutAMicrophoneAndSaysSo) {
  room_.microphone = false;
  start();
  show(5, {"yes", "no"}, "Go?");
  EXPECT_FALSE(status().listens());
  EXPECT_FALSE(status().understands());
  EXPECT_EQ(status().hint(), "Please touch the screen");
  EXPECT_TRUE(status().audible());
  EXPECT_EQ(host_->heartbeat().state(), 2) << "degraded";
  EXPECT_NE(host_->heartbeat().reason().find("no microphone here"), std::string::npos);
  room_.microphone = true;
  pass(6.0);
  EXPECT_TRUE(status().listens()) << "it is tried again each five seconds";
}

TEST_F(Speech, CaptionsGoOnWithoutALoudspeaker) {
  room_.loudspeaker = false;
  start();
  show(5, {"yes", "no"}, "Would you like to go?");
  pass(0.3);
  EXPECT_FALSE(status().audible());
  EXPECT_EQ(status().sentence(), "Would you like to go?");
  pass(3.0);
  EXPECT_TRUE(status().finished()) << "so nobody waits for it";
}

// A device that hangs must not hold the handlers.
TEST_F(Speech, OpensItsDevicesBesideTheHandlers) {
  start(0.0);
  host_->run_for(milliseconds(50));
  EXPECT_EQ(room_.opened, 0) << "after its first steps";
  EXPECT_FALSE(status().audible());
  pass(2.0);
  EXPECT_EQ(room_.opened, 2);
  show(5, {"yes", "no"}, "Would you like to go?");
  EXPECT_TRUE(status().audible());
  EXPECT_TRUE(status().understands());
  room_.microphone = false;
  pass(6.0);
  EXPECT_GT(room_.opened, 2) << "tried again";
  room_.microphone = true;
  pass(6.0);
  EXPECT_TRUE(status().understands());
  EXPECT_EQ(room_.asked_too_early, 0);
}

TEST_F(Speech, SpeaksWithoutModels) {
  room_.models = false;
  start();
  show(5, {"yes"}, "Go?");
  EXPECT_FALSE(status().listens());
  EXPECT_NE(host_->heartbeat().reason().find("no models here"), std::string::npos);
}

TEST_F(Speech, ListensToEnglishOnlyAndSaysSo) {
  start();
  show(5, {"yes"}, "Ja?", "de");
  EXPECT_FALSE(status().listens());
  EXPECT_NE(status().hint().find("Bildschirm"), std::string::npos) << status().hint();
}

TEST_F(Speech, CountsScreensWithAToneThatItDoesNotKnow) {
  start();
  usher_msgs::msg::DialogueScreen screen;
  screen.id(1);
  screen.tone(77);
  host_->publish(topics::kDialogueScreen, screen, "guide");
  pass(1.5);
  EXPECT_EQ(host_->counter("inputs: rejected"), 1U);
}

TEST(SpeechComponentAlone, RunsWithoutAnythingThatSounds) {
  runtime::TestHost host(runtime::component_factory<SpeechComponent>("speech"));
  host.run_for(std::chrono::seconds(2));
  EXPECT_TRUE(host.running());
  EXPECT_EQ(host.heartbeat().state(), 2);
}

TEST_F(Speech, KnowsTheRoomsNoiseBeforeItListens) {
  room_.hum = 3000.0;
  start();
  show(1, {"guide", "search"});
  pass(4.0);
  EXPECT_TRUE(status().understands());
  EXPECT_TRUE(room_.listened_for.empty()) << "a hum that was there before is no utterance";
}

TEST_F(Speech, SuppressesTheRoomsNoiseForWhoAnswersAtOnce) {
  room_.hum = 3000.0;
  start();
  show(1, {"guide", "search"});
  say(0, 0.0);
  ASSERT_GT(room_.recognized.duration(), 0.5);
  const double hum = 20.0 * std::log10(3000.0 / std::sqrt(2.0) / 32768.0);
  EXPECT_LT(loudness_db(std::span(room_.recognized.samples).first(kSpeechRate / 16)), hum - 12.0);
}

}  // namespace
}  // namespace usher::speech
