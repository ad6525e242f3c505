#include "operations/fault_windows/fault.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>

#include "foundation/random/random.hpp"

namespace usher::operations {

namespace {

using namespace std::string_view_literals;

/// [s] The base itself holds its last command for 0.4 s.
constexpr double kHeld = 0.45;
/// [s] A grant that nobody renews has run out.
constexpr double kExpires = 0.2;
constexpr double kTwoAtOnce = 0.12;    // share of windows
constexpr double kSightAtFault = 0.5;  // share of the windows of a robot that sees
constexpr double kLongestDelay = 3.0;  // [s]

/// Topic and who may write it.
constexpr std::array kCommandTopics = {
    std::pair{"drive/command"sv, "movement_control"sv},
    std::pair{"cmd_vel/manual"sv, "manual_control"sv},
    std::pair{"cmd_vel/interaction"sv, "interaction_control"sv},
    std::pair{"cmd_vel/navigation"sv, "local_planner"sv},
    std::pair{"drive/grant"sv, "supervisor"sv},
    std::pair{"movement/enable"sv, "supervisor"sv},
    std::pair{"base/request"sv, "supervisor"sv},
};

/// Topics whose silence stops the robot, within so long [s], and a word of the reason. Each stops
/// by the reader's age, heartbeats after their time-out.
struct SilentTopic {
  std::string_view topic;
  double zero_within;
  std::string_view word;
};
constexpr std::array kSilentTopics = {
    SilentTopic{"drive/command", 0.2, "command"},
    SilentTopic{"drive/grant", 0.2, "grant"},
    SilentTopic{"movement/enable", 0.2, "movement_control"},
    SilentTopic{"cmd_vel/navigation", 0.3, "movement_control"},
    SilentTopic{"base/status", 0.2, "base/status"},
    SilentTopic{"heartbeat", 0.2, "silent"},
    SilentTopic{"whiskers", 0.35, "whiskers"},
    SilentTopic{"scan/filtered", 0.5, "scan"},
    SilentTopic{"odom", 0.25, "odom"},
    SilentTopic{"tf", 0.5, ""},
};

constexpr std::array kFloods = {"heartbeat"sv, "supervisor/request"sv, "tf"sv, "joy"sv, "people"sv};
/// Of those, what only the robot's own components may write.
constexpr std::array kOwnFloods = {"tf"sv, "joy"sv, "people"sv};

std::string_view pick(Random& random, std::span<const std::string_view> from) {
  return from[random.below(from.size())];
}

/// Short, some seconds, or for good.
double draw_duration(Random& random) {
  const double which = random.uniform();
  const double low = random.uniform(0.1, 1.0), middle = random.uniform(1.0, 8.0);
  return which < 0.4 ? low : which < 0.8 ? middle : kWindow;
}

double either_sign(Random& random, double low, double high) {
  const double value = random.uniform(low, high);
  return random.uniform() < 0.5 ? -value : value;
}

void draw_link(Random& random, Fault& fault) {
  constexpr std::array kVariants = {"loss"sv, "delay"sv,        "disorder"sv,
                                    "cut"sv,  "cut from nuc"sv, "cut to nuc"sv};
  constexpr std::array kHosts = {"sensing"sv, "tablet"sv};
  fault.target = pick(random, kHosts);
  fault.variant = pick(random, kVariants);
  fault.amount = fault.variant == "loss" ? random.uniform(0.1, 0.9) : random.uniform(0.02, 0.3);
}

void draw_laser(Random& random, Fault& fault) {
  constexpr std::array kVariants = {"silent"sv, "frozen"sv, "not finite"sv, "biased"sv};
  fault.variant = pick(random, kVariants);
  fault.amount = fault.variant == "biased" ? either_sign(random, 0.02, 0.08) : 0.0;
}

void draw_odometry(Random& random, Fault& fault) {
  constexpr std::array kVariants = {"frozen"sv, "not finite"sv, "biased"sv};
  fault.variant = pick(random, kVariants);
  fault.amount = fault.variant == "biased" ? either_sign(random, 0.02, 0.08) : 0.0;
}

void draw_rogue(Random& random, Fault& fault) {
  const auto& [topic, writer] = kCommandTopics[random.below(kCommandTopics.size())];
  fault.target = topic;
  fault.variant = random.uniform() < 0.3 ? writer : "rogue";
  fault.amount = random.uniform(0.3, 0.8);
  fault.duration = std::min(fault.duration, 5.0);
}

Fault draw_fault(Random& random, const FaultTargets& targets) {
  constexpr std::array kLines = {"commands"sv, "feedback"sv, "both"sv};
  constexpr std::array kCommands = {"repeated"sv, "old epoch"sv, "not finite"sv, "too fast"sv};
  constexpr std::array kTouches = {"silent"sv, "pressed"sv, "free"sv};
  constexpr std::array kHosts = {"nuc"sv, "sensing"sv, "tablet"sv};
  Fault fault;
  fault.kind = static_cast<FaultKind>(random.below(kBlindFaultKinds));
  fault.duration = draw_duration(random);
  switch (fault.kind) {
    case FaultKind::kCrash:
    case FaultKind::kHang:
    case FaultKind::kSlow:
      fault.target = targets.components[random.below(targets.components.size())];
      fault.amount = random.uniform(0.5, 0.95);
      break;
    case FaultKind::kBaseLink:
      fault.variant = pick(random, kLines);
      break;
    case FaultKind::kTopicSilence:
      fault.target = kSilentTopics[random.below(kSilentTopics.size())].topic;
      break;
    case FaultKind::kBadCommand:
      fault.variant = pick(random, kCommands);
      break;
    case FaultKind::kRogue:
      draw_rogue(random, fault);
      break;
    case FaultKind::kLink:
      draw_link(random, fault);
      break;
    case FaultKind::kClock:
      // No host's clock goes back: it is the monotonic one. Each jumps ahead of the others, so that
      // the others are behind it.
      fault.target = pick(random, kHosts);
      fault.amount = random.uniform() < 0.5 ? random.uniform(0.02, 0.5) : random.uniform(0.5, 10.0);
      fault.duration = kWindow;
      break;
    case FaultKind::kLaser:
      draw_laser(random, fault);
      break;
    case FaultKind::kWhiskers:
      fault.variant = pick(random, kTouches);
      break;
    case FaultKind::kOdometry:
      draw_odometry(random, fault);
      break;
    case FaultKind::kFlood:
      fault.target = pick(random, kFloods);
      fault.duration = std::min(fault.duration, 3.0);
      break;
    case FaultKind::kStick:
      fault.amount = either_sign(random, 0.3, 1.0);
      break;
    case FaultKind::kDepth:
    case FaultKind::kUltrasonic:
    case FaultKind::kPeople:
      break;  // draw_sight()
  }
  return fault;
}

Fault draw_sight(Random& random) {
  constexpr std::array kCameras = {"kinect"sv, "rear camera"sv, "both cameras"sv};
  constexpr std::array kImages = {"silent"sv, "frozen"sv, "not finite"sv};
  constexpr std::array kEchoes = {"silent"sv, "not finite"sv, "near"sv};
  constexpr std::array kWords = {"silent"sv, "frozen"sv, "false"sv};
  constexpr std::array kKinds = {FaultKind::kDepth, FaultKind::kUltrasonic, FaultKind::kPeople};
  Fault fault;
  fault.kind = kKinds[random.below(kKinds.size())];
  fault.duration = draw_duration(random);
  if (fault.kind == FaultKind::kDepth) {
    fault.target = pick(random, kCameras);
    fault.variant = pick(random, kImages);
  } else if (fault.kind == FaultKind::kUltrasonic) {
    fault.variant = pick(random, kEchoes);
    if (fault.variant == "near") fault.amount = random.uniform(0.2, 0.8);
  } else {
    fault.variant = pick(random, kWords);
    if (fault.variant == "false") fault.amount = random.uniform(0.8, 3.0);
  }
  return fault;
}

bool needs_sensing_apart(const Fault& fault) {
  return (fault.kind == FaultKind::kLink || fault.kind == FaultKind::kClock) &&
         fault.target == "sensing";
}

/// Of a link to a host: which direction carries nothing.
void expect_of_link(const Fault& fault, Expectation& expected) {
  if (fault.target != "sensing") return;
  if (fault.variant == "cut" || fault.variant == "cut to nuc") {
    expected.zero_within = 0.2;
    expected.words = {"lms100", "sensor_board", "scan_filter"};
  }
}

}  // namespace

std::string_view text(FaultKind kind) {
  constexpr std::array kTexts = {
      "crash",        "hang",          "slow handler", "base line",  "topic silent", "bad command",
      "rogue writer", "link of hosts", "clock jump",   "laser",      "whiskers",     "odometry",
      "flood",        "held stick",    "depth camera", "ultrasonic", "people"};
  static_assert(kTexts.size() == kFaultKinds);
  return kTexts[static_cast<std::size_t>(kind)];
}

std::string Fault::text() const {
  std::string out(operations::text(kind));
  if (!target.empty()) out += " " + target;
  if (!variant.empty()) out += " " + variant;
  char number[48];
  if (amount != 0.0) {
    std::snprintf(number, sizeof(number), " %.3g", amount);
    out += number;
  }
  std::snprintf(number, sizeof(number), " for %.2f s", duration);
  return out + number;
}

std::string WindowPlan::kind() const {
  return faults.size() == 1 ? std::string(operations::text(faults.front().kind)) : "two at once";
}

std::string WindowPlan::text() const {
  std::string out;
  for (const Fault& fault : faults) out += (out.empty() ? "" : " + ") + fault.text();
  return out;
}

WindowPlan draw_window(std::uint64_t seed, int attempt, const FaultTargets& targets) {
  Random random(stream_seed(seed, ("window " + std::to_string(attempt)).c_str()));
  WindowPlan plan;
  plan.seed = seed;
  plan.start = random.below(targets.starts);
  plan.yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
  plan.goal = random.below(targets.locations);
  plan.delay = random.uniform(0.0, kLongestDelay);
  plan.faults.push_back(draw_fault(random, targets));
  if (random.uniform() < kTwoAtOnce) {
    Fault second = draw_fault(random, targets);
    // Twice the same is once.
    if (second.kind != plan.faults.front().kind) plan.faults.push_back(std::move(second));
  }
  if (targets.sees) {
    // Of their own, so that the other draws are those of a robot that does not see.
    Random sight(stream_seed(seed, ("sight " + std::to_string(attempt)).c_str()));
    if (sight.uniform() < kSightAtFault) plan.faults.front() = draw_sight(sight);
  }
  plan.sensing_apart = std::any_of(plan.faults.begin(), plan.faults.end(), needs_sensing_apart);
  return plan;
}

Expectation expectation(const Fault& fault, const FaultTargets& targets) {
  Expectation expected;
  expected.lasts = fault.duration;
  switch (fault.kind) {
    case FaultKind::kCrash:
    case FaultKind::kHang:
      if (targets.critical.contains(fault.target) || fault.target == "supervisor") {
        expected.zero_within = 0.2;
        expected.revoked_within = 0.3;
        expected.words = {fault.target};
      }
      break;
    case FaultKind::kBaseLink:
      expected.zero_within = fault.variant == "feedback" ? 0.35 : kHeld;
      expected.deaf = fault.variant != "feedback";
      // A base that hears nothing and reports all the same looks like one that waits.
      if (fault.variant != "commands") expected.words = {"base"};
      break;
    case FaultKind::kTopicSilence: {
      const auto* topic =
          std::find_if(kSilentTopics.begin(), kSilentTopics.end(),
                       [&](const auto& each) { return each.topic == fault.target; });
      if (topic == kSilentTopics.end()) break;
      expected.zero_within = topic->zero_within;
      if (!topic->word.empty()) expected.words = {std::string(topic->word)};
      break;
    }
    case FaultKind::kBadCommand:
      expected.zero_within = 0.2;
      expected.words = {"command"};
      break;
    case FaultKind::kRogue:
      // Latched: an operator ends it.
      expected.zero_within =
          fault.variant == "rogue" ? 0.1 : 0.2;  // a claimer of the name shows itself later
      expected.revoked_within = 0.3;
      expected.lasts = kWindow;
      expected.words = {fault.variant};
      break;
    case FaultKind::kLink:
      expect_of_link(fault, expected);
      break;
    case FaultKind::kLaser:
      if (fault.variant != "biased") {
        expected.zero_within = 0.8;
        expected.words = {"lms100", "scan"};
      }
      break;
    case FaultKind::kWhiskers:
      if (fault.variant == "silent") {
        expected.zero_within = 0.6;
        expected.words = {"whisker", "sensor_board"};
      } else if (fault.variant == "pressed") {
        expected.forward_barred_within = 0.1;
        expected.read_within = 3.5;  // once it stands
        expected.words = {"whisker"};
      }
      break;
    case FaultKind::kOdometry:
      if (fault.variant != "biased") {
        expected.zero_within = 0.8;
        expected.words = {"base", "odom", "segway_rmp"};
      }
      break;
    case FaultKind::kFlood:
      if (std::find(kOwnFloods.begin(), kOwnFloods.end(), fault.target) != kOwnFloods.end()) {
        expected.zero_within = 0.1;
        expected.lasts = kWindow;  // latched
        expected.words = {kFlooder};
      }
      break;
    case FaultKind::kSlow:
    case FaultKind::kClock:
    case FaultKind::kStick:
    case FaultKind::kDepth:
    case FaultKind::kUltrasonic:
    case FaultKind::kPeople:
      break;
  }
  return expected;
}

std::vector<Expectation> expectations(const WindowPlan& plan, const FaultTargets& targets) {
  std::vector<Expectation> all;
  all.reserve(plan.faults.size());
  for (const Fault& fault : plan.faults) all.push_back(expectation(fault, targets));
  const bool deaf = std::any_of(all.begin(), all.end(), [](const auto& each) { return each.deaf; });
  const auto silent = std::find_if(plan.faults.begin(), plan.faults.end(), [](const Fault& fault) {
    return (fault.kind == FaultKind::kCrash || fault.kind == FaultKind::kHang) &&
           fault.target == "supervisor";
  });
  // A touch that nobody tells of bars nothing: the robot stands because nobody tells.
  const bool unfelt = std::any_of(plan.faults.begin(), plan.faults.end(), [](const Fault& fault) {
    const bool ends = fault.kind == FaultKind::kCrash || fault.kind == FaultKind::kHang;
    return (fault.kind == FaultKind::kTopicSilence && fault.target == "whiskers") ||
           (fault.kind == FaultKind::kWhiskers && fault.variant == "silent") ||
           (ends && fault.target == "sensor_board");
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    Expectation& each = all[i];
    if (unfelt) each.forward_barred_within = Expectation::kNever;
    if (deaf) each.zero_within = std::max(each.zero_within, kHeld);
    if (silent == plan.faults.end() || &*silent == &plan.faults[i]) continue;
    if (plan.faults[i].kind == FaultKind::kRogue && plan.faults[i].duration <= silent->duration) {
      each = {};  // came and went while nobody watched; the laws hold all the same
      continue;
    }
    // Nobody withdraws the right to drive: it runs out. And nobody tells why until it is back.
    each.zero_within = std::max(each.zero_within, kExpires);
    each.read_within += silent->duration;
  }
  return all;
}

}  // namespace usher::operations
