// Speech and interaction control together: the torso is still while the visitor is heard, and only
// then.
#include <gtest/gtest.h>

#include <cmath>

#include "control/interaction_control/shell/component.hpp"
#include "interaction/speech/shell/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher {
namespace {

using std::chrono::milliseconds;
namespace state = usher_msgs::msg::SpeechStatus_Constants;
constexpr std::size_t kTilt = 2;

bool voice = false;  ///< of the visitor

/// A microphone in a room that is silent but for the visitor; the loudspeaker takes what it gets.
class QuietCard final : public speech::SoundCard {
 public:
  Opening to_open_loudspeaker(const std::string&, int rate) override {
    rate_ = static_cast<std::size_t>(rate);
    return [] { return Status{}; };
  }
  Opening to_open_microphone(const std::string&) override {
    return [] { return Status{}; };
  }
  std::size_t room() override { return rate_ / 50; }
  Status write(std::span<const std::int16_t>) override { return {}; }
  std::uint64_t unheard() override { return 0; }
  Status read(std::vector<std::int16_t>& samples) override {
    for (int i = 0; i < 320; ++i)
      samples.push_back(voice ? static_cast<std::int16_t>(9600.0 * std::sin(0.1 * (at_ += 1.0)))
                              : std::int16_t{0});
    return {};
  }

 private:
  std::size_t rate_ = 8000;
  double at_ = 0.0;
};

class ReadyRecognizer final : public speech::Recognizer {
 public:
  Status load() override { return {}; }
  Result<speech::Hearing> hear(const speech::Sound&, std::span<const speech::Phrase>) override {
    return speech::Hearing{};
  }
};

std::unique_ptr<runtime::Component> make_speech(runtime::Host& host) {
  return std::make_unique<speech::SpeechComponent>(
      host,
      speech::Equipment{std::make_unique<QuietCard>(), std::make_unique<speech::NullSynthesizer>(),
                        std::make_unique<ReadyRecognizer>()});
}

std::string zone(const std::string& name, const std::string& bearings, const std::string& tilt) {
  return "  - {name: " + name + ", enabled: true, range_min: 0, range_max: 1.5, " + bearings +
         ", tracking: false, voice: true, left_eye: \"#00ff00\", right_eye: \"#00ff00\", "
         "left_shoulder: 0, right_shoulder: 0, torso_tilt: " +
         tilt + ", head_rise: 0, head_tilt: 0, head_nod: 0, head_shake: 0}\n";
}

class ListeningTorso : public testing::Test {
 protected:
  ListeningTorso()
      : host_(runtime::component_factory<interaction_control::InteractionControlComponent>(
                  "interaction_control"),
              "robot.torso.torso_tilt: [-12 deg, 12 deg]\nrobot.torso.head_rise: [0, 0.08]\n"
              "robot.torso.turn_rate: 0.5\nrobot.torso.rise_rate: 0.04\nrest: ahead\nzones:\n" +
                  zone("ahead", "bearing_min: -40 deg, bearing_max: 40 deg", "0") +
                  zone("left", "bearing_min: 40 deg, bearing_max: 90 deg", "10 deg")) {
    auto file =
        runtime::test_parameters("speech", "texts: " USHER_SOURCE_DIR "/config/dialogue/en.yaml");
    EXPECT_TRUE(file.ok());
    EXPECT_TRUE(host_.world().add({"speech", make_speech}, std::move(file).value()).ok());
    host_.world().observe(topics::kSpeechStatus,
                          [this](const auto& said, const auto&) { speech_state_ = said.state(); });
    run(2000);
  }
  void show(std::uint64_t id, bool listens, const std::string& spoken = "Go?") {
    usher_msgs::msg::DialogueScreen screen;
    screen.id(id);
    screen.language("en");
    screen.spoken(spoken);
    screen.spoken_id(id);
    screen.listens(listens);
    screen.options().emplace_back().id("stop");
    screen.options().back().label("Stop");
    host_.publish(topics::kDialogueScreen, screen, "guide");
  }
  void run(int ms) {
    for (int i = 0; i < ms; i += 50) {
      usher_msgs::msg::MovementEnable enable;
      enable.header(wire::header(host_.now(), ""));
      enable.movement(true);
      enable.interaction_control(!drives_);
      enable.navigation(drives_);
      host_.publish(topics::kMovementEnable, enable);
      nav_msgs::msg::Odometry odom;
      odom.header(wire::header(host_.now(), "odom"));
      odom.pose().pose(wire::to_message(geometry::Pose2{}));
      host_.publish(topics::kOdom, odom);
      usher_msgs::msg::People people;
      people.header(wire::header(host_.now(), "odom"));
      auto& person = people.people().emplace_back();
      person.id(5);
      person.x(std::cos(bearing_));
      person.y(std::sin(bearing_));
      host_.publish(topics::kPeople, people);
      usher_msgs::msg::TorsoStatus torso;
      torso.header(wire::header(host_.now(), ""));
      torso.moves(true);
      if (const auto frame = host_.last(topics::kTorsoFrame)) torso.joints(frame->joints());
      host_.publish(topics::kTorsoStatus, torso);
      host_.run_for(milliseconds(50));
    }
  }
  double tilt() const { return host_.last(topics::kTorsoFrame)->joints()[kTilt]; }

  runtime::TestHost host_;
  int speech_state_ = -1;
  bool drives_ = false;
  double bearing_ = 0.0;
};

TEST_F(ListeningTorso, PosesWhileNoAnswerIsWaitedForAndIsStillWhileOneIs) {
  show(1, false);
  run(2000);
  EXPECT_EQ(speech_state_, state::STATE_SILENT);
  bearing_ = 1.0;
  run(2000);
  EXPECT_NEAR(tilt(), 0.1745, 1e-3);
  show(2, true);
  run(2000);
  ASSERT_EQ(speech_state_, state::STATE_LISTENING);
  bearing_ = 0.0;
  run(2000);
  EXPECT_NEAR(tilt(), 0.1745, 1e-3) << "the visitor is heard";
  show(3, false);
  run(3000);
  EXPECT_NEAR(tilt(), 0.0, 1e-3);
}

TEST_F(ListeningTorso, IsStillAsSoonAsTheVisitorSpeaksThoughTheRobotDoes) {
  show(1, true, std::string(300, 'a'));
  run(1000);
  bearing_ = 1.0;
  run(200);
  ASSERT_EQ(speech_state_, state::STATE_SPEAKING);
  voice = true;
  run(500);
  const double held = tilt();
  EXPECT_GT(held, 0.0);
  EXPECT_LT(held, 0.15);
  run(500);
  EXPECT_EQ(speech_state_, state::STATE_SPEAKING);
  EXPECT_EQ(tilt(), held);
  voice = false;
  run(3000);
  EXPECT_NEAR(tilt(), 0.1745, 1e-3);
}

TEST_F(ListeningTorso, RestsOnTheWayAlthoughAStopIsHeard) {
  show(1, false);
  bearing_ = 1.0;
  run(3000);
  ASSERT_NEAR(tilt(), 0.1745, 1e-3);
  drives_ = true;
  run(3000);
  EXPECT_NEAR(tilt(), 0.0, 1e-3);
}

}  // namespace
}  // namespace usher
