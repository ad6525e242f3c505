#include "wire/pitch_input.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "runtime/testing/test_host.hpp"

namespace usher::wire {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using namespace usher_msgs::msg::BaseStatus_Constants;

/// What the newest Leaning heard.
int pitches = 0;
const PitchInput* leaning = nullptr;

class Leaning final : public runtime::Component {
 public:
  explicit Leaning(runtime::Host& host)
      : pitch_(host, "falls over", [&host] {
          ++pitches;
          host.health().set(runtime::HealthState::kOk);
        }) {
    leaning = &pitch_;
  }

 private:
  PitchInput pitch_;
};

class PitchInputTest : public testing::Test {
 protected:
  PitchInputTest() { pitches = 0; }
  /// A status stamped `ahead_ms` from now, after 10 ms.
  void status(int ahead_ms = 0, double pitch = 0.1, std::uint8_t state = STATE_BALANCING) {
    host.run_for(milliseconds(10));
    usher_msgs::msg::BaseStatus message;
    message.header(header(host.now() + milliseconds(ahead_ms), "base_link"));
    message.state(state);
    message.pitch(pitch);
    host.publish(topics::kBaseStatus, message);
  }
  std::string reason() const { return host.heartbeat().reason(); }
  std::uint64_t refused() {
    host.run_for(milliseconds(100));
    return host.counter("base/status: refused");
  }

  runtime::TestHost host{runtime::component_factory<Leaning>("leaning")};
};

TEST_F(PitchInputTest, OneStatusFromTheFutureDoesNotMakeTheLaterOnesOld) {
  status(10'000);
  EXPECT_EQ(pitches, 0);
  for (int i = 0; i < 5; ++i) status();
  host.run_for(milliseconds(1));
  EXPECT_EQ(pitches, 5);
  EXPECT_EQ(refused(), 1U);
}

TEST(UprightPitch, IsKnownAtAnyTimeWhileTheBaseIsConnected) {
  runtime::TestHost host{runtime::component_factory<Leaning>("leaning"), "robot.base: pioneer"};
  const auto report = [&](runtime::Time stamp, std::uint8_t state) {
    usher_msgs::msg::BaseStatus message;
    message.header(header(stamp, "base_link"));
    message.state(state);
    for (int i = 0; i < 10; ++i) {  // ten statuses tell of one report
      host.run_for(milliseconds(12));
      host.publish(topics::kBaseStatus, message);
    }
    host.run_for(milliseconds(1));
  };
  for (int i = 0; i < 5; ++i) {
    report(host.now(), STATE_BALANCING);
    const auto pitch = leaning->at(host.now());
    ASSERT_TRUE(pitch.ok()) << pitch.error();
    EXPECT_EQ(pitch->angle, 0.0);
  }
  EXPECT_EQ(host.counter("base/status: refused"), 0U);
  report(host.now(), STATE_DISCONNECTED);
  EXPECT_FALSE(leaning->at(host.now()).ok());
  host.run_for(milliseconds(100));
  EXPECT_EQ(host.heartbeat().reason(), "no pitch: the base is disconnected");
}

TEST_F(PitchInputTest, AClockThatIsALittleAheadCounts) {
  for (int i = 0; i < 5; ++i) status(15);
  host.run_for(milliseconds(1));
  EXPECT_EQ(pitches, 5);
  EXPECT_EQ(refused(), 0U);
}

TEST_F(PitchInputTest, SaysWhyItHasHadNoPitchFor100Milliseconds) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int round = 0; round < 20; ++round) {  // one in 90 ms is enough
    status();
    for (int i = 0; i < 8; ++i) status(0, kNan);
    EXPECT_EQ(reason(), "");
  }
  for (int i = 0; i < 22; ++i) status(0, kNan);  // a heartbeat is up to 100 ms old
  EXPECT_THAT(reason(), HasSubstr("no pitch: pitch must be within 1.5 rad"));
  for (int i = 0; i < 22; ++i) status(0, 0.1, STATE_DISCONNECTED);
  EXPECT_EQ(reason(), "no pitch: the base is disconnected");
  for (int i = 0; i < 11; ++i) status();
  EXPECT_EQ(reason(), "");
  EXPECT_EQ(refused(), 20U * 8U + 22U) << "a base that is not connected sends nothing wrong";
}

TEST_F(PitchInputTest, SaysThatTheBaseIsSilent) {
  for (int i = 0; i < 11; ++i) status();
  EXPECT_EQ(reason(), "");
  host.run_for(milliseconds(210));
  EXPECT_EQ(reason(), "no pitch");
}

}  // namespace
}  // namespace usher::wire
