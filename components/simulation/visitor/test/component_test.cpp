#include "simulation/visitor/shell/component.hpp"

#include <gtest/gtest.h>

#include "runtime/testing/test_host.hpp"
#include "simulation/visitor/core/step_up.hpp"
#include "wire/conversions.hpp"

namespace usher::visitor {
namespace {

using std::chrono::milliseconds;
namespace input = usher_msgs::msg::DialogueAnswer_Constants;

/// What arrives at the other end of the visitor's line.
class Line final : public runtime::LockstepDevice {
 public:
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    got.insert(got.end(), bytes.begin(), bytes.end());
    return {};
  }
  runtime::Bytes speak(runtime::Time) override { return {}; }
  std::string text() const { return {got.begin(), got.end()}; }
  runtime::Bytes got;
};

/// Half a second at full scale.
class Loud final : public Voice {
 public:
  explicit Loud(std::vector<std::string>& said) : said_(said) {}
  Result<std::vector<std::int16_t>> say(const std::string& words) override {
    said_.push_back(words);
    return std::vector<std::int16_t>(8000, 30000);
  }

 private:
  std::vector<std::string>& said_;
};

class Someone : public testing::Test {
 protected:
  void start(const std::string& parameters, bool limbs = true) {
    host_ = std::make_unique<runtime::TestHost>(
        runtime::ComponentFactory{"visitor",
                                  [this, limbs](runtime::Host& host) {
                                    return std::unique_ptr<runtime::Component>(
                                        std::make_unique<VisitorComponent>(
                                            host, limbs ? std::make_shared<Loud>(said_) : nullptr));
                                  }},
        "destination: library\nreading_time: 0.5 s\n" + parameters, line_);
    host_->run_for(milliseconds(100));
  }
  void show(std::uint64_t id, const std::string& state, const std::vector<std::string>& options,
            const std::string& language = "en") {
    usher_msgs::msg::DialogueScreen screen;
    screen.id(id);
    screen.state(state);
    screen.language(language);
    screen.time_left(std::numeric_limits<float>::quiet_NaN());
    screen.listens(true);
    for (const auto& option : options) {
      auto& entry = screen.options().emplace_back();
      entry.id(option);
      entry.label("the " + option);
      entry.takes_text(option == "query");
    }
    host_->publish(topics::kDialogueScreen, screen, "guide");
  }
  void hear(bool listens, const std::string& sentence = "", const std::string& asks = "") {
    usher_msgs::msg::SpeechStatus status;
    status.header(wire::header(host_->now(), ""));
    status.listens(listens);
    status.sentence(sentence);
    if (!asks.empty()) status.state(usher_msgs::msg::SpeechStatus_Constants::STATE_ASKING);
    status.hint(asks);
    host_->publish(topics::kSpeechStatus, status, "speech");
  }
  void pass(int tenths) {
    for (int i = 0; i < tenths; ++i) host_->run_for(milliseconds(100));
  }
  auto answers() { return host_->written(topics::kDialogueAnswer); }

  std::vector<std::string> said_;
  std::shared_ptr<Line> line_ = std::make_shared<Line>();
  std::unique_ptr<runtime::TestHost> host_;
};

TEST_F(Someone, WritesItsAnswersWhereThereAreNoDevices) {
  start("input: mixed\nfinger: tcp://127.0.0.1:7431\nmouth: tcp://127.0.0.1:7432", false);
  show(1, "location_ask", {"yes", "no", "guide_me"});
  pass(10);
  show(2, "guide_options", {"library", "lounge"});
  pass(10);
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().front().option_id(), "guide_me");
  EXPECT_EQ(answers().front().input(), input::INPUT_TOUCH);
  EXPECT_TRUE(line_->got.empty());
}

TEST_F(Someone, IsAskedBackWhereNoSoundIsSimulated) {
  start(
      "input: voice\nvoice_understood: 0\nvoice_asked_back: 1\nvoice_confirmed: 1\nvoice_mistaken: "
      "0",
      false);
  show(1, "guide_options", {"library", "lounge"});
  pass(30);
  EXPECT_TRUE(answers().empty()) << "did you say ...?";
  pass(30);
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().front().option_id(), "library");
  EXPECT_EQ(answers().front().input(), input::INPUT_VOICE);
  EXPECT_EQ(host_->counter("voice: said"), 2U);
  EXPECT_EQ(host_->counter("voice: asked back"), 1U);
}

TEST_F(Someone, SpeaksNoLanguageThatTheRobotDoesNotUnderstand) {
  start("input: voice\nlanguage: de\nvoice_understood: 1\nvoice_asked_back: 0\nvoice_mistaken: 0",
        false);
  show(1, "guide_options", {"library", "lounge"}, "de");
  pass(30);
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().front().input(), input::INPUT_TOUCH);
}

TEST_F(Someone, TouchesAndTypesOnTheTablet) {
  start("finger: tcp://127.0.0.1:7431\ntypes: true");
  show(7, "guide_options", {"lounge", "search"});
  pass(10);
  EXPECT_EQ(line_->text(), "7 button search\n");
  line_->got.clear();
  show(8, "guide_options", {"query"});
  pass(10);
  EXPECT_EQ(line_->text(), "8 key l\n8 key i\n8 key b\n8 key r\n");
  EXPECT_TRUE(answers().empty()) << "that is the tablet's business";
}

TEST_F(Someone, SpeaksIntoTheMicrophoneAndTouchesWhatNobodyHears) {
  start("input: voice\nmouth: tcp://127.0.0.1:7432");
  pass(10);
  EXPECT_GE(line_->got.size(), 2U * 15000) << "the room is never silent";
  hear(true);
  show(7, "guide_options", {"library", "lounge"});
  pass(10);
  EXPECT_EQ(said_, (std::vector<std::string>{"the library"}));
  line_->got.clear();
  hear(true, "Did you say", "Did you say \"the library\"?");
  pass(10);
  hear(true, "", "Did you say \"the library\"?");
  pass(5);
  EXPECT_EQ(said_.back(), "yes");
  EXPECT_TRUE(answers().empty()) << "that is the ear's business";
  pass(140);  // the ear has gone
  ASSERT_FALSE(answers().empty());
  EXPECT_EQ(answers().front().option_id(), "library");
  EXPECT_EQ(answers().front().input(), input::INPUT_TOUCH);
  EXPECT_EQ(host_->counter("answers: touched since nobody understood"), 1U);
}

TEST_F(Someone, StepsUpWhenTheRobotWaitsAndTouchesNothingBeforeItGreets) {
  start("steps_up_to: 1 m\ncomes_after: 2 s\nwaits_for_greeting: true", false);
  const auto stand = [&](double x, double y, int tenths) {
    for (int i = 0; i < tenths; ++i) {
      usher_sim_msgs::msg::GroundTruth truth;
      truth.header(wire::header(host_->now(), ""));
      truth.pose(wire::to_message(geometry::Pose2{4.0, 4.0, 0.0}));
      auto& person = truth.people().emplace_back();
      person.name("visitor");
      person.x(x);
      person.y(y);
      host_->publish(topics::kSimGroundTruth, truth, "world");
      pass(1);
    }
  };
  stand(8.0, 4.0, 30);
  EXPECT_TRUE(host_->written(topics::kSimPersonGoal).empty());
  show(1, "inactive", {"language:en", "language:de"});
  stand(8.0, 4.0, 15);
  EXPECT_TRUE(host_->written(topics::kSimPersonGoal).empty());
  stand(8.0, 4.0, 15);
  ASSERT_FALSE(host_->written(topics::kSimPersonGoal).empty());
  EXPECT_EQ(host_->last(topics::kSimPersonGoal)->x(), 5.0);
  EXPECT_FALSE(host_->last(topics::kSimPersonGoal)->follow());
  stand(5.0, 4.1, 5);
  EXPECT_EQ(host_->last(topics::kSimPersonGoal)->speed(), 0.0) << "is there";
  host_->clear();
  stand(5.0, 4.1, 20);
  EXPECT_TRUE(host_->written(topics::kSimPersonGoal).empty());
  EXPECT_TRUE(answers().empty());
}

TEST_F(Someone, AnswersNothingWithoutAScreenAndStepsUpToNothingThatHeDoesNotSee) {
  start("steps_up_to: 1 m\ncomes_after: 1 s", false);
  pass(50);
  EXPECT_TRUE(answers().empty());
  show(1, "inactive", {"language:en"});
  pass(50);
  EXPECT_TRUE(host_->written(topics::kSimPersonGoal).empty()) << "no sim/ground_truth";
}

TEST(StepUp, LeadsRoundTheRobot) {
  const geometry::Pose2 robot{4.0, 4.0, 0.0};
  EXPECT_EQ(step_up(robot, {5.1, 4.0}, 1.0), std::nullopt);
  EXPECT_EQ(step_up(robot, {5.0, 6.0}, 1.0), geometry::Point2(5.0, 4.0));
  EXPECT_EQ(step_up(robot, {3.0, 4.5}, 1.0), geometry::Point2(4.5, 5.2));
  EXPECT_EQ(step_up(robot, {3.0, 3.5}, 1.0), geometry::Point2(4.5, 2.8));
}

}  // namespace
}  // namespace usher::visitor
