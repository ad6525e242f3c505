// DdsHost: a component with real participants around it, in this process.
#include <gmock/gmock.h>
#include <sched.h>

#include <atomic>
#include <thread>

#include "echo_component.hpp"
#include "runtime/dds/dds_host.hpp"
#include "runtime/dds/observer.hpp"
#include "support/folder.hpp"
#include "support/sanitizer.hpp"
#include "support/test_domain.hpp"

namespace usher::runtime {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using testing::HasSubstr;

constexpr Duration kLong =
    std::chrono::duration_cast<Duration>(10s * usher::test::kSanitizerFactor);
constexpr Duration kMoment = std::chrono::duration_cast<Duration>(200ms);

ParameterFile file(const std::string& name) {
  ParameterFile result;
  result.component = "test";
  result.name = name;
  result.host = "nuc";
  result.domain = test_domain();
  return result;
}

std::unique_ptr<Observer> observer() {
  return std::move(Observer::create(
                       {.name = "operator", .host = "nuc", .domain = test_domain(), .peers = {}}))
      .value();
}

/// A host on a dispatcher thread of its own.
class Running {
 public:
  Running(const ParameterFile& parameters, const ComponentFactory& factory)
      : host_(std::move(DdsHost::create(parameters, stop_)).value()),
        status(host_->construct(factory)) {
    if (status.ok()) thread_ = std::thread([this] { code_ = host_->run(); });
  }
  ~Running() { end(); }
  /// Asks it to stop; the exit code.
  int end() {
    stop_.set();
    return join();
  }
  /// Waits until it ends by itself.
  int join() {
    if (thread_.joinable()) thread_.join();
    return code_;
  }
  Engine& engine() { return host_->engine(); }

 private:
  StopFlag stop_;
  std::unique_ptr<DdsHost> host_;
  std::thread thread_;
  int code_ = -1;

 public:
  const Status status;
};

/// A component made of a lambda that declares everything.
class Scripted : public Component {
 public:
  static ComponentFactory factory(const std::function<void(Host&)>& declare) {
    return {"test", [declare](Host& host) -> std::unique_ptr<Component> {
              declare(host);
              return std::make_unique<Scripted>();
            }};
  }
};

TEST(DdsHost, RunsAHandlerForEachSampleAndAnswers) {
  Running echo(file("echo"), component_factory<test::EchoComponent>("echo"));
  ASSERT_TRUE(echo.status.ok()) << echo.status.error();
  auto out = observer();
  auto answers = out->reader(topics::kCmdVelInteraction);
  auto questions = out->writer(topics::kCmdVelManual);
  ASSERT_TRUE(answers.ok() && questions.ok());
  ASSERT_TRUE(questions->wait_for_readers(1, kLong));
  // The echo may find this reader last, and what it answered before is lost: asked until it
  // answers.
  std::shared_ptr<const TwistStamped> answer;
  for (const Time begin = out->now(); answer == nullptr && out->now() - begin < kLong;) {
    questions->write(test::question(out->now(), 0.0));
    answer = answers->take(kMoment);
  }
  ASSERT_NE(answer, nullptr);
  while (const auto late = answers->take(kMoment)) answer = late;
  const double before = answer->twist().angular().x();
  for (int i = 1; i <= 10; ++i) {
    questions->write(test::question(out->now(), 0.1 * i));
    answer = answers->take(kLong);
    ASSERT_NE(answer, nullptr);
    EXPECT_EQ(answer->twist().linear().x(), 0.1 * i);
    EXPECT_EQ(answer->twist().angular().x(), before + i);
  }
  EXPECT_EQ(echo.end(), 0);
}

TEST(DdsHost, BeatsWithLoadAndMemory) {
  Running echo(file("echo"), component_factory<test::EchoComponent>("echo"));
  auto out = observer();
  auto heartbeats = out->reader(topics::kHeartbeat);
  ASSERT_TRUE(heartbeats.ok());
  for (int i = 0; i < 3; ++i) {
    const auto beat = heartbeats->take(kLong);
    ASSERT_NE(beat, nullptr);
    EXPECT_EQ(beat->component_name(), "echo");
    EXPECT_EQ(beat->host(), "nuc");
    EXPECT_EQ(beat->idl_digest(), USHER_IDL_DIGEST);
    EXPECT_EQ(beat->state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
    EXPECT_GT(beat->memory_bytes(), 1U << 20);
    EXPECT_GE(beat->cpu_percent(), 0.0F);
    EXPECT_LT(beat->cpu_percent(),
              100.0F * static_cast<float>(std::thread::hardware_concurrency() + 1));
  }
}

TEST(DdsHost, HonoursTheDepthAndCountsWhatWasLost) {
  std::atomic<bool> busy{false};
  std::atomic<bool> go_on{false};
  std::atomic<int> handled{0};
  Input<TwistStamped> input;
  Running reader(file("reader"), Scripted::factory([&](Host& host) {
                   input = host.input(topics::kCmdVelManual, {.depth = 4},
                                      [&](const TwistStamped&, const SampleInfo&) {
                                        busy = true;
                                        while (!go_on) std::this_thread::yield();
                                        ++handled;
                                      });
                 }));
  ASSERT_TRUE(reader.status.ok()) << reader.status.error();
  auto out = observer();
  auto writer = out->writer(topics::kCmdVelManual);
  auto heartbeats = out->reader(topics::kHeartbeat);
  ASSERT_TRUE(writer.ok() && writer->wait_for_readers(1, kLong));
  writer->write(test::question(out->now(), 0.0));
  while (!busy) std::this_thread::yield();
  for (int i = 0; i < 20; ++i)
    writer->write(test::question(out->now(), 0.0));  // delivered within write()
  go_on = true;
  // One was in its handler, the last four of twenty were kept.
  for (;;) {
    const auto beat = heartbeats->take(kLong);
    ASSERT_NE(beat, nullptr);
    if (beat->samples_lost() == 16) break;
  }
  EXPECT_EQ(reader.end(), 0);
  EXPECT_EQ(handled, 5);
  EXPECT_EQ(input.lost(), 16U);
}

TEST(DdsHost, CountsWhatIsNoMessage) {
  Input<TwistStamped> input;
  Running reader(file("reader"), Scripted::factory([&](Host& host) {
                   input = host.input(topics::kCmdVelManual, {},
                                      [](const TwistStamped&, const SampleInfo&) {
                                        FAIL() << "these bytes are no message";
                                      });
                 }));
  auto out = observer();
  auto writer = out->writer(topics::kCmdVelManual);
  auto heartbeats = out->reader(topics::kHeartbeat);
  ASSERT_TRUE(writer.ok() && writer->wait_for_readers(1, kLong));
  // Both sides must be matched: the writer keeps only the last sample for a reader that was not
  // ready.
  while (input.writers().empty()) std::this_thread::yield();
  for (int i = 0; i < 3; ++i) writer->write_raw(Bytes{0, 1, 0, 0, 1, 2, 3});
  for (;;) {
    const auto beat = heartbeats->take(kLong);
    ASSERT_NE(beat, nullptr);
    const auto& counters = beat->counters();
    if (std::ranges::any_of(counters, [](const usher_msgs::msg::Counter& c) {
          return c.name() == "cmd_vel/manual: rejected" && c.count() == 3;
        })) {
      break;
    }
  }
  reader.end();
  EXPECT_EQ(input.rejected(), 3U);
}

TEST(DdsHost, EndsWithCode3AndALastHeartbeatAfterAFault) {
  auto out = observer();
  auto heartbeats = out->reader(topics::kHeartbeat);
  Running echo(file("echo"), component_factory<test::EchoComponent>("echo"));
  auto questions = out->writer(topics::kCmdVelManual);
  ASSERT_TRUE(questions.ok() && questions->wait_for_readers(1, kLong));
  ASSERT_NE(heartbeats->take(kLong), nullptr);
  questions->write(test::question(out->now(), 0.0, 666.0));
  EXPECT_EQ(echo.join(), 3);
  EXPECT_THAT(echo.engine().fault_reason(), HasSubstr("asked to fail"));
  std::shared_ptr<const usher_msgs::msg::Heartbeat> last;
  do {
    last = heartbeats->take(kLong);
    ASSERT_NE(last, nullptr);
  } while (last->state() != usher_msgs::msg::Heartbeat_Constants::STATE_FAULT);
  EXPECT_THAT(last->reason(), HasSubstr("asked to fail"));
}

TEST(DdsHost, SaysWhyAlsoWhenItEndsBeforeItWasDiscovered) {
  auto out = observer();
  auto heartbeats = out->reader(topics::kHeartbeat);
  ASSERT_TRUE(heartbeats.ok());
  const auto said = [&](const std::string& reason) {
    while (const auto beat = heartbeats->take(kLong)) {
      if (beat->reason().find(reason) != std::string::npos) return true;
    }
    return false;
  };
  Running constructor(file("no_map"),
                      Scripted::factory([](Host& host) { host.fault("no such map"); }));
  EXPECT_FALSE(constructor.status.ok());
  EXPECT_TRUE(constructor.engine().faulted());
  EXPECT_TRUE(said("no such map"));
  Running timer(file("hasty"), Scripted::factory([](Host& host) {
                  host.timer("first", 1ms, [&host](std::uint64_t) { host.fault("out of chalk"); });
                }));
  EXPECT_EQ(timer.join(), 3);
  EXPECT_TRUE(said("out of chalk"));
}

TEST(DdsHost, RunsTimersAtTheirRate) {
  std::atomic<int> fired{0};
  Running ticker(file("ticker"), Scripted::factory([&](Host& host) {
                   host.timer("tick", 5ms, [&](std::uint64_t skipped) {
                     fired += 1 + static_cast<int>(skipped);
                   });
                 }));
  const auto begin = std::chrono::steady_clock::now();
  while (fired < 40) std::this_thread::yield();
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_GE(took, 190ms);  // never early, however loaded the machine is
}

TEST(DdsHost, RunsJobsBesideTheHandlersAndTheirEndAsHandler) {
  std::atomic<bool> done{false};
  std::thread::id job_thread;
  std::thread::id done_thread;
  std::thread::id timer_thread;
  Running worker(file("worker"), Scripted::factory([&](Host& host) {
                   host.timer("once", 10ms, [&, started = false](std::uint64_t) mutable {
                     timer_thread = std::this_thread::get_id();
                     if (std::exchange(started, true)) return;
                     host.offload(
                         1ms, [&] { job_thread = std::this_thread::get_id(); },
                         [&] {
                           done_thread = std::this_thread::get_id();
                           done = true;
                         });
                   });
                 }));
  while (!done) std::this_thread::yield();
  worker.end();
  EXPECT_NE(job_thread, done_thread);
  EXPECT_EQ(done_thread, timer_thread);
}

TEST(DdsHost, RunsJobsOutsideOfRealTime) {
  std::atomic<bool> done{false};
  int handlers = -1, jobs = -1;
  bool permitted = false;
  std::thread([&] {  // a host takes after who makes it
    const sched_param wanted{.sched_priority = 1};
    permitted = sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
    Running worker(file("worker"), Scripted::factory([&](Host& host) {
                     host.timer("once", 10ms, [&, started = false](std::uint64_t) mutable {
                       if (std::exchange(started, true)) return;
                       handlers = sched_getscheduler(0);
                       host.offload(
                           1ms, [&] { jobs = sched_getscheduler(0); }, [&] { done = true; });
                     });
                   }));
    while (!done) std::this_thread::sleep_for(1ms);
  })
      .join();
  if (!permitted) GTEST_SKIP() << "real time is not permitted here";
  EXPECT_EQ(handlers, SCHED_FIFO);
  EXPECT_EQ(jobs, SCHED_OTHER);
}

TEST(DdsHost, KeepsValuesOverItsLife) {
  const usher::test::Folder folder;
  ParameterFile parameters = file("keeper");
  parameters.run_directory = folder.path();
  std::vector<std::string> found;
  const auto factory = Scripted::factory([&](Host& host) {
    const auto kept = host.kept("epoch");
    found.push_back(*kept ? std::string((*kept)->begin(), (*kept)->end()) : "nothing");
    EXPECT_TRUE(host.keep("epoch", Bytes{'4', '2'}).ok());
  });
  Running(parameters, factory).end();
  Running(parameters, factory).end();
  parameters.name = "another";
  Running(parameters, factory).end();
  EXPECT_THAT(found, testing::ElementsAre("nothing", "42", "nothing"));
}

TEST(DdsHost, AJobUnderWayKeepsThoughTheHostEnds) {
  const usher::test::Folder folder;
  ParameterFile parameters = file("keeper");
  parameters.run_directory = folder.path();
  std::atomic<bool> started{false};
  {
    Running ending(parameters, Scripted::factory([&](Host& host) {
                     host.timer("once", 10ms, [&, asked = false](std::uint64_t) mutable {
                       if (std::exchange(asked, true)) return;
                       host.offload(
                           1ms,
                           [&] {
                             started = true;
                             std::this_thread::sleep_for(200ms);  // the host ends meanwhile
                             EXPECT_TRUE(host.keep("late", Bytes{'7'}).ok());
                           },
                           [] {});
                     });
                   }));
    while (!started) std::this_thread::yield();
  }
  Running(parameters,
          Scripted::factory([](Host& host) { EXPECT_TRUE(host.kept("late").value()); }));
}

TEST(DdsHost, ReportsWritersOfAWatchedTopicInHandlers) {
  std::vector<std::string> events;
  std::atomic<int> count{0};
  Running watcher(file("supervisor"), Scripted::factory([&](Host& host) {
                    host.watch_writers("drive/command", [&](const WriterInfo& info) {
                      events.push_back((info.alive ? "+" : "-") + info.participant);
                      ++count;
                    });
                  }));
  {
    auto rogue =
        std::move(
            Observer::create({.name = "rogue", .host = "x", .domain = test_domain(), .peers = {}}))
            .value();
    auto writer = rogue->writer(topics::kDriveCommand);
    ASSERT_TRUE(writer.ok());
    while (count < 1) std::this_thread::yield();
  }
  while (count < 2) std::this_thread::yield();
  watcher.end();
  EXPECT_THAT(events, testing::ElementsAre("+rogue", "-rogue"));
}

TEST(DdsHost, ReportsWrongParametersWithoutRunning) {
  ParameterFile parameters = file("echo");
  parameters.values.push_back({"gain", "99", "demo.yaml:7"});
  Running echo(parameters, component_factory<test::EchoComponent>("echo"));
  ASSERT_FALSE(echo.status.ok());
  EXPECT_THAT(echo.status.error(), HasSubstr("demo.yaml:7"));
  EXPECT_FALSE(echo.engine().faulted());
}

}  // namespace
}  // namespace usher::runtime
