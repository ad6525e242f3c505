// Outputs and faults: all or nothing leaves, and nothing after a fault.
#include <atomic>
#include <stdexcept>

#include "conformance/laws.hpp"

namespace usher::conformance {
namespace {

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
  // The last word may be said more than once.
  const auto ended = std::ranges::find_if(beats, [](const auto& beat) {
    return beat.state() != usher_msgs::msg::Heartbeat_Constants::STATE_OK;
  });
  EXPECT_TRUE(std::all_of(ended, beats.end(), [&](const auto& beat) {
    return beat.state() == beats.back().state() && beat.reason() == beats.back().reason();
  }));
  EXPECT_NE(ended, beats.begin());
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

TEST_F(HostLaw, PortsAreDeclaredInTheConstructorOnly) {
  start(scripted<Timer>([&](Host& host, Timer& timer) {
    timer = host.timer("tick", milliseconds(20), [&](auto) { host.output(kReplies); });
  }));
  ASSERT_TRUE(stage_->run_until([&] { return stage_->exit_code("subject").has_value(); }, kSoon));
  EXPECT_EQ(stage_->exit_code("subject"), 3);
}

}  // namespace
}  // namespace usher::conformance
