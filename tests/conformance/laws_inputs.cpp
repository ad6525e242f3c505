// Inputs: depth, latched values, ages, bytes that are no message, who writes.
#include <atomic>
#include <map>
#include <mutex>

#include "conformance/laws.hpp"

namespace usher::conformance {
namespace {

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
  auto& stale = make<std::atomic<int>>(0);
  struct State {
    Input<Message> input;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.input = host.input(kEvents, {milliseconds(500), "nothing"},
                             [&](const Message& each, const SampleInfo& info) {
                               seen.add({each.frame_id(), host.now(), info});
                               stale += state.input.fresh() == nullptr;
                             });
  }));
  const Time now = stage_->now();
  const Sender stranger{"stranger", "elsewhere"};
  stage_->publish(kEvents, message("recent", now - milliseconds(10)));
  stage_->publish(kEvents, message("future", now + seconds(100)));
  stage_->publish(kEvents, message("old elsewhere", now - seconds(2)), stranger);
  ASSERT_TRUE(wait_for(seen, 3));
  for (const Seen& each : seen.all()) {
    const SampleInfo& info = each.info;
    EXPECT_EQ(info.same_host, each.text != "old elsewhere") << each.text;
    EXPECT_EQ(info.effective, each.text == "recent" ? now - milliseconds(10) : info.arrival)
        << each.text;
  }
  EXPECT_EQ(stale, 0);
}

TEST_F(HostLaw, ASampleThatIsTooOldWhenItComesRunsNoHandlerAndReplacesNoneThatIsNot) {
  auto& seen = make<Log<Seen>>();
  auto& newest = make<Log<std::string>>();
  struct State {
    Input<Message> input;
    Timer timer;
  };
  start(scripted<State>([&](Host& host, State& state) {
    state.input = host.input(kEvents, {seconds(1), "nothing"},
                             [&](const Message& each, const SampleInfo& info) {
                               seen.add({each.frame_id(), host.now(), info});
                             });
    state.timer = host.timer("tick", milliseconds(10), [&](auto) {
      if (state.input.fresh() != nullptr) newest.add(state.input.fresh()->frame_id());
    });
  }));
  stage_->publish(kEvents, message("unset"));  // a time that is unset is never fresh
  stage_->publish(kEvents, message("recent", stage_->now()));
  ASSERT_TRUE(wait_for(seen, 1));
  stage_->publish(kEvents, message("old", stage_->now() - seconds(2)));
  ASSERT_TRUE(stage_->run_until(
      [&] {
        const auto beat = newest_heartbeat("subject");
        return beat.counters().size() == 1 && beat.counters()[0].count() == 2;
      },
      kSoon));
  EXPECT_EQ(newest_heartbeat("subject").counters()[0].name(), "test/events: late");
  EXPECT_EQ(texts(seen.all()), std::vector<std::string>{"recent"});
  for (const std::string& each : newest.all()) EXPECT_EQ(each, "recent");
  EXPECT_GT(newest.size(), 0U);
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

}  // namespace
}  // namespace usher::conformance
