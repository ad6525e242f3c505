// A visitor does the tasks of the thesis' usability study (appendix B) at a robot of two machines:
// MARVIN in simulation on the one, tablet, speech and the visitor's finger and mouth on the other.
// What the thesis wants of the interaction (section 7.1) is judged by what is on the topics, by the
// tablet's pictures and by what the loudspeaker gave.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

#include "deployment/two_hosts.hpp"
#include "foundation/geometry/pose2.hpp"
#include "interaction/speech/core/loudness.hpp"
#include "interaction/speech/core/wav_file.hpp"
#include "operations/experiments/visit_tasks.hpp"
#include "wire/conversions.hpp"

namespace usher::test {
namespace {

namespace answer = usher_msgs::msg::DialogueAnswer_Constants;
namespace joint = usher_msgs::msg::TorsoFrame_Constants;
using Clock = std::chrono::steady_clock;

constexpr double kDegree = 3.14159265358979 / 180.0;
constexpr double kGreetRange = 2.0;  // [m]
constexpr double kGreetBearing = 30.0 * kDegree;
constexpr double kStands = 0.6;         // [m/s] who walks faster passes by
constexpr double kGreetWithin = 5.0;    // [s]
constexpr double kMapError = 0.5;       // [m]
constexpr double kGoalError = 0.4;      // [m]
constexpr double kVisitorBehind = 3.5;  // [m]
constexpr double kTorsoError = 2.0 * kDegree;
constexpr double kSpokenAfter = 4.0;     // [s] a screen that stays so long is said
constexpr double kLeastSound = 10.0;     // [s] of the robot's voice in a visit
constexpr double kLeastLoudness = 0.01;  // of full scale, pauses included
constexpr double kBusy = 1.5;            // times slower than alone
constexpr double kLag = 0.5;             // [s] that the simulation may fall behind
const geometry::Point2 kReception{10.2, 4.6}, kFoyer{4.5, 4.5};

/// What a visitor who wants to go there and back may answer; anything else was not his wish.
const std::set<std::string> kWishes{"language:en", "language:de", "languages", "yes",
                                    "no",          "guide_me",    "done",      "reception",
                                    "foyer",       "start",       "stay"};

/// How a visitor answers, and what the robot has for it.
struct Manner {
  const char* input;
  bool speech;           ///< a component speaks and listens
  const char* language;  ///< of the visitor
};

/// What was not as it should be.
struct Complaints {
  std::vector<std::string> wrong;  ///< however busy the machine is
  std::vector<std::string> late;   ///< also where the machine is too busy for real time

  bool none() const { return wrong.empty() && late.empty(); }
  bool forgivable(bool busy) const { return busy && wrong.empty() && !late.empty(); }
};

/// Everything that could be seen and heard during a visit.
class Witness {
 public:
  void listen(runtime::Observer& observer) {
    hear(observer, topics::kSimGroundTruth, [this](const auto& m) { take(m); });
    hear(observer, topics::kDialogueScreen, [this](const auto& m) { take(m); });
    hear(observer, topics::kDialogueAnswer, [this](const auto& m) {
      answers_[{m.client(), m.id()}] = m;
    });
    hear(observer, topics::kSpeechStatus, [this](const auto& m) {
      if (!m.sentence().empty() && m.audible()) captions_.insert(m.sentence());
      if (m.finished()) finished_ = std::max(finished_, m.spoken_id());
      if (m.state() == usher_msgs::msg::SpeechStatus_Constants::STATE_ASKING)
        questions_.insert(m.hint());
    });
    hear(observer, topics::kAmclPose, [this](const auto& m) {
      if (const auto pose = wire::to_planar(m.pose().pose())) estimate_ = *pose;
    });
    hear(observer, topics::kTorsoStatus, [this](const auto& m) { torso_ = m; });
    hear(observer, topics::kInteractionStatus, [this](const auto& m) { take(m); });
    hear(observer, topics::kGuideVisit, [this](const auto& m) { visit_ = m; });
  }
  /// Before the observer ends.
  void close() { readers_.clear(); }

  bool over() const {
    const std::lock_guard lock(mutex_);
    return visit_ && (state() == "end" || state() == "guide_error");
  }
  double lag() const { return lag_; }
  void print(const std::string& input) const {
    std::printf("--- by %s\n", input.c_str());
    for (const auto& [at, state] : states_) std::printf("%7.1f s  %s\n", at, state.c_str());
    for (const auto& [key, m] : answers_)
      std::printf("%s: %s\n", m.client().c_str(), m.option_id().c_str());
    for (const auto& question : questions_) std::printf("asked back: %s\n", question.c_str());
    std::printf(
        "greeted after %.1f s, map off by %.2f m, robot off %.2f m, visitor %.2f m behind, "
        "torso off %.1f deg, %zu sentences, lag %.2f s\n",
        greeted_after_, map_error_, goal_error_, visitor_behind_, torso_error_ / kDegree,
        said_.size(), lag_);
  }
  /// What must not be however busy the machine is.
  std::vector<std::string> harm() const {
    std::vector<std::string> all;
    if (contacts_ > 0) all.emplace_back("the robot touched something");
    for (const auto& [key, m] : answers_) {
      if (!kWishes.contains(m.option_id()))
        all.push_back("nobody wanted \"" + m.option_id() + "\", but " + m.client() + " said so");
      if (m.client() != "tablet" && m.client() != "speech")
        all.push_back("an answer of " + m.client());
    }
    return all;
  }
  Complaints complaints(const Manner& manner) const {
    Complaints all;
    const auto expect = [&](bool good, const std::string& what) {
      if (!good) all.wrong.push_back(what);
    };
    const auto expect_in_time = [&](bool good, const std::string& what) {
      if (!good) all.late.push_back(what);
    };
    judge_tasks(all.wrong);
    expect(std::isfinite(greeted_after_), "objective 1: never greeted");
    expect_in_time(greeted_after_ < kGreetWithin * slowdown(), "objective 1: greeted too late");
    expect(map_error_ < kMapError, "objective 2: the map shows another place");
    expect(visit_ && visit_->started() == 2 && visit_->arrived() == 2,
           "objective 3: not guided twice");
    expect(goal_error_ < kGoalError && visitor_behind_ < kVisitorBehind,
           "objective 3: not all are there");
    expect(!manner.speech || !captions_.empty(), "objective 4: nothing was said");
    for (const auto& [id, sentence] : said_) {
      const double stayed = sentence.until - sentence.at;
      if (stayed <= kSpokenAfter) continue;
      const std::string which =
          "\"" + sentence.text + "\", shown for " + std::to_string(stayed) + " s";
      expect(sentence.shown, "objective 5: not on the screen " + which);
      expect_in_time(!manner.speech || captions_.contains(sentence.text),
                     "objective 4: never said " + which);
      expect_in_time(!manner.speech || finished_ >= id, "objective 4: not finished " + which);
    }
    expect(visit_ && visit_->language() == manner.language, "another language at the end");
    expect(languages_ == std::set<std::string>{manner.language},
           "a question in another language than the visitor's");
    judge_answers(manner.input, all.wrong);
    expect(torso_error_ < kTorsoError, "objective 6: the torso took another pose");
    return all;
  }

 private:
  struct Sentence {
    std::string text;
    double at = 0.0, until = 0.0;  ///< [s] how long its screen stayed
    bool shown = false;            ///< it could be read, too
  };

  template <class Message, class Take>
  void hear(runtime::Observer& observer, const topics::Topic<Message>& topic, Take take) {
    auto made = observer.reader(topic, [this, take](const auto& message, const auto&) {
      const std::lock_guard lock(mutex_);
      take(message);
    });
    ASSERT_TRUE(made) << made.error();
    auto reader = std::move(made).value();
    readers_.push_back(std::make_shared<decltype(reader)>(std::move(reader)));
  }
  double now() const { return Seconds(Clock::now() - start_).count(); }
  const std::string& state() const {
    static const std::string none;
    return states_.empty() ? none : states_.back().second;
  }

  void take(const usher_sim_msgs::msg::GroundTruth& truth) {
    const auto pose = wire::to_planar(truth.pose());
    if (!pose) return;
    robot_ = *pose;
    lag_ = std::max(lag_, truth.lag());
    contacts_ = truth.contacts();
    for (const auto& person : truth.people()) {
      if (person.name() == "visitor") visitor_ = {person.x(), person.y()};
    }
    if (!near_at_ && state() == "inactive" && (visitor_ - robot_.position()).norm() < kGreetRange) {
      near_at_ = now();
    }
  }
  void take(const usher_msgs::msg::DialogueScreen& screen) {
    if (screen.spoken_id() != 0 && !screen.spoken().empty()) {
      auto& sentence = said_[screen.spoken_id()];
      const std::string page = screen.title() + " " + screen.text();
      if (sentence.text.empty()) sentence = {screen.spoken(), now(), now()};
      sentence.shown = sentence.shown || page.find(screen.spoken()) != std::string::npos;
      sentence.until = now();
    }
    // The greeting hears the languages in English; the first question may come before his touch.
    if (screen.listens() && screen.state() != "introduction" && screen.state() != "location_ask")
      languages_.insert(screen.language());
    if (screen.state() == state()) return;
    if (!said_.empty()) said_.rbegin()->second.until = now();
    states_.emplace_back(now(), screen.state());
    if (screen.state() == "introduction" && near_at_) greeted_after_ = now() - *near_at_;
    if (screen.state() == "location_show") {
      const bool shown = screen.located() &&
                         screen.content() == usher_msgs::msg::DialogueScreen_Constants::CONTENT_MAP;
      const double told = std::hypot(screen.x() - robot_.x, screen.y() - robot_.y);
      const double drawn = (estimate_.position() - robot_.position()).norm();
      map_error_ = shown ? std::max(told, drawn) : INFINITY;
    }
    if (screen.state() == "guide_success") {
      const auto& goal = screen.place() == "foyer" ? kFoyer : kReception;
      goal_error_ = std::max(goal_error_, (goal - robot_.position()).norm());
      visitor_behind_ = std::max(visitor_behind_, (visitor_ - robot_.position()).norm());
    }
  }
  /// config/robots/marvin.yaml, zone nominal.
  void take(const usher_msgs::msg::InteractionStatus& status) {
    if (status.zone() != "nominal" || status.pose() != "nominal" || !status.posed() || !torso_)
      return;
    std::array<double, 7> pose{};
    pose[joint::JOINT_LEFT_SHOULDER] = pose[joint::JOINT_RIGHT_SHOULDER] = -15.0 * kDegree;
    pose[joint::JOINT_HEAD_RISE] = 0.04;
    pose[joint::JOINT_HEAD_NOD] = 5.0 * kDegree;
    double worst = 0.0;
    for (std::size_t i = 0; i < pose.size(); ++i)
      worst = std::max(worst, std::abs(torso_->joints()[i] - pose[i]));
    torso_error_ = std::min(torso_error_, worst);
  }

  void judge_tasks(std::vector<std::string>& all) const {
    const auto done = operations::tasks_done(states_).size();
    const auto tasks = operations::visit_tasks();
    if (done < tasks.size()) all.push_back(std::string("task not done: ") + tasks[done].text);
  }
  void judge_answers(const std::string& input, std::vector<std::string>& all) const {
    std::size_t touches = 0, words = 0;
    for (const auto& [key, m] : answers_) {
      const bool touch = m.client() == "tablet" && m.input() == answer::INPUT_TOUCH;
      const bool word = m.client() == "speech" && m.input() == answer::INPUT_VOICE;
      touches += touch ? 1 : 0;
      words += word ? 1 : 0;
    }
    const bool right = input == "touch"   ? touches > 0 && words == 0
                       : input == "voice" ? touches == 0 && words > 0
                                          : touches > 0 && words > 0;
    if (!right)
      all.push_back("objectives 4 and 5: " + std::to_string(touches) + " touches and " +
                    std::to_string(words) + " words by " + input);
    if (visit_ && (visit_->touches() != touches || visit_->utterances() != words))
      all.emplace_back("the guide counted other answers");
  }

  const Clock::time_point start_ = Clock::now();
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<void>> readers_;
  geometry::Pose2 robot_, estimate_;
  geometry::Point2 visitor_{100.0, 100.0};
  double lag_ = 0.0;
  std::uint32_t contacts_ = 0;
  std::vector<std::pair<double, std::string>> states_;
  std::map<std::uint64_t, Sentence> said_;
  std::set<std::string> captions_, questions_, languages_;
  std::uint64_t finished_ = 0;
  std::map<std::pair<std::string, std::uint64_t>, usher_msgs::msg::DialogueAnswer> answers_;
  std::optional<usher_msgs::msg::TorsoStatus> torso_;
  std::optional<usher_msgs::msg::GuideVisit> visit_;
  std::optional<double> near_at_;
  double greeted_after_ = INFINITY, map_error_ = INFINITY, torso_error_ = INFINITY;
  double goal_error_ = 0.0, visitor_behind_ = 0.0;
};

class Visit : public testing::TestWithParam<Manner> {
 protected:
  /// The office with the visitor alone; he comes from the door and wants to go to the nearest place
  /// and back.
  static TwoHosts::Options options(const Folder& folder, const Manner& manner,
                                   const std::string& pictures, Witness& witness) {
    const std::string office = USHER_SOURCE_DIR "/config/sites/office/";
    folder.file("config/sites/visit/people.yaml",
                "people:\n  - {name: visitor, at: [4.5, 8.8], yaw: -1.5708}\n");
    folder.file("config/sites/visit/site.yaml",
                "map: " + office + "map.yaml\nworld: " + office +
                    "world.yaml\npeople: people.yaml\ninitial_pose: [4.5, 4.5, 1.5708]\n"
                    "locations:\n"
                    "  - {name: foyer, title: Foyer, x: 4.5, y: 4.5, yaw: 1.5708}\n"
                    "  - {name: reception, title: Reception, x: 10.2, y: 4.6, yaw: 0.0}\n"
                    "  - {name: library, title: Library, x: 7.0, y: 12.6, yaw: 1.5708}\n"
                    "  - {name: kitchen, title: Kitchen, x: 21.5, y: 6.6, yaw: -1.5708}\n");
    const std::string notify = "host: tablet, criticality: notify, heartbeat_timeout: 1.0";
    const std::string speech =
        "  speech: {" + notify +
        ", parameters: {texts: " USHER_SOURCE_DIR
        "/config/dialogue/en.yaml, microphone: 'listen://127.0.0.1:7432', loudspeaker: " +
        folder.path() + "/said.wav}}\n";
    return {.base = "marvin-depth-sim.yaml",
            .lines =
                "site: visit\ncomponents:\n  world: {parameters: {people: true}}\n"
                "  tablet: {parameters: {full_screen: false, pictures: " +
                pictures + ", finger: 'listen://127.0.0.1:7431'}}\n" +
                (manner.speech ? speech : "") + "  visitor: {" + notify +
                ", parameters: {input: " + manner.input + ", language: " + manner.language +
                ", finger: 'tcp://127.0.0.1:7431', " +
                (manner.speech ? "mouth: 'tcp://127.0.0.1:7432', " : "") +
                "destination: reception, returns_to: foyer, looks_at_map: true, "
                "waits_for_greeting: true, steps_up_to: 1.1 m, reading_time: 0.5 s}}\n",
            .listen = [&](runtime::Observer& observer) { witness.listen(observer); }};
  }
};

/// On a busy machine speech may be killed before it has written its file.
void judge_sound(const std::string& path, Complaints& complaints) {
  const auto said = speech::read_wav_file(path);
  if (!said)
    complaints.late.push_back("objective 4: nothing came from the loudspeaker: " + said.error());
  else if (said->duration() < kLeastSound || speech::rms(said->samples) < kLeastLoudness)
    complaints.wrong.emplace_back("objective 4: the loudspeaker was silent");
}

TEST(Complaints, AreForgivenOnABusyMachineOnlyWhereAllIsLateAndNothingWrong) {
  EXPECT_TRUE((Complaints{{}, {"greeted too late"}}.forgivable(true)));
  EXPECT_FALSE((Complaints{{}, {"greeted too late"}}.forgivable(false)));
  EXPECT_FALSE((Complaints{{"task not done"}, {"greeted too late"}}.forgivable(true)));
  EXPECT_FALSE((Complaints{{"not guided twice"}, {}}.forgivable(true)));
}

TEST(Witness, OfAVisitThatNeverBeganIsNotForgiving) {
  const Complaints all = Witness{}.complaints({"touch", false, "de"});
  EXPECT_THAT(all.wrong,
              testing::IsSupersetOf({"objective 1: never greeted", "objective 3: not guided twice",
                                     "another language at the end"}));
  EXPECT_FALSE(all.forgivable(true));
}

TEST_P(Visit, DoesTheSevenTasksAndMeetsTheSixObjectives) {
  const Manner& manner = GetParam();
  const std::string input = manner.input;
  const auto networks = two_networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  const std::string pictures = USHER_BINARY_DIR "/hri_visits/" + input;
  Complaints complaints;
  std::vector<std::string> harm;
  // On a machine that is busy with other things sentences come late: there is a second try.
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::filesystem::remove_all(pictures);
    const Folder folder;
    Witness witness;
    TwoHosts robot(*networks, folder, options(folder, manner, pictures, witness));
    const bool over = robot.wait_for([&] { return witness.over(); }, Seconds(240));
    witness.close();
    witness.print(input);
    complaints = witness.complaints(manner);
    harm = witness.harm();
    if (!over) complaints.wrong.emplace_back("the visit did not end");
    if (!complaints.none()) std::printf("%s", robot.story().c_str());
    robot.stop();
    if (manner.speech) judge_sound(folder.path() + "/said.wav", complaints);
    for (const char* state : {"location_show", "guide_active", "guide_success"}) {
      std::error_code none;
      const bool pictured = std::ranges::any_of(
          std::filesystem::directory_iterator(pictures, none), [&](const auto& entry) {
            return entry.path().filename().string().find(state) != std::string::npos;
          });
      if (!pictured) complaints.late.push_back(std::string("objective 5: no picture of ") + state);
    }
    if (complaints.none() || !harm.empty() || (witness.lag() < kLag && slowdown() < kBusy)) break;
    std::printf("the machine was busy: %s %s\n", testing::PrintToString(complaints.wrong).c_str(),
                testing::PrintToString(complaints.late).c_str());
  }
  EXPECT_THAT(harm, testing::IsEmpty());
  EXPECT_THAT(complaints.wrong, testing::IsEmpty());
  if (harm.empty() && complaints.forgivable(slowdown() >= kBusy))
    GTEST_SKIP() << "this machine is too busy for a conversation in real time";
  EXPECT_THAT(complaints.late, testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(By, Visit,
                         testing::Values(Manner{"touch", false, "de"}, Manner{"voice", true, "en"},
                                         Manner{"mixed", true, "en"}),
                         [](const auto& each) { return std::string(each.param.input); });

}  // namespace
}  // namespace usher::test
