#include "wire/keeper.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using std::chrono::milliseconds;

constexpr const char* kCounter = "latch: not kept";

/// Keeps the frame of every transform that it hears of.
class Rememberer final : public runtime::Component {
 public:
  explicit Rememberer(runtime::Host& host)
      : memory(host, "latch", [this](const Status& kept) { told.push_back(kept.ok()); }),
        input(host.input(topics::kGoalPose, {.optional = true},
                         [this](const auto& goal, const auto&) {
                           for (char c : goal.header().frame_id()) memory.keep(std::string(1, c));
                           if (goal.header().frame_id().empty())
                             memory.keep(std::string(2 << 20, 'x'));
                         })) {
    newest = this;
  }
  Keeper memory;
  std::vector<bool> told;
  runtime::Input<geometry_msgs::msg::PoseStamped> input;
  static Rememberer* newest;
};
Rememberer* Rememberer::newest = nullptr;

class KeeperTest : public testing::Test {
 protected:
  /// One after the other; empty: more than can be kept.
  void keep(const std::string& values, int ms = 50) {
    geometry_msgs::msg::PoseStamped goal;
    goal.header().frame_id(values);
    host.publish(topics::kGoalPose, goal);
    host.run_for(milliseconds(ms));
  }
  std::string on_the_disk() {
    const auto& kept = host.world().kept(host.name());
    const auto found = kept.find("latch");
    return found == kept.end() ? "nothing"
                               : std::string(found->second.begin(), found->second.end());
  }
  static const std::vector<bool>& told() { return Rememberer::newest->told; }
  runtime::TestHost host{runtime::component_factory<Rememberer>("rememberer")};
};

TEST_F(KeeperTest, WritesTheFirstAndThenTheNewest) {
  keep("abcd", 6);
  EXPECT_EQ(on_the_disk(), "a");
  host.run_for(milliseconds(50));
  EXPECT_EQ(on_the_disk(), "d");
  EXPECT_EQ(told().size(), 2U) << "not those between";
  keep("d");
  EXPECT_EQ(told().size(), 2U) << "nothing new";
}

TEST_F(KeeperTest, FindsWhatAnEarlierLifeKept) {
  EXPECT_EQ(Rememberer::newest->memory.found(), "");
  keep("a");
  host.world().kill(host.name());
  host.run_for(milliseconds(10));
  host.world().start(host.name());
  host.run_for(milliseconds(10));
  EXPECT_EQ(Rememberer::newest->memory.found(), "a");
  keep("a");
  EXPECT_TRUE(told().empty()) << "it lies there";
}

TEST_F(KeeperTest, WhatCannotBeReadEndsTheComponentAndIsNotTakenForNone) {
  keep("a");
  host.world().kill(host.name());
  host.world().unreadable(host.name()).insert("latch");
  host.world().start(host.name());
  host.run_for(milliseconds(10));
  EXPECT_FALSE(host.running());
  EXPECT_EQ(host.fault_reason(),
            "what was kept over the restart cannot be read: cannot read latch: Input/output error");
  host.world().unreadable(host.name()).clear();
  host.world().start(host.name());
  host.run_for(milliseconds(10));
  EXPECT_EQ(Rememberer::newest->memory.found(), "a") << "and is not overwritten meanwhile";
}

TEST_F(KeeperTest, TriesAgainEachSecondAndSaysSo) {
  keep("a");
  keep("");
  EXPECT_EQ(told().back(), false);
  keep("a", 900);
  EXPECT_EQ(told().size(), 2U) << "not before a second has passed";
  host.run_for(milliseconds(200));
  EXPECT_EQ(told(), (std::vector<bool>{true, false, true})) << "though it was that before";
  EXPECT_EQ(on_the_disk(), "a");
  EXPECT_EQ(host.counter(kCounter), 1U);
}

}  // namespace
}  // namespace usher::wire
