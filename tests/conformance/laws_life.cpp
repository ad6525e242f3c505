// A component's life: randomness, heartbeats, work beside the handlers, memory, the end.
#include <atomic>
#include <stdexcept>

#include "conformance/laws.hpp"

namespace usher::conformance {
namespace {

TEST_F(HostLaw, RandomnessComesFromWorldSeedComponentAndStream) {
  const auto draw = [&](const Stage::Role& role, bool other_first) {
    std::vector<std::uint64_t> numbers;
    EXPECT_TRUE(start(role, scripted<Nothing>([&](Host& host, Nothing&) {
                        if (other_first) host.random("other").next();
                        auto noise = host.random("noise"), other = host.random("other");
                        numbers = {noise.next(), noise.next(), other.next()};
                      }))
                    .ok());
    return numbers;
  };
  auto& role = make<Stage::Role>();
  const auto reference = draw(role, false);
  stage_->stop("subject");
  stage_->run_for(milliseconds(100));
  EXPECT_EQ(draw(role, true), reference) << "a restart, streams in another order";
  EXPECT_NE(reference[0], reference[2]) << "two streams";
  role.name = "sibling";
  EXPECT_NE(draw(role, false), reference) << "another component";
  role.name = "third";
  const auto third = draw(role, false);
  auto other_stage = make_stage();
  std::swap(stage_, other_stage);
  role.seed = 2;
  EXPECT_NE(draw(role, false), third) << "another world";
  role.seed = 1;
  role.name = "subject";
  EXPECT_EQ(draw(role, false), reference) << "the same world again";
}

TEST_F(HostLaw, HeartbeatsTellStateAndComeFiftyOrTenTimesASecond) {
  const auto script = scripted<Timer>([](Host& host, Timer& timer) {
    timer = host.timer("once", milliseconds(500), [&](auto) {
      host.health().set(HealthState::kDegraded, "no whiskers");
      host.health().counter("scan: too short") += 7;
      timer.stop();
    });
  });
  ASSERT_TRUE(start({"plain"}, script).ok());
  ASSERT_TRUE(start({"critical", "here", 1, true}, script).ok());
  stage_->settle();
  const std::size_t plain = stage_->heartbeats("plain").size();
  const std::size_t critical = stage_->heartbeats("critical").size();
  EXPECT_EQ(stage_->heartbeats("plain").front().state(),
            usher_msgs::msg::Heartbeat_Constants::STATE_STARTING);
  stage_->run_for(seconds(2));
  EXPECT_NEAR(static_cast<double>(stage_->heartbeats("plain").size() - plain), 20, 2);
  EXPECT_NEAR(static_cast<double>(stage_->heartbeats("critical").size() - critical), 100, 4);
  const auto beat = newest_heartbeat("plain");
  EXPECT_EQ(beat.component_name(), "plain");
  EXPECT_EQ(beat.host(), "here");
  EXPECT_EQ(beat.idl_digest(), USHER_IDL_DIGEST);
  EXPECT_EQ(beat.state(), usher_msgs::msg::Heartbeat_Constants::STATE_DEGRADED);
  EXPECT_EQ(beat.reason(), "no whiskers");
  ASSERT_EQ(beat.counters().size(), 1U);
  EXPECT_EQ(beat.counters()[0].count(), 7U);
}

TEST_F(HostLaw, OffloadedWorkEndsInAHandlerInOrderAndItsExceptionIsAFault) {
  auto& order = make<Log<std::string>>();
  auto& jobs = make<std::atomic<int>>(0);
  struct State {
    Timer timer, bad;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.timer = host.timer("once", milliseconds(20), [&](auto) {
      state.timer.stop();
      for (int i = 0; i < 3; ++i) {
        host.offload(
            milliseconds(30), [&] { ++jobs; },
            [&order, &jobs, i] {
              EXPECT_GT(jobs, i);
              order.add("done " + std::to_string(i));
            });
      }
      order.add("asked");
    });
    state.bad = host.timer("bad", milliseconds(300), [&](auto) {
      host.offload(
          milliseconds(1), [] { throw std::runtime_error("no recogniser"); },
          [&] { order.add("done after an exception"); });
    });
  }));
  ASSERT_TRUE(wait_for(order, 4));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  EXPECT_THAT(order.all(), ElementsAre("asked", "done 0", "done 1", "done 2"));
  ASSERT_TRUE(stage_->run_until(
      [&] {
        return newest_heartbeat("subject").reason() == "an offloaded job threw: no recogniser";
      },
      kSoon));
}

TEST_F(HostLaw, MemoryOutlivesTheComponent) {
  auto& found = make<Log<std::string>>();
  const auto script = scripted<Nothing>([&](Host& host, Nothing&) {
    const auto kept = host.kept("pose");
    found.add(*kept ? std::string((*kept)->begin(), (*kept)->end()) : "nothing");
    const Bytes bytes{'h', 'e', 'r', 'e'};
    EXPECT_TRUE(host.keep("pose", bytes).ok());
    EXPECT_FALSE(host.keep("map", Bytes(2 << 20)).ok()) << "more than 1 MB";
  });
  start(script);
  stage_->stop("subject");
  stage_->run_for(milliseconds(50));
  start(script);
  EXPECT_THAT(found.all(), ElementsAre("nothing", "here"));
}

TEST_F(HostLaw, NoHandlerWaitsForADisk) {
  auto& kept = make<std::atomic<bool>>(false);
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("once", milliseconds(20), [&](auto) {
      timer.stop();
      host.offload(
          milliseconds(5), [&] { kept = host.keep("pose", Bytes{'1'}).ok(); },
          [&] { static_cast<void>(host.keep("pose", Bytes{'2'}).ok()); });
    });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  EXPECT_TRUE(kept) << "beside the handlers";
  EXPECT_EQ(newest_heartbeat("subject").reason(),
            "pose was kept in a handler: what it publishes would wait for the disk");
}

TEST_F(HostLaw, AskedToStopAComponentEndsWithZeroAndRunsNoMore) {
  auto& ticks = make<std::atomic<int>>(0);
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", milliseconds(5), [&](auto) { ++ticks; });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return ticks > 3; }, kSoon));
  stage_->stop("subject");
  const int at_stop = ticks;
  stage_->run_for(milliseconds(100));
  EXPECT_EQ(ticks, at_stop);
  EXPECT_EQ(stage_->exit_code("subject"), 0);
}

}  // namespace
}  // namespace usher::conformance
