// The script `usher` in a tree where nothing is real but itself: what it installs, builds and runs.
#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "support/process.hpp"

namespace usher {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr const char* kBookworm =
    "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_ID=\"12\"\nID=debian\n";

class Script : public testing::Test {
 protected:
  Script() {
    fs::copy_file(std::string(USHER_SOURCE_DIR) + "/usher", folder_.path() + "/usher");
    folder_.file("deploy/packages.txt", "[build]\ncmake\ng++\n[test]\nlibgtest-dev\n");
    program("tools/dpkg-query",
            "printf 'cmake installed\\ng++ installed\\nlibgtest-dev installed\\n'");
    program("tools/ninja", "echo 'ninja: no work to do.'");
    for (const std::string name : {"cmake", "ctest", "cpack", "apt-get", "sudo"})
      program("tools/" + name, "echo \"" + name + " $*\" >>" + folder_.path() + "/calls");
    // The script reads nothing else with cat than the system's name and its own help.
    program("tools/cat", "[ $# -eq 0 ] && exec /bin/cat; /bin/cat " + folder_.path() + "/system");
    system(kBookworm);
  }

  void program(const std::string& name, const std::string& text) {
    const std::string path = folder_.file(name, "#!/bin/sh\n" + text + "\n");
    fs::permissions(path, fs::perms::owner_all);
  }
  void file(const std::string& name) { folder_.file(name, ""); }
  void system(const std::string& release) { folder_.file("system", release); }
  /// A tree that was built: the program says how it was called.
  void built() {
    folder_.file("build/release/build.ninja", "");
    program("build/release/bin/usher", "echo program \"$@\"");
    program("build/release/bin/usher-experiment", "");
  }
  /// A launcher of this tree that does not end.
  std::unique_ptr<test::Process> launched() {
    const std::string path = folder_.path() + "/build/release/bin/usher";
    fs::copy_file("/usr/bin/tail", path, fs::copy_options::overwrite_existing);
    auto robot = std::make_unique<test::Process>(
        std::vector<std::string>{path, "launch", "-F"});  // a file that never comes
    fs::remove(path);
    built();
    return robot;
  }
  /// Some source is newer than what was built from it.
  void edited() { program("tools/ninja", "echo '[1/9] c++ a.cpp'"); }
  void lacks_packages() { program("tools/dpkg-query", "echo 'cmake installed'; exit 1"); }

  /// Runs it; what it prints is then in `output` and `errors`, what it called in `calls`.
  int run(std::vector<std::string> words, const std::string& setting = "NOTHING=0") {
    fs::remove(folder_.path() + "/calls");
    std::vector<std::string> all{
        "/usr/bin/env",   "-u",
        "USHER_PRESET",   "-u",
        "USHER_NO_BUILD", "PATH=" + folder_.path() + "/tools:/usr/bin:/bin",
        setting,          folder_.path() + "/usher"};
    all.insert(all.end(), words.begin(), words.end());
    test::Process process(all);
    const int code = process.wait();
    output = process.output();
    errors = process.errors();
    calls = test::content_of(folder_.path() + "/calls");
    return code;
  }

  std::string output, errors, calls;

 private:
  test::Folder folder_;
};

TEST_F(Script, BuildsWhatIsNewerThanItsProgramBeforeItRuns) {
  built(), edited();
  for (const std::string command : {"launch", "check", "graph", "experiment", "bench", "keys"}) {
    EXPECT_EQ(run({command, "x"}), 0) << errors;
    EXPECT_EQ(calls, "cmake --build build/release --target usher-programs\n") << command;
    EXPECT_EQ(output, "program " + command + " x\n");
  }
}

TEST_F(Script, BuildsNothingAndSaysNothingWhereNothingIsNewer) {
  built();
  EXPECT_EQ(run({"launch", "x"}), 0);
  EXPECT_EQ(calls, "");
  EXPECT_EQ(errors, "");
  EXPECT_EQ(output, "program launch x\n");
}

TEST_F(Script, TakesWhatIsThereWhereItIsTold) {
  built(), edited();
  EXPECT_EQ(run({"launch", "x"}, "USHER_NO_BUILD=1"), 0);
  EXPECT_EQ(calls, "");
  EXPECT_EQ(output, "program launch x\n");
}

TEST_F(Script, ReplacesNothingUnderARobotThatRuns) {
  built(), edited();
  {
    const auto robot = launched();
    EXPECT_EQ(run({"check", "x"}), 0) << errors;
    EXPECT_EQ(calls, "");
    EXPECT_THAT(errors, HasSubstr("a robot runs with the programs in build/release"));
    EXPECT_EQ(output, "program check x\n");
  }
  EXPECT_EQ(run({"check", "x"}), 0) << errors;
  EXPECT_EQ(calls, "cmake --build build/release --target usher-programs\n");
}

TEST_F(Script, BuildsNothingUnderARobotThatRuns) {
  built(), edited();
  {
    const auto robot = launched();
    for (const std::string command : {"build", "test", "install", "package"}) {
      EXPECT_EQ(run({command}), 2) << command;
      EXPECT_EQ(errors,
                "usher: a robot runs with the programs in build/release: stop it, then build\n");
      EXPECT_EQ(calls, "") << command;
    }
    program("tools/readlink", "exit 1");  // as of a service of root's
    EXPECT_EQ(run({"build"}), 2);
    EXPECT_EQ(run({"check", "x"}), 0) << errors;
    EXPECT_EQ(calls, "");
    program("tools/ninja", "echo 'ninja: no work to do.'");
    EXPECT_EQ(run({"build"}), 0) << "nothing would be replaced" << errors;
  }
  edited();
  EXPECT_EQ(run({"build"}), 0) << errors;
  EXPECT_EQ(calls, "cmake --build build/release --target all\n");
}

TEST_F(Script, RunsTheTestsThatAreMeant) {
  built();
  const std::string log = "build/release/Testing/Temporary/LastTest.log";
  file(log);
  EXPECT_EQ(run({"test", "--label", "unit", "--label", "data", "--only", "amcl"}), 0) << errors;
  EXPECT_THAT(calls, HasSubstr("ctest --no-tests=error --output-on-failure -j "));
  EXPECT_THAT(calls, HasSubstr(" -L ^(unit|data)$ -R amcl\n"));
  EXPECT_EQ(run({"test"}), 0) << errors;
  EXPECT_THAT(calls, Not(HasSubstr(" -R ")));
}

TEST_F(Script, HandsOnAnOptionThatStandsBeforeItsCommand) {
  built();
  EXPECT_EQ(run({"--keys", "k", "status", "--domain", "3"}), 0) << errors;
  EXPECT_EQ(output, "program status --keys k --domain 3\n");
  EXPECT_EQ(run({"--keys=k", "check", "x"}), 0) << errors;
  EXPECT_EQ(output, "program check --keys=k x\n");
}

TEST_F(Script, SaysThatThereIsNothingToTake) {
  EXPECT_EQ(run({"launch", "x"}, "USHER_NO_BUILD=1"), 2);
  EXPECT_EQ(errors, "usher: USHER_NO_BUILD is set, and nothing is built in build/release\n");
}

TEST_F(Script, AStopWaitsForNoCompiler) {
  built(), edited(), lacks_packages();
  for (const std::string command : {"stop", "move", "status", "locate", "teleop", "meet"}) {
    EXPECT_EQ(run({command, "--domain", "42"}), 0) << errors;
    EXPECT_EQ(calls, "") << command;
    EXPECT_EQ(output, "program " + command + " --domain 42\n");
  }
}

TEST_F(Script, AnswersHelpWithoutInstallingOrBuilding) {
  lacks_packages();
  for (const std::string command : {"launch", "experiment", "stop", "demo", "build", "--version"}) {
    EXPECT_EQ(run({command, "--help"}), 0) << command << errors;
    EXPECT_EQ(calls, "") << command;
    EXPECT_THAT(output, StartsWith("usage: ./usher COMMAND")) << command;
  }
  built(), edited();
  for (const std::string command : {"launch", "experiment", "stop", "demo"}) {
    EXPECT_EQ(run({command, "--help"}), 0) << errors;
    EXPECT_EQ(calls, "") << command;
    EXPECT_EQ(output, "program " + command + " --help\n");
  }
}

TEST_F(Script, HelpNamesTheOptionsOfTheDemo) {
  EXPECT_EQ(run({"demo", "--help"}), 0);
  for (const char* option : {"--to", "--seed", "--out"}) EXPECT_THAT(output, HasSubstr(option));
}

TEST_F(Script, SaysWhichSystemItNeedsBeforeItInstalls) {
  lacks_packages();
  system("PRETTY_NAME=\"Ubuntu 22.04.4 LTS\"\nVERSION_ID=\"22.04\"\nID=ubuntu\nID_LIKE=debian\n");
  for (const std::string command : {"demo", "build", "test", "launch", "stop"}) {
    EXPECT_EQ(run({command}), 2) << command;
    EXPECT_THAT(errors, StartsWith("usher: this is Ubuntu 22.04.4 LTS; Usher needs Debian 12"));
    EXPECT_THAT(errors, HasSubstr("docker run "));
    EXPECT_EQ(calls, "") << command;
  }
  system("PRETTY_NAME=\"Debian GNU/Linux 13 (trixie)\"\nVERSION_ID=\"13\"\nID=debian\n");
  EXPECT_EQ(run({"build"}), 2);
  EXPECT_THAT(errors, StartsWith("usher: this is Debian GNU/Linux 13 (trixie); "));
}

TEST_F(Script, InstallsWhatIsMissingOnItsSystem) {
  built(), lacks_packages();
  EXPECT_EQ(run({"launch", "x"}), 0) << errors;
  EXPECT_THAT(calls, HasSubstr("apt-get update"));
  EXPECT_THAT(calls, HasSubstr("--no-install-recommends g++ libgtest-dev\n"));
  EXPECT_THAT(calls, Not(HasSubstr("recommends cmake")));
}

TEST_F(Script, AWrongOptionEndsItBeforeItBuilds) {
  built(), edited();
  for (const std::string command : {"build", "test", "install", "package"}) {
    EXPECT_EQ(run({command, "--nosuch"}), 2) << command;
    EXPECT_EQ(errors, "usher: " + command + ": unknown option --nosuch\n");
    EXPECT_EQ(calls, "") << command;
  }
  EXPECT_EQ(run({"install", "--prefix"}), 2);
  EXPECT_EQ(errors, "usher: --prefix needs a directory\n");
  EXPECT_EQ(run({"test", "--label"}), 2);
  EXPECT_EQ(run({"test", "--only"}), 2);
  EXPECT_EQ(calls, "");
}

TEST_F(Script, AWordThatIsNoCommandIsNamed) {
  EXPECT_EQ(run({"nosuch"}), 2);
  EXPECT_EQ(errors, "usher: unknown command 'nosuch'; see ./usher --help\n");
  EXPECT_THAT(output, IsEmpty());
}

}  // namespace
}  // namespace usher
