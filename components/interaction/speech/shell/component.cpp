#include "interaction/speech/shell/component.hpp"

#include <cmath>

#include "foundation/text/shortened.hpp"
#include "interaction/phrases/shell/read_phrases.hpp"
#include "interaction/speech/core/loudness.hpp"
#include "wire/conversions.hpp"
#include "wire/own_stop.hpp"

namespace usher::speech {

namespace {

using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace state = usher_msgs::msg::SpeechStatus_Constants;

constexpr auto kStep = milliseconds(20);
constexpr auto kDialogueAge = milliseconds(3000);
constexpr std::size_t kStepsPerSecond = 50;
constexpr std::uint64_t kLevelEvery = 2;    // steps: 25 Hz
constexpr std::uint64_t kStatusEvery = 25;  // steps, when nothing changes: 2 Hz
constexpr std::uint64_t kMostSkipped = 50;  // steps that are made up for: 1 s
constexpr std::uint64_t kRetryEvery = 250;  // steps between two tries to open a device: 5 s
constexpr std::size_t kMostJobs = 4;        // that wait for voice or recognizer
constexpr double kDucked = 0.25;            // of the volume, while somebody speaks
constexpr auto kOpenTime = milliseconds(50);
constexpr auto kLoadTime = milliseconds(1000);
constexpr auto kSynthesisTime = milliseconds(30);
constexpr auto kRecognitionTime = milliseconds(120);
constexpr std::size_t kMostWords = 400;  // [byte] of a text
constexpr const char* kHoldKey = "holds";

}  // namespace

SpeechComponent::Settings SpeechComponent::read_settings(runtime::Host& host) {
  auto& parameters = host.parameters();
  Settings settings;
  settings.loudspeaker =
      parameters.text("loudspeaker", "default", "ALSA device, a file that ends in .wav, or none.");
  settings.microphone = parameters.text(
      "microphone", "default",
      "ALSA device, a file that ends in .wav, a stream into which somebody plays samples of 16 bit "
      "and 16 kHz (listen://127.0.0.1:7432), or none.");
  settings.volume = parameters.number("volume", "-", {0.0, 1.0}, 0.8, "Of the robot's voice.");
  settings.voice.voice = parameters.text(
      "voice", "", "Variant of espeak-ng, for example m3 or f2; empty = the language's own.");
  settings.voice.words_per_minute =
      parameters.number("words_per_minute", "-", {80.0, 300.0}, 150.0, "How fast it speaks.");
  settings.voice.pitch = parameters.number("pitch", "-", {0.0, 100.0}, 45.0, "How high it speaks.");
  DecisionRule& rule = settings.rule;
  rule.act_fit = parameters.number("act_fit", "-", {-200.0, 50.0}, rule.act_fit,
                                   "Fit to a phrase from which on an answer is taken; per frame.");
  rule.act_margin = parameters.number("act_margin", "-", {0.0, 50.0}, rule.act_margin,
                                      "Distance to the second phrase that this needs; per frame.");
  rule.ask_fit = parameters.number("ask_fit", "-", {-200.0, 50.0}, rule.ask_fit,
                                   "Fit from which on it asks back; less is ignored.");
  rule.noise_fit = parameters.number("noise_fit", "-", {0.0, 50.0}, rule.noise_fit,
                                     "So much more fit it takes to act on what was said in noise.");
  rule.noise_margin = parameters.number("noise_margin", "-", {0.0, 50.0}, rule.noise_margin,
                                        "The same for the distance to the second phrase.");
  rule.stop_fit = parameters.number("stop_fit", "-", {-200.0, 50.0}, rule.stop_fit,
                                    "Fit from which on a stop is taken.");
  rule.yes_fit = parameters.number("yes_fit", "-", {-200.0, 50.0}, rule.yes_fit,
                                   "Fit from which on a yes to a question back is taken.");
  VoiceActivity::Settings& activity = settings.activity;
  activity.over_noise = parameters.number("over_noise", "-", {2.0, 40.0}, activity.over_noise,
                                          "Decibels that a voice is above the background's mean.");
  activity.over_echo =
      parameters.number("over_echo", "-", {3.0, 40.0}, activity.over_echo,
                        "Decibels that a voice is above the robot's own in the microphone.");
  return settings;
}

SpeechComponent::SpeechComponent(runtime::Host& host)
    : SpeechComponent(host, Equipment{std::make_unique<NullSoundCard>(),
                                      std::make_unique<NullSynthesizer>(), nullptr}) {}

SpeechComponent::SpeechComponent(runtime::Host& host, Equipment equipment)
    : host_(host),
      settings_(read_settings(host)),
      texts_(phrases::read_phrases(host, "speech", kTextKeys)),
      conversation_(settings_.rule),
      activity_(settings_.activity),
      card_(std::move(equipment.card)),
      synthesizer_(std::move(equipment.synthesizer)),
      recognizer_(std::move(equipment.recognizer)),
      player_(synthesizer_->rate()),
      understood_(host.health().counter("answers: understood")),
      ignored_(host.health().counter("answers: ignored")),
      rejected_(host.health().counter("inputs: rejected")),
      memory_(host, kHoldKey),
      status_output_(host.output(topics::kSpeechStatus)),
      level_output_(host.output(topics::kSpeechLevel)),
      answers_(host, topics::kDialogueAnswer),
      requests_(host, topics::kSupervisorRequest) {
  screen_ = host.input(topics::kDialogueScreen, {},
                       [this](const auto& screen, const auto&) { take_screen(screen); });
  guide_ = host.input(topics::kGuideStatus, {.max_age = kDialogueAge,
                                             .on_loss = "a spoken stop goes to the supervisor",
                                             .optional = true});
  meeting_ = host.input(topics::kMeetingStatus, {.max_age = kDialogueAge,
                                                 .on_loss = "a spoken stop goes to the supervisor",
                                                 .optional = true});
  supervisor_ = host.input(
      topics::kSupervisorStatus, {.optional = true}, [this](const auto& status, const auto&) {
        requests_.answered(status.last_request(), status.last_request_client());
        const auto holds = wire::own_stop(status, host_.name(), requests_);
        if (holds && conversation_.hear_stop(*holds)) memory_.keep(*holds ? kHoldKey : "");
      });
  timer_ = host.timer("step", kStep, [this](std::uint64_t skipped) { tick(skipped); });
  player_.set_gain(settings_.volume);
  if (recognizer_ == nullptr) models_trouble_ = "there is no recognizer";
  if (!memory_.found().empty()) conversation_.hold_again();
}

void SpeechComponent::open_devices() {
  const bool first = ticks_ == 1;
  if (!loudspeaker_opens_ && (first || !loudspeaker_trouble_.empty())) open_loudspeaker();
  if (!microphone_opens_ && (first || !microphone_trouble_.empty())) open_microphone();
}

void SpeechComponent::open_loudspeaker() {
  loudspeaker_opens_ = true;
  if (loudspeaker_trouble_.empty())
    loudspeaker_trouble_ = "waits for the loudspeaker " + settings_.loudspeaker;
  const auto opened = std::make_shared<Status>();
  host_.offload(
      kOpenTime,
      [card = card_, opened,
       open = card_->to_open_loudspeaker(settings_.loudspeaker, synthesizer_->rate())] {
        *opened = open();
      },
      [this, opened] {
        loudspeaker_opens_ = false;
        loudspeaker_trouble_ = opened->ok() ? "" : opened->error();
      });
}

void SpeechComponent::open_microphone() {
  microphone_opens_ = true;
  if (microphone_trouble_.empty())
    microphone_trouble_ = "waits for the microphone " + settings_.microphone;
  const auto opened = std::make_shared<Status>();
  host_.offload(
      kOpenTime,
      [card = card_, opened, open = card_->to_open_microphone(settings_.microphone)] {
        *opened = open();
      },
      [this, opened] {
        microphone_opens_ = false;
        microphone_trouble_ = opened->ok() ? "" : opened->error();
      });
}

void SpeechComponent::load() {
  if (recognizer_ == nullptr) return;
  const auto loaded = std::make_shared<Status>();
  host_.offload(
      kLoadTime, [recognizer = recognizer_, loaded] { *loaded = recognizer->load(); },
      [this, loaded] {
        models_ready_ = loaded->ok();
        if (!loaded->ok()) models_trouble_ = loaded->error();
      });
}

void SpeechComponent::take_screen(const usher_msgs::msg::DialogueScreen& screen) {
  const bool done =
      screen.answer_result() == usher_msgs::msg::DialogueScreen_Constants::RESULT_DONE;
  if (answers_.answered(screen.answer_id(), screen.answer_client()) && done)
    conversation_.hear_done();
  Screen taken;
  taken.id = screen.id();
  taken.language = screen.language();
  taken.spoken = shortened(screen.spoken(), kMostWords);
  taken.spoken_id = screen.spoken_id();
  if (screen.tone() <= static_cast<std::uint8_t>(Tone::kCall))
    taken.tone = static_cast<Tone>(screen.tone());
  else
    ++rejected_;
  taken.listens = screen.listens();
  taken.answer_client = screen.answer_client();
  taken.answer_id = screen.answer_id();
  for (const auto& option : screen.options())
    taken.options.push_back({option.id(), option.label(), option.takes_text()});
  const std::size_t language = texts_.find(taken.language);
  const auto text = [&](Text which) {
    return texts_.phrase(language, static_cast<std::size_t>(which));
  };
  conversation_.set_sentences({text(Text::kDidYouSay), text(Text::kByTouch), text(Text::kHeld)});
  conversation_.take(taken, now());
  fulfil();
}

void SpeechComponent::ask_supervisor(std::uint8_t what) {
  usher_msgs::msg::SupervisorRequest request;
  request.id(requests_.next_id());
  request.command(what);
  requests_.give_up();  // the newest word is what counts
  requests_.ask(std::move(request));
}

void SpeechComponent::fulfil() {
  Wishes wishes = conversation_.take_wishes();
  if (wishes.break_off) {
    player_.break_off();
    to_say_.clear();
    ++said_epoch_;
    finished_id_ = spoken_id_;
  }
  for (const Tone wanted : wishes.tones) {
    const Sound sound = tone(wanted, player_.rate());
    player_.add({0, {}, sound, {}});
  }
  if (wishes.say) {
    if (to_say_.size() == kMostJobs) to_say_.pop_front();
    to_say_.push_back(std::move(*wishes.say));
    say_next();
  }
  if (wishes.answer) {
    usher_msgs::msg::DialogueAnswer answer;
    answer.id(answers_.next_id());
    answer.screen_id(wishes.answer->screen_id);
    answer.option_id(wishes.answer->option_id);
    answer.input(usher_msgs::msg::DialogueAnswer_Constants::INPUT_VOICE);
    answers_.give_up();
    answers_.ask(std::move(answer));
  }
  if (wishes.halt) ask_supervisor(command::COMMAND_STOP);
  if (wishes.go_on) ask_supervisor(command::COMMAND_MOVEMENT_ON);
  if (wishes.halt || wishes.go_on) memory_.keep(wishes.halt ? kHoldKey : "");
}

void SpeechComponent::say_next() {
  if (synthesizing_ || to_say_.empty()) return;
  synthesizing_ = true;
  const Wishes::Say say = to_say_.front();
  to_say_.pop_front();
  const auto made = std::make_shared<Result<Utterance>>(Error{"nothing was made"});
  host_.offload(
      kSynthesisTime,
      [synthesizer = synthesizer_, made, say, voice = settings_.voice] {
        *made = synthesizer->say(say.text, say.language, voice);
      },
      [this, made, say, epoch = said_epoch_] {
        synthesizing_ = false;
        voice_trouble_ = made->ok() ? "" : made->error();
        if (epoch == said_epoch_) {
          if (say.id != 0) spoken_id_ = say.id;
          if (made->ok()) {
            Utterance utterance = std::move(*made).value();
            utterance.id = say.id;
            player_.add(std::move(utterance));
          } else {
            finished_id_ = spoken_id_;  // nobody waits for what cannot be said
          }
        }
        say_next();
      });
}

void SpeechComponent::play() {
  // Time passes also while it is opened.
  const auto step = static_cast<std::size_t>(player_.rate()) / kStepsPerSecond;
  out_.resize(loudspeaker_opens_ ? step : card_->room());
  if (out_.empty()) return;
  player_.set_gain(settings_.volume * (activity_.voice() ? kDucked : 1.0));
  player_.take(out_);
  if (!loudspeaker_trouble_.empty()) return;
  if (const Status written = card_->write(out_); !written) loudspeaker_trouble_ = written.error();
}

void SpeechComponent::hear() {
  if (!microphone_trouble_.empty()) return;
  in_.clear();
  if (const Status got = card_->read(in_); !got) {
    microphone_trouble_ = got.error();
    activity_.restart();
    return;
  }
  // What nobody hears comes back to no microphone.
  constexpr double kSilence = -100.0;  // [dB]
  const double echo = loudspeaker_trouble_.empty() ? player_.loudness(unheard()) : kSilence;
  // Heard all the time, so that the room's noise is known when somebody is waited for.
  auto utterance = activity_.hear(in_, echo);
  if (!conversation_.listens()) {
    activity_.restart();
    return;
  }
  if (!utterance) return;
  if (to_recognize_.size() == kMostJobs) to_recognize_.pop_front();
  to_recognize_.push_back(
      {std::move(*utterance), conversation_.phrases(), conversation_.phrases_id()});
  recognize_next();
}

void SpeechComponent::recognize_next() {
  if (recognizing_ || to_recognize_.empty() || !models_ready_) return;
  recognizing_ = true;
  const auto heard = std::make_shared<Heard>(std::move(to_recognize_.front()));
  to_recognize_.pop_front();
  const auto hearing = std::make_shared<Result<Hearing>>(Hearing{});
  host_.offload(
      kRecognitionTime,
      [recognizer = recognizer_, heard, hearing] {
        *hearing = recognizer->hear(heard->sound, heard->phrases);
      },
      [this, heard, hearing] {
        recognizing_ = false;
        models_trouble_ = hearing->ok() ? "" : hearing->error();
        if (hearing->ok()) conversation_.heard(**hearing, heard->phrases, heard->phrases_id, now());
        fulfil();
        recognize_next();
      });
}

void SpeechComponent::tick(std::uint64_t skipped) {
  if (++ticks_ % kRetryEvery == 1) open_devices();
  if (ticks_ == 1) load();
  conversation_.can_understand(models_ready_ && microphone_trouble_.empty());
  conversation_.hear_dialogue(guide_.fresh() != nullptr || meeting_.fresh() != nullptr);
  const auto* supervisor = supervisor_.latest();
  const bool navigates = supervisor != nullptr && !supervisor->current_goal().empty();
  if (const auto* guide = guide_.fresh()) conversation_.hear_visit(guide->serves(), navigates);
  // A sound card of its own has gone on meanwhile; files have not.
  for (std::uint64_t i = 0; i <= std::min(skipped, kMostSkipped); ++i) {
    play();
    hear();
  }
  const bool sounds = player_.sounds(unheard()) || synthesizing_ || !to_say_.empty();
  conversation_.step(sounds, now());
  fulfil();
  understood_ = conversation_.counts().acted + conversation_.counts().confirmed;
  ignored_ = conversation_.counts().ignored + conversation_.counts().denied;
  finished_id_ = std::max(finished_id_, player_.finished(unheard()));
  report();
}

usher_msgs::msg::SpeechStatus SpeechComponent::status() {
  usher_msgs::msg::SpeechStatus status;
  const std::uint64_t waits = unheard();
  const auto caption = player_.caption(waits);
  const bool sounds = player_.sounds(waits);
  status.state(conversation_.asks()            ? state::STATE_ASKING
               : sounds                        ? state::STATE_SPEAKING
               : conversation_.awaits_answer() ? state::STATE_LISTENING
                                               : state::STATE_SILENT);
  const auto* screen = screen_.latest();
  if (screen != nullptr) status.language(screen->language());
  status.audible(loudspeaker_trouble_.empty() && voice_trouble_.empty());
  status.understands(conversation_.understands());
  status.listens(conversation_.listens());
  status.hears(activity_.voice());
  status.spoken_id(spoken_id_);
  status.finished(finished_id_ >= spoken_id_);
  if (caption) {
    status.sentence(caption->sentence);
    status.word_begin(caption->word_begin);
    status.word_length(caption->word_length);
  }
  status.heard(conversation_.last_heard());
  status.confidence(static_cast<float>(conversation_.last_confidence()));
  status.hint(conversation_.hint());
  return status;
}

void SpeechComponent::report() {
  if (ticks_ % kLevelEvery == 0) {
    const double level = level_of(player_.loudness(unheard()));
    if (level > 0.0 || !level_was_zero_ || ticks_ % kStatusEvery == 0) {
      usher_msgs::msg::SpeechLevel message;
      message.header(wire::header(host_.now(), ""));
      message.level(static_cast<float>(level));
      level_output_.publish(message);
    }
    level_was_zero_ = level == 0.0;
  }
  auto message = status();
  if (message != reported_ || ticks_ % kStatusEvery == 0) {
    reported_ = message;
    message.header(wire::header(host_.now(), ""));
    status_output_.publish(message);
  }
  if (ticks_ % kStatusEvery != 0) return;
  std::string trouble;
  for (const std::string* each :
       {&loudspeaker_trouble_, &voice_trouble_, &microphone_trouble_, &models_trouble_}) {
    if (!each->empty()) trouble += (trouble.empty() ? "" : "; ") + *each;
  }
  using runtime::HealthState;
  host_.health().set(trouble.empty() ? HealthState::kOk : HealthState::kDegraded, trouble);
}

}  // namespace usher::speech
