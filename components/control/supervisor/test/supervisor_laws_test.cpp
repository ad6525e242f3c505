// Random histories against what must hold in all of them. The test keeps its own, simpler account
// of who lives and what is latched, and drives a real BaseObedience with the grants.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "control/supervisor/core/supervisor.hpp"
#include "foundation/random/random.hpp"

namespace usher::supervisor {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kDigest = 5;
constexpr int kTimeout = 100;
constexpr int kBaseAge = 150;
const char* const kCritical[] = {"movement_control", "segway_rmp", "amcl"};

Parameters parameters() {
  Parameters parameters;
  for (const char* name : kCritical) {
    parameters.components.push_back({name, Criticality::kStop, milliseconds(kTimeout)});
  }
  parameters.components.push_back({"tablet", Criticality::kNotify, milliseconds(300)});
  parameters.idl_digest = kDigest;
  return parameters;
}

struct World {
  explicit World(std::uint64_t seed) : random(seed) {}

  bool chance(std::uint64_t n) { return random.below(n) == 0; }
  Time now() const { return milliseconds(now_ms); }

  Random random;
  Supervisor supervisor{parameters(), {}};
  drive::BaseObedience base;
  int now_ms = 0;

  std::map<std::string, bool> alive;      ///< sends heartbeats
  std::map<std::string, int> well_until;  ///< last good heartbeat plus time-out
  std::map<WriterId, std::string> writers;
  std::uint8_t next_writer = 1;
  bool latched = false;  ///< a foreign writer or an emergency since the last clear
  bool base_emergency = false;
  bool base_reports = true;
  int base_heard_ms = -kBaseAge;
  std::uint64_t sequence = 0;
  std::uint64_t request_id = 0;

  void hear(const std::string& name) {
    const std::uint64_t digest = chance(200) ? kDigest + 1 : kDigest;
    const Reported state = chance(100) ? static_cast<Reported>(random.below(4)) : Reported::kOk;
    WriterId writer{200};
    for (const auto& [id, participant] : writers) {
      if (participant == name) writer = id;
    }
    supervisor.heartbeat({name, writer, digest, state, "because"}, now());
    const bool good = digest == kDigest && (state == Reported::kOk || state == Reported::kDegraded);
    well_until[name] = good ? now_ms + kTimeout : -1;
  }

  void report() {
    if (!base_reports) return;
    BaseReport report;
    report.emergency = base_emergency;
    report.ready = !base_emergency;
    report.epoch = base.highest_epoch();
    supervisor.base(report, now());
    base_heard_ms = now_ms;
  }

  void happen() {
    switch (random.below(13)) {
      case 0:
        alive[kCritical[random.below(3)]] = false;
        break;
      case 1:
      case 2:
        for (const char* name : kCritical) alive[name] = true;
        break;
      case 3: {
        if (!chance(3) && !writers.empty()) break;
        const std::string name = chance(6) ? "rogue" : "movement_control";
        const WriterId writer{next_writer++};
        writers[writer] = name;
        supervisor.writer_appeared("drive/command", {writer, name, "nuc"}, now());
        if (name == "rogue") latched = true;
        break;
      }
      case 4:
        if (!writers.empty() && chance(2)) {
          const auto victim =
              std::next(writers.begin(), static_cast<std::ptrdiff_t>(random.below(writers.size())));
          supervisor.writer_gone("drive/command", victim->first);
          writers.erase(victim);
        }
        break;
      case 5: {
        const auto command = static_cast<Command>(random.below(10));
        const Answer answer =
            supervisor.request({++request_id, "operator", command, "am218"}, now());
        if (command == Command::kEmergencyStop) latched = true;
        if (command == Command::kClear && answer.done) latched = false;
        break;
      }
      case 6:
        supervisor.request({++request_id, "operator", Command::kClear, ""}, now());
        if (supervisor.status().last_request.done) latched = false;
        break;
      case 7:
        if (chance(5)) base_emergency = true;
        break;
      case 8:
        base_emergency = false;
        break;
      case 9:
        supervisor.navigation(random.below(4), static_cast<GoalState>(random.below(7)));
        break;
      case 10:
        base_reports = !chance(4);
        break;
      case 11:  // a visitor
        for (const Command command : {Command::kNavigationStart, Command::kNavigationGo}) {
          supervisor.request({++request_id, "guide", command, "am218"}, now());
        }
        break;
      default:
        break;
    }
  }
};

TEST(SupervisorLaws, NoGrantWhileSomethingCriticalIsDeadOrLatched) {
  int granted_steps = 0;
  int driven_steps = 0;
  int guided_steps = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    World world(seed);
    std::uint64_t last_epoch = 0;
    WriterId last_writer = drive::kNobody;
    int last_granted_ms = -1000;
    for (int step = 0; step < 1500; ++step) {
      world.now_ms += 20;
      if (world.chance(10)) world.happen();
      for (const char* name : kCritical) {
        if (world.alive[name]) world.hear(name);
      }
      world.report();
      const Decision& decision = world.supervisor.step(world.now());
      const bool granted = decision.grant.writer != drive::kNobody;

      if (granted) {
        ++granted_steps;
        for (const char* name : kCritical) {
          ASSERT_GT(world.well_until[name], world.now_ms) << name << " is dead";
        }
        ASSERT_FALSE(world.latched);
        ASSERT_LT(world.now_ms - world.base_heard_ms, kBaseAge);
        ASSERT_FALSE(world.base_reports && world.base_emergency);
        ASSERT_EQ(world.writers.count(decision.grant.writer), 1U) << "the holder is alive";
        ASSERT_EQ(world.writers[decision.grant.writer], "movement_control");
        for (const auto& [writer, name] : world.writers) ASSERT_EQ(name, "movement_control");
        ASSERT_NE(decision.state, State::kFault);
        ASSERT_NE(decision.state, State::kInitialise);
        ASSERT_TRUE(decision.reason.empty() || decision.reason.starts_with("stopped by"));
        if (decision.grant.writer != last_writer) {
          ASSERT_GT(decision.grant.epoch, last_epoch);
        }
        last_granted_ms = world.now_ms;
      } else {
        ASSERT_NE(decision.reason, "") << "a stop has a reason";
        ASSERT_FALSE(decision.enables.navigation || decision.enables.manual ||
                     decision.enables.interaction);
      }
      for (const Fault& fault : world.supervisor.status().faults) {
        ASSERT_FALSE(granted && fault.active && fault.latched()) << fault.detail;
      }
      ASSERT_GE(decision.grant.epoch, last_epoch);
      ASSERT_TRUE(!decision.enables.movement || decision.state == State::kInteraction ||
                  decision.state == State::kNavigationActive || decision.state == State::kManual);
      last_epoch = decision.grant.epoch;
      last_writer = decision.grant.writer;
      if (decision.state == State::kNavigationActive) ++guided_steps;

      // The base: everybody commands all the time, and the grant may be lost on its way.
      if (!world.chance(10)) world.base.grant(decision.grant, world.now());
      for (const auto& [writer, name] : world.writers) {
        world.base.permitted({writer, decision.grant.epoch, ++world.sequence, {0.5, 0.0}},
                             world.now());
      }
      if (world.base.permitted(world.now()).twist.v != 0.0) {
        ++driven_steps;
        ASSERT_LT(world.now_ms - last_granted_ms, 120) << "driven without a grant";
      }
    }
  }
  // The histories are worth something only if the robot was often allowed to drive.
  EXPECT_GT(granted_steps, 40000);
  EXPECT_GT(driven_steps, 40000);
  EXPECT_GT(guided_steps, 1000);
}

// After all faults end and an operator cleared, the robot is allowed to drive again: no dead end.
TEST(SupervisorLaws, RecoversFromEveryHistory) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    World world(seed);
    for (int step = 0; step < 500; ++step) {
      world.now_ms += 20;
      if (world.chance(4)) world.happen();
      for (const char* name : kCritical) {
        if (world.alive[name]) world.hear(name);
      }
      world.report();
      world.supervisor.step(world.now());
    }
    const std::map<WriterId, std::string> writers = world.writers;
    for (const auto& [writer, name] : writers)
      world.supervisor.writer_gone("drive/command", writer);
    const WriterId fresh{250};
    world.supervisor.writer_appeared("drive/command", {fresh, "movement_control", "nuc"},
                                     world.now());
    for (int step = 0; step < 100; ++step) {
      world.now_ms += 20;
      for (const char* name : kCritical) {
        world.supervisor.heartbeat(
            {name, name == std::string("movement_control") ? fresh : WriterId{200}, kDigest,
             Reported::kOk, ""},
            world.now());
      }
      world.supervisor.base({}, world.now());
      world.supervisor.step(world.now());
      if (step == 60) {
        ASSERT_TRUE(
            world.supervisor.request({1'000'000, "operator", Command::kClear, ""}, world.now())
                .done);
      }
    }
    ASSERT_EQ(world.supervisor.decision().grant.writer, fresh)
        << "seed " << seed << ": " << world.supervisor.decision().reason;
    const State state = world.supervisor.decision().state;
    ASSERT_TRUE(state == State::kInteraction || state == State::kManual ||
                state == State::kNavigationStart || state == State::kNavigationActive)
        << text(state);
  }
}

}  // namespace
}  // namespace usher::supervisor
