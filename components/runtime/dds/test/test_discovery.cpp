#include <gmock/gmock.h>

#include "runtime/dds/discovery.hpp"

namespace usher::runtime {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Guid guid(std::uint8_t participant, std::uint8_t entity, std::uint8_t host = 1) {
  Guid result{};
  result[2] = host;
  result[11] = participant;
  result[15] = entity;
  return result;
}

EndpointInfo writer(const Guid& id, const std::string& topic = "rt/scan") {
  EndpointInfo info;
  info.guid = id;
  info.writer = true;
  info.topic = topic;
  return info;
}

TEST(Identity, SurvivesTheUserData) {
  const Identity identity{"amcl", "nuc", 0xfedcba9876543210ULL};
  EXPECT_EQ(identity.user_data(), "usher;name=amcl;host=nuc;idl=fedcba9876543210");
  const auto parsed = Identity::parse(identity.user_data());
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->name, "amcl");
  EXPECT_EQ(parsed->host, "nuc");
  EXPECT_EQ(parsed->idl_digest, 0xfedcba9876543210ULL);
}

TEST(Identity, IsNotThereInForeignOrDamagedUserData) {
  EXPECT_FALSE(Identity::parse(""));
  EXPECT_FALSE(Identity::parse("enclave=/;"));
  const auto damaged = Identity::parse("usher;;name;idl=zz;host=");
  ASSERT_TRUE(damaged);
  EXPECT_EQ(damaged->name, "");
  EXPECT_EQ(damaged->idl_digest, 0U);
}

class Book : public testing::Test {
 protected:
  std::vector<std::string> events;
  Time now{Duration{5}};
  DiscoveryBook book{"nuc", [this] { return now; }};

  void observe() {
    book.observe([this](const ParticipantInfo& info,
                        bool alive) { events.push_back((alive ? "+" : "-") + info.identity.name); },
                 [this](const EndpointInfo& info, bool alive) {
                   events.push_back((alive ? "+" : "-") + info.participant + ":" + info.topic);
                 });
  }
};

TEST_F(Book, JoinsWritersWithTheNamesOfTheirParticipants) {
  observe();
  book.participant_seen(guid(7, 0xc1), {"lms100", "nuc", 1});
  book.endpoint_seen(writer(guid(7, 3)));
  EXPECT_THAT(events, ElementsAre("+lms100", "+lms100:rt/scan"));
  const WriterInfo info = book.writer(guid(7, 3));
  EXPECT_EQ(info.participant, "lms100");
  EXPECT_EQ(info.host, "nuc");
  EXPECT_EQ(info.since, now);
  EXPECT_TRUE(info.alive);
}

TEST_F(Book, NamesAWriterThatWasSeenBeforeItsParticipant) {
  observe();
  book.endpoint_seen(writer(guid(7, 3)));
  EXPECT_THAT(events, IsEmpty()) << "nobody takes it for a foreign one";
  EXPECT_THAT(book.endpoints(), IsEmpty());
  book.participant_seen(guid(8, 0xc1), {"amcl", "nuc", 1});
  book.participant_seen(guid(7, 0xc1), {"lms100", "nuc", 1});
  EXPECT_THAT(events, ElementsAre("+amcl", "+lms100", "+lms100:rt/scan"));
  EXPECT_EQ(book.writer(guid(7, 3)).participant, "lms100");
}

TEST_F(Book, ForgetsAWriterThatEndsBeforeItsParticipantIsSeen) {
  observe();
  book.endpoint_seen(writer(guid(7, 3)));
  book.endpoint_gone(guid(7, 3));
  book.endpoint_seen(writer(guid(8, 3)));
  book.participant_gone(guid(8, 0xc1));
  book.participant_seen(guid(7, 0xc1), {"lms100", "nuc", 1});
  book.participant_seen(guid(8, 0xc1), {"amcl", "nuc", 1});
  EXPECT_THAT(events, ElementsAre("+lms100", "+amcl"));
}

TEST_F(Book, TellsLateObserversWhatIsThere) {
  book.participant_seen(guid(7, 0xc1), {"lms100", "nuc", 1});
  book.endpoint_seen(writer(guid(7, 3)));
  observe();
  EXPECT_THAT(events, ElementsAre("+lms100", "+lms100:rt/scan"));
}

TEST_F(Book, EndsWhatALostParticipantOwned) {
  book.participant_seen(guid(7, 0xc1), {"a", "nuc", 1});
  book.participant_seen(guid(8, 0xc1), {"a", "nuc", 1});
  book.endpoint_seen(writer(guid(7, 3)));
  book.endpoint_seen(writer(guid(8, 3)));
  observe();
  events.clear();
  book.participant_gone(guid(7, 0xc1));
  EXPECT_THAT(events, ElementsAre("-a:rt/scan", "-a"));
  book.endpoint_gone(guid(7, 3));  // reported again by the library
  EXPECT_EQ(events.size(), 2U);
  EXPECT_EQ(book.endpoints().size(), 1U);
  EXPECT_EQ(book.participants().size(), 1U);
}

TEST_F(Book, ReportsEachChangeOnce) {
  observe();
  book.participant_seen(guid(7, 0xc1), {"a", "nuc", 1});
  book.participant_seen(guid(7, 0xc1), {"a", "nuc", 1});
  book.endpoint_seen(writer(guid(7, 3)));
  book.endpoint_seen(writer(guid(7, 3)));
  book.endpoint_gone(guid(9, 9));
  book.participant_gone(guid(9, 9));
  EXPECT_EQ(events.size(), 2U);
}

TEST_F(Book, KnowsAWriterThatWasMatchedBeforeItWasReported) {
  EXPECT_EQ(book.writer(guid(1, 2)).guid, guid(1, 2));
  EXPECT_TRUE(book.writer(guid(1, 2)).alive);
}

TEST_F(Book, JudgesTheHostByNameAndElseByNumber) {
  book.participant_seen(guid(1, 0xc1, 1), {"a", "nuc", 1});
  book.participant_seen(guid(2, 0xc1, 1), {"b", "tablet", 1});
  book.participant_seen(guid(3, 0xc1, 2), {"c", "nuc", 1});
  book.participant_seen(guid(4, 0xc1, 1), {"ros", "", 0});
  const Guid own = guid(9, 0xc1, 1);
  EXPECT_TRUE(book.same_host(guid(1, 3, 1), own));
  EXPECT_FALSE(book.same_host(guid(2, 3, 1), own));
  EXPECT_TRUE(book.same_host(guid(3, 3, 2), own));
  EXPECT_TRUE(book.same_host(guid(4, 3, 1), own));
  EXPECT_FALSE(book.same_host(guid(5, 3, 2), own));
}

TEST_F(Book, ListsWhoWasKeptOutAndNotAmongThoseThatTakePart) {
  observe();
  book.participant_seen(guid(7, 0xc1), {"intruder", "", 0}, "10.0.0.9");
  book.participant_refused(guid(7, 0xc1));
  book.participant_refused(guid(7, 0xc1));  // asks again and again
  book.message_refused("10.0.0.9");
  book.message_refused("10.0.0.9");
  EXPECT_THAT(events, ElementsAre("+intruder", "-intruder"));
  EXPECT_THAT(book.participants(), IsEmpty());
  const auto refusals = book.refusals();
  ASSERT_EQ(refusals.size(), 2U);
  EXPECT_EQ(refusals[0].name, "intruder");
  EXPECT_EQ(refusals[0].address, "10.0.0.9");
  EXPECT_EQ(refusals[1].name, "");
  EXPECT_EQ(refusals[1].messages, 2U);
}

TEST_F(Book, RemembersABoundedNumberOfRefusals) {
  for (int i = 0; i < 1000; ++i) book.message_refused("10.0.0." + std::to_string(i));
  EXPECT_EQ(book.refusals().size(), DiscoveryBook::kMaxRefusals);
}

TEST_F(Book, MayBeAskedFromItsEvents) {
  std::size_t seen = 99;
  book.observe({}, [&](const EndpointInfo&, bool) { seen = book.endpoints().size(); });
  book.participant_seen(guid(7, 0xc1), {"lms100", "nuc", 1});
  book.endpoint_seen(writer(guid(7, 3)));
  EXPECT_EQ(seen, 1U);
  book.endpoint_gone(guid(7, 3));
  EXPECT_EQ(seen, 0U);
  EXPECT_EQ(book.participants().size(), 1U);
}

}  // namespace
}  // namespace usher::runtime
