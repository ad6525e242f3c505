#include "runtime/testing/test_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// How the test of a shell looks: make it, speak to it, look at what it wrote.
namespace usher::runtime {
namespace {

using std::chrono::milliseconds;

/// Repeats velocities of the operator, limited, and stops when none comes.
class Limiter final : public Component {
 public:
  explicit Limiter(Host& host)
      : limit_(host.parameters().number("limit", "m/s", {0, 2}, 0.5, "Highest speed.")),
        output_(host.output(topics::kCmdVelNavigation)) {
    host.input(
        topics::kCmdVelManual, {milliseconds(200), "stops"},
        [this, &host](const auto& command, const auto&) {
          geometry_msgs::msg::TwistStamped limited = command;
          if (command.twist().linear().x() > limit_) {
            limited.twist().linear().x(limit_);
            ++host.health().counter("limited");
          }
          if (command.twist().linear().x() > 100) host.fault("this is no aeroplane");
          output_.publish(limited);
        },
        [this] { output_.publish({}); });
    host.health().set(HealthState::kOk);
  }

 private:
  double limit_;
  Output<geometry_msgs::msg::TwistStamped> output_;
};

geometry_msgs::msg::TwistStamped twist(double v, Time stamp) {
  geometry_msgs::msg::TwistStamped result;
  const auto nanoseconds = stamp.time_since_epoch().count();
  result.header().stamp().sec(static_cast<std::int32_t>(nanoseconds / 1'000'000'000));
  result.header().stamp().nanosec(static_cast<std::uint32_t>(nanoseconds % 1'000'000'000));
  result.twist().linear().x(v);
  return result;
}

TEST(Limiter, PassesWhatIsSlowAndLimitsTheRest) {
  TestHost host(component_factory<Limiter>("limiter"), "limit: 0.8 m/s");
  host.publish(topics::kCmdVelManual, twist(0.3, host.now()));
  host.run_for(milliseconds(1));
  EXPECT_EQ(host.last(topics::kCmdVelNavigation)->twist().linear().x(), 0.3);
  host.publish(topics::kCmdVelManual, twist(3.0, host.now()));
  host.run_for(milliseconds(100));
  EXPECT_EQ(host.last(topics::kCmdVelNavigation)->twist().linear().x(), 0.8);
  EXPECT_EQ(host.written(topics::kCmdVelNavigation).size(), 2U);
  EXPECT_EQ(host.counter("limited"), 1U);
  EXPECT_EQ(host.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_OK);
}

TEST(Limiter, StopsWhenNobodySpeaks) {
  TestHost host(component_factory<Limiter>("limiter"));
  host.publish(topics::kCmdVelManual, twist(0.3, host.now()));
  host.run_for(milliseconds(199));
  EXPECT_EQ(host.last(topics::kCmdVelNavigation)->twist().linear().x(), 0.3);
  host.run_for(milliseconds(2));
  EXPECT_EQ(host.last(topics::kCmdVelNavigation)->twist().linear().x(), 0.0);
  host.clear();
  host.run_for(milliseconds(500));
  EXPECT_FALSE(host.last(topics::kCmdVelNavigation)) << "it says so once";
}

TEST(Limiter, RefusesAWrongLimit) {
  const auto error =
      TestHost::try_make(component_factory<Limiter>("limiter"), "limit: 3 m/s").error();
  EXPECT_EQ(error, "limit must be in [0, 2] m/s, got 3 m/s (limiter:5)");
  EXPECT_THROW(TestHost(component_factory<Limiter>("limiter"), "limit: 3 m/s"), std::runtime_error);
}

TEST(Limiter, EndsWithAFaultWhenAskedToFly) {
  TestHost host(component_factory<Limiter>("limiter"));
  host.publish(topics::kCmdVelManual, twist(1000, host.now()));
  host.run_for(milliseconds(10));
  EXPECT_FALSE(host.running());
  EXPECT_EQ(host.fault_reason(), "this is no aeroplane");
  EXPECT_EQ(host.heartbeat().state(), usher_msgs::msg::Heartbeat_Constants::STATE_FAULT);
  EXPECT_FALSE(host.last(topics::kCmdVelNavigation)) << "nothing of that handler left";
}

}  // namespace
}  // namespace usher::runtime
