// Transport and Observer over real participants.
#include <arpa/inet.h>
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <fastdds/dds/publisher/Publisher.hpp>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "idl/topics.hpp"
#include "runtime/dds/dds_transport.hpp"
#include "runtime/dds/message_types.hpp"
#include "runtime/dds/observer.hpp"
#include "runtime/dds/participant.hpp"
#include "runtime/dds/rtps_message.hpp"
#include "support/sanitizer.hpp"
#include "support/test_domain.hpp"

namespace {

/// Announcements that this process sent, by where they went.
struct {
  std::atomic<int> loopback{0};
  std::atomic<int> multicast{0};
} g_announcements;

}  // namespace

/// Stands before the C library's.
extern "C" ssize_t sendto(int socket, const void* bytes, std::size_t size, int flags,
                          const sockaddr* to, socklen_t length) {
  using usher::runtime::MessageKind;
  static const auto below = reinterpret_cast<decltype(&sendto)>(dlsym(RTLD_NEXT, "sendto"));
  const auto kind = usher::runtime::classify({static_cast<const std::uint8_t*>(bytes), size});
  if (kind == MessageKind::kAnnouncement && to != nullptr && to->sa_family == AF_INET) {
    const std::uint32_t address = ntohl(reinterpret_cast<const sockaddr_in*>(to)->sin_addr.s_addr);
    if (address >> 24U == 127) ++g_announcements.loopback;
    if (IN_MULTICAST(address)) ++g_announcements.multicast;
  }
  return below(socket, bytes, size, flags, to, length);
}

namespace usher::runtime {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr Duration kLong =
    std::chrono::duration_cast<Duration>(10s * usher::test::kSanitizerFactor);

std::unique_ptr<DdsTransport> transport(const std::string& name, const std::string& host = "nuc") {
  auto made = DdsTransport::create({name, host, test_domain(), {}}, MonotonicClock(0));
  EXPECT_TRUE(made.ok()) << made.error();
  return std::move(made).value();
}
std::unique_ptr<Observer> observer(const std::string& name = "operator",
                                   const std::string& host = "nuc") {
  auto made = Observer::create({.name = name, .host = host, .domain = test_domain(), .peers = {}});
  EXPECT_TRUE(made.ok()) << made.error();
  return std::move(made).value();
}

template <class Message>
InputDeclaration input(const topics::Topic<Message>& topic) {
  InputDeclaration declaration;
  declaration.topic = topic.name;
  declaration.type = &message_type<Message>();
  declaration.qos = topic.reader_qos();
  return declaration;
}
template <class Message>
OutputDeclaration output(const topics::Topic<Message>& topic) {
  return {std::string(topic.name), &message_type<Message>(), topic.writer_qos(), topic.rate_hz};
}
template <class Message>
std::shared_ptr<const Bytes> encode(const Message& message) {
  auto cdr = std::make_shared<Bytes>();
  EXPECT_TRUE(message_type<Message>().serialize(&message, *cdr));
  return cdr;
}

/// Samples as a transport delivers them.
class Deliveries {
 public:
  struct Sample {
    std::shared_ptr<const void> message;
    Guid writer;
    std::uint64_t number;
    bool same_host;
  };
  Transport::Deliver deliver() {
    return [this](std::shared_ptr<const void> message, const Guid& writer, std::uint64_t number,
                  bool same_host) {
      const std::scoped_lock lock(mutex_);
      samples.push_back({std::move(message), writer, number, same_host});
      changed_.notify_all();
    };
  }
  bool wait(std::size_t count, Duration limit = kLong) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return samples.size() >= count; });
  }
  std::vector<Sample> samples;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

/// Spins on what the transport can only be asked for; the limit is far above what discovery needs.
template <class Condition>
bool eventually(const Condition& condition, Duration limit = kLong) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return condition();
}

TEST(DdsTransport, CarriesSamplesWithTheirWriterAndNumber) {
  auto writing = transport("lms100");
  auto reading = transport("amcl");
  Deliveries deliveries;
  auto& reader = reading->open_reader(input(topics::kCmdVelManual), deliveries.deliver());
  auto& writer = writing->open_writer(output(topics::kCmdVelManual));
  ASSERT_TRUE(
      eventually([&] { return writer.reader_count() == 1 && reader.writers().size() == 1; }));

  geometry_msgs::msg::TwistStamped twist;
  twist.twist().linear().x(0.25);
  writer.write(encode(twist));
  ASSERT_TRUE(deliveries.wait(1));
  const auto& sample = deliveries.samples[0];
  ASSERT_NE(sample.message, nullptr);
  EXPECT_EQ(static_cast<const geometry_msgs::msg::TwistStamped*>(sample.message.get())
                ->twist()
                .linear()
                .x(),
            0.25);
  EXPECT_EQ(sample.writer, writer.guid());
  EXPECT_EQ(sample.number, 1U);
  EXPECT_TRUE(sample.same_host);

  const auto writers = reader.writers();
  ASSERT_EQ(writers.size(), 1U);
  EXPECT_EQ(writers[0].guid, writer.guid());
  EXPECT_EQ(writers[0].participant, "lms100");
  EXPECT_EQ(writers[0].host, "nuc");
  EXPECT_TRUE(writers[0].alive);
}

TEST(DdsTransport, TellsSamplesOfAnotherHostApart) {
  auto writing = transport("tablet", "tablet");
  auto reading = transport("guide", "nuc");
  Deliveries deliveries;
  reading->open_reader(input(topics::kMap), deliveries.deliver());
  writing->open_writer(output(topics::kMap)).write(encode(nav_msgs::msg::OccupancyGrid{}));
  ASSERT_TRUE(deliveries.wait(1));
  EXPECT_FALSE(deliveries.samples[0].same_host);
}

TEST(DdsTransport, GivesALateReaderTheLastLatchedValue) {
  auto writing = transport("map_server");
  auto& writer = writing->open_writer(output(topics::kMap));
  nav_msgs::msg::OccupancyGrid map;
  for (std::uint32_t width = 1; width <= 3; ++width) {
    map.info().width(width);
    writer.write(encode(map));
  }
  auto reading = transport("costmap");
  Deliveries deliveries;
  reading->open_reader(input(topics::kMap), deliveries.deliver());
  ASSERT_TRUE(deliveries.wait(1));
  EXPECT_EQ(static_cast<const nav_msgs::msg::OccupancyGrid*>(deliveries.samples[0].message.get())
                ->info()
                .width(),
            3U);
  EXPECT_EQ(deliveries.samples[0].number, 3U);
  map.info().width(4);
  writer.write(encode(map));
  ASSERT_TRUE(deliveries.wait(2));
  EXPECT_EQ(deliveries.samples[1].number, 4U);
}

TEST(DdsTransport, CarriesMapsThatAreLargerThanADatagram) {
  auto writing = transport("map_server");
  auto reading = transport("costmap");
  Deliveries deliveries;
  reading->open_reader(input(topics::kMap), deliveries.deliver());
  nav_msgs::msg::OccupancyGrid map;
  map.data().resize(1'500'000);
  for (std::size_t i = 0; i < map.data().size(); ++i)
    map.data()[i] = static_cast<std::int8_t>(i % 101);
  writing->open_writer(output(topics::kMap)).write(encode(map));
  ASSERT_TRUE(deliveries.wait(1));
  EXPECT_EQ(*static_cast<const nav_msgs::msg::OccupancyGrid*>(deliveries.samples[0].message.get()),
            map);
}

TEST(DdsTransport, DeliversBytesThatAreNoMessageAsNull) {
  auto reading = transport("amcl");
  Deliveries deliveries;
  reading->open_reader(input(topics::kCmdVelManual), deliveries.deliver());
  auto rogue = observer("rogue");
  auto writer = rogue->writer(topics::kCmdVelManual);
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->wait_for_readers(1, kLong));
  Bytes whole = *encode(geometry_msgs::msg::TwistStamped{});
  const std::vector<Bytes> wrong = {{},
                                    {0},
                                    {0, 1, 0, 0},
                                    Bytes(whole.begin(), whole.end() - 1),
                                    {0, 1, 0, 0, 255, 255, 255, 255}};
  for (const Bytes& bytes : wrong) {
    ASSERT_TRUE(writer->write_raw(bytes));
    ASSERT_TRUE(deliveries.wait(static_cast<std::size_t>(&bytes - wrong.data()) + 1));
  }
  writer->write_raw(whole);
  ASSERT_TRUE(deliveries.wait(wrong.size() + 1));
  for (std::size_t i = 0; i < wrong.size(); ++i)
    EXPECT_EQ(deliveries.samples[i].message, nullptr) << i;
  EXPECT_NE(deliveries.samples.back().message, nullptr);
}

class Watched {
 public:
  std::function<void(const WriterInfo&)> handler() {
    return [this](const WriterInfo& info) {
      const std::scoped_lock lock(mutex_);
      events.push_back(info);
      changed_.notify_all();
    };
  }
  bool wait(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kLong, [&] { return events.size() >= count; });
  }
  std::vector<WriterInfo> events;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

TEST(DdsTransport, SeesAWriterBeforeItsFirstSampleAndItsEnd) {
  auto watching = transport("supervisor");
  Watched watched;
  watching->watch_writers("drive/command", watched.handler());
  Guid guid{};
  {
    auto writing = transport("movement_control");
    writing->open_writer(output(topics::kMovementStatus));  // another topic is not reported
    guid = writing->open_writer(output(topics::kDriveCommand)).guid();
    ASSERT_TRUE(watched.wait(1));
    EXPECT_EQ(watched.events[0].guid, guid);
    EXPECT_EQ(watched.events[0].topic, "drive/command");
    EXPECT_EQ(watched.events[0].participant, "movement_control");
    EXPECT_TRUE(watched.events[0].alive);
  }
  ASSERT_TRUE(watched.wait(2));
  EXPECT_EQ(watched.events[1].guid, guid);
  EXPECT_FALSE(watched.events[1].alive);
  EXPECT_EQ(watched.events.size(), 2U);
}

TEST(DdsTransport, SeesTwoWritersThatCallThemselvesTheSame) {
  auto watching = transport("supervisor");
  Watched watched;
  watching->watch_writers("drive/command", watched.handler());
  Deliveries deliveries;
  auto& reader = watching->open_reader(input(topics::kDriveCommand), deliveries.deliver());
  auto first = transport("movement_control");
  auto second = transport("movement_control");
  auto& one = first->open_writer(output(topics::kDriveCommand));
  auto& two = second->open_writer(output(topics::kDriveCommand));
  ASSERT_TRUE(watched.wait(2));
  EXPECT_NE(watched.events[0].guid, watched.events[1].guid);
  EXPECT_EQ(watched.events[0].participant, "movement_control");
  EXPECT_EQ(watched.events[1].participant, "movement_control");
  ASSERT_TRUE(eventually([&] {
    return reader.writers().size() == 2 && one.reader_count() == 1 && two.reader_count() == 1;
  }));
  one.write(encode(usher_msgs::msg::DriveCommand{}));
  two.write(encode(usher_msgs::msg::DriveCommand{}));
  ASSERT_TRUE(deliveries.wait(2));
  EXPECT_NE(deliveries.samples[0].writer, deliveries.samples[1].writer);
}

// --- Foreign quality of service: endpoints as other programs make them
// ----------------------------------------------------

namespace dds = eprosima::fastdds::dds;

class Foreign {
 public:
  explicit Foreign(const std::string& name)
      : participant_(
            Participant::create({name, "", test_domain(), {}}, MonotonicClock(0)).value()) {}

  /// The quality is what Qos cannot say: made by hand from the writer's publisher.
  dds::DataWriter* best_effort_writer(const std::string& topic, const std::string& type) {
    dds::DataWriter* model =
        participant_->create_writer(topic, type, {true, false, 1}, nullptr).value();
    dds::DataWriterQos qos = model->get_qos();
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    dds::Topic* same = model->get_topic();
    auto* publisher = const_cast<dds::Publisher*>(model->get_publisher());
    participant_->delete_writer(model);
    return publisher->create_datawriter(same, qos);
  }
  Participant& operator*() const { return *participant_; }

 private:
  std::unique_ptr<Participant> participant_;
};

TEST(ForeignQuality, ABestEffortWriterIsSeenButDoesNotReachAReliableReader) {
  auto reading = transport("segway_rmp");
  Watched watched;
  reading->watch_writers("drive/command", watched.handler());
  Deliveries deliveries;
  auto& reader = reading->open_reader(input(topics::kDriveCommand), deliveries.deliver());
  Foreign foreign("ros2_node");
  auto* writer =
      foreign.best_effort_writer("rt/drive/command", "usher_msgs::msg::dds_::DriveCommand_");
  ASSERT_TRUE(eventually([&] {
    return std::ranges::any_of(watched.events, [&](const WriterInfo& info) {
      return info.guid == to_guid(writer->guid()) && info.alive;
    });
  }));
  EXPECT_EQ(watched.events.back().participant, "ros2_node");
  EXPECT_EQ(watched.events.back().host, "");
  // A well-matched writer that comes later is matched: then the foreign one would have been, too.
  auto own = transport("movement_control");
  own->open_writer(output(topics::kDriveCommand));
  ASSERT_TRUE(eventually([&] { return !reader.writers().empty(); }));
  ASSERT_EQ(reader.writers().size(), 1U);
  EXPECT_EQ(reader.writers()[0].participant, "movement_control");
}

TEST(ForeignQuality, ABestEffortWriterReachesAReaderOfAStream) {
  auto reading = transport("scan_filter");
  Deliveries deliveries;
  auto& reader = reading->open_reader(input(topics::kScan), deliveries.deliver());
  Foreign foreign("ros2_driver");
  foreign.best_effort_writer("rt/scan", "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_TRUE(eventually([&] { return reader.writers().size() == 1; }));
}

TEST(ForeignQuality, ReadersAndWritersWithTheDefaultsOfRos2Match) {
  // rmw's defaults: reliable, volatile, keep last 10; sensor data: best effort, keep last 5;
  // latched: transient local.
  auto own = transport("lms100");
  auto& scan = own->open_writer(output(topics::kScan));
  auto& map = own->open_writer(output(topics::kMap));
  Deliveries deliveries;
  auto& goal = own->open_reader(input(topics::kGoalPose), deliveries.deliver());
  Foreign ros("rviz2");
  const std::string scan_type = "sensor_msgs::msg::dds_::LaserScan_";
  ASSERT_TRUE((*ros).create_reader("rt/scan", scan_type, {true, false, 10}, nullptr).ok());
  ASSERT_TRUE((*ros).create_reader("rt/scan", scan_type, {false, false, 5}, nullptr).ok());
  ASSERT_TRUE(
      (*ros)
          .create_reader("rt/map", "nav_msgs::msg::dds_::OccupancyGrid_", {true, true, 1}, nullptr)
          .ok());
  ASSERT_TRUE((*ros)
                  .create_writer("rt/goal_pose", "geometry_msgs::msg::dds_::PoseStamped_",
                                 {true, false, 10}, nullptr)
                  .ok());
  EXPECT_TRUE(eventually([&] {
    return scan.reader_count() == 2 && map.reader_count() == 1 && goal.writers().size() == 1;
  }));
}

TEST(ForeignQuality, AnotherTypeOfTheSameTopicIsSeenButNotMatched) {
  auto reading = transport("segway_rmp");
  Watched watched;
  reading->watch_writers("drive/command", watched.handler());
  Deliveries deliveries;
  auto& reader = reading->open_reader(input(topics::kDriveCommand), deliveries.deliver());
  Foreign foreign("intruder");
  ASSERT_TRUE((*foreign)
                  .create_writer("rt/drive/command", "intruder::Command", {true, false, 1}, nullptr)
                  .ok());
  ASSERT_TRUE(watched.wait(1));
  EXPECT_EQ(watched.events[0].participant, "intruder");
  EXPECT_TRUE(reader.writers().empty());
}

// --- Settings
// ------------------------------------------------------------------------------------------------------------

TEST(DdsTransport, RefusesPeersThatAreNoAddressesAndWrongDomains) {
  const auto peer =
      DdsTransport::create({"amcl", "nuc", test_domain(), {"tablet.local"}}, MonotonicClock(0));
  ASSERT_FALSE(peer.ok());
  EXPECT_THAT(peer.error(), HasSubstr("tablet.local"));
  const auto domain = DdsTransport::create({"amcl", "nuc", 233, {}}, MonotonicClock(0));
  ASSERT_FALSE(domain.ok());
  EXPECT_THAT(domain.error(), HasSubstr("233"));
}

TEST(DdsTransport, MeetsOthersAlsoWhenPeersAreGiven) {
  // One side names the other's address: both that one and whoever is found by multicast are
  // matched.
  auto made =
      DdsTransport::create({"guide", "nuc", test_domain(), {"127.0.0.1"}}, MonotonicClock(0));
  ASSERT_TRUE(made.ok()) << made.error();
  auto other = transport("tablet");
  auto& writer = other->open_writer(output(topics::kDialogueAnswer));
  Deliveries deliveries;
  (*made)->open_reader(input(topics::kDialogueAnswer), deliveries.deliver());
  EXPECT_TRUE(eventually([&] { return writer.reader_count() == 1; }));
}

TEST(DdsTransport, AsksTheProgramAndNotTheLibraryWhoseLeaseHasEnded) {
  void* check = dlsym(RTLD_DEFAULT,
                      "_ZN8eprosima8fastrtps4rtps3PDP35check_remote_participant_livelinessEPNS1_"
                      "20ParticipantProxyDataE");
  ASSERT_NE(check, nullptr) << "the library has no such function: is the replacement still needed?";
  Dl_info info{};
  ASSERT_NE(dladdr(check, &info), 0);
  EXPECT_EQ(std::string(info.dli_fname).find("libfastrtps"), std::string::npos) << info.dli_fname;
}

TEST(DdsTransport, AnnouncesItselfToItsOwnHostByMulticastAlone) {
  const auto first = transport("lms100");
  auto second = transport("amcl");
  Watched watched;
  second->watch_writers("scan", watched.handler());
  first->open_writer(output(topics::kScan));
  ASSERT_TRUE(watched.wait(1));  // they have met
  g_announcements.loopback = g_announcements.multicast = 0;
  ASSERT_TRUE(eventually([] { return g_announcements.multicast >= 6; }));
  EXPECT_EQ(g_announcements.loopback, 0);
}

TEST(DdsTransport, LeavesNoSharedMemoryBehind) {
  const auto files = [] {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
      const std::string name = entry.path().filename();
      count += name.find("fastrtps") != std::string::npos ||
                       name.find("fast_datasharing") != std::string::npos
                   ? 1U
                   : 0U;
    }
    return count;
  };
  const std::size_t before = files();
  auto writing = transport("lms100");
  auto reading = transport("amcl");
  auto& writer = writing->open_writer(output(topics::kCmdVelManual));
  Deliveries deliveries;
  reading->open_reader(input(topics::kCmdVelManual), deliveries.deliver());
  ASSERT_TRUE(eventually([&] { return writer.reader_count() == 1; }));
  EXPECT_EQ(files(), before);  // not even while they run
}

TEST(DdsTransport, IgnoresProfilesOfTheEnvironment) {
  // The first participant of the process has already been made when this runs in the whole suite,
  // and it must have cleared these; run alone, it proves that the profile is not read.
  EXPECT_EQ(std::getenv("FASTRTPS_DEFAULT_PROFILES_FILE"), nullptr);
  transport("amcl");
  EXPECT_STREQ(std::getenv("SKIP_DEFAULT_XML_FILE"), "1");
}

// --- Observer
// ------------------------------------------------------------------------------------------------------------

TEST(Observer, ListsParticipantsWithHostAndDigestAndTheirEndpoints) {
  auto own = transport("lms100", "nuc");
  own->open_writer(output(topics::kScan));
  auto watching = observer();
  ASSERT_TRUE(watching->wait_for(
      [](const Observer& o) {
        return std::ranges::any_of(o.endpoints(),
                                   [](const EndpointInfo& e) { return e.participant == "lms100"; });
      },
      kLong));
  const auto participants = watching->participants();
  const auto found = std::ranges::find(participants, "lms100",
                                       [](const ParticipantInfo& p) { return p.identity.name; });
  ASSERT_NE(found, participants.end());
  EXPECT_EQ(found->identity.host, "nuc");
  EXPECT_EQ(found->identity.idl_digest, USHER_IDL_DIGEST);
  EXPECT_TRUE(std::ranges::any_of(
      participants, [](const ParticipantInfo& p) { return p.identity.name == "operator"; }));
  const auto endpoints = watching->endpoints();
  const auto scan = std::ranges::find(endpoints, "rt/scan", &EndpointInfo::topic);
  ASSERT_NE(scan, endpoints.end());
  EXPECT_TRUE(scan->writer);
  EXPECT_TRUE(scan->reliable);
  EXPECT_FALSE(scan->latched);
  EXPECT_EQ(scan->type, "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(scan->host, "nuc");
}

TEST(Observer, ReadsAnyTopicAndCountsIt) {
  auto own = transport("movement_control");
  auto& writer = own->open_writer(output(topics::kDriveCommand));
  auto watching = observer();
  std::atomic<int> seen{0};
  auto subscription =
      watching->subscribe("rt/drive/command", "usher_msgs::msg::dds_::DriveCommand_",
                          {true, false, 1}, [&](const Observer::RawSample& sample) {
                            EXPECT_GE(sample.cdr.size(), 4U);
                            ++seen;
                          });
  ASSERT_TRUE(subscription.ok()) << subscription.error();
  ASSERT_TRUE(eventually([&] { return writer.reader_count() == 1; }));
  for (int i = 0; i < 20; ++i) {
    usher_msgs::msg::DriveCommand command;
    const auto now = watching->now().time_since_epoch();
    command.stamp().sec(static_cast<std::int32_t>(now / 1s));
    command.stamp().nanosec(static_cast<std::uint32_t>((now % 1s).count()));
    writer.write(encode(command));
    ASSERT_TRUE(eventually([&] { return seen == i + 1; }));
  }
  writer.write(std::make_shared<Bytes>(Bytes{0, 1, 0, 0}));
  ASSERT_TRUE(eventually([&] { return (*subscription)->statistics().malformed == 1; }));
  const auto statistics = (*subscription)->statistics();
  EXPECT_EQ(statistics.samples, 21U);
  EXPECT_EQ(statistics.missed, 0U);
  EXPECT_GT(statistics.rate_hz, 1.0);
  EXPECT_GT(statistics.latency_p50, Duration{});
  EXPECT_LE(statistics.latency_p50, statistics.latency_p99);
  EXPECT_EQ((*subscription)->writer_count(), 1U);
}

TEST(Observer, RefusesASecondTypeOfATopic) {
  auto watching = observer();
  const auto first = watching->subscribe("rt/thing", "a::A", {}, {});
  ASSERT_TRUE(first.ok());
  const auto second = watching->subscribe("rt/thing", "b::B", {}, {});
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error(), HasSubstr("a::A"));
}

TEST(Observer, WritesAndReadsTopicsOfTheCatalogue) {
  auto one = observer("one");
  auto two = observer("two");
  auto reader = two->reader(topics::kNavigateGoal);
  auto writer = one->writer(topics::kNavigateGoal);
  ASSERT_TRUE(reader.ok() && writer.ok());
  ASSERT_TRUE(writer->wait_for_readers(1, kLong));
  usher_msgs::msg::NavigateGoal goal;
  for (std::uint64_t id = 1; id <= 5; ++id) {
    goal.id(id);
    goal.location("foyer");
    ASSERT_TRUE(writer->write(goal));
  }
  for (std::uint64_t id = 1; id <= 5; ++id) {
    const auto received = reader->take(kLong);
    ASSERT_NE(received, nullptr);
    EXPECT_EQ(received->id(), id);
  }
  EXPECT_EQ(reader->take(), nullptr);
}

TEST(Observer, EndsSubscriptionsWhileSamplesArrive) {
  auto one = observer("one");
  auto two = observer("two");
  auto writer = one->writer(topics::kCmdVelManual);
  ASSERT_TRUE(writer.ok());
  std::atomic<bool> stop{false};
  std::thread flood([&] {
    while (!stop) {
      writer->write(geometry_msgs::msg::TwistStamped{});
      // The writer's mutex is not fair: with a sanitizer on a busy machine the discovery of the
      // next reader would never get it.
      std::this_thread::yield();
    }
  });
  for (int i = 0; i < 20; ++i) {
    std::atomic<int> count{0};
    auto reader = two->reader<geometry_msgs::msg::TwistStamped>(
        topics::kCmdVelManual, [&](const auto&, const Observer::RawSample&) { ++count; });
    ASSERT_TRUE(reader.ok());
    EXPECT_TRUE(eventually([&] { return count > 0; }));
  }
  stop = true;
  flood.join();
}

TEST(Observer, ReportsThatSomebodyLeft) {
  auto watching = observer();
  const auto there = [](const Observer& o) {
    return std::ranges::any_of(o.participants(),
                               [](const ParticipantInfo& p) { return p.identity.name == "guest"; });
  };
  {
    auto guest = observer("guest");
    ASSERT_TRUE(watching->wait_for(there, kLong));
  }
  EXPECT_TRUE(watching->wait_for([&](const Observer& o) { return !there(o); }, kLong));
}

}  // namespace
}  // namespace usher::runtime
