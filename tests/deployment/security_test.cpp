// DDS-Security between participants of one domain: who may take part, who may write what, and what
// becomes of packets that nobody of the robot signed.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "idl/topics.hpp"
#include "operations/security/authority.hpp"
#include "operations/security/keys.hpp"
#include "operations/security/packet_attack.hpp"
#include "runtime/dds/observer.hpp"
#include "support/folder.hpp"
#include "support/test_domain.hpp"

namespace usher::test {
namespace {

namespace fs = std::filesystem;
using namespace operations;
using runtime::Observer;
using testing::HasSubstr;
using usher_msgs::msg::DriveCommand;

constexpr auto kLong = std::chrono::seconds(20);
constexpr auto kMoment = std::chrono::milliseconds(1500);  // far longer than a match takes

class Security : public testing::Test {
 protected:
  void SetUp() override {
    const auto made = make_keys(keys(), "test", identities(), {});
    ASSERT_TRUE(made) << made.error();
  }
  std::string keys() const { return folder_.path() + "/keys"; }

  static std::vector<Permissions> identities() {
    const auto domain = test_domain();
    return {{"movement_control", domain, {"rt/heartbeat", "rt/drive/command"}, {"rt/drive/grant"}},
            {"segway_rmp", domain, {"rt/heartbeat", "rt/odom"}, {"rt/drive/command"}},
            {"guide", domain, {"rt/heartbeat"}, {"rt/map"}}};
  }
  /// An empty identity = without keys.
  static std::unique_ptr<Observer> join(const std::string& name, const std::string& identity) {
    auto made = Observer::create(
        {.name = name, .host = "nuc", .domain = test_domain(), .identity = identity});
    EXPECT_TRUE(made) << (made ? "" : made.error());
    return made ? std::move(made).value() : nullptr;
  }
  std::unique_ptr<Observer> join(const std::string& name) const {
    return join(name, keys() + "/" + name);
  }
  template <class Condition>
  static bool eventually(Condition condition, std::chrono::milliseconds limit = kLong) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  static bool refused(const Observer& by, const std::string& name) {
    const auto refusals = by.refusals();
    return std::ranges::any_of(refusals, [&](const runtime::Refusal& refusal) {
      return refusal.name == name && refusal.address.find('.') != std::string::npos;
    });
  }

  Folder folder_;
};

TEST_F(Security, WhoHasPermissionsWritesAndReads) {
  auto writing = join("movement_control");
  auto reading = join("segway_rmp");
  auto writer = writing->writer(topics::kDriveCommand);
  auto reader = reading->reader(topics::kDriveCommand);
  ASSERT_TRUE(writer && reader);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(writer->wait_for_readers(1, kLong));
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  std::printf("matched after %.0f ms\n", took.count());
  DriveCommand command;
  for (std::uint64_t number = 1; number <= 100; ++number) {
    command.number(number);
    ASSERT_TRUE(writer->write(command));
    const auto received = reader->take(kLong);
    ASSERT_NE(received, nullptr);
    EXPECT_EQ(received->number(), number);
  }
  EXPECT_TRUE(reading->refusals().empty());
}

TEST_F(Security, WhoHasNoKeysIsRefusedAndNamedAndHearsNothing) {
  auto reading = join("segway_rmp");
  auto reader = reading->reader(topics::kDriveCommand);
  auto intruder = join("intruder", "");
  auto forged = intruder->writer(topics::kDriveCommand);
  auto spying = intruder->reader(topics::kOdom);
  auto odometer = reading->writer(topics::kOdom);
  ASSERT_TRUE(reader && forged && spying && odometer);
  ASSERT_TRUE(eventually([&] { return refused(*reading, "intruder"); }));
  EXPECT_FALSE(forged->wait_for_readers(1, kMoment));
  EXPECT_EQ(odometer->reader_count(), 0U);
  for (const auto& participant : reading->participants())
    EXPECT_NE(participant.identity.name, "intruder") << "it takes no part";
}

TEST_F(Security, WhoWasCertifiedBySomebodyElseIsRefused) {
  const std::string other = folder_.path() + "/other";
  ASSERT_TRUE(make_keys(other, "other", identities(), {}));
  auto reading = join("segway_rmp");
  auto reader = reading->reader(topics::kDriveCommand);
  auto intruder = join("movement_control", other + "/movement_control");
  auto forged = intruder->writer(topics::kDriveCommand);
  ASSERT_TRUE(reader && forged);
  EXPECT_TRUE(eventually([&] { return refused(*reading, "movement_control"); }));
  EXPECT_FALSE(forged->wait_for_readers(1, kMoment));
}

TEST_F(Security, WhoHasKeysButNoPermissionCannotWrite) {
  auto guide = join("guide");
  const auto writer = guide->writer(topics::kDriveCommand);
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error(), HasSubstr("no permission to write rt/drive/command"));
  EXPECT_THAT(writer.error(), HasSubstr("guide/permissions.smime"));
  EXPECT_FALSE(guide->reader(topics::kDriveCommand)) << "nor read";
  EXPECT_TRUE(guide->reader(topics::kMap));
}

/// The library of an attacker need not ask its own permissions. Here it believes a governance of
/// the attacker's making, under which everybody may write everything, while its certificate and
/// permissions are the robot's.
TEST_F(Security, RulesThatAParticipantMadeForItselfDoNotHelpIt) {
  const std::string evil = folder_.path() + "/evil";
  fs::create_directories(evil);
  fs::copy(keys() + "/guide", evil + "/guide");
  const auto authority = Authority::create("attacker", 10);
  ASSERT_TRUE(authority);
  std::string lenient = governance_document(test_domain());
  for (const std::string right : {"enable_read_access_control", "enable_write_access_control"}) {
    const std::string yes = "<" + right + ">true";
    ASSERT_NE(lenient.find(yes), std::string::npos);
    lenient.replace(lenient.find(yes), yes.size(), "<" + right + ">false");
  }
  std::ofstream(evil + "/ca.pem") << content_of(keys() + "/ca.pem")
                                  << authority->pair()->certificate;
  std::ofstream(evil + "/governance.smime") << *authority->sign(lenient);

  auto reading = join("segway_rmp");
  auto reader = reading->reader(topics::kDriveCommand);
  auto attacker =
      Observer::create({.name = "guide", .domain = test_domain(), .identity = evil + "/guide"});
  ASSERT_TRUE(attacker) << attacker.error();
  auto writer = (*attacker)->writer(topics::kDriveCommand);
  ASSERT_TRUE(writer) << "its own rules let it: " << writer.error();
  EXPECT_FALSE(writer->wait_for_readers(1, kMoment));
  DriveCommand command;
  command.v(1.0);
  for (int i = 0; i < 100; ++i) writer->write(command);
  EXPECT_EQ(reader->take(kMoment), nullptr);
}

TEST_F(Security, APacketThatTheWriterDidNotSendIsNotTaken) {
  auto writing = join("movement_control");
  auto reading = join("segway_rmp");
  auto tap = PacketTap::open(test_domain());
  if (!tap) GTEST_SKIP() << tap.error();
  auto writer = writing->writer(topics::kDriveCommand);
  std::atomic<std::uint64_t> honest{0};
  std::atomic<std::uint64_t> forged{0};
  auto reader = reading->reader(topics::kDriveCommand, [&](const auto& command, const auto&) {
    ++(command.v() > 0.0 ? forged : honest);
  });
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(writer->wait_for_readers(1, kLong));
  DriveCommand command;
  std::uint64_t sent = 0;
  const auto send_one = [&] {
    command.number(++sent);
    ASSERT_TRUE(writer->write(command));
    ASSERT_TRUE(eventually([&] { return honest == sent; })) << sent << " sent, " << honest;
  };
  for (int i = 0; i < 10; ++i) send_one();
  std::optional<Datagram> heard;
  ASSERT_TRUE(eventually([&] { return (heard = tap->next_of(writer->guid())).has_value(); }));

  DriveCommand wanted;
  wanted.v(1.0);
  wanted.number(1'000'000);
  runtime::Bytes payload;
  ASSERT_TRUE(runtime::message_type<DriveCommand>().serialize(&wanted, payload));
  const PacketSender sender;
  for (const auto forgery : kForgeries) {
    for (std::uint64_t i = 1; i <= 200; ++i) {
      ASSERT_TRUE(
          sender.send(heard->to, forge(forgery, *heard, writer->guid(), payload, sent + i)));
      if (i % 50 == 0) send_one();  // the honest go on arriving in between, each once
    }
    EXPECT_EQ(forged, 0U) << to_string(forgery);
    EXPECT_EQ(honest, sent) << to_string(forgery);
  }
  for (const auto& message : sabotage(writer->guid(), sent + 1000)) {
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(sender.send(heard->to, message));
    send_one();
  }
  const auto refusals = reading->refusals();
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_EQ(refusals[0].address, "127.0.0.1");
  EXPECT_GE(refusals[0].messages, 5U * 200U);
}

TEST_F(Security, AMalformedPacketEndsNobody) {
  // Without keys too: Fast DDS 2.9.1 by itself ends the process at a statistics submessage that is
  // not the last.
  auto writing = join("one", "");
  auto reading = join("two", "");
  auto writer = writing->writer(topics::kDriveCommand);
  auto reader = reading->reader(topics::kDriveCommand);
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(writer->wait_for_readers(1, kLong));
  runtime::Bytes payload;
  const DriveCommand nothing;
  ASSERT_TRUE(runtime::message_type<DriveCommand>().serialize(&nothing, payload));
  const PacketSender sender;
  const auto everybody = listeners(test_domain());
  ASSERT_GT(everybody.size(), 2U);
  std::mt19937 random(1);
  for (const auto& message : malformed(writer->guid(), payload, random)) {
    for (const auto& to : everybody) sender.send(to, message);
  }
  ASSERT_TRUE(eventually([&] {
    const auto refusals = reading->refusals();
    return !refusals.empty() && refusals[0].messages > 20;
  }));
  ASSERT_TRUE(writer->write(DriveCommand{}));
  EXPECT_NE(reader->take(kLong), nullptr);
}

TEST_F(Security, AKeyThatOthersMayReadIsNotUsed) {
  ASSERT_EQ(::chmod((keys() + "/guide/key.pem").c_str(), 0644), 0);
  const auto made =
      Observer::create({.name = "guide", .domain = test_domain(), .identity = keys() + "/guide"});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error(), HasSubstr("its mode must be 0600"));
  const auto missing =
      Observer::create({.name = "amcl", .domain = test_domain(), .identity = keys() + "/amcl"});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error(), HasSubstr("cannot read " + keys() + "/amcl/certificate.pem"));
}

}  // namespace
}  // namespace usher::test
