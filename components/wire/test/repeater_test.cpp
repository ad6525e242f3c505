#include "wire/repeater.hpp"

#include <gtest/gtest.h>

#include "idl/topics.hpp"
#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using namespace usher_msgs::msg::SupervisorRequest_Constants;
using std::chrono::milliseconds;

class Asker final : public runtime::Component {
 public:
  explicit Asker(runtime::Host& host) : requests(host, topics::kSupervisorRequest) {
    newest = this;
  }
  Repeater<usher_msgs::msg::SupervisorRequest> requests;
  static Asker* newest;
};
Asker* Asker::newest = nullptr;

class RepeaterTest : public testing::Test {
 protected:
  RepeaterTest() { host.run_for(milliseconds(10)); }

  static usher_msgs::msg::SupervisorRequest request(std::uint8_t command) {
    usher_msgs::msg::SupervisorRequest message;
    message.id(requests().next_id());
    message.command(command);
    return message;
  }
  std::uint64_t ask(std::uint8_t command) {
    auto message = request(command);
    const auto id = message.id();
    requests().ask(std::move(message));
    return id;
  }
  std::uint64_t stop() {
    auto message = request(COMMAND_STOP);
    const auto id = message.id();
    requests().ask_first(std::move(message), [](const auto& waiting) {
      return waiting.command() == COMMAND_MOVEMENT_ON;
    });
    return id;
  }
  std::uint8_t asked() {
    host.run_for(milliseconds(250));
    return host.last(topics::kSupervisorRequest).value().command();
  }
  static Repeater<usher_msgs::msg::SupervisorRequest>& requests() {
    return Asker::newest->requests;
  }
  runtime::TestHost host{runtime::component_factory<Asker>("asker")};
};

TEST_F(RepeaterTest, AsksOneAfterTheOther) {
  const auto start = ask(COMMAND_NAVIGATION_START), go = ask(COMMAND_NAVIGATION_GO);
  EXPECT_EQ(asked(), COMMAND_NAVIGATION_START);
  EXPECT_FALSE(requests().answered(start + 100, "asker"));
  EXPECT_TRUE(requests().answered(start, "asker"));
  EXPECT_EQ(asked(), COMMAND_NAVIGATION_GO);
  EXPECT_TRUE(requests().answered(go, "asker"));
  EXPECT_FALSE(requests().waits());
}

TEST_F(RepeaterTest, AnAnswerToAnotherClientIsNone) {
  const auto stop = ask(COMMAND_STOP);
  EXPECT_FALSE(requests().answered(stop, "tablet")) << "ids are unique per client only";
  EXPECT_TRUE(requests().waits());
}

TEST_F(RepeaterTest, AStopWaitsForNoAnswerAndDropsWhatWouldLiftIt) {
  const auto start = ask(COMMAND_NAVIGATION_START);
  ask(COMMAND_MOVEMENT_ON);
  const auto go = ask(COMMAND_NAVIGATION_GO), stopped = stop();
  EXPECT_EQ(asked(), COMMAND_STOP);
  EXPECT_TRUE(requests().answered(start, "asker")) << "that was on its way";
  EXPECT_EQ(asked(), COMMAND_STOP);
  EXPECT_TRUE(requests().answered(stopped, "asker"));
  EXPECT_EQ(asked(), COMMAND_NAVIGATION_GO);
  EXPECT_TRUE(requests().answered(go, "asker"));
  EXPECT_FALSE(requests().waits());
}

TEST_F(RepeaterTest, AStopHasRoomInAFullQueue) {
  for (std::size_t i = 0; i < 2 * Repeater<usher_msgs::msg::SupervisorRequest>::kMostWaiting; ++i)
    ask(COMMAND_NAVIGATION_END);
  stop();
  EXPECT_EQ(asked(), COMMAND_STOP);
}

}  // namespace
}  // namespace usher::wire
