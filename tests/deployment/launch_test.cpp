// What `usher launch` refuses: a clear error, an exit code that is not 0, nothing left running.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "deployment/running_robot.hpp"
#include "support/service_manager.hpp"
#include "support/terminal.hpp"
#include "support/test_domain.hpp"

namespace usher::test {
namespace {

using Words = std::vector<std::string>;

class Launch : public testing::Test {
 protected:
  Launch() {
    ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    ::setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
  }

  std::string manifest(const std::string& change = "") const {
    return folder_.file("deploy/robot.yaml", "extends: " + std::string(USHER_SOURCE_DIR) +
                                                 "/deploy/marvin-sim.yaml\ndomain: " +
                                                 std::to_string(test_domain()) + "\n" + change);
  }
  /// What it says on stderr.
  std::string refused(Words words, const std::string& program = usher_program()) const {
    words.insert(words.begin(), {program, "launch"});
    Process launch(words);
    const int code = launch.wait();
    EXPECT_GT(code, 0);
    EXPECT_LT(code, 128);
    EXPECT_TRUE(components_from(folder_.path()).empty());
    EXPECT_FALSE(launch.errors().empty());
    return launch.errors();
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  Folder folder_;
};

TEST_F(Launch, RefusesAMissingFile) {
  const auto path = folder_.path() + "/none.yaml";
  EXPECT_EQ(refused({path}), "usher: there is no such file (" + path + ")\n");
  EXPECT_TRUE(contains(refused({folder_.path()}), "it is a directory"));
}

TEST_F(Launch, RefusesAWrongKey) {
  const auto path = manifest("components:\n  amcl: {critical: stop}\n");
  const auto errors = refused({path});
  EXPECT_TRUE(contains(errors, path + ":4: unknown key: component 'amcl': unknown key 'critical'"))
      << errors;
  EXPECT_TRUE(contains(errors, "nothing was started")) << errors;
}

TEST_F(Launch, RefusesAnUnknownHost) {
  const auto errors = refused({manifest(), "--host", "laptop"});
  EXPECT_TRUE(contains(errors, "unknown host 'laptop', expected one of nuc, tablet")) << errors;
}

TEST_F(Launch, RefusesAHostWithoutComponents) {
  const auto errors = refused({manifest("hosts:\n  attic: {}\n"), "--host", "attic"});
  EXPECT_TRUE(contains(errors, "nothing runs on host 'attic'")) << errors;
}

TEST_F(Launch, RefusesWrongSettings) {
  EXPECT_TRUE(contains(refused({manifest(), "--set", "amcl"}), "COMPONENT.PARAMETER=VALUE"));
  EXPECT_TRUE(contains(refused({manifest(), "--set", "amcl.beams=3"}),
                       "command line: unknown key: component 'amcl' has no parameter 'beams'"));
  EXPECT_TRUE(contains(refused({manifest(), "--set", "ghost.a=3"}), "no component 'ghost'"));
  EXPECT_TRUE(contains(refused({manifest(), "--set", "guide.answer_timeout=60 deg"}),
                       "command line: wrong value"));
}

TEST_F(Launch, RefusesARunDirectoryThatCannotBeWritten) {
  const auto file = folder_.file("occupied", "");
  const auto errors = refused({manifest(), "--run-directory", file + "/run"});
  EXPECT_TRUE(contains(errors, "cannot write " + file + "/run")) << errors;
}

TEST_F(Launch, RefusesWhenAProgramIsMissing) {
  namespace fs = std::filesystem;
  const auto program = folder_.file("install/bin/usher", "");
  fs::copy_file(usher_program(), program, fs::copy_options::overwrite_existing);
  fs::create_directories(folder_.path() + "/install/share");
  fs::create_directory_symlink(std::string(USHER_BINARY_DIR) + "/share/usher",
                               folder_.path() + "/install/share/usher");
  const auto errors = refused({manifest()}, program);
  EXPECT_TRUE(contains(errors, "usher-")) << errors;
  EXPECT_TRUE(contains(errors, " is missing (")) << errors;
}

TEST_F(Launch, WithoutManifestIsAWrongCall) {
  Process launch({usher_program(), "launch"});
  EXPECT_EQ(launch.wait(), 2);
}

TEST(Help, OfACommandNamesAllThatTheCommandTakes) {
  const std::vector<std::vector<std::string>> commands{
      {"launch", "--keys"},         {"check", "--keys"},
      {"topics", "echo", "--keys"}, {"bench", "--json"},
      {"bench", "--instructions"},  {"experiment", "--seeds"},
      {"status", "--domain"},       {"calibrate", "kinect", "--keys"}};
  for (auto command : commands) {
    const std::string option = command.back();
    command.back() = "--help";
    command.insert(command.begin(), usher_program());
    Process help(command);
    EXPECT_EQ(help.wait(), 0) << help.errors();
    EXPECT_NE(help.output().find(option), std::string::npos) << option << "\n" << help.output();
  }
}

TEST(Measuring, HandsItsOptionsToTheProgramThatMeasures) {
  Process list({usher_program(), "experiment", "--list"});
  EXPECT_EQ(list.wait(), 0) << list.errors();
  EXPECT_NE(list.output().find("guide: "), std::string::npos) << list.output();
  Process experiment({usher_program(), "experiment", "nothing", "--seeds", "2", "--out", "/tmp"});
  EXPECT_NE(experiment.wait(), 0);
  EXPECT_NE(experiment.errors().find("unknown experiment 'nothing'"), std::string::npos)
      << experiment.errors();
  Process bench({usher_program(), "bench", "nothing", "--json", "--instructions"});
  EXPECT_NE(bench.wait(), 0);
  EXPECT_NE(bench.errors().find("nothing"), std::string::npos) << bench.errors();
  EXPECT_EQ(bench.errors().find("not expected"), std::string::npos) << bench.errors();
}

// The first start of map_server hangs before it could say anything.
TEST_F(Launch, KillsAndRestartsWhatDoesNotComeAlive) {
  namespace fs = std::filesystem;
  const std::string install = folder_.path() + "/install", built = std::string(USHER_BINARY_DIR);
  fs::create_directories(install + "/bin");
  fs::create_directories(install + "/share");
  fs::create_directory_symlink(built + "/share/usher", install + "/share/usher");
  for (const auto& program : fs::directory_iterator(built + "/bin"))
    fs::create_symlink(program, install + "/bin/" + program.path().filename().string());
  for (const auto* own : {"/bin/usher", "/bin/usher-map_server"}) fs::remove(install + own);
  fs::copy_file(usher_program(), install + "/bin/usher");
  fs::permissions(folder_.file("install/bin/usher-map_server",
                               "#!/bin/sh\nmkdir " + install + "/hung && exec sleep 1000\nexec " +
                                   built + "/bin/usher-map_server \"$@\"\n"),
                  fs::perms::owner_all);
  Process launch({install + "/bin/usher", "launch",
                  manifest("components:\n  map_server: {start_patience: 6}\n")});
  const auto says = [&](const std::string& text) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(40);
    while (!contains(launch.output(), text) && std::chrono::steady_clock::now() < until &&
           launch.pid() > 0)
      launch.wait(std::chrono::milliseconds(100));
    return contains(launch.output(), text);
  };
  EXPECT_TRUE(says("map_server: has not come alive within 6 s of its start, killed"))
      << launch.output() << launch.errors();
  EXPECT_TRUE(says("map_server: started again")) << launch.output();
  launch.wait(std::chrono::seconds(8));
  launch.signal(SIGTERM);
  EXPECT_EQ(launch.wait(), 0) << launch.output();
  const std::string told = launch.output();
  EXPECT_EQ(told.find("has not come alive"), told.rfind("has not come alive")) << told;
}

// Ctrl-S, for longer than the terminal's buffer lasts: the supervision goes on.
TEST_F(Launch, RestartsWhatEndsThoughItsTerminalIsPaused) {
  Terminal terminal;
  Process launch({usher_program(), "launch", manifest(), "--host", "tablet"}, terminal.path());
  const auto tablet_after = [&](pid_t former) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(40);
    while (launch.pid() > 0 && std::chrono::steady_clock::now() < until) {
      const auto components = components_from(folder_.path());
      const auto tablet = components.find("tablet");
      if (tablet != components.end() && tablet->second != former) return tablet->second;
      launch.wait(std::chrono::milliseconds(20));
    }
    return pid_t{0};
  };
  pid_t tablet = tablet_after(0);
  ASSERT_GT(tablet, 0) << terminal.text() << launch.errors();
  terminal.type("\x13");
  launch.wait(std::chrono::seconds(2));  // a table each second is held up
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(::kill(tablet, SIGKILL), 0);
    const pid_t next = tablet_after(tablet);
    ASSERT_GT(next, 0) << "restart " << i + 1;
    tablet = next;
  }
  launch.signal(SIGTERM);
  EXPECT_EQ(launch.wait(), 0) << launch.errors();
  terminal.type("\x11");
  EXPECT_TRUE(contains(terminal.text(), "tablet: started")) << terminal.text();
}

TEST_F(Launch, SaysThatItLivesAndWhatItLaunchedEndsWhenItHangs) {
  constexpr std::chrono::seconds kWatchdog(1);
  constexpr Seconds kAborted(3);  // TimeoutAbortSec= of the unit
  const ServiceManager manager(kWatchdog);
  Process launch({usher_program(), "launch", manifest(), "--host", "tablet"});
  const auto hears = [&](const std::string& word, Seconds limit) {
    const auto until = std::chrono::steady_clock::now() + limit;
    for (;;) {
      const auto words = manager.heard();
      if (std::ranges::count(words, word) > 0) return true;
      if (std::chrono::steady_clock::now() > until) return false;
      launch.wait(std::chrono::milliseconds(10));
    }
  };
  ASSERT_TRUE(hears("READY=1", Seconds(40))) << launch.errors();
  for (int i = 0; i < 10; ++i)
    ASSERT_TRUE(hears("WATCHDOG=1", Seconds(kWatchdog) * slowdown())) << i << launch.errors();
  ASSERT_FALSE(components_from(folder_.path()).empty());

  launch.signal(SIGSTOP);
  manager.heard();
  EXPECT_FALSE(hears("WATCHDOG=1", Seconds(kWatchdog)));
  for (const auto& [name, process] : components_from(folder_.path())) ::kill(process, SIGTERM);
  const auto until = std::chrono::steady_clock::now() + kAborted * slowdown();
  while (!components_from(folder_.path()).empty() && std::chrono::steady_clock::now() < until)
    launch.wait(std::chrono::milliseconds(20));
  EXPECT_TRUE(components_from(folder_.path()).empty());
}

TEST(SecondLaunch, IsRefusedAndTheFirstGoesOn) {
  RunningRobot robot;
  ASSERT_TRUE(robot.wait_for([&] { return robot.may_drive(); }, Seconds(60)))
      << robot.launcher().errors();
  const auto before = robot.components();
  for (const Words& options :
       {Words{}, Words{"--host", "nuc"}, Words{"--run-directory", robot.folder() + "/elsewhere"}}) {
    Words words{usher_program(), "launch", robot.manifest()};
    words.insert(words.end(), options.begin(), options.end());
    Process second(words);
    EXPECT_EQ(second.wait(), 1);
    EXPECT_NE(second.errors().find("this robot is already launched here, by process " +
                                   std::to_string(robot.launcher().pid())),
              std::string::npos)
        << second.errors();
  }
  EXPECT_EQ(robot.components(), before);
}

}  // namespace
}  // namespace usher::test
