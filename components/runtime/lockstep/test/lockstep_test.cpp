#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "idl/topics.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::runtime {
namespace {

using ::testing::ElementsAre;
using Message = std_msgs::msg::Header;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr topics::Topic<Message> kStream{"test/stream", topics::Kind::kStream, 5, 0, "*", ""};
constexpr topics::Topic<Message> kEvents{"test/events", topics::Kind::kEvent, 8, 0, "*", ""};
constexpr topics::Topic<Message> kLatched{"test/latched", topics::Kind::kLatched, 1, 0, "*", ""};

ParameterFile file(const std::string& name, const std::string& host = "here") {
  ParameterFile result;
  result.component = "subject";
  result.name = name;
  result.host = host;
  return result;
}
Message message(int number) {
  Message result;
  result.frame_id(std::to_string(number));
  return result;
}
int number_of(const Message& message) { return std::stoi(message.frame_id()); }

/// Writes numbers from 1 on, each period.
ComponentFactory counter(const topics::Topic<Message>& topic, Duration period) {
  struct Counter final : Component {
    Counter(Host& host, const topics::Topic<Message>& topic, Duration period)
        : output(host.output(topic)),
          timer(host.timer("tick", period, [this](auto) { output.publish(message(++count)); })) {}
    int count = 0;
    Output<Message> output;
    Timer timer;
  };
  return {"subject",
          [topic, period](Host& host) { return std::make_unique<Counter>(host, topic, period); }};
}

struct Seen {
  int number;
  Time arrival, now;
};
/// Notes what arrives.
ComponentFactory listener(const topics::Topic<Message>& topic, std::vector<Seen>& seen,
                          int depth = 0) {
  return {"subject", [topic, &seen, depth](Host& host) {
            host.input(topic, {.depth = depth},
                       [&](const Message& message, const SampleInfo& info) {
                         seen.push_back({number_of(message), info.arrival, host.now()});
                       });
            return std::make_unique<Component>();
          }};
}
/// Notes writers that come and go.
ComponentFactory watcher(const topics::Topic<Message>& topic,
                         std::vector<std::pair<std::string, Time>>& seen) {
  return {"subject", [topic, &seen](Host& host) {
            host.watch_writers(std::string(topic.name), [&](const WriterInfo& info) {
              seen.emplace_back((info.alive ? "+" : "-") + info.participant, host.now());
            });
            return std::make_unique<Component>();
          }};
}

TEST(LockstepWorld, AOneWayCutStopsOneDirection) {
  LockstepWorld world;
  std::vector<Seen> here, there;
  constexpr topics::Topic<Message> kBack{"test/back", topics::Kind::kStream, 5, 0, "*", ""};
  ASSERT_TRUE(world.add(counter(kStream, milliseconds(10)), file("one", "a")).ok());
  ASSERT_TRUE(world.add(counter(kBack, milliseconds(10)), file("two", "b")).ok());
  ASSERT_TRUE(world.add(listener(kStream, there), file("three", "b")).ok());
  ASSERT_TRUE(world.add(listener(kBack, here), file("four", "a")).ok());
  world.run_for(milliseconds(200));
  const std::size_t heard_here = here.size(), heard_there = there.size();
  world.cut_one_way("a", "b", world.now(), world.now() + milliseconds(300));
  world.run_for(milliseconds(300));
  EXPECT_LE(there.size(), heard_there + 1);
  EXPECT_GE(here.size(), heard_here + 29);
  world.run_for(milliseconds(200));
  EXPECT_GE(there.size(), heard_there + 19);
}

TEST(LockstepWorld, AClockJumpsForAllOfItsHostAndTimersCountWhatTheySkipped) {
  LockstepWorld world;
  struct Clock final : Component {
    explicit Clock(Host& host)
        : timer(host.timer("tick", milliseconds(10), [this, &host](std::uint64_t skipped) {
            times.push_back(host.now());
            most_skipped = std::max(most_skipped, skipped);
          })) {}
    std::vector<Time> times;
    std::uint64_t most_skipped = 0;
    Timer timer;
  };
  Clock *a = nullptr, *b = nullptr;
  const auto make = [](Clock*& place) {
    return ComponentFactory{"subject", [&place](Host& host) {
                              auto clock = std::make_unique<Clock>(host);
                              place = clock.get();
                              return clock;
                            }};
  };
  ASSERT_TRUE(world.add(make(a), file("one", "a")).ok());
  ASSERT_TRUE(world.add(make(b), file("two", "b")).ok());
  world.run_for(milliseconds(105));
  world.jump_clock("a", seconds(2));
  world.run_for(milliseconds(100));
  EXPECT_EQ(a->times.back() - b->times.back(), seconds(2));
  EXPECT_GE(a->most_skipped, 199U);
  EXPECT_EQ(b->most_skipped, 0U);
  EXPECT_TRUE(std::is_sorted(a->times.begin(), a->times.end()));
  EXPECT_GE(a->times.size(), 20U) << "it goes on at once";
}

TEST(LockstepWorld, TamperingChangesAndSwallowsSamples) {
  LockstepWorld world;
  std::vector<Seen> seen;
  world.tamper(kStream, [](const Guid&, Message& each) {
    const int number = number_of(each);
    each = message(number + 1000);
    return number % 2 == 0;
  });
  ASSERT_TRUE(world.add(counter(kStream, milliseconds(10)), file("one")).ok());
  ASSERT_TRUE(world.add(listener(kStream, seen), file("two")).ok());
  world.run_for(milliseconds(105));
  ASSERT_FALSE(seen.empty());
  for (const Seen& each : seen) {
    EXPECT_GT(each.number, 1000);
    EXPECT_EQ(each.number % 2, 0);
  }
}

TEST(LockstepWorld, TheSameSeedWritesTheSameBytes) {
  const auto run = [](std::uint64_t seed) {
    LockstepWorld::Options options;
    options.network.seed = seed;
    LockstepWorld world(options);
    world.set_link("here", "there", {microseconds(300), microseconds(500), 0.2});
    struct Echo final : Component {
      explicit Echo(Host& host) : noise(host.random("noise")), output(host.output(kEvents)) {
        host.input(kStream, {}, [this](const Message& each, const SampleInfo&) {
          Message answer = each;
          answer.stamp().nanosec(static_cast<std::uint32_t>(noise.below(1000)));
          output.publish(answer);
        });
      }
      Random noise;
      Output<Message> output;
    };
    EXPECT_TRUE(world.add(counter(kStream, milliseconds(7)), file("a")).ok());
    EXPECT_TRUE(world.add(component_factory<Echo>("subject"), file("b", "there")).ok());
    EXPECT_TRUE(world.add(component_factory<Echo>("subject"), file("c", "there")).ok());
    world.run_for(seconds(5));
    EXPECT_GT(world.lost_on_links(), 100U);
    return world.digest();
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST(LockstepWorld, SamplesNeedTheLatencyOfTheLink) {
  LockstepWorld world;
  std::vector<Seen> near, far;
  Time written{};
  world.set_link("here", "there", {milliseconds(3)});
  ASSERT_TRUE(world.add(counter(kEvents, seconds(1)), file("writer")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, near), file("near")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, far), file("far", "there")).ok());
  world.observe(kEvents, [&](const Message&, const SampleInfo& info) {
    written = info.arrival;
    EXPECT_EQ(world.participant_of(info.writer), "writer");
  });
  world.run_for(milliseconds(1500));
  ASSERT_EQ(near.size(), 1U);
  ASSERT_EQ(far.size(), 1U);
  EXPECT_EQ(near[0].arrival - written, microseconds(100));
  EXPECT_EQ(far[0].arrival - written, milliseconds(3));
  EXPECT_EQ(far[0].now, far[0].arrival);
}

TEST(LockstepWorld, JitterLosesOrderOnlyForBestEffort) {
  LockstepWorld world;
  std::vector<Seen> stream, events;
  world.set_link("here", "there", {milliseconds(1), milliseconds(20)});
  ASSERT_TRUE(world.add(counter(kStream, milliseconds(5)), file("a")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(5)), file("b")).ok());
  ASSERT_TRUE(world.add(listener(kStream, stream), file("c", "there")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, events), file("d", "there")).ok());
  world.run_for(seconds(2));
  const auto ascending = [](const std::vector<Seen>& all) {
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LT(all[i - 1].number, all[i].number);
  };
  ascending(stream);  // what comes too late is dropped by its number
  ascending(events);
  EXPECT_LT(stream.size(), 350U);
  EXPECT_EQ(events.size(),
            static_cast<std::size_t>(events.back().number - events.front().number + 1));
}

TEST(LockstepWorld, ReliableSamplesSurviveLossAndBestEffortOnesDoNot) {
  LockstepWorld world;
  std::vector<Seen> stream, events;
  world.set_link("here", "there", {milliseconds(1), Duration::zero(), 0.3});
  ASSERT_TRUE(world.add(counter(kStream, milliseconds(10)), file("a")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(10)), file("b")).ok());
  ASSERT_TRUE(world.add(listener(kStream, stream), file("c", "there")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, events, 64), file("d", "there")).ok());
  world.run_for(seconds(10));
  EXPECT_NEAR(static_cast<double>(stream.size()), 700, 50);
  // Each lost one is repeated after 20 ms; a run of losses longer than the writer's depth loses the
  // oldest.
  EXPECT_GT(events.size(), 970U);
}

TEST(LockstepWorld, AnOutageKeepsTheWritersDepthOfReliableSamples) {
  LockstepWorld world;
  std::vector<Seen> stream, events;
  ASSERT_TRUE(world.add(counter(kStream, milliseconds(10)), file("a")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(10)), file("b")).ok());
  ASSERT_TRUE(world.add(listener(kStream, stream), file("c", "there")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, events, 64), file("d", "there")).ok());
  const Time begin = world.now() + milliseconds(1005);
  world.cut("here", "there", begin, begin + milliseconds(500));
  world.run_for(seconds(3));
  const auto gaps = [](const std::vector<Seen>& all) {
    std::vector<std::pair<int, int>> result;
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (all[i].number != all[i - 1].number + 1)
        result.emplace_back(all[i - 1].number, all[i].number);
    }
    return result;
  };
  EXPECT_THAT(gaps(stream), ElementsAre(std::pair(100, 151)));
  // 50 were written; the last 8 before the first repetition (20 ms after the outage) are still
  // there.
  EXPECT_THAT(gaps(events), ElementsAre(std::pair(100, 145)));
}

TEST(LockstepWorld, ALongOutageEndsTheMatchAndALatchedValueComesAgainOnce) {
  LockstepWorld world;
  std::vector<Seen> latched, events;
  std::vector<std::pair<std::string, Time>> writers;
  ASSERT_TRUE(world.add(listener(kLatched, latched), file("reader", "there")).ok());
  ASSERT_TRUE(world.add(watcher(kEvents, writers), file("watcher", "there")).ok());
  ASSERT_TRUE(world.add(listener(kEvents, events, 64), file("other", "there")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(100)), file("writer")).ok());
  ASSERT_TRUE(world.add(counter(kLatched, milliseconds(1600)), file("latching")).ok());
  const Time start = world.now();
  world.cut("here", "there", start + milliseconds(1550), start + milliseconds(4050));
  world.run_for(milliseconds(4010));
  EXPECT_TRUE(latched.empty());
  ASSERT_EQ(writers.size(), 2U);
  EXPECT_EQ(writers[1].first, "-writer");
  EXPECT_EQ(writers[1].second, start + milliseconds(2350)) << "one lease after the cut";
  world.run_for(milliseconds(700));
  ASSERT_EQ(writers.size(), 3U);
  EXPECT_EQ(writers[2].first, "+writer");
  ASSERT_EQ(latched.size(), 1U) << "the last value, once";
  EXPECT_EQ(latched[0].number, 2);
  // Volatile samples of the time without a match are gone.
  EXPECT_EQ(events[15].number - events[14].number, 26);
}

TEST(LockstepWorld, AKilledComponentIsBackAfterTheTimeThatItsKillerSays) {
  LockstepWorld world;
  ASSERT_TRUE(world
                  .add(counter(kEvents, milliseconds(100)), file("killed"),
                       {.restart_after = milliseconds(50)})
                  .ok());
  world.kill("killed", milliseconds(700));
  world.run_for(milliseconds(699));
  EXPECT_FALSE(world.running("killed"));
  world.run_for(milliseconds(2));
  EXPECT_TRUE(world.running("killed"));
  world.kill("killed");
  world.run_for(milliseconds(51));
  EXPECT_TRUE(world.running("killed")) << "its own time again";
}

TEST(LockstepWorld, AKilledWriterIsNoticedAfterItsLeaseAndAStoppedOneAtOnce) {
  LockstepWorld world;
  std::vector<std::pair<std::string, Time>> writers;
  ASSERT_TRUE(world.add(watcher(kEvents, writers), file("watcher")).ok());
  ASSERT_TRUE(world
                  .add(counter(kEvents, milliseconds(100)), file("killed"),
                       {.restart_after = milliseconds(50)})
                  .ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(100)), file("stopped")).ok());
  const Time start = world.now();
  world.at(start + seconds(1), [&] {
    world.kill("killed");
    world.stop("stopped");
    EXPECT_FALSE(world.running("killed"));
  });
  world.run_for(seconds(4));
  EXPECT_TRUE(world.running("killed"));
  EXPECT_EQ(world.lives("killed"), 2U);
  ASSERT_EQ(writers.size(), 5U);
  EXPECT_EQ(writers[2], std::pair(std::string("-stopped"), start + seconds(1) + microseconds(100)));
  EXPECT_EQ(writers[3], std::pair(std::string("+killed"), start + milliseconds(1080)))
      << "before the ghost has gone";
  EXPECT_EQ(writers[4], std::pair(std::string("-killed"), start + milliseconds(1800)));
}

TEST(LockstepWorld, AHungComponentFillsItsMailboxesAndIsStillAlive) {
  LockstepWorld world;
  std::vector<Seen> seen;
  std::vector<std::pair<std::string, Time>> writers;
  ASSERT_TRUE(world.add(listener(kEvents, seen), file("reader")).ok());
  ASSERT_TRUE(world.add(watcher(kEvents, writers), file("watcher")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(10)), file("writer")).ok());
  world.run_for(seconds(1));
  const std::size_t before = seen.size();
  world.hang("reader", seconds(2));
  world.hang("writer", milliseconds(1));
  world.run_for(milliseconds(1999));
  EXPECT_EQ(seen.size(), before);
  world.run_for(milliseconds(2));
  EXPECT_GE(seen.size(), before + 8);
  EXPECT_LE(seen.size(), before + 9);
  EXPECT_EQ(writers.size(), 1U) << "nobody was declared dead";
}

TEST(LockstepWorld, HostsHaveTheirOwnClocks) {
  LockstepWorld world;
  std::vector<Seen> seen;
  world.set_clock("there", seconds(-100));
  ASSERT_TRUE(world.add(listener(kEvents, seen), file("reader", "there")).ok());
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(500)), file("writer")).ok());
  const Time start = world.now();
  world.run_for(milliseconds(600));
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].now, start + milliseconds(500) + microseconds(500) - seconds(100));
}

TEST(LockstepWorld, HandlersMayTakeTime) {
  LockstepWorld world;
  std::vector<Seen> seen;
  std::vector<Time> written;
  ASSERT_TRUE(world
                  .add(counter(kEvents, milliseconds(10)), file("writer"),
                       {.handler_cost = milliseconds(4)})
                  .ok());
  ASSERT_TRUE(
      world.add(listener(kEvents, seen), file("reader"), {.handler_cost = milliseconds(15)}).ok());
  world.observe(kEvents,
                [&](const Message&, const SampleInfo& info) { written.push_back(info.arrival); });
  const Time start = world.now();
  world.run_for(seconds(1));
  EXPECT_EQ(written[0] - start, milliseconds(14));
  // 15 ms a sample that comes every 10 ms: two of three are seen, the rest is counted.
  EXPECT_NEAR(static_cast<double>(seen.size()), 65, 4);
  for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_LE(seen[i - 1].now, seen[i].now);
}

TEST(LockstepWorld, WrongParametersAreAnErrorAndTheNameIsTaken) {
  LockstepWorld world;
  ParameterFile wrong = file("a");
  wrong.values.push_back({"speed", "3", "f:1"});
  EXPECT_EQ(world.add(counter(kEvents, seconds(1)), wrong).error(),
            "unknown parameter speed (f:1)");
  EXPECT_FALSE(world.running("a"));
  EXPECT_EQ(world.fault_reason("a"), "unknown parameter speed (f:1)");
  EXPECT_EQ(world.add(counter(kEvents, seconds(1)), file("a")).error(),
            "the name a is given twice");
  EXPECT_THROW(world.kill("b"), std::out_of_range);
}

TEST(LockstepWorld, AFaultyComponentIsRestartedAndKeepsItsMemory) {
  struct Fragile final : Component {
    explicit Fragile(Host& host) {
      const auto lives = host.kept("lives");
      const Bytes next{static_cast<std::uint8_t>(*lives ? (*lives)->at(0) + 1 : 1)};
      EXPECT_TRUE(host.keep("lives", next).ok());
      timer = host.timer("end", milliseconds(100), [&host](auto) { host.fault("as always"); });
    }
    Timer timer;
  };
  LockstepWorld world;
  ASSERT_TRUE(world
                  .add(component_factory<Fragile>("subject"), file("a"),
                       {.restart_after = milliseconds(100)})
                  .ok());
  world.run_for(milliseconds(950));
  EXPECT_EQ(world.lives("a"), 5U);
  EXPECT_EQ(world.kept("a").at("lives"), Bytes{5});
  EXPECT_EQ(world.fault_reason("a"), "as always");
}

TEST(LockstepWorld, ThereAreNoDevices) {
  std::vector<std::string> reasons;
  struct Driver final : Component {
    Driver(Host& host, std::vector<std::string>& reasons) {
      StreamHandlers handlers;
      handlers.on_open = [] { ADD_FAILURE(); };
      handlers.on_close = [&, this](const std::string& reason) {
        reasons.push_back(reason);
        EXPECT_FALSE(stream->open());
        EXPECT_FALSE(stream->write(Bytes{1}));
        if (reasons.size() < 3) stream->reopen(milliseconds(100));
      };
      stream = &host.open_stream("tcp://192.168.1.2:2112", std::move(handlers));
    }
    Stream* stream = nullptr;
  };
  LockstepWorld world;
  ASSERT_TRUE(
      world
          .add({"subject", [&](Host& host) { return std::make_unique<Driver>(host, reasons); }},
               file("a"))
          .ok());
  world.run_for(seconds(1));
  ASSERT_EQ(reasons.size(), 3U);
  EXPECT_EQ(reasons[0], "there are no devices in simulation: tcp://192.168.1.2:2112");
}

TEST(LockstepWorld, ObserversMayPublishAndEndComponents) {
  LockstepWorld world;
  std::vector<Seen> seen;
  ASSERT_TRUE(world.add(counter(kEvents, milliseconds(10)), file("writer")).ok());
  ASSERT_TRUE(world.add(listener(kStream, seen), file("reader")).ok());
  world.observe(kEvents, [&](const Message& each, const SampleInfo&) {
    world.publish(kStream, each, "robot watcher");
    if (number_of(each) == 5) world.kill("writer");
  });
  world.run_for(seconds(1));
  EXPECT_EQ(seen.size(), 5U);
  EXPECT_FALSE(world.running("writer"));
}

TEST(LockstepWorld, AGuestLeavesAndComesBackAsAnother) {
  LockstepWorld world;
  std::vector<std::pair<std::string, Time>> writers;
  ASSERT_TRUE(world.add(watcher(kEvents, writers), file("watcher")).ok());
  const Guid first = world.writer_guid(kEvents, "guest");
  EXPECT_EQ(world.writer_guid(kEvents, "guest"), first);
  EXPECT_EQ(world.participant_of(first), "guest");
  EXPECT_EQ(world.participant_of(Guid{}), "");
  world.run_for(milliseconds(10));
  world.leave("guest");
  world.run_for(milliseconds(10));
  EXPECT_NE(world.writer_guid(kEvents, "guest"), first);
  world.run_for(milliseconds(10));
  ASSERT_EQ(writers.size(), 3U);
  EXPECT_EQ(writers[1].first, "-guest");
}

}  // namespace
}  // namespace usher::runtime
