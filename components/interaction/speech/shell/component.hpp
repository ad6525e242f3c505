#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "interaction/phrases/core/phrase_file.hpp"
#include "interaction/speech/core/conversation.hpp"
#include "interaction/speech/core/voice_activity.hpp"
#include "interaction/speech/shell/equipment.hpp"
#include "runtime/api/host.hpp"
#include "wire/keeper.hpp"
#include "wire/repeater.hpp"

namespace usher::speech {

/// Says what the dialogue says, and takes spoken answers.
class SpeechComponent final : public runtime::Component {
 public:
  /// Without anything that sounds or hears.
  explicit SpeechComponent(runtime::Host& host);
  SpeechComponent(runtime::Host& host, Equipment equipment);

 private:
  struct Settings {
    std::string loudspeaker, microphone;
    double volume = 1.0;
    Synthesizer::Settings voice;
    DecisionRule rule;
    VoiceActivity::Settings activity;
  };
  static Settings read_settings(runtime::Host& host);

  Time now() const { return host_.now().time_since_epoch(); }
  void load();
  void take_screen(const usher_msgs::msg::DialogueScreen& screen);
  void tick(std::uint64_t skipped);
  void play();
  void hear();
  void fulfil();
  void say_next();
  void recognize_next();
  void ask_supervisor(std::uint8_t command);
  void open_devices();
  void open_loudspeaker();
  void open_microphone();
  std::uint64_t unheard() { return loudspeaker_opens_ ? 0 : card_->unheard(); }
  usher_msgs::msg::SpeechStatus status();
  void report();

  runtime::Host& host_;
  Settings settings_;
  phrases::PhraseBook texts_;
  Conversation conversation_;
  VoiceActivity activity_;
  std::shared_ptr<SoundCard> card_;
  std::shared_ptr<Synthesizer> synthesizer_;
  std::shared_ptr<Recognizer> recognizer_;  ///< null: nothing is understood
  Player player_;
  std::string loudspeaker_trouble_, microphone_trouble_, voice_trouble_, models_trouble_;
  bool models_ready_ = false;
  bool loudspeaker_opens_ = false, microphone_opens_ = false;  ///< beside the handlers

  std::deque<Wishes::Say> to_say_;
  bool synthesizing_ = false;
  std::uint64_t said_epoch_ = 0;  ///< what was asked for before a break-off is not said any more
  std::uint64_t spoken_id_ = 0, finished_id_ = 0;
  struct Heard {
    Sound sound;
    std::vector<Phrase> phrases;
    std::uint64_t phrases_id = 0;
  };
  std::deque<Heard> to_recognize_;
  bool recognizing_ = false;

  std::vector<std::int16_t> out_, in_;
  usher_msgs::msg::SpeechStatus reported_;
  std::uint64_t ticks_ = 0;
  bool level_was_zero_ = false;
  std::uint64_t& understood_;
  std::uint64_t& ignored_;
  std::uint64_t& rejected_;
  wire::Keeper memory_;  ///< that a spoken stop holds
  runtime::Input<usher_msgs::msg::DialogueScreen> screen_;
  runtime::Input<usher_msgs::msg::GuideStatus> guide_;
  runtime::Input<usher_msgs::msg::MeetingStatus> meeting_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Output<usher_msgs::msg::SpeechStatus> status_output_;
  runtime::Output<usher_msgs::msg::SpeechLevel> level_output_;
  wire::Repeater<usher_msgs::msg::DialogueAnswer> answers_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  runtime::Timer timer_;
};

}  // namespace usher::speech
