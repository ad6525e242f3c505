#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "operations/manifest/manifest.hpp"
#include "support/process.hpp"

namespace usher {
namespace {

namespace fs = std::filesystem;

const std::string kPrograms = std::string(USHER_BINARY_DIR) + "/bin";
constexpr const char* kBroken = "tests/contract/manifests";

/// An installation that has, beside the real components, those of tests/contract/contracts, which
/// break a rule that no real component breaks.
class Installation {
 public:
  Installation() {
    const fs::path root = folder_.path();
    fs::create_directories(root / "bin");
    for (const auto& program : fs::directory_iterator(kPrograms)) {
      if (program.path().filename() != "usher")
        fs::create_symlink(program.path(), root / "bin" / program.path().filename());
    }
    fs::copy_file(kPrograms + "/usher", root / "bin" / "usher");
    const fs::path share = root / "share" / "usher";
    fs::create_directories(share / "contracts");
    fs::create_directory_symlink(std::string(USHER_SOURCE_DIR) + "/config", share / "config");
    for (const auto& entry :
         fs::directory_iterator(std::string(USHER_BINARY_DIR) + "/share/usher/contracts"))
      fs::copy_file(entry.path(), share / "contracts" / entry.path().filename());
    char digest[20];
    std::snprintf(digest, sizeof(digest), "%016llx",
                  static_cast<unsigned long long>(USHER_IDL_DIGEST));
    for (const auto& entry : fs::directory_iterator("tests/contract/contracts")) {
      std::string text = test::content_of(entry.path());
      constexpr std::string_view kPlaceholder = "@IDL_DIGEST@";
      if (const auto at = text.find(kPlaceholder); at != std::string::npos)
        text.replace(at, kPlaceholder.size(), digest);
      folder_.file("share/usher/contracts/" + entry.path().filename().string(), text);
    }
  }
  std::string program() const { return folder_.path() + "/bin/usher"; }

 private:
  test::Folder folder_;
};

struct Expectation {
  std::string verdict;
  std::string origin;  ///< file:line, the file from the source directory
};

struct Expectations {
  std::vector<Expectation> findings;
  bool among_others = false;
};

/// The comments at the top: `# expect: VERDICT at FILE:LINE`, and `# among others` where breaking
/// one thing breaks more.
Expectations expectations_of(const fs::path& manifest) {
  Expectations expectations;
  std::istringstream lines(test::content_of(manifest));
  constexpr std::string_view kExpect = "# expect: ";
  for (std::string line; std::getline(lines, line) && line.starts_with("#");) {
    if (line == "# among others") expectations.among_others = true;
    const auto at = line.find(" at ");
    if (!line.starts_with(kExpect) || at == std::string::npos) continue;
    expectations.findings.push_back(
        {line.substr(kExpect.size(), at - kExpect.size()),
         (manifest.parent_path() / line.substr(at + 4)).lexically_normal().string()});
  }
  return expectations;
}

/// Either `FILE:LINE: VERDICT: ...`, or `MANIFEST: VERDICT: ... FILE:LINE ...`.
bool says(const std::string& line, const Expectation& expected) {
  if (line.starts_with(expected.origin + ": " + expected.verdict + ": ")) return true;
  const auto at = line.find(expected.origin);
  if (at == std::string::npos || line.find(": " + expected.verdict + ": ") == std::string::npos)
    return false;
  const auto after = at + expected.origin.size();
  return after == line.size() || std::isdigit(static_cast<unsigned char>(line[after])) == 0;
}

class UsherCheck : public testing::Test {
 protected:
  static void SetUpTestSuite() { fs::current_path(USHER_SOURCE_DIR); }
};

TEST_F(UsherCheck, AcceptsTheShippedManifests) {
  for (const auto& entry : fs::directory_iterator("deploy")) {
    if (entry.path().extension() != ".yaml") continue;
    test::Process check({kPrograms + "/usher", "check", entry.path()});
    EXPECT_EQ(check.wait(), 0) << entry.path() << "\n" << check.output() << check.errors();
    EXPECT_NE(check.output().find(": good, "), std::string::npos) << check.output();
    EXPECT_EQ(check.errors(), "");
  }
}

/// Which host runs what; docs/hosts.md tells of it.
TEST_F(UsherCheck, SensingHasAHostOfItsOwnInTheManifestOfThreeHosts) {
  const auto manifest = operations::read_manifest("deploy/marvin-three-hosts.yaml", {"config"});
  ASSERT_TRUE(manifest) << manifest.error();
  const auto one_host = operations::read_manifest("deploy/marvin.yaml", {"config"});
  ASSERT_TRUE(one_host) << one_host.error();
  std::map<std::string, std::set<std::string>> parts;
  for (const auto& component : manifest->components) parts[component.host].insert(component.name);
  EXPECT_THAT(parts["sensing"], testing::ElementsAre("lms100", "scan_filter", "sensor_board"));
  EXPECT_THAT(parts["tablet"], testing::ElementsAre("tablet"));
  EXPECT_THAT(parts["nuc"], testing::IsSupersetOf({"supervisor", "movement_control", "segway_rmp",
                                                   "local_planner", "amcl", "costmap"}));
  EXPECT_EQ(parts.size(), manifest->hosts.size());
  EXPECT_EQ(manifest->components.size(), one_host->components.size()) << "nobody is lost";
  for (const auto& component : manifest->components) {
    const auto* before = one_host->component(component.name);
    ASSERT_NE(before, nullptr) << component.name;
    EXPECT_EQ(component.criticality, before->criticality) << component.name;
    EXPECT_EQ(component.heartbeat_timeout, before->heartbeat_timeout) << component.name;
  }
}

TEST_F(UsherCheck, RefusesEveryBrokenManifestWithVerdictAndLine) {
  const Installation installation;
  std::vector<fs::path> manifests;
  for (const auto& entry : fs::directory_iterator(kBroken)) manifests.push_back(entry.path());
  std::sort(manifests.begin(), manifests.end());
  ASSERT_GE(manifests.size(), 18U);
  for (const auto& manifest : manifests) {
    SCOPED_TRACE(manifest.string());
    const auto expected = expectations_of(manifest);
    EXPECT_FALSE(expected.findings.empty()) << "the first line must say what is expected";
    test::Process check({installation.program(), "check", manifest.string()});
    EXPECT_EQ(check.wait(), 1) << check.output() << check.errors();
    EXPECT_EQ(check.errors(), "");
    std::vector<std::string> lines;
    std::istringstream output(check.output());
    for (std::string line; std::getline(output, line);) lines.push_back(line);
    for (const auto& finding : expected.findings) {
      EXPECT_TRUE(std::any_of(lines.begin(), lines.end(),
                              [&](const auto& line) { return says(line, finding); }))
          << "expected " << finding.verdict << " at " << finding.origin << ", got\n"
          << check.output();
    }
    if (!expected.among_others) {
      EXPECT_EQ(lines.size(), expected.findings.size()) << check.output();
    }
  }
}

TEST_F(UsherCheck, RefusesWhatIsNoManifest) {
  const test::Folder folder;
  for (const auto& path :
       {folder.path() + "/none.yaml", folder.path(), folder.file("empty.yaml", ""),
        folder.file("list.yaml", "- a\n"), folder.file("noise.yaml", "\x01\x02\xff\xfe"),
        folder.file("bad.yaml", "[\n"), folder.file("other.yaml", "version: 3\npresets: []\n")}) {
    test::Process check({kPrograms + "/usher", "check", path});
    EXPECT_EQ(check.wait(), 1) << path;
    const std::string text = check.output();
    EXPECT_TRUE(text.starts_with(path + ": unreadable: ") ||
                text.starts_with(path + ":1: unreadable: "))
        << text;
    EXPECT_EQ(text.find(path, 1), std::string::npos) << "its name once: " << text;
    EXPECT_EQ(text.find('\n'), text.size() - 1) << "one line: " << text;
  }
}

TEST_F(UsherCheck, JudgesEachOfSeveral) {
  const auto broken = std::string(kBroken) + "/two_writers.yaml";
  test::Process check({kPrograms + "/usher", "check", "deploy/marvin.yaml", broken});
  EXPECT_EQ(check.wait(), 1);
  EXPECT_NE(check.output().find("deploy/marvin.yaml: good, "), std::string::npos);
  EXPECT_NE(check.output().find(": two writers: "), std::string::npos);
}

TEST_F(UsherCheck, SaysWhomItCouldNotAsk) {
  const Installation installation;
  fs::remove(fs::path(installation.program()).parent_path() / "usher-amcl");
  test::Process check({installation.program(), "check", "deploy/marvin-sim.yaml"});
  EXPECT_EQ(check.wait(), 0) << check.output();
  EXPECT_EQ(check.errors(), "usher: not asked what they refuse, since their programs are not in " +
                                fs::path(installation.program()).parent_path().string() +
                                ": amcl\n");
}

TEST_F(UsherCheck, WithoutManifestIsAWrongCall) {
  test::Process check({kPrograms + "/usher", "check"});
  EXPECT_EQ(check.wait(), 2);
}

}  // namespace
}  // namespace usher
