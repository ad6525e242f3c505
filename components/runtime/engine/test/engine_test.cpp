#include "runtime/engine/engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <deque>
#include <map>
#include <thread>
#include <utility>

#include "idl/topics.hpp"
#include "support/counted_new.hpp"

// What the conformance suite cannot reach from outside: the engine's bounds, its threads and its
// allocations, on a platform and a transport made of lists.
namespace usher::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Message = std_msgs::msg::Header;
using std::chrono::milliseconds;

constexpr topics::Topic<Message> kEvents{"test/events", topics::Kind::kEvent, 4, 0, "*", ""};
constexpr topics::Topic<Message> kReplies{"test/replies", topics::Kind::kEvent, 4, 0, "*", ""};

class FakePlatform final : public Platform {
 public:
  class FakeStream final : public Stream {
   public:
    bool write(std::span<const std::uint8_t> bytes) override { return !bytes.empty(); }
    bool write_latest(std::span<const std::uint8_t> bytes) override { return write(bytes); }
    bool open() const override { return true; }
    void reopen(Duration /*delay*/) override {}
  };

  Time now() const override {
    const Time read = Time(Duration(clock.load()));
    if (at_next_look) std::exchange(at_next_look, nullptr)();
    return read;
  }
  Duration work_time() const override { return {}; }
  void wake() override { ++wakes; }
  Resources resources() override { return {}; }
  void offload(Duration, std::function<void()> job, std::function<void()> finished) override {
    jobs.emplace_back(std::move(job), std::move(finished));
  }
  Stream& open_stream(const std::string&, StreamSink its_sink) override {
    sink = std::move(its_sink);
    return stream;
  }
  Status keep(const std::string&, std::span<const std::uint8_t>) override { return {}; }
  Result<std::optional<Bytes>> kept(const std::string&) override { return std::optional<Bytes>(); }

  /// Called by the next look at the clock: what happens in that very moment.
  mutable std::function<void()> at_next_look;
  std::atomic<std::int64_t> clock{1'000'000'000};
  std::atomic<int> wakes{0};
  std::deque<std::pair<std::function<void()>, std::function<void()>>> jobs;
  StreamSink sink;
  FakeStream stream;
};

class FakeTransport final : public Transport {
 public:
  class FakeReader final : public Reader {
    std::vector<WriterInfo> writers() const override { return {}; }
  };
  class FakeWriter final : public Writer {
   public:
    bool write(std::shared_ptr<const Bytes> cdr) override {
      if (full) return false;
      ++written;
      last = *cdr;
      return true;
    }
    std::size_t reader_count() const override { return 1; }
    Guid guid() const override { return {9}; }
    bool full = false;  ///< takes nothing
    int written = 0;
    Bytes last;
  };
  Reader& open_reader(const InputDeclaration& declaration, Deliver its_deliver) override {
    deliver[declaration.topic] = std::move(its_deliver);
    return readers.emplace_back();
  }
  Writer& open_writer(const OutputDeclaration& declaration) override {
    return writers[declaration.topic];
  }
  void watch_writers(const std::string&, std::function<void(const WriterInfo&)> event) override {
    watch = std::move(event);
  }

  std::map<std::string, Deliver> deliver;
  std::deque<FakeReader> readers;
  std::map<std::string, FakeWriter> writers;
  std::function<void(const WriterInfo&)> watch;
};

ParameterFile file() {
  ParameterFile result;
  result.component = result.name = "subject";
  result.host = "here";
  return result;
}

class EngineTest : public ::testing::Test {
 protected:
  void make(std::function<void(Host&)> script) {
    engine_ = std::make_unique<Engine>(file(), platform_, transport_);
    status_ = engine_->construct({"subject", [&](Host& host) {
                                    script(host);
                                    return std::make_unique<Component>();
                                  }});
  }
  void deliver(int number, const Guid& writer = {1}) {
    transport_.deliver.at("test/events")(message_, writer, static_cast<std::uint64_t>(number),
                                         true);
  }
  void advance(Duration duration) { platform_.clock += duration.count(); }

  FakePlatform platform_;
  FakeTransport transport_;
  std::unique_ptr<Engine> engine_;
  Status status_;
  std::shared_ptr<const Message> message_ = std::make_shared<Message>();
};

TEST_F(EngineTest, ARepeatedOrOlderNumberIsNoNews) {
  std::vector<std::uint64_t> numbers;
  make([&](Host& host) {
    host.input(kEvents, {},
               [&](const auto&, const SampleInfo& info) { numbers.push_back(info.number); });
  });
  for (const int number : {1, 1, 2}) deliver(number);
  EXPECT_TRUE(engine_->run_turn());
  for (const int number : {2, 1, 5, 4}) deliver(number);
  deliver(1, {2});  // another writer counts for itself
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_THAT(numbers, ElementsAre(1, 2, 5, 1));
}

TEST_F(EngineTest, PortsOpenOnlyWhenTheComponentIsMade) {
  Guid early{1};
  Output<Message> output;
  make([&](Host& host) {
    output = host.output(kReplies);
    output.publish(*message_);
    host.input(kEvents, {});
    early = output.guid();
    EXPECT_TRUE(transport_.writers.empty());
    EXPECT_TRUE(transport_.deliver.empty());
  });
  ASSERT_TRUE(status_.ok());
  EXPECT_EQ(early, Guid{});
  EXPECT_EQ(output.guid(), Guid{9});
  EXPECT_EQ(transport_.writers["test/replies"].written, 1) << "what the constructor published";
}

TEST_F(EngineTest, AFaultOfTheConstructorLeavesAHeartbeatAndNothingElse) {
  make([&](Host& host) {
    auto output = host.output(kReplies);
    output.publish(*message_);
    host.fault("no laser");
  });
  EXPECT_FALSE(status_.ok());
  EXPECT_EQ(status_.error(), "no laser");
  EXPECT_TRUE(engine_->faulted());
  EXPECT_EQ(transport_.writers["test/replies"].written, 0);
  ASSERT_EQ(transport_.writers["heartbeat"].written, 1);
  const auto& type = message_type<usher_msgs::msg::Heartbeat>();
  const auto beat = type.deserialize(transport_.writers["heartbeat"].last);
  EXPECT_EQ(static_cast<const usher_msgs::msg::Heartbeat*>(beat.get())->reason(), "no laser");
  EXPECT_FALSE(engine_->run_turn());
}

TEST_F(EngineTest, SamplesThatAreNotWrittenAreCounted) {
  Output<Message> output;
  make([&](Host& host) {
    output = host.output(kReplies);
    host.timer("speak", std::chrono::milliseconds(10), [&](auto) { output.publish(*message_); });
  });
  const auto counted = [&] {
    advance(std::chrono::milliseconds(100));
    while (engine_->next_due() <= platform_.now()) EXPECT_TRUE(engine_->run_turn());
    const auto beat = message_type<usher_msgs::msg::Heartbeat>().deserialize(
        transport_.writers["heartbeat"].last);
    std::uint64_t count = 0;
    for (const auto& counter :
         static_cast<const usher_msgs::msg::Heartbeat*>(beat.get())->counters()) {
      if (counter.name() == "test/replies: not written") count = counter.count();
    }
    return count;
  };
  EXPECT_EQ(counted(), 0U);
  const int written = transport_.writers["test/replies"].written;
  EXPECT_GT(written, 0);
  transport_.writers["test/replies"].full = true;
  const auto first = counted();
  EXPECT_GT(first, 0U);
  EXPECT_GT(counted(), first);
  EXPECT_EQ(transport_.writers["test/replies"].written, written);
}

TEST_F(EngineTest, WrongParametersAreNoFaultAndExplainOne) {
  make([&](Host& host) {
    host.parameters().number("width", "m", {1, 2}, "How wide.");
    host.fault("the width is odd");
  });
  EXPECT_FALSE(status_.ok());
  EXPECT_THAT(status_.error(), HasSubstr("width must be set"));
  EXPECT_FALSE(engine_->faulted());
  EXPECT_TRUE(transport_.writers.empty());
}

TEST_F(EngineTest, TooManyPostedEventsAreAFault) {
  int handled = 0;
  make([&](Host& host) { host.watch_writers("x", [&](const auto&) { ++handled; }); });
  for (std::size_t i = 0; i < Engine::kMaxPosted; ++i) transport_.watch({});
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_EQ(handled, static_cast<int>(Engine::kMaxPosted));
  for (std::size_t i = 0; i <= Engine::kMaxPosted; ++i) transport_.watch({});
  EXPECT_FALSE(engine_->run_turn());
  EXPECT_EQ(engine_->fault_reason(), "more than 4096 events were waiting");
}

TEST_F(EngineTest, TooManyJobsAreAFault) {
  Host* host = nullptr;
  make([&](Host& its_host) { host = &its_host; });
  int done = 0;
  engine_->post([&] {
    for (std::size_t i = 0; i < Engine::kMaxJobs; ++i)
      host->offload(
          {}, [] {}, [&] { ++done; });
  });
  EXPECT_TRUE(engine_->run_turn());
  for (auto& [job, finished] : platform_.jobs) {
    job();
    finished();
  }
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_EQ(done, static_cast<int>(Engine::kMaxJobs));
  engine_->post([&] {
    for (std::size_t i = 0; i <= Engine::kMaxJobs; ++i)
      host->offload(
          {}, [] {}, [] {});
  });
  EXPECT_FALSE(engine_->run_turn());
  EXPECT_EQ(engine_->fault_reason(), "64 offloaded jobs are under way");
}

TEST_F(EngineTest, AStreamThatIsTooFastIsHeldBack) {
  std::string seen;
  make([&](Host& host) {
    StreamHandlers handlers;
    handlers.on_open = [&] { seen += "open "; };
    handlers.on_bytes = [&](std::span<const std::uint8_t> bytes) {
      seen += std::to_string(bytes.size()) + " ";
    };
    handlers.on_close = [&](const std::string& reason) { seen += reason; };
    auto& stream = host.open_stream("tcp://x:1", std::move(handlers));
    EXPECT_FALSE(stream.write(Bytes{1})) << "opens when the component is made";
  });
  platform_.sink.opened();
  EXPECT_TRUE(platform_.sink.received(Bytes(10)));
  EXPECT_TRUE(platform_.sink.received(Bytes(Engine::kMaxStreamBytes - 10)));
  EXPECT_FALSE(platform_.sink.received(Bytes(1)));
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_TRUE(platform_.sink.received(Bytes(Engine::kMaxStreamBytes + 1)))
      << "alone it may be larger";
  platform_.sink.closed("unplugged");
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_EQ(seen, "open 10 262134 262145 unplugged");
}

TEST_F(EngineTest, TheWriterThatWasSilentForLongestIsForgotten) {
  std::uint64_t seen = 0;
  make([&](Host& host) { host.input(kEvents, {}, [&](const auto&, const auto&) { ++seen; }); });
  const auto writer = [](std::size_t i) {
    return Guid{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), 1};
  };
  for (std::size_t i = 0; i < 3 * Engine::kMaxWriters; ++i) {
    deliver(1, writer(i));
    advance(milliseconds(1));
    EXPECT_TRUE(engine_->run_turn());
  }
  EXPECT_EQ(seen, 3 * Engine::kMaxWriters);
  deliver(1, writer(3 * Engine::kMaxWriters - 1));
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_EQ(seen, 3 * Engine::kMaxWriters) << "a recent one is remembered";
}

TEST_F(EngineTest, NothingHappensAfterTheEnd) {
  int handled = 0;
  make([&](Host& host) { host.input(kEvents, {}, [&](const auto&, const auto&) { ++handled; }); });
  const auto late_deliver = transport_.deliver.at("test/events");
  deliver(1);
  EXPECT_TRUE(engine_->has_work());
  engine_->stop();
  EXPECT_FALSE(engine_->has_work());
  deliver(2);
  engine_->post([&] { ++handled; });
  EXPECT_FALSE(engine_->has_work());
  EXPECT_FALSE(engine_->run_turn());
  EXPECT_EQ(engine_->next_due(), Time::max());
  engine_.reset();
  late_deliver(message_, {1}, 3, true);  // a middleware thread that comes late
  EXPECT_EQ(handled, 0);
}

TEST_F(EngineTest, ASampleThatArrivesAfterTheLookAtTheClockWaitsForTheNextTurn) {
  std::vector<Duration> ages;
  make([&](Host& host) {
    host.input(kEvents, {}, [&](const auto&, const SampleInfo& info) {
      ages.push_back(host.now() - info.arrival);
    });
  });
  platform_.at_next_look = [&] {
    advance(milliseconds(1));
    deliver(1);
  };
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_TRUE(ages.empty());
  EXPECT_TRUE(engine_->has_work());
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_THAT(ages, ElementsAre(Duration::zero()));
}

TEST_F(EngineTest, AClockThatGoesBackIsNotFollowed) {
  std::vector<Time> times;
  make([&](Host& host) {
    host.input(kEvents, {}, [&](const auto&, const auto&) { times.push_back(host.now()); });
  });
  deliver(1);
  engine_->run_turn();
  advance(-milliseconds(500));
  deliver(2);
  engine_->run_turn();
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0], times[1]);
}

TEST_F(EngineTest, AnAgeWithoutAWordAboutItsLossIsRefused) {
  make([&](Host& host) { host.input(kEvents, {milliseconds(100)}); });
  EXPECT_FALSE(status_.ok());
  EXPECT_THAT(status_.error(),
              HasSubstr("input test/events has an age but does not say what its loss means"));
}

TEST_F(EngineTest, ASecondWriterIsNotHeardWhileTheFirstIs) {
  const Guid first = {1}, second = {2};
  std::vector<Guid> handled;
  make([&](Host& host) {
    host.input(kEvents, {.max_age = milliseconds(100), .on_loss = "nothing", .one_writer = true},
               [&](const auto&, const SampleInfo& info) { handled.push_back(info.writer); });
  });
  const auto turn = [&](std::uint64_t number, const Guid& writer) {
    transport_.deliver.at("test/events")(message_, writer, number, false);
    EXPECT_TRUE(engine_->run_turn());
  };
  turn(1, first);
  turn(1, second);
  advance(milliseconds(90));
  turn(2, second);
  turn(2, first);
  EXPECT_THAT(handled, ElementsAre(first, first));
  advance(milliseconds(101));
  turn(3, second);
  turn(3, first);
  EXPECT_THAT(handled, ElementsAre(first, first, second)) << "a restart takes over from silence";
}

TEST_F(EngineTest, OneWriterForEverIsRefused) {
  make([&](Host& host) { host.input(kEvents, {.one_writer = true}); });
  EXPECT_THAT(status_.error(), HasSubstr("one writer but no age"));
}

TEST_F(EngineTest, OnlyInputsWithAHandlerWakeTheDispatcher) {
  Input<Message> polled;
  make([&](Host& host) { polled = host.input(kEvents, {}); });
  deliver(1);
  EXPECT_FALSE(engine_->has_work());
  EXPECT_EQ(platform_.wakes, 0);
  EXPECT_EQ(polled.latest(), nullptr);
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_NE(polled.latest(), nullptr);
  for (int i = 2; i < 20; ++i) deliver(i);
  EXPECT_TRUE(engine_->run_turn());
  EXPECT_EQ(polled.info()->number, 19U);
  EXPECT_EQ(polled.lost(), 0U) << "nobody asked for each of them";
}

TEST_F(EngineTest, ATurnAllocatesNothing) {
  struct {
    Output<Message> output;
    Timer timer;
  } component;
  std::uint64_t handled = 0;
  make([&](Host& host) {
    component.output = host.output(kReplies);
    host.input(kEvents, {milliseconds(100), "nothing"}, [&](const Message& message, const auto&) {
      ++handled;
      component.output.publish(message);
    });
    component.timer = host.timer("tick", milliseconds(10), [&](auto) { ++handled; });
    host.health().set(HealthState::kOk);
    ++host.health().counter("things");
  });
  std::uint64_t number = 0;
  const auto turns = [&](int count) {
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < 3; ++j) transport_.deliver["test/events"](message_, {1}, ++number, false);
      advance(milliseconds(5));
      engine_->run_turn();
    }
  };
  turns(100);
  transport_.writers["test/replies"].last.reserve(1000);
  const std::uint64_t before = test::allocation_count();
  turns(1000);
  EXPECT_EQ(test::allocation_count() - before, 0U);
  EXPECT_EQ(handled, 1100U * 3 + 550);
}

TEST_F(EngineTest, TakesFromManyThreads) {
  std::uint64_t handled = 0, posted = 0;
  Input<Message> input;
  make([&](Host& host) {
    input = host.input(kEvents, {}, [&](const auto&, const auto&) { ++handled; });
  });
  constexpr int kThreads = 3, kSamples = 20000;
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  std::atomic<int> running{kThreads};
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      const Guid writer{static_cast<std::uint8_t>(t + 1)};
      const auto& deliver_here = transport_.deliver.at("test/events");
      for (int i = 1; i <= kSamples; ++i) {
        deliver_here(i % 10 == 0 ? nullptr : message_, writer, static_cast<std::uint64_t>(i), true);
        if (i % 100 == 0) engine_->post([&] { ++posted; });
      }
      --running;
    });
  }
  while (running > 0) ASSERT_TRUE(engine_->run_turn());
  for (std::thread& thread : threads) thread.join();
  ASSERT_TRUE(engine_->run_turn());
  EXPECT_EQ(handled + input.lost() + input.rejected(),
            static_cast<std::uint64_t>(kThreads) * kSamples);
  EXPECT_EQ(input.rejected(), static_cast<std::uint64_t>(kThreads) * kSamples / 10);
  EXPECT_EQ(posted, static_cast<std::uint64_t>(kThreads) * kSamples / 100);
}

}  // namespace
}  // namespace usher::runtime
