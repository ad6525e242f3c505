#include "operations/manifest/manifest.hpp"

#include <gmock/gmock.h>

#include "support/folder.hpp"

namespace usher::operations {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kHead = "robot: r\nsite: s\nhosts: {nuc: {}, tablet: {peers: [10.0.0.2]}}\n";

class ManifestFile : public testing::Test {
 protected:
  Result<Manifest> read(const std::string& text, const std::string& name = "m.yaml") {
    return read_manifest(folder_.file("deploy/" + name, text), {folder_.path() + "/config"});
  }
  /// The findings without the folder, so that they can be compared.
  std::vector<std::string> findings(const std::string& text) {
    const auto manifest = read(text);
    EXPECT_TRUE(manifest) << (manifest ? "" : manifest.error());
    std::vector<std::string> found;
    if (!manifest) return found;
    for (const auto& finding : manifest->findings) found.push_back(shortened(to_string(finding)));
    return found;
  }
  std::string error(const std::string& text) {
    const auto manifest = read(text);
    return manifest ? "accepted" : shortened(manifest.error());
  }
  std::string shortened(std::string text) const {
    const std::string prefix = folder_.path() + "/deploy/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

  test::Folder folder_;
};

TEST_F(ManifestFile, SaysWhatRunsWhere) {
  const auto manifest =
      read(std::string(kHead) +
           "domain: 7\nseed: 9\ncomponents:\n"
           "  amcl: {host: nuc, criticality: degrade, restart: on_failure,\n"
           "         restart_budget: 3, heartbeat_timeout: 0.5, start_patience: 4, group: g,\n"
           "         real_time: true,\n"
           "         parameters: {max_beams: 60, list: [1, 2]}}\n"
           "  eyes: {type: kinect, host: tablet}\n");
  ASSERT_TRUE(manifest) << manifest.error();
  EXPECT_THAT(manifest->findings, IsEmpty());
  EXPECT_EQ(manifest->name, "m");
  EXPECT_EQ(manifest->domain, 7U);
  EXPECT_EQ(manifest->seed, 9U);
  EXPECT_EQ(manifest->robot_file, folder_.path() + "/config/robots/r.yaml");
  EXPECT_EQ(manifest->site_file, folder_.path() + "/config/sites/s/site.yaml");
  EXPECT_THAT(manifest->host("tablet")->peers, ElementsAre("10.0.0.2"));
  const auto* amcl = manifest->component("amcl");
  ASSERT_NE(amcl, nullptr);
  EXPECT_EQ(amcl->type, "amcl");
  EXPECT_EQ(amcl->criticality, Criticality::kDegrade);
  EXPECT_EQ(amcl->restart, RestartPolicy::kOnFailure);
  EXPECT_EQ(amcl->restart_budget, 3);
  EXPECT_EQ(amcl->heartbeat_timeout, 0.5);
  EXPECT_EQ(amcl->start_patience, 4.0);
  EXPECT_TRUE(amcl->real_time);
  EXPECT_EQ(amcl->group, "g");
  ASSERT_EQ(amcl->parameters.size(), 2U);
  EXPECT_EQ(amcl->parameters[1].yaml, "[1, 2]");
  EXPECT_EQ(shortened(amcl->parameters[1].origin), "m.yaml:10");
  EXPECT_EQ(manifest->component("eyes")->type, "kinect");
  EXPECT_EQ(manifest->component("nobody"), nullptr);
  EXPECT_EQ(manifest->host("nobody"), nullptr);
}

TEST_F(ManifestFile, IsSafeWhereNothingIsSaid) {
  const auto manifest = read(std::string(kHead) + "components: {amcl: {host: nuc}}\n");
  ASSERT_TRUE(manifest);
  const auto& amcl = manifest->components.front();
  EXPECT_EQ(amcl.criticality, Criticality::kStop);
  EXPECT_EQ(amcl.restart, RestartPolicy::kAlways);
  EXPECT_EQ(amcl.heartbeat_timeout, 0.12);
  EXPECT_EQ(amcl.start_patience, 30.0);
  EXPECT_FALSE(amcl.real_time);
}

TEST_F(ManifestFile, NamesTheLineOfEachKey) {
  const auto manifest =
      read(std::string(kHead) + "components:\n  amcl:\n    host: nuc\n    criticality: stop\n");
  ASSERT_TRUE(manifest);
  const auto& amcl = manifest->components.front();
  EXPECT_EQ(shortened(amcl.origin), "m.yaml:5");
  EXPECT_EQ(shortened(amcl.origin_of("criticality")), "m.yaml:7");
  EXPECT_EQ(shortened(amcl.origin_of("restart")), "m.yaml:5") << "not given: the component";
}

TEST_F(ManifestFile, ExtendsAnother) {
  folder_.file("deploy/base.yaml", std::string(kHead) +
                                       "components:\n  amcl: {host: nuc}\n"
                                       "  lms100: {host: nuc, parameters: {a: 1, b: 2}}\n"
                                       "  guide: {host: nuc}\n");
  const auto manifest = read(
      "extends: base.yaml\ndomain: 3\ncomponents:\n"
      "  lms100: {type: lms100_sim, parameters: {b: 3}}\n"
      "  guide: ~\n  world: {host: nuc}\n");
  ASSERT_TRUE(manifest) << manifest.error();
  EXPECT_THAT(manifest->findings, IsEmpty());
  EXPECT_EQ(manifest->name, "m");
  EXPECT_EQ(manifest->domain, 3U);
  std::vector<std::string> names;
  for (const auto& component : manifest->components) names.push_back(component.name);
  EXPECT_THAT(names, ElementsAre("amcl", "lms100", "world")) << "null removes";
  const auto* laser = manifest->component("lms100");
  EXPECT_EQ(laser->type, "lms100_sim");
  EXPECT_EQ(shortened(laser->origin), "base.yaml:6");
  EXPECT_EQ(shortened(laser->origin_of("host")), "base.yaml:6");
  EXPECT_EQ(shortened(laser->origin_of("type")), "m.yaml:4");
  EXPECT_EQ(shortened(laser->parameters[0].origin), "base.yaml:6");
  EXPECT_EQ(shortened(laser->parameters[1].origin), "m.yaml:4");
}

TEST_F(ManifestFile, RemovesOnlyWhatIsThere) {
  folder_.file("deploy/base.yaml", std::string(kHead) +
                                       "components:\n  amcl: {host: nuc}\n"
                                       "  torso: {host: nuc}\n");
  EXPECT_THAT(findings("extends: base.yaml\ntorso: ~\ncomponents:\n  torsoo: ~\n  torso: ~\n"),
              ElementsAre("m.yaml:2: unknown key: there is no 'torso' here that null could remove",
                          "m.yaml:4: unknown key: there is no 'torsoo' here that null could "
                          "remove; did you mean torso?"));
}

TEST_F(ManifestFile, SaysThatAComponentIsInNoManifestBefore) {
  folder_.file("deploy/base.yaml", std::string(kHead) + "components: {amcl: {host: nuc}}\n");
  EXPECT_THAT(findings("extends: base.yaml\ncomponents:\n  speech: {parameters: {a: 1}}\n"),
              ElementsAre("m.yaml:3: missing value: component 'speech' has no host, neither here "
                          "nor in what this manifest extends; expected one of nuc, tablet"));
}

TEST_F(ManifestFile, RefusesACircle) {
  folder_.file("deploy/a.yaml", "\nextends: b.yaml\n");
  folder_.file("deploy/b.yaml", "extends: sub/../m.yaml\n");
  EXPECT_EQ(error("extends: a.yaml\n"), "manifests extend one another in a circle (b.yaml:1)");
  EXPECT_EQ(error("extends: m.yaml\n"), "manifests extend one another in a circle (m.yaml:1)");
}

TEST_F(ManifestFile, ExtendsAtMostEight) {
  folder_.file("deploy/0.yaml", std::string(kHead) + "components: {amcl: {host: nuc}}\n");
  for (int i = 1; i <= 9; ++i) {
    folder_.file("deploy/" + std::to_string(i) + ".yaml",
                 "extends: " + std::to_string(i - 1) + ".yaml\n");
  }
  EXPECT_TRUE(read_manifest(folder_.path() + "/deploy/8.yaml", {}));
  const auto too_deep = read_manifest(folder_.path() + "/deploy/9.yaml", {});
  ASSERT_FALSE(too_deep);
  EXPECT_THAT(shortened(too_deep.error()),
              testing::StartsWith("more than 8 manifests extend one another (1.yaml:1)"));
}

TEST_F(ManifestFile, SaysWhatCannotBeRead) {
  EXPECT_EQ(error("extends: none.yaml\n"),
            "'extends' names none.yaml, which is no file (m.yaml:1)");
  EXPECT_EQ(error("extends: [a]\n"), "'extends' must name a file, got [a] (m.yaml:1)");
  EXPECT_THAT(error("extends: .\n"), HasSubstr(", which is no file (m.yaml:1)"));
  EXPECT_EQ(error("- a\n"), "a manifest must be a map (m.yaml:1)");
  EXPECT_EQ(error(""), "a manifest must be a map (m.yaml:1)");
  EXPECT_THAT(error("a: [\n"), HasSubstr("not valid YAML"));
}

TEST_F(ManifestFile, SaysWhichFileWasMeant) {
  folder_.file("deploy/marvin.yaml", "");
  EXPECT_EQ(error("extends: marvn.yaml\n"),
            "'extends' names marvn.yaml, which is no file; did you mean marvin.yaml? (m.yaml:1)");
  const auto misspelt = read_manifest(folder_.path() + "/deploy/mavin.yaml", {});
  ASSERT_FALSE(misspelt);
  EXPECT_EQ(shortened(misspelt.error()),
            "there is no such file; did you mean marvin.yaml? (mavin.yaml)");
  EXPECT_EQ(error("extends: marvin\n"),
            "'extends' names marvin, which is no file; did you mean marvin.yaml? (m.yaml:1)")
      << "not the same word again";
}

TEST_F(ManifestFile, IsNoneWithoutAnyOfItsKeys) {
  EXPECT_EQ(error("version: 3\nconfigurePresets: []\n"),
            "no manifest: expected the keys robot, site, hosts, components (m.yaml:1)");
  EXPECT_THAT(error("name: marvin\ntrack: 0.5\ncomponents: {amcl: {max_beams: 3}}\n"),
              testing::StartsWith("no manifest: "))
      << "a robot's file";
}

TEST_F(ManifestFile, ShowsLittleOfWhatItRefuses) {
  const std::string text(900, 'x');
  EXPECT_THAT(findings(std::string(kHead) + "domain: " + text + "\n" + text +
                       ": 1\ncomponents: {amcl: {host: nuc}}\n"),
              testing::AllOf(testing::SizeIs(2), testing::Each(testing::ResultOf(
                                                     [](const auto& line) { return line.size(); },
                                                     testing::Lt(400U)))));
}

TEST_F(ManifestFile, MissesWhatMustBeThere) {
  EXPECT_THAT(findings("hosts: {}\n"),
              ElementsAre("m.yaml:1: missing value: manifest: 'robot' must be given",
                          "m.yaml:1: missing value: manifest: 'site' must be given",
                          "m.yaml:1: missing value: manifest: 'hosts' must be given",
                          "m.yaml:1: missing value: manifest: 'components' must be given"));
}

TEST_F(ManifestFile, SaysOnceThatAKeySaysNothing) {
  EXPECT_THAT(
      findings("robot: ''\nsite: s\nhosts: {nuc: {}}\n"
               "components: {amcl: {host: ''}}\n"),
      ElementsAre("m.yaml:1: wrong value: manifest: 'robot' must be a word, got \"\"",
                  "m.yaml:4: wrong value: component 'amcl': 'host' must be a word, got \"\""));
}

TEST_F(ManifestFile, FindsEveryUnknownKey) {
  EXPECT_THAT(findings(std::string(kHead) +
                       "robots: 3\ncomponents:\n  amcl: {host: nuc, critical: stop}\n"),
              ElementsAre("m.yaml:4: unknown key: manifest: unknown key 'robots'; did you mean "
                          "robot?",
                          "m.yaml:6: unknown key: component 'amcl': unknown key 'critical'; did "
                          "you mean criticality?"));
  EXPECT_THAT(findings(std::string(kHead) + "wheels: 3\ncomponents: {amcl: {host: nuc}}\n"),
              ElementsAre("m.yaml:4: unknown key: manifest: unknown key 'wheels', expected one of "
                          "name, robot, site, domain, seed, fresh_start, robot_facts, security, "
                          "discovery_server, fleet, hosts, components"));
  EXPECT_THAT(findings("robot: r\nsite: s\nhosts: {nuc: {peer: [a]}}\n"
                       "components: {amcl: {host: nuc}}\n"),
              ElementsAre("m.yaml:3: unknown key: host 'nuc': unknown key 'peer'; did you mean "
                          "peers?"));
}

TEST_F(ManifestFile, FindsWrongValues) {
  const auto with = [&](const std::string& settings) {
    return findings(std::string(kHead) + "components:\n  amcl: {host: nuc, " + settings + "}\n");
  };
  EXPECT_THAT(with("heartbeat_timeout: 0"),
              ElementsAre("m.yaml:5: wrong value: component 'amcl': 'heartbeat_timeout' must be a "
                          "number in [0.05, 60], got 0"));
  EXPECT_THAT(with("restart_budget: 2.5"),
              ElementsAre(HasSubstr("must be a whole number in [0, 1000], got 2.5")));
  for (const auto* bad : {"nan", "inf", "1e999", "-1", "61", "1 s", "''", "[1]", "{a: 1}"})
    EXPECT_THAT(with("heartbeat_timeout: " + std::string(bad)), testing::SizeIs(1)) << bad;
  EXPECT_THAT(with("criticality: high"),
              ElementsAre("m.yaml:5: wrong value: component 'amcl': 'criticality' must be one of "
                          "stop, degrade, notify, got high"));
  EXPECT_THAT(with("restart: [always]"), ElementsAre(HasSubstr("must be one of always,")));
  EXPECT_THAT(with("type: [a]"), ElementsAre(HasSubstr("'type' must be a word, got [a]")));
  EXPECT_THAT(with("parameters: 5"), ElementsAre(HasSubstr("'parameters' must be a map, got 5")));
  EXPECT_THAT(with("parameters: [a]"), ElementsAre(HasSubstr("must be a map, got [a]")));
  EXPECT_THAT(with("group: a/b"), ElementsAre(HasSubstr("a group's name must be")));
  EXPECT_THAT(findings(std::string(kHead) + "domain: 233\ncomponents: {a: {host: nuc}}\n"),
              ElementsAre(HasSubstr("m.yaml:4: wrong value: manifest: 'domain' must be a whole "
                                    "number in [0, 232], got 233")));
  EXPECT_THAT(findings(std::string(kHead) + "seed: -1\ncomponents: {a: {host: nuc}}\n"),
              ElementsAre(HasSubstr("'seed' must be a whole number")));
}

TEST_F(ManifestFile, WantsMapsWhereMapsBelong) {
  EXPECT_THAT(findings(std::string(kHead) + "components: {amcl: 5}\n"),
              ElementsAre(HasSubstr("wrong value: component 'amcl': must be a map, got 5"),
                          HasSubstr("missing value: component 'amcl' has no host")));
  EXPECT_THAT(findings(std::string(kHead) + "components: [amcl]\n"),
              ElementsAre(HasSubstr("'components' must be a map, got [amcl]")));
  EXPECT_THAT(findings("robot: r\nsite: s\nhosts: nuc\ncomponents: {a: {host: nuc}}\n"),
              ElementsAre(HasSubstr("'hosts' must be a map, got nuc")));
  EXPECT_THAT(findings("robot: r\nsite: s\nhosts: {nuc: {peers: [10.0.0.1, [2]]}}\n"
                       "components: {a: {host: nuc}}\n"),
              ElementsAre(HasSubstr("host 'nuc': 'peers' must hold words, got [2]")));
}

TEST_F(ManifestFile, SaysHowHostsMeetAndWhereTheKeysAre) {
  const auto manifest = read(std::string(kHead) +
                             "security: ../keys\n"
                             "discovery_server: {host: nuc, address: 10.0.0.1}\n"
                             "components: {amcl: {host: nuc}}\n");
  ASSERT_TRUE(manifest) << manifest.error();
  EXPECT_THAT(manifest->findings, IsEmpty());
  EXPECT_EQ(manifest->keys, folder_.path() + "/keys") << "from the folder of the manifest";
  EXPECT_EQ(manifest->discovery_server.locator(), "10.0.0.1:11811");
  EXPECT_EQ(shortened(manifest->origin_of("security")), "m.yaml:4");
}

TEST_F(ManifestFile, TakesNoPathForARobotOrASite) {
  EXPECT_THAT(findings("robot: ../r\nsite: /etc/site.yaml\nhosts: {nuc: {}}\n"
                       "components: {a: {host: nuc}}\n"),
              ElementsAre("m.yaml:1: wrong value: a robot's name must be 1 to 64 letters, digits, "
                          "'_' or '-', got \"../r\"",
                          "m.yaml:2: wrong value: a site's name must be 1 to 64 letters, digits, "
                          "'_' or '-', got /etc/site.yaml"));
}

TEST_F(ManifestFile, FindsHostsThatCannotBeReached) {
  EXPECT_THAT(findings("robot: r\nsite: s\nhosts: {nuc: {peers: [nuc.local]}}\n"
                       "components: {a: {host: nuc}}\n"),
              ElementsAre("m.yaml:3: wrong value: a peer of 'nuc' must be an IPv4 address like "
                          "10.0.0.2, got nuc.local"));
  folder_.file("deploy/base.yaml", std::string(kHead) + "components: {a: {host: nuc}}\n");
  EXPECT_THAT(findings("extends: base.yaml\nhosts: {tablet: {peers: [tablet.local]}}\n"),
              ElementsAre(HasSubstr("m.yaml:2: wrong value: a peer of 'tablet' must be")))
      << "where it is given, not where the host is";
  EXPECT_THAT(
      findings(std::string(kHead) + "discovery_server: {host: laptop, address: nuc, port: 80}\n"
                                    "components: {a: {host: nuc}}\n"),
      ElementsAre(HasSubstr("'port' must be a whole number in [1024, 65535], got 80"),
                  HasSubstr("the discovery server's address must be an IPv4 address"),
                  HasSubstr("the discovery server runs on the unknown host 'laptop'")));
}

TEST_F(ManifestFile, FindsUnknownHosts) {
  EXPECT_THAT(findings(std::string(kHead) + "components:\n  amcl:\n    host: laptop\n"),
              ElementsAre("m.yaml:6: unknown host: component 'amcl' runs on the unknown host "
                          "'laptop', expected one of nuc, tablet"));
}

TEST_F(ManifestFile, RefusesNamesThatAreNoFileNames) {
  for (const auto* bad : {"'../amcl'", "'a b'", "'a,b'", "''", "'\xc3\xa4'"}) {
    EXPECT_THAT(findings(std::string(kHead) + "components: {" + bad + ": {host: nuc}}\n"),
                testing::Contains(HasSubstr("must be 1 to 64 letters, digits, '_' or '-'")))
        << bad;
  }
}

TEST_F(ManifestFile, TakesTheNearestConfig) {
  const auto own = folder_.file("config/robots/r.yaml", "");
  const auto installed = folder_.file("share/config/sites/s/site.yaml", "");
  const auto manifest = read_manifest(
      folder_.file("deploy/m.yaml", std::string(kHead) + "components: {a: {host: nuc}}\n"),
      {folder_.path() + "/config", folder_.path() + "/share/config"});
  ASSERT_TRUE(manifest);
  EXPECT_EQ(manifest->robot_file, own);
  EXPECT_EQ(manifest->site_file, installed);
}

TEST_F(ManifestFile, ReadsTheFleet) {
  const std::string body = std::string(kHead) + "domain: 7\ncomponents: {amcl: {host: nuc}}\n";
  const auto manifest = read(body +
                             "fleet: {domain: 60, robot: iris, peers: [10.0.0.3], "
                             "start: [1, 2, 0]}\n");
  ASSERT_TRUE(manifest) << manifest.error();
  EXPECT_THAT(manifest->findings, IsEmpty());
  EXPECT_EQ(manifest->fleet.robot, "iris");
  EXPECT_EQ(manifest->fleet.domain, 60U);
  EXPECT_THAT(manifest->fleet.peers, ElementsAre("10.0.0.3"));
  EXPECT_EQ(manifest->fleet.start.yaml, "[1, 2, 0]");
  EXPECT_EQ(read(body)->fleet.robot, "");
  EXPECT_THAT(findings(body + "fleet: {domain: 7, robot: iris}\n"),
              ElementsAre(HasSubstr("its domain must not be the robot's own, both are 7")));
  EXPECT_THAT(findings(body + "fleet: {robot: iris}\n"),
              ElementsAre(HasSubstr("'domain' must be given")));
  EXPECT_THAT(findings(body + "fleet: {domain: 60, robot: \"i/s\"}\n"),
              ElementsAre(HasSubstr("a robot's name must be")));
  EXPECT_THAT(findings(body + "fleet: {domain: 60, robot: iris, peers: [otto]}\n"),
              ElementsAre(HasSubstr("IPv4")));
}

}  // namespace
}  // namespace usher::operations
