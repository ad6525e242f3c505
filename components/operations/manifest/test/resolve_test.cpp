#include "operations/manifest/resolve.hpp"

#include <gmock/gmock.h>

#include "runtime/parameters/interpret.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using runtime::Contract;
using runtime::ParameterKind;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

Contract::Parameter number(const std::string& name, const std::string& unit, double low,
                           double high) {
  Contract::Parameter parameter;
  parameter.name = name;
  parameter.unit = unit;
  parameter.range = {low, high};
  parameter.fallback = "1";
  parameter.text = "What it means.";
  return parameter;
}

Contract::Parameter of_kind(const std::string& name, ParameterKind kind, bool required = false) {
  auto parameter = number(name, "-", -1e9, 1e9);
  parameter.kind = kind;
  parameter.required = required;
  parameter.count_min = 1;
  parameter.count_max = 4;
  return parameter;
}

/// A robot, a site and a manifest in a folder, and contracts for two components.
class Resolving : public testing::Test {
 protected:
  Resolving() {
    Contract legs;
    legs.component = "legs";
    legs.idl_digest = "wrong on purpose, judged elsewhere";
    legs.parameters = {number("gain", "-", 0, 100),
                       number("reach", "m", 0, 2),
                       of_kind("steps", ParameterKind::kNumbers),
                       of_kind("map", ParameterKind::kFile),
                       of_kind("title", ParameterKind::kText),
                       number("robot.width", "m", 0, 1),
                       number("robot.arm.length", "m", 0, 1),
                       of_kind("site.plan", ParameterKind::kFile)};
    legs.parameters[5].required = true;
    Contract judge;
    judge.component = "judge";
    judge.parameters = {of_kind("manifest.name", ParameterKind::kText),
                        of_kind("manifest.components", ParameterKind::kRecords)};
    auto& records = judge.parameters[1];
    for (const auto* field : {"name", "type", "host", "criticality"})
      records.fields.push_back({.name = field, .kind = ParameterKind::kText});
    records.fields.push_back(
        {.name = "timeout", .kind = ParameterKind::kNumber, .unit = "s", .range = {0, 60}});
    contracts_ = {{"legs", legs}, {"judge", judge}};
    robot_ = "width: 0.6 m\narm: {length: 30 cm}\n";
    site_ = "plan: plan.pgm\n";
    folder_.file("config/sites/s/plan.pgm", "x");
  }

  Deployment resolved(const std::string& components, const std::vector<Override>& overrides = {}) {
    folder_.file("config/robots/r.yaml", robot_);
    folder_.file("config/sites/s/site.yaml", site_);
    const auto path = folder_.file(
        "deploy/m.yaml", "robot: r\nsite: s\nhosts: {nuc: {}}\ncomponents:\n" + components);
    const auto manifest = read_manifest(path, {folder_.path() + "/config"});
    EXPECT_TRUE(manifest) << (manifest ? "" : manifest.error());
    auto deployment = resolve(*manifest, contracts_, overrides);
    std::erase_if(deployment.findings,
                  [](const Finding& f) { return f.verdict == Verdict::kWrongIdl; });
    return deployment;
  }
  std::vector<std::string> findings(const std::string& components,
                                    const std::vector<Override>& overrides = {}) {
    std::vector<std::string> found;
    for (const auto& finding : resolved(components, overrides).findings)
      found.push_back(shortened(to_string(finding)));
    return found;
  }
  std::string shortened(std::string text) const {
    for (auto at = text.find(folder_.path()); at != std::string::npos;
         at = text.find(folder_.path()))
      text.erase(at, folder_.path().size() + 1);
    return text;
  }
  /// "value (origin)" of a parameter of the first component; "-" when the default holds.
  std::string value(const Deployment& deployment, const std::string& name) const {
    for (const auto& given : deployment.files.at(0).values) {
      if (given.name == name) return shortened(given.yaml + " (" + given.origin + ")");
    }
    return "-";
  }

  test::Folder folder_;
  Contracts contracts_;
  std::string robot_;
  std::string site_;
};

TEST_F(Resolving, LaysLaterLayersOverEarlierOnes) {
  const std::string plain = "  legs: {host: nuc}\n";
  const std::string set = "  legs:\n    host: nuc\n    parameters:\n      gain: 4\n";
  EXPECT_EQ(value(resolved(plain), "gain"), "-") << "the contract's default";
  robot_ += "components:\n  legs:\n    gain: 2\n";
  EXPECT_EQ(value(resolved(plain), "gain"), "2 (config/robots/r.yaml:5)");
  site_ += "components: {legs: {gain: 3}}\n";
  EXPECT_EQ(value(resolved(plain), "gain"), "3 (config/sites/s/site.yaml:2)");
  EXPECT_EQ(value(resolved(set), "gain"), "4 (deploy/m.yaml:8)");
  const auto deployment = resolved(set, {{"legs", "gain", "5"}});
  EXPECT_EQ(value(deployment, "gain"), "5 (command line)");
  EXPECT_THAT(deployment.findings, IsEmpty());
}

TEST_F(Resolving, GivesTheFactsOfRobotAndSite) {
  const auto deployment = resolved("  legs: {host: nuc}\n");
  EXPECT_THAT(deployment.findings, IsEmpty());
  EXPECT_EQ(value(deployment, "robot.width"), "0.6 m (config/robots/r.yaml:1)");
  EXPECT_EQ(value(deployment, "robot.arm.length"), "30 cm (config/robots/r.yaml:2)");
  EXPECT_EQ(deployment.files[0].name, "legs");
  EXPECT_EQ(deployment.files[0].host, "nuc");
  EXPECT_TRUE(deployment.files[0].critical);
  EXPECT_FALSE(resolved("  legs: {host: nuc, criticality: notify}\n").files[0].critical);
  contracts_.at("legs").outputs.emplace_back().topic = "cmd_vel/legs";
  EXPECT_TRUE(resolved("  legs: {host: nuc, criticality: notify}\n").files[0].critical)
      << "who may move the robot shows life at 50 Hz";
}

TEST_F(Resolving, LaysTheManifestsFactsOverThoseOfTheRobotsFile) {
  const std::string legs = "  legs: {host: nuc}\n";
  const auto deployment = resolved(legs + "robot_facts: {arm: {length: 40 cm}}\n");
  EXPECT_THAT(deployment.findings, IsEmpty());
  EXPECT_EQ(value(deployment, "robot.arm.length"), "40 cm (deploy/m.yaml:6)");
  EXPECT_EQ(value(deployment, "robot.width"), "0.6 m (config/robots/r.yaml:1)");
  EXPECT_THAT(findings(legs + "robot_facts: {arm: {lenght: 40 cm}}\n"),
              ElementsAre("deploy/m.yaml:6: unknown key: no component asks for 'arm.lenght'; did "
                          "you mean arm.length?"));
  EXPECT_THAT(findings(legs + "robot_facts: {arm: {length: 40 kg}}\n"),
              ElementsAre(HasSubstr("deploy/m.yaml:6: wrong value: robot.arm.length")));
  EXPECT_THAT(findings(legs + "robot_facts: 3\n"),
              ElementsAre("deploy/m.yaml:6: wrong value: manifest: 'robot_facts' must be a map, "
                          "got 3"));
}

TEST_F(Resolving, RefusesFactsThatAreSetElsewhere) {
  const std::string set =
      "  legs:\n    host: nuc\n    parameters:\n      robot.width: 0.5 m\n"
      "      site.plan: x\n";
  EXPECT_THAT(findings(set),
              ElementsAre("deploy/m.yaml:8: misplaced: 'robot.width' can be set only by the "
                          "robot's file or the manifest's robot_facts",
                          "deploy/m.yaml:9: misplaced: 'site.plan' can be set only by the site's "
                          "file"));
  EXPECT_EQ(value(resolved(set), "robot.width"), "0.6 m (config/robots/r.yaml:1)");
  EXPECT_THAT(findings("  legs: {host: nuc}\n", {{"legs", "robot.width", "0.5 m"}}),
              ElementsAre(HasSubstr("command line: misplaced")));
  EXPECT_THAT(findings("  judge: {host: nuc, parameters: {manifest.name: x}}\n"),
              ElementsAre(HasSubstr("misplaced: 'manifest.name' can be set only by the launcher")));
}

TEST_F(Resolving, DerivesWhatTheManifestSays) {
  const auto deployment = resolved(
      "  judge: {host: nuc}\n"
      "  legs: {host: nuc, criticality: degrade, heartbeat_timeout: 0.5}\n");
  EXPECT_THAT(deployment.findings, IsEmpty());
  EXPECT_EQ(value(deployment, "manifest.name"), "m (deploy/m.yaml:1)");
  const auto& declared = contracts_.at("judge").parameters[1];
  const auto given = runtime::interpret(declared, deployment.files[0].values.at(1));
  ASSERT_TRUE(given) << given.error();
  ASSERT_EQ(given->records.size(), 2U);
  EXPECT_EQ(given->records[1].texts.at("name"), "legs");
  EXPECT_EQ(given->records[1].texts.at("criticality"), "degrade");
  EXPECT_EQ(given->records[1].numbers.at("timeout"), 0.5);
}

TEST_F(Resolving, FindsUnknownTypesKeysAndComponents) {
  EXPECT_THAT(findings("  legs: {host: nuc}\n  wings:\n    host: nuc\n    type: feathers\n"),
              ElementsAre("deploy/m.yaml:8: unknown type: component 'wings' has the unknown type "
                          "'feathers'"));
  EXPECT_THAT(
      findings("  legs:\n    host: nuc\n    parameters: {gian: 3}\n"),
      ElementsAre("deploy/m.yaml:7: unknown key: component 'legs' has no parameter 'gian'; did you "
                  "mean gain?"));
  EXPECT_THAT(findings("  legs: {host: nuc}\n  left:\n    host: nuc\n    type: lges\n"),
              ElementsAre(EndsWith("has the unknown type 'lges'; did you mean legs?")));
  EXPECT_THAT(findings("  legs: {host: nuc}\n", {{"arms", "gain", "1"}, {"legs", "x", "1"}}),
              ElementsAre("command line: unknown key: component 'legs' has no parameter 'x'",
                          "command line: unknown key: no component 'arms' in the manifest"));
  EXPECT_THAT(
      findings("  legs: {host: nuc}\n", {{"leg", "gain", "1"}, {"legs", "gian", "1"}}),
      ElementsAre("command line: unknown key: component 'legs' has no parameter 'gian'; did "
                  "you mean gain?",
                  "command line: unknown key: no component 'leg' in the manifest; did you "
                  "mean legs?"));
  robot_ += "components: {judg: {a: 1}}\n";
  EXPECT_THAT(findings("  legs: {host: nuc}\n"),
              ElementsAre(EndsWith("the unknown component 'judg'; did you mean judge?")));
}

TEST_F(Resolving, FindsFactsThatNobodyAsksFor) {
  robot_ += "arm_length: 3\ncomponents: {wings: {a: 1}, judge: {}, legs: {b: 2}}\n";
  EXPECT_THAT(findings("  legs: {host: nuc}\n"),
              ElementsAre("config/robots/r.yaml:4: unknown key: component 'legs' has no parameter "
                          "'b'",
                          "config/robots/r.yaml:3: unknown key: no component asks for "
                          "'arm_length'; did you mean arm.length?",
                          "config/robots/r.yaml:4: unknown key: settings for the unknown "
                          "component 'wings'"));
}

TEST_F(Resolving, AllowsSettingsForAComponentThatIsLeftOut) {
  robot_ += "components: {legs: {gain: 1}}\n";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"), IsEmpty());
}

TEST_F(Resolving, FindsWrongValues) {
  const auto with = [&](const std::string& setting) {
    const auto found = findings("  legs: {host: nuc, parameters: {" + setting + "}}\n");
    return found.size() == 1 ? found[0] : std::to_string(found.size()) + " findings";
  };
  EXPECT_EQ(with("gain: 101"), "deploy/m.yaml:5: wrong value: gain must be in [0, 100], got 101");
  EXPECT_THAT(with("reach: 50 deg"),
              HasSubstr("wrong value: reach must be in one of the units m,"));
  EXPECT_THAT(with("reach: 300 cm"), HasSubstr("reach must be in [0, 2] m, got 300 cm"));
  EXPECT_THAT(with("gain: much"), HasSubstr("gain must be a number in [0, 100], got \"much\""));
  EXPECT_THAT(with("gain: nan"), HasSubstr("wrong value"));
  EXPECT_THAT(with("gain: [1]"), HasSubstr("got a list"));
  EXPECT_THAT(with("gain: ~"), HasSubstr("got nothing"));
  EXPECT_THAT(with("gain: ''"), HasSubstr("wrong value"));
  EXPECT_THAT(with("steps: [1, 2, 3, 4, 5]"), HasSubstr("got 5"));
  EXPECT_THAT(with("title: {a: 1}"), HasSubstr("got a mapping"));
  EXPECT_THAT(findings("  legs: {host: nuc}\n", {{"legs", "gain", "[1"}}),
              ElementsAre("command line: wrong value: legs.gain: a key must be a word"));
}

TEST_F(Resolving, FindsAddressesThatAreNone) {
  contracts_.at("legs").parameters.push_back(of_kind("line", ParameterKind::kText));
  contracts_.at("legs").parameters.back().fallback = "serial:///dev/ttyUSB0?baud=9600";
  const auto with = [&](const std::string& address) {
    return findings("  legs: {host: nuc, parameters: {line: \"" + address + "\"}}\n");
  };
  EXPECT_THAT(with("tcp://192.168.0.1:2112"), IsEmpty());
  for (const auto* bad : {"tcp//192.168.0.1:2112", "seral:///dev/ttyUSB0?baud=9600", "none", ""})
    EXPECT_THAT(with(bad), ElementsAre(HasSubstr("deploy/m.yaml:5: wrong value: 'line': a stream "
                                                 "is tcp://")))
        << bad;
}

TEST_F(Resolving, FindsADeviceThatTwoComponentsOpen) {
  auto& parameters = contracts_.at("legs").parameters;
  parameters.push_back(of_kind("line", ParameterKind::kText));
  parameters.back().fallback = "serial:///dev/ttyUSB0?baud=9600";
  const auto with = [&](const std::string& second) {
    return findings("  legs: {host: nuc}\n  arms: {type: legs, host: nuc" + second + "}\n");
  };
  const auto both =
      HasSubstr("wrong value: 'legs' and 'arms' of host 'nuc' both open /dev/ttyUSB0");
  EXPECT_THAT(with(""), ElementsAre(both)) << "by their defaults";
  EXPECT_THAT(with(", parameters: {line: \"serial:///dev/ttyUSB0?baud=115200\"}"),
              ElementsAre(testing::AllOf(both, HasSubstr("deploy/m.yaml:6"))));
  EXPECT_THAT(with(", parameters: {line: \"device:///dev/ttyUSB0\"}"), ElementsAre(both));
  EXPECT_THAT(with(", parameters: {line: \"serial:///dev/ttyUSB1?baud=9600\"}"), IsEmpty());
  for (const char* port : {"1", "2"}) {
    const std::string tcp = "tcp://10.0.0.1:" + std::string(port);
    EXPECT_THAT(findings("  legs: {host: nuc, parameters: {line: \"tcp://10.0.0.1:1\"}}\n  arms: "
                         "{type: legs, host: nuc, parameters: {line: \"" +
                         tcp + "\"}}\n"),
                IsEmpty())
        << "a server may serve two";
  }
}

TEST_F(Resolving, FindsTheFileOfARobotOnAnotherBase) {
  Contract base;
  base.parameters = {of_kind("robot.base", ParameterKind::kText)};
  for (const char* driver : {"segway_rmp", "p3dx_sim"}) {
    base.component = driver;
    contracts_[driver] = base;
  }
  const auto with = [&](const char* driver) {
    return findings("  legs: {host: nuc}\n  base: {host: nuc, type: " + std::string(driver) +
                    "}\n");
  };
  EXPECT_THAT(with("segway_rmp"), IsEmpty());
  EXPECT_THAT(with("p3dx_sim"),
              ElementsAre(HasSubstr("m.yaml:1: wrong value: 'base' drives a pioneer, and the "
                                    "robot's file says base: segway (by saying nothing)")));
  robot_ += "base: pioneer\n";
  EXPECT_THAT(with("p3dx_sim"), IsEmpty());
  EXPECT_THAT(with("segway_rmp"),
              ElementsAre(HasSubstr("r.yaml:3: wrong value: 'base' drives a segway, and the "
                                    "robot's file says base: pioneer: is it this robot's?")));
}

TEST_F(Resolving, SaysOnceThatAComponentHasNoHost) {
  EXPECT_THAT(findings("  judge: {host: nuc}\n  legs: {}\n"),
              ElementsAre(HasSubstr("deploy/m.yaml:6: missing value: component 'legs' has no "
                                    "host")));
}

TEST_F(Resolving, FindsARobotThatWaitsForWhiskersForEver) {
  contracts_.at("judge").parameters.push_back(of_kind("whiskers_required", ParameterKind::kFlag));
  auto& required = contracts_.at("judge").parameters.back();
  required.fallback = "true";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"),
              ElementsAre("deploy/m.yaml:5: no writer: 'judge' lets nothing move without whiskers, "
                          "and nobody writes them; a robot that has none says whiskers_required: "
                          "false"));
  robot_ += "components: {judge: {whiskers_required: true}}\n";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"),
              ElementsAre(HasSubstr("config/robots/r.yaml:3: no writer: ")));
  EXPECT_THAT(findings("  judge: {host: nuc, parameters: {whiskers_required: false}}\n"),
              IsEmpty());
  contracts_.at("legs").outputs.emplace_back().topic = "whiskers";
  const auto beside = findings("  judge: {host: nuc}\n  legs: {host: nuc}\n");
  EXPECT_THAT(beside, testing::Not(testing::Contains(HasSubstr("without whiskers"))));
}

TEST_F(Resolving, FindsWhatMustBeSet) {
  robot_ = "arm: {length: 0.3 m}\n";
  EXPECT_THAT(findings("  legs: {host: nuc}\n"),
              ElementsAre("config/robots/r.yaml:1: missing value: 'robot.width' of 'legs' must be "
                          "set: What it means."));
}

TEST_F(Resolving, FindsFilesFromTheirOwnPlace) {
  folder_.file("deploy/sub/a: b.pgm", "x");
  const auto deployment = resolved("  legs: {host: nuc, parameters: {map: 'sub/a: b.pgm'}}\n");
  EXPECT_THAT(deployment.findings, IsEmpty());
  EXPECT_EQ(value(deployment, "site.plan"), "config/sites/s/plan.pgm (config/sites/s/site.yaml:1)");
  EXPECT_EQ(value(deployment, "map"), "\"deploy/sub/a: b.pgm\" (deploy/m.yaml:5)");
}

TEST_F(Resolving, FindsFilesThatAreNotThere) {
  EXPECT_THAT(findings("  legs: {host: nuc, parameters: {map: none.pgm}}\n"),
              ElementsAre("deploy/m.yaml:5: missing file: 'map' names deploy/none.pgm, which is "
                          "not there"));
  EXPECT_THAT(findings("  legs: {host: nuc, parameters: {map: .}}\n"),
              ElementsAre(HasSubstr("missing file")))
      << "a folder is no file";
  EXPECT_THAT(findings("  legs: {host: nuc, parameters: {map: ''}}\n"), IsEmpty())
      << "no file is wanted";
}

TEST_F(Resolving, KeepsWordsOnTheCommandLineWhole) {
  const auto deployment = resolved("  legs: {host: nuc}\n",
                                   {{"legs", "title", "Lab \\ north"}, {"legs", "gain", " 5 "}});
  EXPECT_EQ(value(deployment, "title"), "\"Lab \\\\ north\" (command line)");
  EXPECT_EQ(value(deployment, "gain"), "5 (command line)");
}

TEST_F(Resolving, FindsUnreadableAndShapelessFiles) {
  robot_ = "- a\n";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"),
              ElementsAre("config/robots/r.yaml:1: wrong value: the robot's file must be a map, "
                          "got [a]"));
  robot_ = "width: 1\ncomponents: 5\n";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"),
              ElementsAre(HasSubstr("r.yaml:2: wrong value: 'components' must be a map, got 5")));
  robot_ = "width: 1\ncomponents: {legs: [gain]}\n";
  EXPECT_THAT(findings("  judge: {host: nuc}\n"),
              ElementsAre(HasSubstr("the settings of 'legs' must be a map, got [gain]")));
  robot_ = "arm.length: 1\narm: {length: 1}\n";
  EXPECT_THAT(
      findings("  judge: {host: nuc}\n"),
      ElementsAre("config/robots/r.yaml:2: wrong value: 'robot.arm.length' is given twice"));
  robot_ = "a: [\n";
  EXPECT_THAT(
      findings("  judge: {host: nuc}\n"),
      ElementsAre("config/robots/r.yaml:2: unreadable: not valid YAML: end of sequence flow "
                  "not found"));
}

TEST_F(Resolving, SaysWhereAFileIsNamedThatIsNotThere) {
  const auto path =
      folder_.file("deploy/n.yaml",
                   "robot: marvn\nsite: hall\nhosts: {nuc: {}}\ncomponents: {legs: {host: nuc}}\n");
  folder_.file("config/robots/marvin.yaml", "");
  folder_.file("config/sites/s/site.yaml", site_);
  const auto manifest = read_manifest(path, {folder_.path() + "/config"});
  ASSERT_TRUE(manifest);
  const auto deployment = resolve(*manifest, contracts_, {});
  std::vector<std::string> found;
  for (const auto& finding : deployment.findings) {
    if (finding.verdict != Verdict::kWrongIdl) found.push_back(shortened(to_string(finding)));
  }
  // Not also each fact that the files would have.
  EXPECT_THAT(
      found,
      ElementsAre("deploy/n.yaml:1: missing file: 'robot' names config/robots/marvn.yaml, which is "
                  "not there; did you mean marvin?",
                  "deploy/n.yaml:2: missing file: 'site' names config/sites/hall/site.yaml, which "
                  "is not there"));
}

TEST(ReadContracts, RefusesFoldersWithoutContractsAndBrokenOnes) {
  const test::Folder folder;
  EXPECT_THAT(read_contracts(folder.path()).error(), HasSubstr("no contract in"));
  EXPECT_THAT(read_contracts(folder.path() + "/none").error(), HasSubstr("cannot read"));
  folder.file("legs.yaml", "component: legs\nversion: 1\nidl_digest: x\n");
  folder.file("README.md", "not a contract");
  const auto contracts = read_contracts(folder.path());
  ASSERT_TRUE(contracts) << contracts.error();
  EXPECT_EQ(contracts->size(), 1U);
  folder.file("wings.yaml", "component: wings\nlegs: 2\n");
  EXPECT_THAT(read_contracts(folder.path()).error(), HasSubstr("wings.yaml:2"));
}

}  // namespace
}  // namespace usher::operations
