// A stranger who writes samples that are none, or are no longer what they were, on a topic by which
// the simulated robot decides, while it drives: it stands for him, no component ends, and once he
// has left and an operator has cleared that, it drives as if he had never been.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/security/packet_attack.hpp"
#include "support/decided_by.hpp"

namespace usher::operations {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kStranger = "stranger";

struct Attacked {
  std::string topic;
  runtime::Bytes nothing;  ///< a message of it without content
  std::function<void(runtime::LockstepWorld&, const runtime::Bytes&)> write;
};

template <class Message>
runtime::Bytes empty_of(const topics::Topic<Message>& /*topic*/) {
  const Message message;
  runtime::Bytes cdr;
  EXPECT_TRUE(runtime::message_type<Message>().serialize(&message, cdr));
  return cdr;
}

void PrintTo(const Attacked& attacked, std::ostream* out) { *out << attacked.topic; }

std::vector<Attacked> attacked() {
  std::vector<Attacked> all;
  const auto take = [&](const auto& topic) {
    all.push_back(
        {std::string(topic.name), empty_of(topic), [topic](auto& world, const runtime::Bytes& cdr) {
           world.publish_bytes(topic, cdr, kStranger);
         }});
  };
  take(topics::kScan);
  take(topics::kTf);
  test::each_topic_that_it_decides_by(take);
  return all;
}

class MangledSamples : public testing::TestWithParam<Attacked> {};

TEST_P(MangledSamples, AreForgottenWhenTheirWriterHasLeft) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const auto deployment =
      load_deployment(share + "/deploy/marvin-depth-sim.yaml", installation, {});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  LockstepRun* run = nullptr;
  runtime::Bytes heard;  // what the robot itself says there
  std::string reason;
  const auto robot = lockstep_robot(*deployment, 1, [&](LockstepRun& made) {
    run = &made;
    made.world().observe_all([&](const runtime::WrittenSample& sample) {
      const bool own = made.world().participant_of(sample.writer) != kStranger;
      if (own && sample.topic == GetParam().topic) heard = sample.cdr;
    });
    made.world().observe(topics::kSupervisorStatus,
                         [&](const auto& status, const auto&) { reason = status.reason(); });
  });
  ASSERT_TRUE(robot.ok()) << robot.error();
  ASSERT_TRUE((*robot)->send("seminar_room", 12.0).ok());  // on its way
  auto& world = run->world();
  ASSERT_GT(run->record().samples().back().v, 0.2);
  std::map<std::string, std::uint64_t> lives;
  for (const auto& name : world.components()) lives[name] = world.lives(name);

  if (heard.empty()) heard = GetParam().nothing;
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    GetParam().write(world, mangled(heard, random));
    world.run_for(milliseconds(10));
  }
  EXPECT_NE(reason.find(kStranger), std::string::npos) << reason;
  EXPECT_LT(std::abs(run->record().samples().back().v), 0.1) << "it may sway";
  world.leave(kStranger);
  usher_msgs::msg::SupervisorRequest clear;
  clear.client("operator");
  clear.id(77);
  clear.command(usher_msgs::msg::SupervisorRequest_Constants::COMMAND_CLEAR);
  world.publish(topics::kSupervisorRequest, clear, "operator");
  world.run_for(seconds(2));

  const auto arrival = (*robot)->send("reception", 120.0);
  ASSERT_TRUE(arrival.ok()) << arrival.error();
  EXPECT_TRUE(arrival->reported) << arrival->reason << "\n" << run->complaints();
  EXPECT_EQ(run->record().summary().contacts, 0U) << run->record().summary().contact_with;
  for (const auto& name : world.components())
    EXPECT_EQ(world.lives(name), lives[name]) << name << ": " << world.fault_reason(name);
}

INSTANTIATE_TEST_SUITE_P(On, MangledSamples, testing::ValuesIn(attacked()), [](const auto& each) {
  std::string name = each.param.topic;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
});

}  // namespace
}  // namespace usher::operations
