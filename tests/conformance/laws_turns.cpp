// Turns: what runs when, and that time stands still meanwhile.
#include <algorithm>
#include <atomic>
#include <map>

#include "conformance/laws.hpp"

namespace usher::conformance {
namespace {

TEST_F(HostLaw, HandlersNeverOverlap) {
  auto& inside = make<std::atomic<int>>(0);
  auto& overlaps = make<std::atomic<int>>(0);
  auto& entered = make<std::atomic<int>>(0);
  auto& role = make<Stage::Role>();
  role.work = std::chrono::microseconds(200);
  const auto handle = [&] {
    if (inside.fetch_add(1) != 0) ++overlaps;
    ++entered;
    stage_->work(role);
    inside.fetch_sub(1);
  };
  struct State {
    Input<Message> events, others;
    Timer fast, slow;
  };
  ASSERT_TRUE(start(role, scripted<State>([&](Host& host, State& state) {
                      state.events =
                          host.input(kEvents, {}, [handle](const auto&, const auto&) { handle(); });
                      state.others =
                          host.input(kOthers, {}, [handle](const auto&, const auto&) { handle(); });
                      state.fast =
                          host.timer("fast", milliseconds(1), [handle](auto) { handle(); });
                      state.slow = host.timer("slow", milliseconds(3), [handle, &host](auto) {
                        handle();
                        host.offload(
                            milliseconds(2), [] {}, handle);
                      });
                      host.watch_writers("test/events", [handle](const auto&) { handle(); });
                    }))
                  .ok());
  for (int i = 0; i < 50; ++i) {
    stage_->publish(kEvents, message(i));
    stage_->publish(kOthers, message(i), {"second"});
    stage_->run_for(milliseconds(2));
  }
  EXPECT_EQ(overlaps, 0);
  EXPECT_GT(entered, 150);
}

TEST_F(HostLaw, TimeStandsStillInsideAHandlerAndNeverGoesBack) {
  auto& first = make<Log<Time>>();
  auto& last = make<Log<Time>>();
  auto& role = make<Stage::Role>();
  role.work = milliseconds(1);
  ASSERT_TRUE(start(role, scripted<Timer>([&](Host& host, Timer& timer) {
                      timer = host.timer("tick", milliseconds(5), [&](auto) {
                        first.add(host.now());
                        stage_->work(role);
                        last.add(host.now());
                      });
                    }))
                  .ok());
  ASSERT_TRUE(wait_for(last, 20));
  const auto begins = first.all(), ends = last.all();
  EXPECT_TRUE(std::is_sorted(begins.begin(), begins.end()));
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_EQ(begins[i], ends[i]);
  EXPECT_LT(begins.front(), begins.back());
}

TEST_F(HostLaw, NothingInATurnComesFromItsFuture) {
  auto& seen = make<Log<Seen>>();
  auto& role = make<Stage::Role>();
  role.work = milliseconds(2);
  ASSERT_TRUE(start(role, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.input(kEvents, {}, [&](const Message& each, const SampleInfo& info) {
                        seen.add({each.frame_id(), host.now(), info});
                        stage_->work(role);
                      });
                    }))
                  .ok());
  for (int i = 0; i < 500 && seen.size() < 15; ++i) {
    stage_->publish(kEvents, message(i));
    stage_->run_for(milliseconds(1));
  }
  ASSERT_GE(seen.size(), 15U);
  for (const Seen& each : seen.all()) EXPECT_LE(each.info.arrival, each.now);
}

TEST_F(HostLaw, ATurnRunsAtMostDepthSamplesPerInputAndWriter) {
  auto& seen = make<Log<Seen>>();
  start(scripted<Nothing>([&](Host& host, Nothing&) {
    host.input(kEvents, {}, [&](const Message& each, const SampleInfo& info) {
      seen.add({each.frame_id(), host.now(), info});
    });
  }));
  stage_->publish(kEvents, message("hello"), {"first"});
  stage_->publish(kEvents, message("hello"), {"second"});
  ASSERT_TRUE(wait_for(seen, 2));
  stage_->hold("subject", milliseconds(300));
  stage_->run_for(milliseconds(50));
  std::vector<Message> many;
  for (int i = 0; i < 3 * kDepth; ++i) many.push_back(message(i));
  stage_->publish_all(kEvents, many, {"first"});
  stage_->publish_all(kEvents, many, {"second"});
  ASSERT_TRUE(wait_for(seen, 2 + 2 * kDepth));
  stage_->run_for(milliseconds(100));
  std::map<std::pair<Time, runtime::Guid>, int> per_turn;
  for (const Seen& each : seen.all()) ++per_turn[{each.now, each.info.writer}];
  for (const auto& [turn, count] : per_turn) EXPECT_LE(count, kDepth);
  // One writer's flood does not push out the other's samples.
  EXPECT_EQ(seen.size(), 2U + 2 * kDepth);
}

TEST_F(HostLaw, AFloodCannotStarveATimer) {
  auto& role = make<Stage::Role>();
  role.work = std::chrono::microseconds(500);
  auto& ticks = make<Log<Time>>();
  auto& handled = make<std::atomic<int>>(0);
  struct State {
    Output<Message> output;
    Timer timer;
  };
  ASSERT_TRUE(start(role, scripted<State>([&](Host& host, State& state) {
                      // Every sample makes two new ones: there is always more work than time.
                      state.output = host.output(kEvents);
                      host.input(kEvents, {}, [&](const Message& each, const SampleInfo&) {
                        ++handled;
                        stage_->work(role);
                        state.output.publish(each);
                        state.output.publish(each);
                      });
                      state.timer = host.timer("tick", milliseconds(20),
                                               [&](auto) { ticks.add(host.now()); });
                    }))
                  .ok());
  stage_->publish(kEvents, message(0));
  stage_->run_for(seconds(1));
  EXPECT_GT(handled, 300);
  // At most kDepth samples of each of two writers run between two looks at the clock: 16 * 0.5 ms.
  EXPECT_GE(ticks.size(), 40U);
}

TEST_F(HostLaw, SamplesRunInOrderOfArrivalThenOfDeclaration) {
  auto& seen = make<Log<Seen>>();
  start(scripted<Nothing>([&](Host& host, Nothing&) {
    for (const Topic& topic : {kOthers, kEvents}) {
      const std::string prefix = topic.name == kOthers.name ? "others " : "events ";
      host.input(topic, {}, [&host, &seen, prefix](const Message& each, const SampleInfo& info) {
        seen.add({prefix + each.frame_id(), host.now(), info});
      });
    }
  }));
  stage_->publish(kEvents, message("hello"));
  stage_->publish(kOthers, message("hello"));
  ASSERT_TRUE(wait_for(seen, 2));
  const std::size_t before = seen.size();
  stage_->hold("subject", milliseconds(200));
  stage_->run_for(milliseconds(50));
  for (int i = 0; i < 3; ++i) {
    stage_->publish(kEvents, message(i));
    stage_->run_for(milliseconds(5));
    stage_->publish(kOthers, message(i));
    stage_->run_for(milliseconds(5));
  }
  ASSERT_TRUE(wait_for(seen, before + 6));
  auto all = seen.all();
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(before));
  EXPECT_THAT(texts(all),
              ElementsAre("events 0", "others 0", "events 1", "others 1", "events 2", "others 2"));

  // What arrives at the same moment runs in order of declaration.
  stage_->publish(kEvents, message(3));
  stage_->publish(kOthers, message(3));
  ASSERT_TRUE(wait_for(seen, before + 8));
  all = seen.all();
  const Seen &first = all[all.size() - 2], &second = all.back();
  const bool same = first.info.arrival == second.info.arrival;
  EXPECT_TRUE(!same || first.text == "others 3");
  EXPECT_LE(first.info.arrival, second.info.arrival);
  EXPECT_TRUE(same || stage_->tolerance() > Duration::zero());
}

TEST_F(HostLaw, OfWhatIsDueLossesRunFirstThenByTimeThenByDeclaration) {
  auto& order = make<Log<std::string>>();
  struct State {
    Timer late, early, twin;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.late = host.timer("late", milliseconds(300), [&](auto) { order.add("late"); });
    host.input(kEvents, {milliseconds(250), "nothing", 0, true}, {}, [&] { order.add("stale"); });
    state.early = host.timer("early", milliseconds(200), [&](auto) { order.add("early"); });
    state.twin = host.timer("twin", milliseconds(200), [&](auto) { order.add("twin"); });
  }));
  stage_->run_for(milliseconds(20));
  stage_->hold("subject", milliseconds(340));
  ASSERT_TRUE(wait_for(order, 4));
  EXPECT_THAT(order.all(), ElementsAre("stale", "early", "twin", "late"));
}

TEST_F(HostLaw, SamplesRunBeforeWhatIsDue) {
  auto& order = make<Log<std::string>>();
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", milliseconds(150), [&](auto) { order.add("tick"); });
    host.input(kEvents, {}, [&](const Message& each, const auto&) { order.add(each.frame_id()); });
  }));
  stage_->publish(kEvents, message("hello"));
  ASSERT_TRUE(wait_for(order, 1));
  stage_->hold("subject", milliseconds(250));
  stage_->run_for(milliseconds(180));
  stage_->publish(kEvents, message("sample"));
  ASSERT_TRUE(wait_for(order, 3));
  EXPECT_THAT(order.all(), ElementsAre("hello", "sample", "tick"));
}

struct Tick {
  Time now{};
  std::uint64_t skipped = 0;
};

TEST_F(HostLaw, TimersDoNotDriftAndCountWhatTheySkipped) {
  constexpr Duration kPeriod = milliseconds(10);
  auto& ticks = make<Log<Tick>>();
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", kPeriod, [&](std::uint64_t skipped) {
      ticks.add({host.now(), skipped});
    });
  }));
  for (int i = 0; i < 8; ++i) {
    stage_->run_for(milliseconds(43));
    stage_->hold("subject", milliseconds(37));
    stage_->run_for(milliseconds(60));
  }
  const auto all = ticks.all();
  ASSERT_GT(all.size(), 30U);
  std::int64_t periods = 0;
  std::uint64_t skipped = 0;
  // The first may have been late itself; after it every period is either a call or counted as
  // skipped.
  for (std::size_t i = 1; i < all.size(); ++i) {
    periods += 1 + static_cast<std::int64_t>(all[i].skipped);
    skipped += all[i].skipped;
    const Duration expected = periods * kPeriod, real = all[i].now - all[0].now;
    EXPECT_LT(real - expected, kPeriod) << "tick " << i;
    EXPECT_GT(real - expected, -kPeriod - stage_->tolerance()) << "tick " << i;
  }
  EXPECT_GE(skipped, 8U * 2);
  const auto beats = stage_->heartbeats("subject");
  ASSERT_FALSE(beats.empty());
  ASSERT_FALSE(beats.back().counters().empty());
  EXPECT_EQ(beats.back().counters()[0].name(), "timer tick: skipped");
}

TEST_F(HostLaw, ATimerIsFirstDueOnePeriodAfterStartOrRestartAndStops) {
  auto& ticks = make<Log<Tick>>();
  auto& restarted = make<Log<Tick>>();
  auto& stopped = make<std::atomic<bool>>(false);
  struct State {
    Timer once, second;
    Time start{};
  };
  auto& constructed = make<Time>();
  start(scripted<State>([&](Host& host, State& state) {
    constructed = host.now();
    state.once = host.timer("once", milliseconds(50), [&](std::uint64_t skipped) {
      EXPECT_FALSE(stopped);
      ticks.add({host.now(), skipped});
      state.once.stop();
      stopped = true;
      state.second.restart(milliseconds(70));
    });
    state.second = host.timer("second", Duration::zero(), [&](std::uint64_t skipped) {
      restarted.add({host.now(), skipped});
      state.second.stop();
    });
  }));
  ASSERT_TRUE(wait_for(restarted, 1));
  stage_->run_for(milliseconds(200));
  ASSERT_EQ(ticks.size(), 1U);
  ASSERT_EQ(restarted.size(), 1U);
  EXPECT_GE(ticks.all()[0].now - constructed, milliseconds(50));
  EXPECT_GE(restarted.all()[0].now - ticks.all()[0].now, milliseconds(70));
  EXPECT_LE(restarted.all()[0].now - ticks.all()[0].now,
            milliseconds(70) + 2 * stage_->tolerance());
}

}  // namespace
}  // namespace usher::conformance
