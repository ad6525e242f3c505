#include "operations/security/keys.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "operations/security/authority.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kDays = 30;

TEST(Authority, SignsWhatOnlyItCanSign) {
  const auto one = Authority::create("one", kDays);
  const auto two = Authority::create("two", kDays);
  ASSERT_TRUE(one && two);
  const auto own = one->pair()->certificate;
  const auto signed_text = one->sign("<dds>5</dds>\n");
  ASSERT_TRUE(signed_text) << signed_text.error();
  const auto read = verify_document(*signed_text, own);
  ASSERT_TRUE(read) << read.error();
  EXPECT_THAT(*read, HasSubstr("<dds>5</dds>"));
  EXPECT_FALSE(verify_document(*signed_text, two->pair()->certificate));
  std::string changed = *signed_text;
  changed[changed.find("5<")] = '6';
  EXPECT_FALSE(verify_document(changed, own)) << "not one byte may differ";
  EXPECT_FALSE(verify_document("", own));
  EXPECT_FALSE(verify_document("no document", own));
  EXPECT_FALSE(verify_document(*signed_text, "no certificate"));
}

TEST(Authority, CertifiesNames) {
  const auto authority = Authority::create("robot", kDays);
  ASSERT_TRUE(authority);
  const auto own = authority->pair()->certificate;
  const auto pair = authority->issue("amcl", kDays);
  ASSERT_TRUE(pair) << pair.error();
  EXPECT_TRUE(verify_certificate(pair->certificate, own, "amcl"));
  EXPECT_THAT(verify_certificate(pair->certificate, own, "guide").error(), HasSubstr("guide"));
  const auto other = Authority::create("robot", kDays);
  EXPECT_FALSE(verify_certificate(pair->certificate, other->pair()->certificate, "amcl"))
      << "the same name is not the same CA";
  EXPECT_FALSE(verify_certificate("", own, "amcl"));
  const auto expired = authority->issue("amcl", -1);
  ASSERT_TRUE(expired);
  EXPECT_THAT(verify_certificate(expired->certificate, own, "amcl").error(), HasSubstr("expired"));
}

TEST(Authority, IsLoadedOnlyWithItsOwnKey) {
  const auto one = Authority::create("one", kDays);
  const auto two = Authority::create("two", kDays);
  ASSERT_TRUE(one && two);
  EXPECT_TRUE(Authority::load(*one->pair()));
  EXPECT_FALSE(Authority::load({one->pair()->certificate, two->pair()->key}));
  EXPECT_FALSE(Authority::load({"", ""}));
}

TEST(Permissions, SurviveTheirDocument) {
  EXPECT_EQ(subject_of("amcl"), "CN=amcl,O=Usher");
  const Permissions amcl{"amcl", 42, {"rt/amcl_pose", "rt/tf"}, {"rt/map"}};
  const auto read = read_permissions(permissions_document(amcl, kDays));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->name, "amcl");
  EXPECT_EQ(read->domain, 42U);
  EXPECT_EQ(read->write, amcl.write);
  EXPECT_EQ(read->read, amcl.read);
  for (const std::string broken : {"", "<dds>", "<dds></dds>", "<dds><permissions/></dds>"})
    EXPECT_FALSE(read_permissions(broken)) << broken;
}

class Keys : public testing::Test {
 protected:
  Keys() {
    runtime::Contract movement;
    movement.component = "movement_control";
    movement.outputs = {{.topic = "drive/command", .type = "", .qos = {}, .rate_hz = 50}};
    movement.inputs = {{.topic = "drive/grant", .type = "", .on_loss = "", .qos = {}}};
    runtime::Contract guide;
    guide.component = "guide";
    guide.outputs = {{.topic = "dialogue/screen", .type = "", .qos = {}, .rate_hz = 0}};
    contracts_ = {{"movement_control", movement}, {"guide", guide}};
    manifest_.path = "m.yaml";
    manifest_.name = "m";
    manifest_.domain = 7;
    manifest_.keys = folder_.path() + "/keys";
    manifest_.hosts = {{.name = "nuc"}, {.name = "tablet"}};
    add("movement_control", "nuc");
    add("guide", "tablet");
  }
  void add(const std::string& name, const std::string& host) {
    auto& component = manifest_.components.emplace_back();
    component.name = component.type = name;
    component.host = host;
    component.origin = "m.yaml:" + std::to_string(manifest_.components.size());
  }
  std::vector<std::string> findings() const {
    std::vector<Finding> found;
    judge_keys(manifest_, contracts_, found);
    std::vector<std::string> texts;
    for (const auto& finding : found) texts.push_back(to_string(finding));
    return texts;
  }
  Result<std::vector<KeysEntry>> make(const KeysOptions& options = {}) const {
    return make_keys(manifest_.keys, "m", permissions_of(manifest_, contracts_), options);
  }
  static unsigned mode(const std::string& path) {
    struct stat file {};
    ::stat(path.c_str(), &file);
    return file.st_mode & 0777U;
  }

  test::Folder folder_;
  Manifest manifest_;
  Contracts contracts_;
};

TEST_F(Keys, GiveEachComponentWhatItsContractListsAndNoMore) {
  const auto all = permissions_of(manifest_, contracts_);
  const auto of = [&](const std::string& name) {
    return *std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.name == name; });
  };
  EXPECT_THAT(of("movement_control").write, ElementsAre("rt/drive/command", "rt/heartbeat"));
  EXPECT_THAT(of("movement_control").read, ElementsAre("rt/drive/grant"));
  EXPECT_THAT(of("guide").write, ElementsAre("rt/dialogue/screen", "rt/heartbeat"));
  EXPECT_THAT(of("guide").read, IsEmpty());
  EXPECT_TRUE(of("operator").write.contains("rt/supervisor/request"));
  for (const auto& identity : all) {
    EXPECT_EQ(identity.write.contains("rt/drive/command"), identity.name == "movement_control")
        << identity.name;
  }
}

TEST_F(Keys, ArePrivateAndGoodForTheirManifest) {
  ASSERT_TRUE(make());
  EXPECT_THAT(findings(), IsEmpty());
  EXPECT_EQ(mode(manifest_.keys), 0700U);
  EXPECT_EQ(mode(manifest_.keys + "/ca.key"), 0600U);
  EXPECT_EQ(mode(manifest_.keys + "/guide/key.pem"), 0600U);
}

TEST_F(Keys, AreKeptWhenMadeAgainUnlessAllIsRenewed) {
  ASSERT_TRUE(make());
  const auto key = test::content_of(manifest_.keys + "/guide/key.pem");
  const auto authority = test::content_of(manifest_.keys + "/ca.pem");
  add("amcl", "nuc");
  contracts_["amcl"].component = "amcl";
  const auto again = make();
  ASSERT_TRUE(again) << again.error();
  for (const auto& entry : *again) EXPECT_EQ(entry.made, entry.name == "amcl") << entry.name;
  EXPECT_EQ(test::content_of(manifest_.keys + "/guide/key.pem"), key);
  EXPECT_EQ(test::content_of(manifest_.keys + "/ca.pem"), authority);
  EXPECT_THAT(findings(), IsEmpty());
  ASSERT_TRUE(make({.renew = true}));
  EXPECT_NE(test::content_of(manifest_.keys + "/guide/key.pem"), key);
  EXPECT_NE(test::content_of(manifest_.keys + "/ca.pem"), authority);
  EXPECT_THAT(findings(), IsEmpty());
}

TEST_F(Keys, AreFoundWantingWhenTheContractHasGrown) {
  ASSERT_TRUE(make());
  contracts_["guide"].outputs.push_back(
      {.topic = "navigate/goal", .type = "", .qos = {}, .rate_hz = 0});
  EXPECT_THAT(findings(),
              ElementsAre("m.yaml:2: no permission: 'guide' may not write navigate/goal (" +
                          manifest_.keys + "/guide/permissions.smime)"));
  ASSERT_TRUE(make()) << "signs anew";
  EXPECT_THAT(findings(), IsEmpty());
}

TEST_F(Keys, AreFoundWantingWhenTheyAllowMoreThanTheContract) {
  auto identities = permissions_of(manifest_, contracts_);
  for (auto& identity : identities) identity.write.insert("rt/drive/command");
  ASSERT_TRUE(make_keys(manifest_.keys, "m", identities, {}));
  const auto texts = findings();
  ASSERT_FALSE(texts.empty());
  EXPECT_THAT(texts[0], HasSubstr("m.yaml:2: no permission: 'guide' may write drive/command, which "
                                  "its contract does not list"));
}

TEST_F(Keys, AreFoundWantingInAnotherDomainAndOfAnotherCa) {
  ASSERT_TRUE(make());
  manifest_.domain = 8;
  EXPECT_THAT(findings(),
              ElementsAre(testing::AllOf(HasSubstr("none of the 4 keys in " + manifest_.keys),
                                         HasSubstr("permissions for domain 7, not for 8"))))
      << "one finding, not one for each";
  manifest_.domain = 7;
  ASSERT_TRUE(make_keys(folder_.path() + "/other", "o", permissions_of(manifest_, contracts_), {}));
  std::filesystem::copy_file(folder_.path() + "/other/ca.pem", manifest_.keys + "/ca.pem",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(
      findings(),
      ElementsAre(testing::AllOf(HasSubstr("none of the 4 keys"),
                                 HasSubstr("the certificate of 'movement_control' is not valid")),
                  HasSubstr("governance.smime is not signed by the CA")));
}

TEST_F(Keys, AreFoundWantingWithoutAGovernanceOfTheirCa) {
  ASSERT_TRUE(make());
  folder_.file("keys/governance.smime", "");
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("governance.smime is not signed by the CA")));
  std::filesystem::remove(manifest_.keys + "/governance.smime");
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("cannot read " + manifest_.keys + "/governance")));
}

TEST_F(Keys, OfAnotherHostNeedNotBeHere) {
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("missing file: cannot read")));
  ASSERT_TRUE(make());
  std::filesystem::remove_all(manifest_.keys + "/guide");
  EXPECT_THAT(findings(), IsEmpty()) << "they are on the tablet";
  add("amcl", "nuc");
  contracts_["amcl"].component = "amcl";
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("no permission: cannot read")))
      << "this one belongs here";
}

TEST_F(Keys, OfTheLauncherAndOfADiscoveryServerBelongToTheirHosts) {
  manifest_.discovery_server = {.host = "nuc", .address = "10.0.0.1"};
  ASSERT_TRUE(make());
  std::filesystem::remove_all(manifest_.keys + "/operator");
  EXPECT_THAT(findings(), IsEmpty()) << "whose commands may come from elsewhere";
  std::filesystem::remove_all(manifest_.keys + "/launcher");
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("/launcher/certificate.pem")));
  ASSERT_TRUE(make());
  std::filesystem::remove_all(manifest_.keys + "/discovery_server");
  EXPECT_THAT(findings(), ElementsAre(HasSubstr("/discovery_server/certificate.pem")));
  std::filesystem::remove_all(manifest_.keys + "/movement_control");
  EXPECT_THAT(findings(), IsEmpty()) << "this is the tablet";
}

TEST_F(Keys, AreNotMadeWhereNothingCanBeWritten) {
  folder_.file("occupied", "");
  const auto made =
      make_keys(folder_.path() + "/occupied", "m", permissions_of(manifest_, contracts_), {});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error(), HasSubstr("occupied"));
}

}  // namespace
}  // namespace usher::operations
