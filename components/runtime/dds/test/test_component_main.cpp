// The program of a component, as a process of its own.
#include <gmock/gmock.h>

#include <filesystem>

#include "echo_component.hpp"
#include "runtime/api/contract.hpp"
#include "runtime/dds/observer.hpp"
#include "support/folder.hpp"
#include "support/process.hpp"
#include "support/sanitizer.hpp"
#include "support/test_domain.hpp"

namespace usher::runtime {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using usher::test::Folder;
using usher::test::Process;

constexpr Duration kLong =
    std::chrono::duration_cast<Duration>(10s * usher::test::kSanitizerFactor);
const std::string kProgram = USHER_BINARY_DIR "/tests/usher-test-echo";

std::string parameters(const std::string& name = "echo", const std::string& rest = "") {
  return "component: echo\nname: " + name +
         "\nhost: nuc\ndomain: " + std::to_string(test_domain()) + "\nseed: 1\ncritical: true\n" +
         rest;
}
std::unique_ptr<Observer> observer() {
  return std::move(Observer::create(
                       {.name = "operator", .host = "nuc", .domain = test_domain(), .peers = {}}))
      .value();
}
bool sees(const Observer& observer, const std::string& name) {
  return std::ranges::any_of(observer.participants(), [&](const ParticipantInfo& info) {
    return info.identity.name == name;
  });
}

TEST(ComponentMain, PrintsWhatTheComponentIs) {
  Process help({kProgram, "--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_THAT(help.output(), HasSubstr("--parameters"));
  EXPECT_THAT(help.output(), HasSubstr("cmd_vel/interaction"));
  EXPECT_THAT(help.output(), HasSubstr("gain"));
  EXPECT_THAT(help.output(), HasSubstr("0.1..10"));
  EXPECT_THAT(help.output(), HasSubstr("Factor on the velocity."));
  Process contract({kProgram, "--contract"});
  EXPECT_EQ(contract.wait(), 0);
  const auto read = contract_from_yaml(contract.output(), "--contract");
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(read->component, "echo");
  Process version({kProgram, "--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_THAT(version.output(), HasSubstr("usher-echo "));
}

TEST(ComponentMain, EndsWithCode2OnWrongOptionsAndFiles) {
  const Folder folder;
  Process option({kProgram, "--frequency", "50"});
  EXPECT_EQ(option.wait(), 2);
  Process absent({kProgram, "--parameters", folder.path() + "/absent.yaml"});
  EXPECT_EQ(absent.wait(), 2);
  EXPECT_THAT(absent.errors(), HasSubstr("absent.yaml"));
  const std::string range =
      folder.file("range.yaml", parameters("echo", "parameters:\n  gain: 0\n"));
  Process wrong({kProgram, "--parameters", range});
  EXPECT_EQ(wrong.wait(), 2);
  EXPECT_THAT(wrong.errors(), HasSubstr("range.yaml:8"));
  std::string other = parameters();
  other.replace(other.find("echo"), 4, "amcl");
  Process misled({kProgram, "--parameters", folder.file("amcl.yaml", other)});
  EXPECT_EQ(misled.wait(), 2);
  EXPECT_THAT(misled.errors(), HasSubstr("amcl"));
}

TEST(ComponentMain, StopsInOrderWhenAsked) {
  const Folder folder;
  const std::string path = folder.file("echo.yaml", parameters());
  auto out = observer();
  for (const int signal : {SIGTERM, SIGINT}) {
    Process child({kProgram, "--parameters", path});
    ASSERT_TRUE(out->wait_for([](const Observer& o) { return sees(o, "echo"); }, kLong));
    child.signal(signal);
    EXPECT_EQ(child.wait(), 0) << child.errors();
    // It has left: nobody had to wait for its lease.
    EXPECT_TRUE(out->wait_for([](const Observer& o) { return !sees(o, "echo"); }, 500ms));
  }
}

TEST(ComponentMain, EndsWithCode3AfterAFault) {
  const Folder folder;
  Process child({kProgram, "--parameters", folder.file("echo.yaml", parameters())});
  auto out = observer();
  auto questions = out->writer(topics::kCmdVelManual);
  auto heartbeats = out->reader(topics::kHeartbeat);
  ASSERT_TRUE(questions.ok() && questions->wait_for_readers(1, kLong));
  ASSERT_NE(heartbeats->take(kLong), nullptr);
  questions->write(test::question(out->now(), 0.0, 666.0));
  EXPECT_EQ(child.wait(), 3);
  EXPECT_THAT(child.errors(), HasSubstr("asked to fail"));
  for (;;) {
    const auto beat = heartbeats->take(kLong);
    ASSERT_NE(beat, nullptr) << "the last heartbeat was lost";
    if (beat->state() == usher_msgs::msg::Heartbeat_Constants::STATE_FAULT) break;
  }
}

TEST(ComponentMain, IgnoresDdsSettingsOfTheEnvironment) {
  // A profile that would move every participant to another network interface, and a discovery
  // server that is not there.
  const Folder folder;
  const std::string profile = folder.file("profile.xml", "<this is not even XML");
  ::setenv("FASTRTPS_DEFAULT_PROFILES_FILE", profile.c_str(), 1);
  ::setenv("ROS_DISCOVERY_SERVER", "10.255.255.1:11811", 1);
  Process child({kProgram, "--parameters", folder.file("echo.yaml", parameters())});
  ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
  ::unsetenv("ROS_DISCOVERY_SERVER");
  auto out = observer();
  EXPECT_TRUE(out->wait_for([](const Observer& o) { return sees(o, "echo"); }, kLong));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(child.output() + child.errors(), "");
}

TEST(ComponentMain, IsBackAndMatchedWithin1SecondAfterKill9) {
  const Folder folder;
  const std::string path = folder.file("echo.yaml", parameters());
  auto out = observer();
  auto answers = out->reader(topics::kCmdVelInteraction);
  auto questions = out->writer(topics::kCmdVelManual);
  ASSERT_TRUE(answers.ok() && questions.ok());
  const auto answered = [&] {
    const auto end = std::chrono::steady_clock::now() + kLong;
    while (std::chrono::steady_clock::now() < end) {
      questions->write(test::question(out->now(), 1.0));
      if (answers->take(5ms) != nullptr) return true;
    }
    return false;
  };
  std::vector<double> times;
  auto child = std::make_unique<Process>(std::vector<std::string>{kProgram, "--parameters", path});
  ASSERT_TRUE(answered());
  for (int round = 0; round < 5; ++round) {
    child->signal(SIGKILL);
    ASSERT_EQ(child->wait(), 128 + SIGKILL);
    while (answers->take() != nullptr) {
    }
    const auto begin = std::chrono::steady_clock::now();
    child = std::make_unique<Process>(std::vector<std::string>{kProgram, "--parameters", path});
    ASSERT_TRUE(answered());
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::ranges::sort(times);
  std::printf("first answer after a restart: median %.0f ms, worst %.0f ms\n", 1e3 * times[2],
              1e3 * times[4]);
  EXPECT_LT(times[2], 1.0 * usher::test::kSanitizerFactor);
}

TEST(ComponentMain, IsSeenDeadWithinItsLeaseAfterKill9) {
  const Folder folder;
  Process child({kProgram, "--parameters", folder.file("echo.yaml", parameters())});
  auto out = observer();
  ASSERT_TRUE(out->wait_for([](const Observer& o) { return sees(o, "echo"); }, kLong));
  child.signal(SIGKILL);
  ASSERT_EQ(child.wait(), 128 + SIGKILL);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(out->wait_for([](const Observer& o) { return !sees(o, "echo"); }, kLong));
  std::printf(
      "seen dead after %.0f ms\n",
      1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  EXPECT_TRUE(std::ranges::none_of(out->endpoints(),
                                   [](const EndpointInfo& e) { return e.participant == "echo"; }));
}

TEST(GroupMain, RunsSeveralComponentsInOneProcess) {
  const Folder folder;
  const std::string left = folder.file("left.yaml", parameters("left"));
  const std::string right = folder.file("right.yaml", parameters("right"));
  Process child({kProgram, "--group", "--parameters", left, "--parameters", right});
  auto out = observer();
  ASSERT_TRUE(
      out->wait_for([](const Observer& o) { return sees(o, "left") && sees(o, "right"); }, kLong));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait(), 0) << child.errors();
}

TEST(GroupMain, EndsAllWhenOneEnds) {
  const Folder folder;
  Process child({kProgram, "--group", "--parameters", folder.file("left.yaml", parameters("left")),
                 "--parameters", folder.file("right.yaml", parameters("right"))});
  auto out = observer();
  auto questions = out->writer(topics::kCmdVelManual);
  ASSERT_TRUE(questions.ok() && questions->wait_for_readers(2, kLong));
  questions->write(test::question(out->now(), 0.0, 666.0));
  EXPECT_EQ(child.wait(), 3) << child.errors();
}

TEST(GroupMain, RefusesComponentsThatItDoesNotHave) {
  const Folder folder;
  std::string other = parameters();
  other.replace(other.find("echo"), 4, "amcl");
  Process child({kProgram, "--group", "--parameters", folder.file("amcl.yaml", other)});
  EXPECT_EQ(child.wait(), 2);
  EXPECT_THAT(child.errors(), HasSubstr("'amcl' is not in this program"));
  Process none({kProgram, "--group"});
  EXPECT_EQ(none.wait(), 2);
}

}  // namespace
}  // namespace usher::runtime
