// What the programs answer to a command line that is wrong, before they meet a robot.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "support/process.hpp"

namespace usher {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

const std::string kProgram = std::string(USHER_BINARY_DIR) + "/bin/usher";
const std::string kDemo = std::string(USHER_SOURCE_DIR) + "/deploy/demo.yaml";

/// What a command says on stderr; it has to end with `code`.
std::string errors_of(Words words, int code, const std::string& program = kProgram) {
  const std::string line = testing::PrintToString(words);
  words.insert(words.begin(), program);
  test::Process command(words);
  EXPECT_EQ(command.wait(), code) << line << "\n" << command.errors();
  return command.errors();
}

TEST(WrongUsage, EndsWithTwoWhateverTheCommand) {
  for (const Words& words : std::vector<Words>{{},
                                               {"nosuch"},
                                               {"--nosuch"},
                                               {"check"},
                                               {"check", "--nosuch"},
                                               {"launch", kDemo, "--set", "amcl"},
                                               {"status", "--domain", "999"},
                                               {"stop", "--domain", "x"},
                                               {"doctor", "--domain", "999"},
                                               {"topics", "--seconds", "-1"},
                                               {"topics", "echo"},
                                               {"goto", "--max-speed=-1"},
                                               {"goto", "kitchen", "--max-speed", "99"},
                                               {"goto", "--pose", "nan", "0", "0"},
                                               {"goto", "kitchen", "--pose", "1", "2", "3"},
                                               {"goto", "kitchen", "--cancel"},
                                               {"goto", "--cancel", "--no-wait"},
                                               {"locate", "1", "2"},
                                               {"locate", "-1", "-2", "7"},
                                               {"teleop", "--hold", "1"},
                                               {"map"},
                                               {"meet", "--persons", "0"},
                                               {"calibrate", "nosuch"},
                                               {"install"},
                                               {"install", "--systemd"},
                                               {"demo", "nosuch"},
                                               {"demo", "meeting", "--to", "kitchen"},
                                               {"bench"},
                                               {"bench", "nosuch"},
                                               {"experiment"},
                                               {"experiment", "nosuch"},
                                               {"experiment", "guide", "--nosuch"},
                                               {"experiment", "guide", "--seeds", "-1"},
                                               {"experiment", "guide", "--only", "x"}}) {
    const std::string line = testing::PrintToString(words);
    EXPECT_THAT(errors_of(words, 2), HasSubstr("usher: ")) << line;
  }
}

TEST(WrongUsage, SaysWhatWasMeant) {
  EXPECT_THAT(errors_of({"staus"}, 2),
              HasSubstr("'staus'; see usher --help; did you mean status?"));
  EXPECT_THAT(errors_of({"stop", "--emergancy"}, 2), HasSubstr("did you mean --emergency?"));
  EXPECT_THAT(errors_of({"experiment", "gude"}, 2), HasSubstr("did you mean guide?"));
  EXPECT_THAT(errors_of({"experiment", "guide", "--windows", "3"}, 2),
              HasSubstr("guide takes no --windows; besides --out it takes --seeds, --only"));
  EXPECT_THAT(errors_of({"experiment", "guide", "--seed", "3"}, 2),
              HasSubstr("did you mean --seeds?"));
  // Not every build has the benchmark that is meant.
  EXPECT_THAT(errors_of({"bench", "nosuchbenchmark"}, 2),
              HasSubstr("unknown benchmark 'nosuchbenchmark'; see usher bench --list"));
}

TEST(WrongUsage, OfASettingIsToldByWhatTheManifestHas) {
  EXPECT_THAT(errors_of({"launch", kDemo, "--set", "amlc.max_beams=60"}, 1),
              HasSubstr("no component 'amlc' in the manifest; did you mean amcl?"));
  EXPECT_THAT(errors_of({"launch", kDemo, "--set", "amcl.max_beam=60"}, 1),
              HasSubstr("has no parameter 'max_beam'; did you mean max_beams?"));
}

TEST(Teleop, NeedsATerminal) {
  EXPECT_EQ(errors_of({"teleop", "--domain", "231"}, 1),
            "usher: teleop needs a terminal: it reads the keys from standard input\n");
}

TEST(Help, NamesTheExitCodes) {
  for (const Words& words : std::vector<Words>{{"--help"},
                                               {"bench", "--help"},
                                               {"experiment", "--help"},
                                               {"status", "--help"},
                                               {"stop", "--help"},
                                               {"map", "save", "--help"}}) {
    Words all{kProgram};
    all.insert(all.end(), words.begin(), words.end());
    test::Process help(all);
    EXPECT_EQ(help.wait(), 0);
    EXPECT_THAT(help.output(), HasSubstr("Exit codes: 0 ")) << testing::PrintToString(words);
  }
}

/// What a command says on stdout; it has to end with 0.
std::string output_of(Words words) {
  words.insert(words.begin(), kProgram);
  test::Process command(words);
  EXPECT_EQ(command.wait(), 0) << command.output() << command.errors();
  return command.output();
}

TEST(Install, TellsEachHostItsOwnUnit) {
  const test::Folder folder;
  const std::string text =
      output_of({"install", "--systemd", std::string(USHER_SOURCE_DIR) + "/deploy/marvin.yaml",
                 "--to", folder.path()});
  EXPECT_THAT(text, HasSubstr("\non nuc: systemctl daemon-reload && systemctl enable --now "
                              "usher-nuc.service\non tablet: systemctl daemon-reload && systemctl "
                              "enable --now usher-tablet.service\n"));
}

TEST(Keys, SayWhatAHostNeeds) {
  const test::Folder folder;
  const std::string text = output_of({"keys", folder.path() + "/keys", "--manifest", kDemo});
  EXPECT_THAT(text, HasSubstr("a host needs ca.pem, governance.smime and the folders launcher, "
                              "operator and those of what runs there\n"));
}

}  // namespace
}  // namespace usher
