// Topics of a fleet: who hears them, and what a robot without a fleet has of them.
#include <algorithm>

#include "conformance/laws.hpp"

namespace usher::conformance {
namespace {

inline constexpr Topic kTold{"fleet/test/told",    topics::Kind::kLatched, 1, 0, "*", "",
                             topics::Scope::kFleet};
inline constexpr Topic kOwn{"test/own", topics::Kind::kLatched, 1, 0, "*", ""};

Stage::Role of(const std::string& robot, const std::string& name = "subject") {
  Stage::Role role;
  role.name = name;
  role.robot = robot;
  return role;
}
/// Says its robot's name on a topic of the fleet and on one of its own, again and again.
Stage::Make tells() {
  struct State {
    Output<Message> told, own;
  };
  return scripted<State>([](Host& host, State& state) {
    state.told = host.output(kTold);
    state.own = host.output(kOwn);
    host.timer("tell", milliseconds(50), [&host, &state](auto) {
      state.told.publish(message(host.robot_name(), host.now()));
      state.own.publish(message(host.robot_name(), host.now()));
    });
  });
}

struct Heard {
  Log<std::string> told, own;
  Log<std::vector<std::string>> each;
  Log<Time> lost;
};
/// Writes down what it hears of both.
Stage::Make hears(Heard& heard) {
  struct State {
    Input<Message> told;
  };
  return scripted<State>([&heard](Host& host, State& state) {
    state.told = host.input(
        kTold, {.max_age = milliseconds(400), .on_loss = "is alone", .each_writer = true},
        [&heard](const Message& each, const auto&) { heard.told.add(each.frame_id()); },
        [&heard, &host] { heard.lost.add(host.now()); });
    host.input(kOwn, {},
               [&heard](const Message& each, const auto&) { heard.own.add(each.frame_id()); });
    host.timer("look", milliseconds(50), [&heard, &state](auto) {
      std::vector<std::string> names;
      for (const Message* each : state.told.fresh_of_each()) names.push_back(each->frame_id());
      std::sort(names.begin(), names.end());
      heard.each.add(names);
    });
  });
}

bool has(const Log<std::string>& log, const std::string& text) {
  const auto all = log.all();
  return std::find(all.begin(), all.end(), text) != all.end();
}

TEST_F(HostLaw, ATopicOfTheFleetReachesEveryRobotAndAllOthersOnlyTheirOwn) {
  auto& heard = make<Heard>();
  ASSERT_TRUE(start(of("iris", "teller"), tells()).ok());
  ASSERT_TRUE(start(of("otto", "teller"), tells()).ok());
  ASSERT_TRUE(start(of("otto", "hearer"), hears(heard)).ok());
  EXPECT_TRUE(
      stage_->run_until([&] { return has(heard.told, "iris") && has(heard.told, "otto"); }, kSoon));
  EXPECT_TRUE(stage_->run_until([&] { return has(heard.own, "otto"); }, kSoon));
  stage_->run_for(milliseconds(300));
  EXPECT_FALSE(has(heard.own, "iris"));
}

TEST_F(HostLaw, TheSilenceOfOneRobotIsSeenThoughOthersGoOn) {
  auto& heard = make<Heard>();
  ASSERT_TRUE(start(of("iris", "teller"), tells()).ok());
  ASSERT_TRUE(start(of("otto", "teller"), tells()).ok());
  ASSERT_TRUE(start(of("otto", "hearer"), hears(heard)).ok());
  const auto newest = [&] {
    const auto all = heard.each.all();
    return all.empty() ? std::vector<std::string>{} : all.back();
  };
  EXPECT_TRUE(stage_->run_until([&] { return newest().size() == 2; }, kSoon));
  stage_->stop("iris/teller");
  EXPECT_TRUE(
      stage_->run_until([&] { return newest() == std::vector<std::string>{"otto"}; }, kSoon));
  EXPECT_EQ(heard.lost.size(), 0U) << "the input as a whole is fresh";
  stage_->stop("otto/teller");
  EXPECT_TRUE(stage_->run_until([&] { return newest().empty() && heard.lost.size() == 1; }, kSoon));
}

TEST_F(HostLaw, ARobotInNoFleetHasPortsOfItThatAreSilentAndNeverStale) {
  auto& heard = make<Heard>();
  ASSERT_TRUE(start(of("", "teller"), tells()).ok());
  ASSERT_TRUE(start(of("", "hearer"), hears(heard)).ok());
  EXPECT_TRUE(stage_->run_until([&] { return heard.own.size() > 10; }, kSoon));
  stage_->run_for(milliseconds(600));
  EXPECT_EQ(heard.told.size(), 0U);
  EXPECT_EQ(heard.lost.size(), 0U);
}

}  // namespace
}  // namespace usher::conformance
