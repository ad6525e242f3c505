// The host laws, judged over whichever stage is linked. Where a real machine may be late, the stage
// says by how much; no law is weaker for it, since each is stated on what the component itself can
// observe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "conformance/stage.hpp"

namespace usher::conformance {
namespace {

using runtime::HealthState;
using runtime::Input;
using runtime::Output;
using runtime::SampleInfo;
using runtime::Timer;
using runtime::WriterInfo;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kDepth = 8;
constexpr Topic kEvents{"test/events", topics::Kind::kEvent, kDepth, 0, "*", ""};
constexpr Topic kOthers{"test/others", topics::Kind::kEvent, kDepth, 0, "*", ""};
constexpr Topic kReplies{"test/replies", topics::Kind::kEvent, 64, 0, "*", ""};
constexpr Topic kLatched{"test/latched", topics::Kind::kLatched, 1, 0, "*", ""};
constexpr Duration kSoon = seconds(5);  ///< limit of waiting for what comes at once

/// A component made of a function: whatever it returns lives as long as the component.
class Scripted final : public Component {
 public:
  explicit Scripted(std::shared_ptr<void> state) : state_(std::move(state)) {}

 private:
  std::shared_ptr<void> state_;
};
template <class State>
Stage::Make scripted(std::function<void(Host&, State&)> script) {
  return [script](Host& host) {
    auto state = std::make_shared<State>();
    script(host, *state);
    return std::make_unique<Scripted>(state);
  };
}
struct Nothing {};

class HostLaw : public ::testing::Test {
 protected:
  Status start(const Stage::Role& role, Stage::Make make) {
    return stage_->start(role, std::move(make));
  }
  void start(Stage::Make make) { ASSERT_TRUE(start({}, std::move(make)).ok()); }
  template <class Entry>
  bool wait_for(const Log<Entry>& log, std::size_t count) {
    return stage_->run_until([&] { return log.size() >= count; }, kSoon);
  }

  /// An empty one before the first.
  usher_msgs::msg::Heartbeat newest_heartbeat(const std::string& name) {
    const auto beats = stage_->heartbeats(name);
    return beats.empty() ? usher_msgs::msg::Heartbeat() : beats.back();
  }
  /// What handlers refer to lives longer than the stage on which they run.
  template <class T, class... Arguments>
  T& make(Arguments&&... arguments) {
    auto made = std::make_shared<T>(std::forward<Arguments>(arguments)...);
    props_.push_back(made);
    return *made;
  }

 private:
  std::vector<std::shared_ptr<void>> props_;

 protected:
  std::unique_ptr<Stage> stage_ = make_stage();
};

struct Seen {
  std::string text;
  Time now{};
  SampleInfo info{};
};
std::vector<std::string> texts(const std::vector<Seen>& all) {
  std::vector<std::string> result;
  for (const Seen& each : all) result.push_back(each.text);
  return result;
}

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

TEST_F(HostLaw, WhatIsDueRunsInOrderOfTimeThenOfDeclaration) {
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
  EXPECT_THAT(order.all(), ElementsAre("early", "twin", "stale", "late"));
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

TEST_F(HostLaw, DepthIsHonouredAndLossesAreCounted) {
  auto& seen = make<Log<Seen>>();
  auto& lost = make<std::atomic<std::uint64_t>>(0);
  start(scripted<Input<Message>>([&](Host& host, Input<Message>& input) {
    input = host.input(kEvents, {}, [&](const Message& each, const SampleInfo& info) {
      seen.add({each.frame_id(), host.now(), info});
      lost = input.lost();
    });
  }));
  stage_->publish(kEvents, message("hello"));
  ASSERT_TRUE(wait_for(seen, 1));
  stage_->hold("subject", milliseconds(200));
  stage_->run_for(milliseconds(50));
  std::vector<Message> many;
  for (int i = 0; i < kDepth + 5; ++i) many.push_back(message(i));
  stage_->publish_all(kEvents, many, {});
  ASSERT_TRUE(wait_for(seen, 1 + kDepth));
  EXPECT_EQ(seen.all()[1].text, "5");  // the oldest went
  EXPECT_EQ(seen.all().back().text, std::to_string(kDepth + 4));
  EXPECT_EQ(lost, 5U);
  ASSERT_TRUE(
      stage_->run_until([&] { return newest_heartbeat("subject").samples_lost() == 5; }, kSoon));
  const auto beat = newest_heartbeat("subject");
  ASSERT_EQ(beat.counters().size(), 1U);
  EXPECT_EQ(beat.counters()[0].name(), "test/events: lost");
  EXPECT_EQ(beat.counters()[0].count(), 5U);
}

TEST_F(HostLaw, ALatchedInputGetsTheLastValueOfALivingWriterHoweverLate) {
  struct State {
    Output<Message> output;
  };
  ASSERT_TRUE(start({"writer"}, scripted<State>([](Host& host, State& state) {
                      state.output = host.output(kLatched);
                      state.output.publish(message("old"));
                      state.output.publish(message("new"));
                    }))
                  .ok());
  stage_->settle();
  stage_->run_for(milliseconds(500));
  auto& seen = make<Log<Seen>>();
  const auto reader = scripted<Nothing>([&](Host& host, Nothing&) {
    host.input(kLatched, {}, [&](const Message& each, const SampleInfo& info) {
      seen.add({each.frame_id(), host.now(), info});
    });
  });
  ASSERT_TRUE(start({"reader"}, reader).ok());
  ASSERT_TRUE(wait_for(seen, 1));
  stage_->run_for(milliseconds(300));
  EXPECT_THAT(texts(seen.all()), ElementsAre("new"));
  EXPECT_EQ(newest_heartbeat("reader").samples_lost(), 0U) << "only the last value was sent";

  stage_->stop("writer");
  stage_->run_for(milliseconds(300));
  auto& later = make<Log<Seen>>();
  ASSERT_TRUE(start({"late"}, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.input(kLatched, {}, [&](const Message& each, const SampleInfo& info) {
                        later.add({each.frame_id(), host.now(), info});
                      });
                    }))
                  .ok());
  stage_->run_for(milliseconds(500));
  EXPECT_EQ(later.size(), 0U) << "a value without a living writer";
}

TEST_F(HostLaw, ARepeatedLatchedValueChangesNothing) {
  auto& seen = make<Log<Seen>>();
  auto& losses = make<std::atomic<int>>(0);
  ASSERT_TRUE(
      start({"reader", "there"}, scripted<Input<Message>>([&](Host& host, Input<Message>& input) {
              input = host.input(
                  kLatched, {seconds(1), "nothing"},
                  [&](const Message& each, const SampleInfo& info) {
                    seen.add({each.frame_id(), host.now(), info});
                  },
                  [&] { ++losses; });
            }))
          .ok());
  stage_->settle();
  stage_->publish(kLatched, message("once"));
  ASSERT_TRUE(wait_for(seen, 1));
  if (!stage_->cut("here", "there", seconds(3))) GTEST_SKIP() << "this stage cannot cut links";
  stage_->run_for(seconds(6));
  EXPECT_EQ(seen.size(), 1U) << "it came again after the new match";
  EXPECT_EQ(losses, 1);
  stage_->publish(kLatched, message("twice"));
  ASSERT_TRUE(wait_for(seen, 2)) << "what is new must come";
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

TEST_F(HostLaw, OutputsLeaveWhenTheHandlerReturns) {
  auto& seen = make<Log<Seen>>();
  auto& written = make<Log<Time>>();
  ASSERT_TRUE(start({"reader"}, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.input(kReplies, {}, [&](const Message& each, const SampleInfo& info) {
                        seen.add({each.frame_id(), host.now(), info});
                      });
                    }))
                  .ok());
  auto& role = make<Stage::Role>();
  role.name = "writer";
  role.work = milliseconds(50);
  struct State {
    Output<Message> output;
    Timer timer;
  };
  ASSERT_TRUE(start(role, scripted<State>([&](Host& host, State& state) {
                      state.output = host.output(kReplies);
                      state.timer = host.timer("tick", milliseconds(100), [&](auto) {
                        if (state.output.reader_count() == 0) return;
                        written.add(host.now());
                        for (int i = 0; i < 3; ++i) state.output.publish(message(i));
                        stage_->work(role);
                      });
                    }))
                  .ok());
  ASSERT_TRUE(wait_for(seen, 3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(seen.all()[i].text, std::to_string(i));
    EXPECT_GE(seen.all()[i].info.arrival - written.all()[0], milliseconds(50));
  }
}

TEST_F(HostLaw, NothingOfAFaultyHandlerLeavesAndNoHandlerRunsAfterIt) {
  auto& seen = make<Log<Seen>>();
  ASSERT_TRUE(start({"reader"}, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.input(kReplies, {}, [&](const Message& each, const SampleInfo& info) {
                        seen.add({each.frame_id(), host.now(), info});
                      });
                    }))
                  .ok());
  auto& after = make<std::atomic<int>>(0);
  auto& faults = make<std::atomic<int>>(0);
  struct State {
    Output<Message> output;
    Timer timer;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.output = host.output(kReplies);
    host.health().set(HealthState::kOk);
    host.input(kEvents, {}, [&](const Message& each, const SampleInfo&) {
      if (faults > 0) ++after;
      state.output.publish(each);
      if (each.frame_id() == "bad") {
        ++faults;
        host.fault("the laser is upside down");
      }
    });
    state.timer = host.timer("tick", milliseconds(5), [&](auto) {
      if (faults > 0) ++after;
    });
  }));
  stage_->settle();
  stage_->publish(kEvents, message("good"));
  ASSERT_TRUE(wait_for(seen, 1));
  stage_->hold("subject", milliseconds(100));
  stage_->run_for(milliseconds(20));
  stage_->publish_all(kEvents, {message("fine"), message("bad"), message("unseen")}, {});
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  stage_->run_for(milliseconds(200));
  EXPECT_EQ(stage_->exit_code("subject"), 3);
  EXPECT_EQ(after, 0);
  EXPECT_THAT(texts(seen.all()), ElementsAre("good", "fine"));
  const auto beats = stage_->heartbeats("subject");
  ASSERT_GE(beats.size(), 2U);
  EXPECT_EQ(beats.back().state(), usher_msgs::msg::Heartbeat_Constants::STATE_FAULT);
  EXPECT_EQ(beats.back().reason(), "the laser is upside down");
  for (std::size_t i = 0; i + 1 < beats.size(); ++i) {
    EXPECT_EQ(beats[i].state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
  }
}

TEST_F(HostLaw, AnExceptionIsAFault) {
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", milliseconds(50),
                       [](auto) { throw std::runtime_error("out of chalk"); });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  EXPECT_EQ(stage_->exit_code("subject"), 3);
  ASSERT_TRUE(stage_->run_until(
      [&] {
        const auto beats = stage_->heartbeats("subject");
        return !beats.empty() &&
               beats.back().state() == usher_msgs::msg::Heartbeat_Constants::STATE_FAULT;
      },
      kSoon));
  EXPECT_EQ(newest_heartbeat("subject").reason(), "timer tick threw: out of chalk");
}

TEST_F(HostLaw, AFaultThatTheHandlerSwallowsIsStillOne) {
  auto& seen = make<Log<Seen>>();
  ASSERT_TRUE(start({"reader"}, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.input(kReplies, {}, [&](const Message& each, const SampleInfo& info) {
                        seen.add({each.frame_id(), host.now(), info});
                      });
                    }))
                  .ok());
  struct State {
    Output<Message> output;
    Timer timer;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.output = host.output(kReplies);
    state.timer = host.timer("tick", milliseconds(200), [&](auto) {
      state.output.publish(message("from the grave"));
      try {
        host.fault("really");
      } catch (...) {
      }
    });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  stage_->run_for(milliseconds(100));
  EXPECT_EQ(stage_->exit_code("subject"), 3);
  EXPECT_EQ(seen.size(), 0U);
}

TEST_F(HostLaw, WrongParametersAreAllToldAndTheComponentNeverAppears) {
  auto& role = make<Stage::Role>();
  role.parameters = "speed: 5 m/s\nspeeed: 1\nname: 3";
  auto& writers = make<Log<WriterInfo>>();
  ASSERT_TRUE(start({"watcher"}, scripted<Nothing>([&](Host& host, Nothing&) {
                      host.watch_writers("test/replies",
                                         [&](const WriterInfo& info) { writers.add(info); });
                    }))
                  .ok());
  const Status status =
      start(role, scripted<Output<Message>>([](Host& host, Output<Message>& output) {
              auto& parameters = host.parameters();
              parameters.number("speed", "m/s", {0, 1}, 0.5, "how fast");
              parameters.number("width", "m", {0.1, 1}, "how wide");
              parameters.text("name", "", "who");
              output = host.output(kReplies);
              output.publish(message("too early"));
            }));
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error(),
              HasSubstr("speed must be in [0, 1] m/s, got 5 m/s (subject.yaml:7)\n"));
  EXPECT_THAT(status.error(), HasSubstr("width must be set to a number in [0.1, 1] m (subject"));
  EXPECT_THAT(status.error(),
              HasSubstr("unknown parameter speeed (subject.yaml:8); did you mean speed?"));
  stage_->run_for(milliseconds(300));
  EXPECT_EQ(writers.size(), 0U);
  EXPECT_TRUE(stage_->heartbeats("subject").empty());
}

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

TEST_F(HostLaw, AnInputThatNeverCameIsReportedOnceAfterItsAge) {
  auto& losses = make<Log<Time>>();
  auto& fresh = make<std::atomic<int>>(0);
  auto& constructed = make<Time>();
  struct State {
    Input<Message> input;
    Timer timer;
  };
  start(scripted<State>([&](Host& host, State& state) {
    constructed = host.now();
    state.input =
        host.input(kEvents, {milliseconds(100), "nothing"}, {}, [&] { losses.add(host.now()); });
    state.timer = host.timer("tick", milliseconds(10), [&](auto) {
      if (state.input.fresh() != nullptr) ++fresh;
    });
  }));
  stage_->run_for(milliseconds(500));
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_GT(losses.all()[0] - constructed, milliseconds(100));
  EXPECT_LE(losses.all()[0] - constructed, milliseconds(101) + 4 * stage_->tolerance());
  EXPECT_EQ(fresh, 0);
}

TEST_F(HostLaw, EachLossOfFreshnessIsReportedOnce) {
  auto& events = make<Log<std::string>>();
  struct State {
    Input<Message> input;
    Timer timer;
    bool was_fresh = false;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.input = host.input(kEvents, {milliseconds(300), "nothing"}, {}, [&] {
      EXPECT_EQ(state.input.fresh(), nullptr);
      state.was_fresh = false;
      events.add("lost");
    });
    state.timer = host.timer("tick", milliseconds(10), [&](auto) {
      const bool is_fresh = state.input.fresh() != nullptr;
      if (is_fresh && !state.was_fresh) events.add("fresh");
      if (!is_fresh && state.was_fresh) events.add("stale without a report");
      state.was_fresh = is_fresh;
    });
  }));
  stage_->run_for(milliseconds(400));
  // A sample that is stale when it comes is no return to freshness.
  stage_->publish(kEvents, message(0, stage_->now() - seconds(1)));
  stage_->run_for(milliseconds(100));
  for (int loss = 0; loss < 3; ++loss) {
    for (int i = 0; i < 4; ++i) {
      stage_->publish(kEvents, message(i, stage_->now()));
      stage_->run_for(milliseconds(30));
    }
    stage_->run_for(milliseconds(600));
  }
  EXPECT_THAT(events.all(), ElementsAre("lost", "fresh", "lost", "fresh", "lost", "fresh", "lost"));
}

TEST_F(HostLaw, AgeCountsFromTheStampOfTheOwnHostAndFromArrivalOtherwise) {
  auto& seen = make<Log<Seen>>();
  auto& fresh = make<std::map<std::string, bool>>();
  auto& mutex = make<std::mutex>();
  struct State {
    Input<Message> input;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.input = host.input(kEvents, {milliseconds(500), "nothing"},
                             [&](const Message& each, const SampleInfo& info) {
                               seen.add({each.frame_id(), host.now(), info});
                               const std::lock_guard lock(mutex);
                               fresh[each.frame_id()] = state.input.fresh() != nullptr;
                             });
  }));
  const Time now = stage_->now();
  const Sender stranger{"stranger", "elsewhere"};
  stage_->publish(kEvents, message("recent", now - milliseconds(10)));
  stage_->publish(kEvents, message("old", now - seconds(2)));
  stage_->publish(kEvents, message("future", now + seconds(100)));
  stage_->publish(kEvents, message("unset"));
  stage_->publish(kEvents, message("old elsewhere", now - seconds(2)), stranger);
  ASSERT_TRUE(wait_for(seen, 5));
  for (const Seen& each : seen.all()) {
    const SampleInfo& info = each.info;
    EXPECT_EQ(info.same_host, each.text != "old elsewhere") << each.text;
    Time expected = info.arrival;
    if (each.text == "recent") expected = now - milliseconds(10);
    if (each.text == "old") expected = now - seconds(2);
    if (each.text == "unset") expected = Time{};
    EXPECT_EQ(info.effective, expected) << each.text;
  }
  const std::lock_guard lock(mutex);
  EXPECT_TRUE(fresh["recent"]);
  EXPECT_FALSE(fresh["old"]);
  EXPECT_TRUE(fresh["future"]);
  EXPECT_FALSE(fresh["unset"]) << "an unset stamp is never fresh";
  EXPECT_TRUE(fresh["old elsewhere"]);
}

TEST_F(HostLaw, BytesThatAreNoMessageAreRejectedAndCounted) {
  auto& seen = make<Log<Seen>>();
  auto& rejected = make<std::atomic<std::uint64_t>>(0);
  struct State {
    Input<Message> input;
    Timer timer;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.input = host.input(kEvents, {}, [&](const Message& each, const SampleInfo& info) {
      seen.add({each.frame_id(), host.now(), info});
    });
    state.timer =
        host.timer("tick", milliseconds(10), [&](auto) { rejected = state.input.rejected(); });
  }));
  const Bytes truncated{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 200, 0, 0, 0, 'a'};
  stage_->publish_bytes(kEvents, truncated);
  stage_->publish_bytes(kEvents, {0, 1, 0, 0});
  stage_->publish(kEvents, message("fine"));
  ASSERT_TRUE(wait_for(seen, 1));
  ASSERT_TRUE(stage_->run_until([&] { return rejected == 2; }, kSoon));
  EXPECT_EQ(texts(seen.all()), std::vector<std::string>{"fine"});
  ASSERT_TRUE(
      stage_->run_until([&] { return !newest_heartbeat("subject").counters().empty(); }, kSoon));
  const auto counters = newest_heartbeat("subject").counters();
  EXPECT_EQ(counters[0].name(), "test/events: rejected");
  EXPECT_EQ(counters[0].count(), 2U);
}

TEST_F(HostLaw, EveryWriterIsSeenBeforeItsFirstSampleAndWhenItEnds) {
  auto& events = make<Log<std::string>>();
  start(scripted<Nothing>([&](Host& host, Nothing&) {
    host.watch_writers("test/events", [&](const WriterInfo& info) {
      events.add((info.alive ? "begin " : "end ") + info.participant + " on " + info.host);
    });
    host.input(kEvents, {},
               [&](const Message& each, const SampleInfo&) { events.add(each.frame_id()); });
  }));
  stage_->publish(kEvents, message("sample"), {"stranger", "elsewhere"});
  ASSERT_TRUE(wait_for(events, 2));
  stage_->leave({"stranger", "elsewhere"});
  ASSERT_TRUE(wait_for(events, 3));
  EXPECT_THAT(events.all(),
              ElementsAre("begin stranger on elsewhere", "sample", "end stranger on elsewhere"));
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
    found.add(kept.ok() ? std::string(kept->begin(), kept->end()) : "nothing");
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

TEST_F(HostLaw, WhatAPolledInputShowsDoesNotChangeInsideAHandler) {
  auto& before = make<Log<std::string>>();
  auto& after = make<Log<std::string>>();
  auto& role = make<Stage::Role>();
  role.work = milliseconds(5);
  struct State {
    Input<Message> input;
    Timer timer;
  };
  ASSERT_TRUE(start(role, scripted<State>([&](Host& host, State& state) {
                      state.input = host.input(kEvents, {});
                      state.timer = host.timer("tick", milliseconds(10), [&](auto) {
                        if (state.input.latest() == nullptr) return;
                        const Message* first = state.input.latest();
                        before.add(first->frame_id());
                        stage_->work(role);
                        EXPECT_EQ(state.input.latest(), first);
                        after.add(state.input.latest()->frame_id());
                      });
                    }))
                  .ok());
  for (int i = 0; i < 100; ++i) {
    stage_->publish(kEvents, message(i));
    stage_->run_for(milliseconds(2));
  }
  ASSERT_TRUE(wait_for(after, 10));
  const auto first = before.all(), second = after.all();
  for (std::size_t i = 0; i < second.size(); ++i) EXPECT_EQ(first[i], second[i]);
  EXPECT_NE(second.front(), second.back());
}

TEST_F(HostLaw, PortsAreDeclaredInTheConstructorOnly) {
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", milliseconds(20), [&](auto) { host.output(kReplies); });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  EXPECT_EQ(stage_->exit_code("subject"), 3);
}

}  // namespace
}  // namespace usher::conformance
