#include "operations/launcher/launcher.hpp"

#include <gmock/gmock.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <thread>

#include "operations/launcher/precedence.hpp"
#include "operations/launcher/run_places.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr auto kPatience = std::chrono::seconds(20);

/// Programs that are shell scripts, and deployments of them.
class Launching : public testing::Test {
 protected:
  Launching() {
    ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    ::setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
    options_ = {"", folder_.path() + "/bin", folder_.path() + "/run"};
    deployment_.manifest.path = "m.yaml";
    deployment_.manifest.domain = 7;
    deployment_.manifest.hosts = {{.name = "nuc"}, {.name = "tablet"}};
    program("sleeper", "exec sleep 1000");
  }

  void program(const std::string& type, const std::string& script) {
    const auto path = folder_.file("bin/usher-" + type, "#!/bin/sh\n" + script + "\n");
    ::chmod(path.c_str(), 0755);
  }
  ManifestComponent& component(const std::string& name, const std::string& type) {
    runtime::ParameterFile file;
    file.component = type;
    file.name = name;
    file.host = "nuc";
    file.domain = 7;
    deployment_.files.push_back(file);
    auto& made = deployment_.manifest.components.emplace_back();
    made.name = name;
    made.type = type;
    made.host = "nuc";
    made.origin = "m.yaml:" + std::to_string(deployment_.files.size());
    return made;
  }
  Launcher launcher() {
    auto made = Launcher::create(deployment_, options_);
    EXPECT_TRUE(made) << (made ? "" : made.error());
    return std::move(made).value();
  }
  std::string refusal() const {
    const auto made = Launcher::create(deployment_, options_);
    return made ? "launched" : made.error();
  }
  /// Polls until the condition holds, and keeps what happened.
  bool wait_for(Launcher& launcher, const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (true) {
      launcher.poll();
      for (auto& event : launcher.events()) events_.push_back(std::move(event));
      if (condition()) return true;
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  static bool alive(pid_t pid) { return ::kill(pid, 0) == 0; }

  test::Folder folder_;
  Deployment deployment_;
  LaunchOptions options_;
  std::vector<std::string> events_;
};

TEST_F(Launching, GivesEachComponentItsParameterFile) {
  component("legs", "sleeper");
  auto& file = deployment_.files[0];
  file.seed = 9;
  file.critical = true;
  file.peers = {"10.0.0.2"};
  file.values = {{"reach", "0.2 m", "config/a \"b\".yaml:3"},
                 {"names", "[a, \"b, c\"]", "m.yaml:1"}};
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.find("legs")->pid > 0; }));
  const auto read = runtime::read_parameter_file(folder_.path() + "/run/legs.yaml");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->component, "sleeper");
  EXPECT_EQ(read->name, "legs");
  EXPECT_EQ(read->host, "nuc");
  EXPECT_EQ(read->domain, 7U);
  EXPECT_EQ(read->seed, 9U);
  EXPECT_TRUE(read->critical);
  EXPECT_GT(read->clock_anchor, 0);
  EXPECT_EQ(read->run_directory, folder_.path() + "/run");
  EXPECT_EQ(read->peers, file.peers);
  ASSERT_EQ(read->values.size(), 2U);
  EXPECT_EQ(read->values[0].yaml, "0.2 m");
  EXPECT_EQ(read->values[0].origin, "config/a \"b\".yaml:3");
  EXPECT_EQ(made.find("legs")->arguments.back(), folder_.path() + "/run/legs.yaml");
  EXPECT_THAT(events_, Contains("legs: started"));
}

TEST_F(Launching, ReadsBackWhatItWritesForAComponentWithoutParameters) {
  component("legs", "sleeper");
  const auto read = runtime::parse_parameter_file(to_yaml(deployment_.files[0]), "legs.yaml");
  ASSERT_TRUE(read) << read.error();
  EXPECT_TRUE(read->values.empty());
}

TEST_F(Launching, LetsWhatMustAnswerInTimeGoFirst) {
  const int before = getpriority(PRIO_PROCESS, 0);
  const bool permitted = may_go_first();
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), before) << "asking changes nothing";
  component("legs", "sleeper");
  component("ears", "sleeper");
  deployment_.files[0].critical = true;
  auto made = launcher();
  const auto nice = [&](const char* name) {
    const pid_t pid = made.find(name)->pid;
    return pid > 0 ? getpriority(PRIO_PROCESS, static_cast<id_t>(pid)) : before + 1;
  };
  if (permitted) {
    EXPECT_TRUE(wait_for(made, [&] { return nice("legs") == -10; }));
  } else {
    EXPECT_TRUE(wait_for(made, [&] { return made.find("legs")->pid > 0; }));
    EXPECT_THAT(events_, Contains(HasSubstr("cannot go before other programs")));
  }
  EXPECT_TRUE(wait_for(made, [&] { return nice("ears") == before; }));
}

/// Processors on which a process may run; -1 where it is gone.
int processors(pid_t pid) {
  cpu_set_t set;
  return sched_getaffinity(pid, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : -1;
}

TEST_F(Launching, LetsWhatMustBeEvenRunInRealTimeOnOneProcessor) {
  const int before = sched_getscheduler(0), all = processors(0);
  const bool permitted = may_run_in_real_time();
  EXPECT_EQ(sched_getscheduler(0), before) << "asking changes nothing";
  EXPECT_EQ(processors(0), all);
  component("eyes", "sleeper").group = "depth";
  component("scans", "sleeper").group = "depth";
  component("legs", "sleeper");
  deployment_.manifest.components[0].real_time = true;
  deployment_.files[2].critical = true;
  program("group", "exec sleep 1000");
  auto made = launcher();
  const auto sleeps = [&](const char* name) {  // and has all that it will have
    const std::string folder = "/proc/" + std::to_string(made.find(name)->pid);
    return test::content_of(folder + "/comm") == "sleep\n";
  };
  ASSERT_TRUE(wait_for(made, [&] { return sleeps("eyes") && sleeps("legs"); }));
  const pid_t eyes = made.find("eyes")->pid, legs = made.find("legs")->pid;
  EXPECT_EQ(sched_getscheduler(legs), before);
  EXPECT_EQ(processors(legs), all);
  if (permitted) {
    EXPECT_EQ(sched_getscheduler(eyes), SCHED_FIFO);
    EXPECT_EQ(processors(eyes), 1) << "the others are the drive chain's";
  } else {
    EXPECT_EQ(sched_getscheduler(eyes), before);
    EXPECT_THAT(events_, Contains(HasSubstr("depth: cannot run in real time")));
  }
}

TEST(Precedence, OfWhoMeasuresIsThatOfTheThreadsThatItStarts) {
  const int before = sched_getscheduler(0);
  const auto measuring = made_before_all([] {
    std::pair<int, sched_param> found;
    std::thread([&] {
      found.first = sched_getscheduler(0);
      sched_getparam(0, &found.second);
    }).join();
    return found;
  });
  EXPECT_EQ(sched_getscheduler(0), before) << "the caller's own";
  if (measuring.first != SCHED_FIFO) GTEST_SKIP() << "real time is not permitted here";
  EXPECT_GE(measuring.second.sched_priority, kRealTime);
}

TEST_F(Launching, RestartsAtOnceWhatWasKilled) {
  component("legs", "sleeper");
  component("arms", "sleeper");
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.find("arms")->pid > 0; }));
  const pid_t legs = made.find("legs")->pid;
  const pid_t arms = made.find("arms")->pid;
  ::kill(legs, SIGKILL);
  ASSERT_TRUE(wait_for(made, [&] { return made.find("legs")->starts == 2; }));
  EXPECT_NE(made.find("legs")->pid, legs);
  EXPECT_EQ(made.find("arms")->pid, arms);
  EXPECT_EQ(made.find("legs")->last_end, "killed by SIGKILL");
  EXPECT_THAT(events_, Contains("legs: started again"));
  EXPECT_FALSE(made.broken());
}

TEST_F(Launching, PausesLongerEachTimeAndGivesUpBeyondTheBudget) {
  program("crash", "echo first; echo the reason is this >&2; exit 3");
  component("legs", "crash").restart_budget = 4;
  auto made = launcher();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(wait_for(made, [&] { return made.broken(); }));
  const auto took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(made.find("legs")->starts, 5) << "the first start and four more";
  EXPECT_EQ(made.find("legs")->state, Process::State::kGaveUp);
  EXPECT_GE(took, std::chrono::milliseconds(0 + 100 + 200 + 400));
  EXPECT_THAT(events_, Contains("legs: ended with a fault (the reason is this)"));
  EXPECT_THAT(events_, Contains(HasSubstr("more than 4 starts within a minute: given up")));
}

TEST_F(Launching, WithoutWhatOnlyMakesItSlowerTheRobotGoesOn) {
  program("crash", "exit 3");
  auto& component_of = component("planner", "crash");
  component_of.restart_budget = 1;
  component_of.criticality = Criticality::kDegrade;
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.incomplete(); }));
  EXPECT_FALSE(made.broken());
}

TEST_F(Launching, DoesNotRestartWhatRefusesItsParameters) {
  program("picky", "echo wrong unit >&2; exit 2");
  component("legs", "picky");
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.broken(); }));
  EXPECT_EQ(made.find("legs")->starts, 1);
  EXPECT_THAT(events_, Contains("legs: refused its parameters (wrong unit)"));
}

TEST_F(Launching, FollowsTheRestartPolicy) {
  program("done", "exit 0");
  program("crash", "exit 3");
  component("never", "done").restart = RestartPolicy::kNever;
  component("on_failure", "done").restart = RestartPolicy::kOnFailure;
  auto made = launcher();
  const auto stopped = [&](const std::string& name) {
    return made.find(name)->state == Process::State::kStopped;
  };
  ASSERT_TRUE(wait_for(made, [&] { return stopped("never") && stopped("on_failure"); }));
  EXPECT_FALSE(made.broken()) << "ending well is not a failure";
  EXPECT_EQ(made.find("on_failure")->starts, 1);

  deployment_.files.clear();
  deployment_.manifest.components.clear();
  component("failing", "crash").restart = RestartPolicy::kOnFailure;
  component("again", "done").restart = RestartPolicy::kAlways;
  options_.run_directory += "2";
  deployment_.manifest.domain = 8;
  auto other = launcher();
  EXPECT_TRUE(wait_for(other, [&] {
    return other.find("failing")->starts >= 2 && other.find("again")->starts >= 2;
  }));
}

TEST_F(Launching, PutsAGroupIntoOneProcess) {
  program("group", "exec sleep 1000");
  component("eyes", "kinect").group = "depth";
  component("depth_pipeline", "depth_pipeline").group = "depth";
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.find("eyes")->pid > 0; }));
  EXPECT_EQ(made.processes().size(), 1U);
  EXPECT_EQ(made.find("eyes"), made.find("depth_pipeline"));
  const auto& words = made.find("eyes")->arguments;
  EXPECT_EQ(words.size(), 5U);
  EXPECT_EQ(words.at(2), folder_.path() + "/run/eyes.yaml");
  EXPECT_EQ(words.at(4), folder_.path() + "/run/depth_pipeline.yaml");
}

TEST_F(Launching, StopsWhatListensAndKillsWhatDoesNot) {
  const std::string order = folder_.path() + "/order";
  program("polite", "trap 'echo polite >> " + order + "; exit 0' TERM\ntouch " + folder_.path() +
                        "/ready\nwhile :; do sleep 0.01; done");
  program("deaf", "trap '' TERM\ntouch " + folder_.path() + "/deaf\nwhile :; do sleep 0.01; done");
  component("polite", "polite");
  component("deaf", "deaf");
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] {
    return std::filesystem::exists(folder_.path() + "/ready") &&
           std::filesystem::exists(folder_.path() + "/deaf");
  }));
  const pid_t polite = made.find("polite")->pid;
  const pid_t deaf = made.find("deaf")->pid;
  const auto start = std::chrono::steady_clock::now();
  made.stop();
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  EXPECT_FALSE(alive(polite));
  EXPECT_FALSE(alive(deaf));
  EXPECT_EQ(test::content_of(order), "polite\n");
  EXPECT_EQ(made.find("polite")->state, Process::State::kStopped);
  EXPECT_THAT(made.events(), Contains("deaf: did not stop within 2 s, killed"));
}

TEST_F(Launching, StopsTheRobotFirstAndTheBaseLast) {
  const std::string order = folder_.path() + "/order";
  // Each writes its name when it is asked to end, and the base what the robot did then.
  for (const std::string name : {"base", "supervisor", "planner", "screen"}) {
    std::string script = "trap 'echo " + name;
    script += " >> " + order;
    script += "; exit 0' TERM\ntouch " + folder_.path();
    script += "/ready_" + name;
    script += "\nwhile :; do sleep 0.01; done";
    program(name, script);
    component(name, name);
  }
  deployment_.movement = {{"base", Movement::kBaseDriver}, {"planner", Movement::kCommands}};
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] {
    return std::filesystem::exists(folder_.path() + "/ready_base") &&
           std::filesystem::exists(folder_.path() + "/ready_supervisor") &&
           std::filesystem::exists(folder_.path() + "/ready_planner") &&
           std::filesystem::exists(folder_.path() + "/ready_screen");
  }));
  std::string when_asked;
  int asked = 0;
  made.stop([&] {
    when_asked = test::content_of(order);
    return ++asked == 20;
  });
  EXPECT_EQ(asked, 20) << "nobody else is stopped before the robot stands";
  EXPECT_EQ(when_asked, "planner\n");
  EXPECT_EQ(test::content_of(order), "planner\nscreen\nsupervisor\nbase\n");
}

TEST_F(Launching, DoesNotWaitForEverForARobotThatDoesNotStand) {
  component("legs", "sleeper");
  deployment_.movement = {{"legs", Movement::kBaseDriver}};
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.find("legs")->pid > 0; }));
  const auto start = std::chrono::steady_clock::now();
  made.stop([] { return false; });
  EXPECT_GE(std::chrono::steady_clock::now() - start, Launcher::kLongestStanding);
  EXPECT_EQ(made.find("legs")->state, Process::State::kStopped);
  EXPECT_THAT(made.events(), Contains("the robot was not seen to stand within 5 s"));
}

TEST_F(Launching, GoesOnWithoutWhatIsMerelyReported) {
  program("crash", "exit 3");
  component("screen", "crash").restart_budget = 1;
  deployment_.manifest.components.back().criticality = Criticality::kNotify;
  component("legs", "sleeper");
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.incomplete(); }));
  EXPECT_FALSE(made.broken());
  EXPECT_THAT(events_, Contains(HasSubstr("given up; the robot goes on without it")));
  EXPECT_TRUE(alive(made.find("legs")->pid));
  EXPECT_THAT(made.summary(), HasSubstr("screen is given up"));
}

TEST_F(Launching, BoundsTheLogsAndKeepsTheFormerOne) {
  program("chatter", "while :; do head -c 200000 /dev/zero; sleep 0.02; done");
  component("legs", "chatter");
  folder_.file("run/legs.log", "the former launch\n");
  const std::string log = folder_.path() + "/run/legs.log";
  auto made = launcher();
  EXPECT_EQ(test::content_of(log + ".1"), "the former launch\n");
  ASSERT_TRUE(wait_for(made, [&] {
    std::error_code error;
    return std::filesystem::file_size(log + ".1", error) > 4'000'000;
  }));
  const auto chatter = made.find("legs")->pid;
  ::kill(chatter, SIGSTOP);
  made.poll();
  EXPECT_EQ(made.find("legs")->starts, 1) << "its log was cut under its hands";
}

TEST_F(Launching, KeepsItsFilesWhereNobodyElseCanPutAny) {
  component("legs", "sleeper");
  const std::string runtime = folder_.path() + "/runtime";
  std::filesystem::create_directory(runtime);
  ::setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  EXPECT_EQ(refusal(), "launched");
  struct stat facts {};
  ASSERT_EQ(::stat((runtime + "/usher").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0700U);
  std::filesystem::remove_all(runtime + "/usher");
  std::filesystem::create_directory_symlink(folder_.path(), runtime + "/usher");
  EXPECT_EQ(refusal(), runtime + "/usher must be a directory of this user, and is not");
  std::filesystem::remove(runtime + "/usher");
  // Below /tmp, as here, others may not even read; what others could have written is not taken.
  ASSERT_EQ(::mkdir((runtime + "/usher").c_str(), 0755), 0);
  EXPECT_EQ(refusal(), "launched");
  ASSERT_EQ(::stat((runtime + "/usher").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0700U);
  ASSERT_EQ(::chmod((runtime + "/usher").c_str(), 0777), 0);
  EXPECT_THAT(refusal(), HasSubstr("others may write there"));
}

TEST(RunDirectory, OutlivesABootWhereTheUserHasAHome) {
  ::setenv("XDG_STATE_HOME", "/state", 1);
  ::setenv("HOME", "/home/ann", 1);
  EXPECT_EQ(default_run_directory(7, "nuc"), "/state/usher/domain-7-nuc");
  ::unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(default_run_directory(7, ""), "/home/ann/.local/state/usher/domain-7");
  ::unsetenv("HOME");
  ::unsetenv("XDG_RUNTIME_DIR");
  const std::string user = std::to_string(::geteuid());
  EXPECT_THAT(default_run_directory(7, "nuc"),
              testing::AnyOf("/run/user/" + user + "/usher/domain-7-nuc",
                             "/tmp/usher-" + user + "/domain-7-nuc"));
}

TEST_F(Launching, MakesItsRunDirectoryForThisUserAlone) {
  component("legs", "sleeper");
  const std::string run = options_.run_directory = folder_.path() + "/deep/run/";
  { const auto made = launcher(); }
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(run).permissions(), perms::owner_all);
  std::filesystem::permissions(run, perms::owner_all | perms::group_all);
  { const auto made = launcher(); }
  EXPECT_EQ(std::filesystem::status(run).permissions(), perms::owner_all | perms::group_all)
      << "one that was there stays as somebody made it";
}

TEST_F(Launching, NamesTheDomainsWhereALauncherLives) {
  component("legs", "sleeper");
  const std::string runtime = folder_.path() + "/runtime";
  std::filesystem::create_directory(runtime);
  ::setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  const std::uint32_t domain = deployment_.manifest.domain;
  {
    const auto lives = launcher();
    EXPECT_THAT(launched_domains(), testing::Contains(domain));
    folder_.file("runtime/usher/domain-99-nuc.lock", "999999999\n");  // more than any process has
    folder_.file("runtime/usher/domain-99-operator.yaml", "");
    folder_.file("runtime/usher/domain-x-nuc.lock", "1\n");
    folder_.file("runtime/usher/domain-98.lock", std::to_string(::getpid()) + "\n");
    folder_.file("runtime/usher/domain-98-operator.yaml", "");
    EXPECT_THAT(launched_domains(), testing::Not(testing::Contains(99U))) << "it was killed";
    EXPECT_THAT(launched_domains(), testing::Not(testing::Contains(98U)))
        << "that is no lock of ours";
  }
  EXPECT_THAT(launched_domains(), testing::Not(testing::Contains(domain))) << "it has ended";
  ::unsetenv("XDG_RUNTIME_DIR");
}

TEST_F(Launching, StopsWhatIsHalted) {
  component("legs", "sleeper");
  auto made = launcher();
  ASSERT_TRUE(wait_for(made, [&] { return made.find("legs")->pid > 0; }));
  const pid_t legs = made.find("legs")->pid;
  ::kill(legs, SIGSTOP);
  made.stop();
  EXPECT_FALSE(alive(legs));
}

TEST_F(Launching, StopsEverythingWhenItEnds) {
  component("legs", "sleeper");
  pid_t legs = 0;
  {
    auto made = launcher();
    ASSERT_TRUE(wait_for(made, [&] { return made.find("legs")->pid > 0; }));
    legs = made.find("legs")->pid;
  }
  EXPECT_FALSE(alive(legs));
}

TEST_F(Launching, IsRefusedTwice) {
  component("legs", "sleeper");
  const std::string already =
      "this robot is already launched here, by process " + std::to_string(::getpid());
  {
    const auto first = launcher();
    EXPECT_THAT(refusal(), HasSubstr(already)) << "the same run directory";
    options_.run_directory += "2";
    EXPECT_THAT(refusal(), HasSubstr(already)) << "the same host in the same domain";
    options_.host = "nuc";
    EXPECT_THAT(refusal(), HasSubstr(already));
    deployment_.manifest.domain = 8;
    EXPECT_EQ(refusal(), "launched") << "another robot";
    options_.run_directory = folder_.path() + "/run";
    EXPECT_THAT(refusal(), HasSubstr(already)) << "another robot, but in the first one's place";
  }
  EXPECT_EQ(refusal(), "launched") << "when the first has ended";
}

TEST_F(Launching, StartsOnlyItsHostsPart) {
  component("legs", "sleeper");
  component("screen", "sleeper").host = "tablet";
  options_.host = "tablet";
  const auto made = launcher();
  EXPECT_EQ(made.processes().size(), 1U);
  EXPECT_EQ(made.find("legs"), nullptr);
  EXPECT_NE(made.find("screen"), nullptr);
}

TEST_F(Launching, RefusesWhatCannotWork) {
  component("legs", "sleeper");
  options_.host = "laptop";
  EXPECT_EQ(refusal(), "unknown host 'laptop', expected one of nuc, tablet (m.yaml)");
  options_.host = "tablet";
  EXPECT_EQ(refusal(), "nothing runs on host 'tablet' (m.yaml)");
  options_.host = "";
  component("wings", "feathers");
  EXPECT_EQ(refusal(), "program " + folder_.path() + "/bin/usher-feathers is missing (m.yaml:2)");
  deployment_.findings.push_back({Verdict::kNoWriter, "nobody writes scan", "m.yaml:5"});
  EXPECT_EQ(refusal(), "m.yaml:5: no writer: nobody writes scan");
}

TEST_F(Launching, ForgetsWhatWasKeptForAFreshStart) {
  component("legs", "sleeper");
  const auto kept = folder_.file("run/kept/legs/pose", "1 2 3");
  launcher();
  EXPECT_TRUE(std::filesystem::exists(kept));
  deployment_.manifest.fresh_start = true;
  launcher();
  EXPECT_FALSE(std::filesystem::exists(kept));
}

TEST_F(Launching, ABootEndsTheSessionAndNoLatch) {
  component("legs", "sleeper");
  const auto latch = folder_.file("run/kept/legs/emergency", "off");
  auto pose = folder_.file("run/kept/amcl/session.pose", "1 2 3");
  launcher();
  EXPECT_FALSE(std::filesystem::exists(pose)) << "the first launch since the boot";
  folder_.file("run/kept/amcl/session.pose", "4 5 6");
  launcher();
  EXPECT_TRUE(std::filesystem::exists(pose)) << "a launcher that was only restarted";
  std::filesystem::remove_all(folder_.path() + "/usher");  // as a boot does to XDG_RUNTIME_DIR
  launcher();
  EXPECT_FALSE(std::filesystem::exists(pose));
  // A machine whose folder outlives a boot, as /tmp may.
  folder_.file("run/kept/amcl/session.pose", "7 8 9");
  for (const auto& lock : std::filesystem::directory_iterator(folder_.path() + "/usher"))
    std::ofstream(lock.path()) << "1234\n8a1f-of-another-boot\n";
  launcher();
  EXPECT_FALSE(std::filesystem::exists(pose)) << "locks of before the boot";
  EXPECT_TRUE(std::filesystem::exists(latch));
}

TEST_F(Launching, KillsWhatWasHeardAndFallsSilent) {
  for (const auto* name : {"legs", "head", "arms"}) component(name, "sleeper");
  auto launcher = this->launcher();
  ASSERT_TRUE(wait_for(launcher, [&] { return launcher.find("arms")->pid != 0; }));
  const pid_t legs = launcher.find("legs")->pid;
  const pid_t arms = launcher.find("arms")->pid;
  const auto begin = std::chrono::steady_clock::now();
  launcher.heard("legs", begin);
  launcher.heard("head", begin);
  ASSERT_TRUE(wait_for(launcher, [&] {
    const auto now = std::chrono::steady_clock::now();
    launcher.heard("somebody on another host", now);
    launcher.heard_by_supervisor("head", now);
    return launcher.find("legs")->starts == 2;
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, Launcher::kHang);
  EXPECT_NE(launcher.find("legs")->pid, legs);
  EXPECT_EQ(launcher.find("arms")->pid, arms) << "never heard: it may not speak at all";
  EXPECT_EQ(launcher.find("head")->starts, 1) << "the supervisor hears it";
  EXPECT_THAT(events_, Contains("legs: hangs, killed"));
}

TEST_F(Launching, KillsWhatDoesNotComeAlive) {
  for (const auto* name : {"legs", "arms", "screen", "map"})
    component(name, "sleeper").start_patience = 6.0;
  component("patient", "sleeper");
  auto launcher = this->launcher();
  ASSERT_TRUE(wait_for(launcher, [&] { return launcher.find("patient")->pid != 0; }));
  const auto begin = std::chrono::steady_clock::now();
  launcher.heard("map", begin);
  ASSERT_TRUE(wait_for(launcher, [&] {
    const auto now = std::chrono::steady_clock::now();
    launcher.heard("arms", now);
    launcher.heard("map", now);
    launcher.heard_by_supervisor("screen", now);
    return launcher.find("legs")->starts == 2;
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  for (const auto* name : {"arms", "screen", "map", "patient"})
    EXPECT_EQ(launcher.find(name)->starts, 1) << name;
  EXPECT_THAT(events_, Contains("legs: has not come alive within 6 s of its start, killed"));
}

TEST_F(Launching, IsTwiceAsPatientWithKeys) {
  deployment_.manifest.keys = "keys";
  component("legs", "sleeper").start_patience = 3.0;
  auto launcher = this->launcher();
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(wait_for(launcher, [&] {
    launcher.heard("arms", std::chrono::steady_clock::now());
    return launcher.find("legs")->starts == 2;
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_THAT(events_, Contains("legs: has not come alive within 6 s of its start, killed"));
}

TEST_F(Launching, KillsNobodyWhenItHearsNobody) {
  component("legs", "sleeper").start_patience = 1.0;
  auto launcher = this->launcher();
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(wait_for(launcher, [&] {
    return std::chrono::steady_clock::now() - begin > Launcher::kHang + std::chrono::seconds(2);
  }));
  EXPECT_EQ(launcher.find("legs")->starts, 1);
}

TEST_F(Launching, KillsNobodyWhenItHearsNobodyAnyMore) {
  component("legs", "sleeper");
  auto launcher = this->launcher();
  ASSERT_TRUE(wait_for(launcher, [&] { return launcher.find("legs")->pid != 0; }));
  const auto begin = std::chrono::steady_clock::now();
  launcher.heard("legs", begin);
  ASSERT_TRUE(wait_for(launcher, [&] {
    return std::chrono::steady_clock::now() - begin > Launcher::kHang + std::chrono::seconds(2);
  }));
  EXPECT_EQ(launcher.find("legs")->starts, 1);
}

TEST_F(Launching, BelievesNoSilenceWhenItWasStoppedItself) {
  component("legs", "sleeper");
  auto launcher = this->launcher();
  ASSERT_TRUE(wait_for(launcher, [&] { return launcher.find("legs")->pid != 0; }));
  launcher.heard("legs", std::chrono::steady_clock::now());
  std::this_thread::sleep_for(Launcher::kHang + std::chrono::milliseconds(100));  // as SIGSTOP does
  launcher.poll();
  launcher.poll();
  EXPECT_EQ(launcher.find("legs")->starts, 1);
  EXPECT_TRUE(alive(launcher.find("legs")->pid));
}

}  // namespace
}  // namespace usher::operations
