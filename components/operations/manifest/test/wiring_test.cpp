#include "operations/manifest/wiring.hpp"

#include <gmock/gmock.h>

#include <cstdio>

#include "support/folder.hpp"

namespace usher::operations {
namespace {

using runtime::Contract;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const runtime::Qos kStream{true, false, 5};
const runtime::Qos kLatched{true, true, 1};

Contract contract(const std::string& type) {
  Contract contract;
  contract.component = type;
  char digest[20];
  std::snprintf(digest, sizeof(digest), "%016llx",
                static_cast<unsigned long long>(USHER_IDL_DIGEST));
  contract.idl_digest = digest;
  return contract;
}

Contract writer(const std::string& type, const std::string& topic, double rate_hz = 50.0) {
  auto made = contract(type);
  made.outputs.push_back({topic, "T", kStream, rate_hz});
  return made;
}

Contract reader(const std::string& type, const std::string& topic, double max_age = 0.0) {
  auto made = contract(type);
  made.inputs.push_back(
      {.topic = topic, .type = "T", .on_loss = "stops", .qos = kStream, .max_age = max_age});
  return made;
}

/// Manifests are read from text so that findings have the lines that an operator sees.
class Wiring : public testing::Test {
 protected:
  void add(const Contract& made) { contracts_[made.component] = made; }

  std::vector<std::string> findings(const std::string& components) {
    const auto manifest = read_manifest(
        folder_.file("m.yaml",
                     "robot: r\nsite: s\nhosts: {nuc: {}, tablet: {}}\ncomponents:\n" + components),
        {});
    EXPECT_TRUE(manifest) << (manifest ? "" : manifest.error());
    EXPECT_THAT(manifest->findings, IsEmpty());
    std::vector<Finding> found;
    judge_wiring(*manifest, contracts_, found);
    std::vector<std::string> texts;
    texts.reserve(found.size());
    for (const auto& finding : found)
      texts.push_back(to_string(finding).substr(folder_.path().size() + 1));
    return texts;
  }

  test::Folder folder_;
  Contracts contracts_;
};

TEST_F(Wiring, IsGoodWhenEveryInputHasItsWriter) {
  add(writer("lms100", "scan"));
  add(reader("scan_filter", "scan", 0.1));
  EXPECT_THAT(findings("  lms100: {host: nuc}\n  scan_filter: {host: nuc}\n"), IsEmpty());
}

TEST_F(Wiring, BlamesTheNullThatTookAWriterOut) {
  add(writer("lms100", "scan"));
  add(reader("scan_filter", "scan"));
  folder_.file("base.yaml",
               "robot: r\nsite: s\nhosts: {nuc: {}}\ncomponents:\n  laser: {host: nuc, type: "
               "lms100}\n  scan_filter: {host: nuc}\n");
  const auto manifest =
      read_manifest(folder_.file("over.yaml", "extends: base.yaml\ncomponents:\n  laser: ~\n"), {});
  ASSERT_TRUE(manifest) << manifest.error();
  std::vector<Finding> found;
  judge_wiring(*manifest, contracts_, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(to_string(found.front()),
            folder_.path() +
                "/over.yaml:3: no writer: 'scan_filter' reads scan, which 'laser' wrote that is "
                "taken out here");
}

TEST_F(Wiring, FindsAnInputThatNobodyWrites) {
  add(writer("lms100", "scan"));
  add(reader("scan_filter", "scan"));
  EXPECT_THAT(findings("  scan_filter: {host: nuc}\n"),
              ElementsAre("m.yaml:5: no writer: 'scan_filter' reads scan, and nobody writes it"));
  contracts_["scan_filter"].inputs[0].optional = true;
  EXPECT_THAT(findings("  scan_filter: {host: nuc}\n"), IsEmpty());
}

TEST_F(Wiring, LeavesToTheOperatorWhatTheOperatorMayWrite) {
  add(reader("amcl", "initialpose"));
  EXPECT_THAT(findings("  amcl: {host: nuc}\n"), IsEmpty());
}

TEST_F(Wiring, FindsTwoWriters) {
  add(writer("lms100", "scan"));
  add(writer("lms100_sim", "scan"));
  EXPECT_THAT(findings("  lms100: {host: nuc}\n  second: {type: lms100, host: nuc}\n"),
              ElementsAre("m.yaml:6: two writers: scan is written by 'lms100' and by 'second'"));
  EXPECT_THAT(findings("  lms100: {host: nuc}\n  other:\n    host: nuc\n    type: lms100_sim\n"),
              ElementsAre("m.yaml:8: two writers: scan is written by 'lms100' and by 'other'"))
      << "a simulated device takes the place of the real one";
}

TEST_F(Wiring, FindsASecondDeviceOfAnotherMake) {
  add(writer("lms100", "scan"));
  add(writer("urg04lx", "scan"));
  EXPECT_THAT(findings("  lms100: {host: nuc}\n  urg04lx: {host: nuc}\n"),
              ElementsAre("m.yaml:6: two writers: scan is written by 'lms100' and by 'urg04lx'"));
  for (const char* topic : {"base/status", "odom"}) {
    add(writer("segway_rmp", topic, 100));
    add(writer("p3dx", topic, 10));
    EXPECT_THAT(findings("  segway_rmp: {host: nuc}\n  p3dx: {host: nuc}\n"),
                ElementsAre(HasSubstr("two writers: " + std::string(topic) + " is written by ")));
  }
}

TEST_F(Wiring, AllowsSeveralWritersWhereTheCatalogueNamesThem) {
  add(writer("segway_rmp", "tf", 100));
  add(writer("amcl", "tf", 50));
  EXPECT_THAT(findings("  segway_rmp: {host: nuc}\n  amcl: {host: nuc}\n"), IsEmpty());
}

TEST_F(Wiring, AllowsEveryComponentItsHeartbeat) {
  add(writer("amcl", "heartbeat", 10));
  add(writer("guide", "heartbeat", 10));
  EXPECT_THAT(findings("  amcl: {host: nuc}\n  guide: {host: nuc}\n  b: {host: nuc, type: amcl}\n"),
              IsEmpty());
}

TEST_F(Wiring, FindsWhoMayNotWrite) {
  add(writer("guide", "drive/command"));
  EXPECT_THAT(findings("  guide: {host: nuc}\n"),
              testing::Contains("m.yaml:5: unauthorized writer: 'guide' (guide) may not write "
                                "drive/command"));
}

TEST_F(Wiring, FindsTopicsThatTheCatalogueDoesNotKnow) {
  add(writer("lms100", "scans"));
  EXPECT_THAT(findings("  lms100: {host: nuc}\n"),
              ElementsAre("m.yaml:5: type mismatch: 'lms100' writes scans, which the catalogue "
                          "does not know"));
}

TEST_F(Wiring, FindsOneTopicWithTwoTypes) {
  add(writer("lms100", "scan"));
  add(reader("scan_filter", "scan"));
  contracts_["scan_filter"].inputs[0].type = "U";
  EXPECT_THAT(findings("  lms100: {host: nuc}\n  scan_filter: {host: nuc}\n"),
              ElementsAre("m.yaml:6: type mismatch: scan is written as T by 'lms100' and read as U "
                          "by 'scan_filter'"));
}

TEST_F(Wiring, FindsReadersThatAskForMoreThanIsOffered) {
  add(writer("lms100", "scan"));
  add(reader("scan_filter", "scan"));
  auto& asked = contracts_["scan_filter"].inputs[0].qos;
  auto& offered = contracts_["lms100"].outputs[0].qos;
  const std::string both = "  lms100: {host: nuc}\n  scan_filter: {host: nuc}\n";
  const auto mismatch =
      ElementsAre("m.yaml:6: QoS mismatch: 'scan_filter' asks more of scan than 'lms100' offers");
  asked = kLatched;
  EXPECT_THAT(findings(both), mismatch);
  offered = kLatched;
  EXPECT_THAT(findings(both), IsEmpty());
  offered.reliable = false;
  EXPECT_THAT(findings(both), mismatch);
  asked.reliable = false;
  EXPECT_THAT(findings(both), IsEmpty());
  asked = {false, false, 50};
  EXPECT_THAT(findings(both), IsEmpty()) << "less is fine, and depth does not decide";
}

TEST_F(Wiring, FindsWritersTooSlowForTheAgeThatIsAccepted) {
  add(writer("lms100", "scan", 50));
  add(reader("scan_filter", "scan", 0.029));
  const std::string both = "  lms100: {host: nuc}\n  scan_filter: {host: nuc}\n";
  EXPECT_THAT(findings(both),
              ElementsAre("m.yaml:6: rate too low: 'scan_filter' accepts scan up to 0.029 s old, "
                          "but 'lms100' writes it at 50 Hz only"));
  contracts_["scan_filter"].inputs[0].max_age = 0.03;
  EXPECT_THAT(findings(both), IsEmpty()) << "one and a half periods";
  contracts_["scan_filter"].inputs[0].max_age = 0.001;
  contracts_["lms100"].outputs[0].rate_hz = 0.0;
  EXPECT_THAT(findings(both), IsEmpty()) << "on occasion";
}

TEST_F(Wiring, FindsDriveChainsWithUnsafePolicies) {
  for (const auto* topic : {"drive/command", "drive/grant", "base/status", "movement/enable"}) {
    contracts_.clear();
    const std::string type = std::string(topic) == "drive/command" ? "movement_control"
                             : std::string(topic) == "base/status" ? "segway_rmp"
                                                                   : "supervisor";
    add(writer(type, topic));
    const auto with = [&](const std::string& setting) {
      return findings("  " + type + ":\n    host: nuc\n    " + setting + "\n");
    };
    EXPECT_THAT(with("criticality: stop"), IsEmpty());
    EXPECT_THAT(with("criticality: degrade"),
                ElementsAre("m.yaml:7: unsafe policy: '" + type +
                            "' belongs to the drive chain: its criticality must be stop, not "
                            "degrade"));
    EXPECT_THAT(with("criticality: notify"), ElementsAre(HasSubstr("stop, not notify")));
    EXPECT_THAT(with("restart: never"), ElementsAre(HasSubstr("m.yaml:7: unsafe policy: ")));
    EXPECT_THAT(with("restart: on_failure"), ElementsAre(HasSubstr("its restart must be always")));
    EXPECT_THAT(with("restart_budget: 0"),
                ElementsAre(HasSubstr("its restart_budget must be at least 1")));
    EXPECT_THAT(with("heartbeat_timeout: 0.16"),
                ElementsAre(HasSubstr("its heartbeat_timeout must be at most 0.15 s, not 0.16 s")));
    EXPECT_THAT(with("heartbeat_timeout: 0.15"), IsEmpty());
  }
  add(writer("guide", "navigate/goal", 0));
  EXPECT_THAT(findings("  guide: {host: nuc, criticality: notify, restart: never}\n"), IsEmpty())
      << "what does not decide over motion may be lost";
}

TEST_F(Wiring, FindsGuidesWhoseLossWouldNotStopTheRobot) {
  const struct {
    const char* type;
    const char* topic;
  } guides[] = {{"lms100", "scan"},
                {"scan_filter", "scan/filtered"},
                {"scan_filter", "ultrasonic/filtered"},
                {"sensor_board", "ultrasonic"},
                {"sensor_board", "whiskers"},
                {"costmap", "local_costmap/costs"},
                {"amcl", "localization/status"},
                {"local_planner", "cmd_vel/navigation"}};
  for (const auto& [type, topic] : guides) {
    SCOPED_TRACE(topic);
    contracts_.clear();
    add(writer(type, topic));
    add(writer("supervisor", "drive/grant"));
    const auto with = [&, guide = std::string(type)](const std::string& setting) {
      return findings("  supervisor: {host: nuc}\n  " + guide + ":\n    host: tablet\n    " +
                      setting + "\n");
    };
    EXPECT_THAT(with("criticality: stop"), IsEmpty()) << "on whatever host";
    EXPECT_THAT(with("criticality: notify"),
                ElementsAre("m.yaml:8: unsafe policy: '" + std::string(type) +
                            "' tells where the robot may drive: its criticality must be stop, not "
                            "notify"));
    EXPECT_THAT(with("criticality: degrade"), ElementsAre(HasSubstr("stop, not degrade")));
    EXPECT_THAT(with("heartbeat_timeout: 0.16"),
                ElementsAre(HasSubstr("its heartbeat_timeout must be at most 0.15 s, not 0.16 s")));
    EXPECT_THAT(with("restart: never"), IsEmpty()) << "it stands, and stays standing";
  }
}

TEST_F(Wiring, KeepsTheDriveChainOnOneHost) {
  add(writer("movement_control", "drive/command"));
  add(writer("segway_rmp", "base/status", 100));
  add(writer("supervisor", "drive/grant"));
  EXPECT_THAT(findings("  movement_control: {host: nuc}\n  segway_rmp: {host: nuc}\n"
                       "  supervisor:\n    host: tablet\n"),
              ElementsAre("m.yaml:8: split drive chain: the drive chain must live on one host: "
                          "'segway_rmp' is on nuc, 'supervisor' on tablet"));
  EXPECT_THAT(findings("  movement_control:\n    host: tablet\n  segway_rmp: {host: nuc}\n"
                       "  supervisor: {host: nuc}\n"),
              ElementsAre("m.yaml:6: split drive chain: the drive chain must live on one host: "
                          "'segway_rmp' is on nuc, 'movement_control' on tablet"))
      << "not the two that are where the base is";
}

TEST_F(Wiring, KeepsAGroupTogether) {
  add(contract("kinect"));
  add(contract("depth_pipeline"));
  const auto with = [&](const std::string& other) {
    return findings("  kinect: {host: nuc, group: depth}\n  depth_pipeline: {group: depth, " +
                    other + "}\n");
  };
  EXPECT_THAT(with("host: nuc"), IsEmpty());
  EXPECT_THAT(with("host: tablet"),
              ElementsAre("m.yaml:6: split group: group 'depth' must live on one host: 'kinect' is "
                          "on nuc, 'depth_pipeline' on tablet"));
  EXPECT_THAT(with("host: nuc, restart: never"),
              ElementsAre(HasSubstr("must have one restart and restart_budget")))
      << "one process has one policy; the first component's would silently win";
  EXPECT_THAT(with("host: nuc, restart_budget: 2"), ElementsAre(HasSubstr("split group")));
  EXPECT_THAT(with("host: nuc, real_time: true"),
              ElementsAre("m.yaml:6: split group: group 'depth' must have one real_time: those of "
                          "'kinect' and 'depth_pipeline' differ"));
  EXPECT_THAT(findings("  kinect: {host: nuc, group: depth_pipeline}\n"
                       "  depth_pipeline: {host: nuc}\n"),
              ElementsAre("m.yaml:5: split group: group 'depth_pipeline' has the name of a "
                          "component; choose another"));
}

TEST_F(Wiring, FindsContractsFromOtherIdl) {
  add(contract("amcl"));
  contracts_["amcl"].idl_digest = "0123456789abcdef";
  EXPECT_THAT(findings("  amcl: {host: nuc}\n"),
              ElementsAre(HasSubstr("m.yaml:5: wrong IDL: the contract of 'amcl' was made from IDL "
                                    "0123456789abcdef, this program from ")));
}

TEST_F(Wiring, SaysNothingOfComponentsWithoutContract) {
  EXPECT_THAT(findings("  wings: {host: nuc}\n"), IsEmpty()) << "the resolver says it";
}

}  // namespace
}  // namespace usher::operations
