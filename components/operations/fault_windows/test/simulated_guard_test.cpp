#include "operations/fault_windows/simulated_guard.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "idl/topics.hpp"
#include "runtime/testing/test_host.hpp"

namespace usher::operations {
namespace {

using std::chrono::milliseconds;

/// Drives along a bend.
class Driver final : public runtime::Component {
 public:
  explicit Driver(runtime::Host& host)
      : base_(host.output(topics::kSimBaseCommand)),
        timer_(host.timer("drive", milliseconds(10), [this](auto) {
          usher_sim_msgs::msg::BaseCommand command;
          command.v(0.5);
          command.w(0.6);
          base_.publish(command);
        })) {}

 private:
  runtime::Output<usher_sim_msgs::msg::BaseCommand> base_;
  runtime::Timer timer_;
};

TEST(SimulatedGuard, KeepsABaseOnItsArcWhoseDriverHangsOrDies) {
  for (const bool dies : {false, true}) {
    runtime::TestHost host{runtime::component_factory<Driver>("segway_rmp_sim"), "{}"};
    auto& world = host.world();
    SimulatedGuard guard(world, host.name(), milliseconds(50));
    std::vector<usher_sim_msgs::msg::BaseCommand> told;
    world.observe(topics::kSimBaseCommand,
                  [&](const auto& command, const auto&) { told.push_back(command); });
    host.run_for(milliseconds(500));
    ASSERT_EQ(told.back().v(), 0.5);
    if (dies) {
      world.kill(host.name());
    } else {
      world.hang(host.name(), std::chrono::seconds(3));
    }
    host.run_for(milliseconds(200));
    EXPECT_EQ(told.back().v(), 0.0);
    EXPECT_EQ(told.back().w(), 0.6) << (dies ? "dies" : "hangs");
    host.run_for(milliseconds(1000));
    EXPECT_EQ(told.back().v(), 0.0);
    EXPECT_EQ(told.back().w(), 0.0) << "no longer than it may roll";
  }
}

}  // namespace
}  // namespace usher::operations
