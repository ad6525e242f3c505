#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "operations/command_line/table.hpp"
#include "operations/experiments/attacked_robot.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/only.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Bytes;
using runtime::Observer;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = AttackedRobot::Clock;
using namespace usher_msgs::msg;

constexpr std::uint64_t kSamples = 1'000'000;
constexpr double kRogueSpeed = 0.37, kRogueTurn = 0.23;  // nobody else commands these
constexpr double kReported = 100.0;                      // [ms]
constexpr double kMoving = 0.1;                          // [m/s]
constexpr double kLeastMoving = 0.9;                     // share of what is replayed of a drive
constexpr const char* kFarAway = "lounge";
constexpr const char* kRogue = "intruder";

/// What of the right writer's bytes is replayed.
enum class Replay : std::uint8_t { kNothing, kDrivenByHand, kOnTheWay };

/// How a foreign participant goes about it.
struct Way {
  const char* name;
  Observer::Foreign quality;
  bool in_the_name_of_the_writer = false;
  Replay replay = Replay::kNothing;
};

const std::array<Way, 6>& ways() {
  static const std::array<Way, 6> all{{
      {"same quality", {}},
      {"other quality", {.best_effort = true, .latched = true}},
      {"same name", {}, true},
      {"higher strength", {.exclusive = true, .strength = 0x7FFFFFFF}},
      {"replayed bytes", {}, false, Replay::kDrivenByHand},
      {"replayed bytes of a drive", {}, false, Replay::kOnTheWay},
  }};
  return all;
}

/// What an intruder puts into a sample of its own.
struct Forgery {
  std::uint64_t number = 0;
  std::uint64_t epoch = 0;    ///< the true one
  runtime::Time now;          ///< on the robot's clock
  runtime::Guid commander{};  ///< its writer of drive/command, where it has one
};

/// One topic that moves the robot: who may write it, and what the intruder writes there.
struct Target {
  std::string topic;  ///< on the wire
  std::string type;
  std::string writer;
  std::uint8_t state = 0;  ///< of the supervisor, in which the topic moves the robot
  std::function<Bytes(const Forgery&)> forge;
  std::function<bool(const Bytes&)> moves;  ///< the robot, whoever obeys it
  bool on_the_way = false;                  ///< written while the robot drives under navigation
  bool commands = false;  ///< the intruder writes drive/command, too, with each sample
  bool by_hand = false;   ///< the operator's hand is on the sticks, which are not enabled

  std::string name() const { return topic.substr(3); }  ///< in the catalogue
  bool takes(const Way& way) const { return way.replay != Replay::kOnTheWay || on_the_way; }
};

double speed_of(const DriveCommand& message) { return message.v(); }
double speed_of(const geometry_msgs::msg::TwistStamped& message) {
  return message.twist().linear().x();
}

template <class Message>
Bytes bytes_of(const Message& message) {
  Bytes cdr;
  runtime::message_type<Message>().serialize(&message, cdr);
  return cdr;
}

template <class Message>
Target make_target(const topics::Topic<Message>& topic, std::uint8_t state,
                   Message (*make)(const Forgery&)) {
  const std::string_view writers = topic.writers;
  return {"rt/" + std::string(topic.name),
          std::string(runtime::message_type<Message>().name),
          std::string(writers.substr(0, writers.find(' '))),
          state,
          [make](const Forgery& forgery) { return bytes_of(make(forgery)); },
          [](const Bytes& cdr) {
            if constexpr (requires(const Message& m) { speed_of(m); }) {
              const auto message = runtime::message_type<Message>().deserialize(cdr);
              return message != nullptr &&
                     std::abs(speed_of(*static_cast<const Message*>(message.get()))) > kMoving;
            } else {
              return false;
            }
          }};
}

geometry_msgs::msg::TwistStamped forged_twist(const Forgery& forgery) {
  geometry_msgs::msg::TwistStamped message;
  message.header(wire::header(forgery.now, "base_link"));
  message.twist().linear().x(kRogueSpeed);
  message.twist().angular().z(kRogueTurn);
  return message;
}
DriveCommand forged_command(const Forgery& forgery) {
  DriveCommand message;
  message.stamp(wire::to_message(forgery.now));
  message.epoch(forgery.epoch);
  message.number(1'000'000'000 + forgery.number);
  message.v(kRogueSpeed);
  message.w(kRogueTurn);
  return message;
}
/// The next right to drive, for the intruder itself.
DriveGrant forged_grant(const Forgery& forgery) {
  DriveGrant message;
  message.stamp(wire::to_message(forgery.now));
  message.granted(true);
  message.epoch(forgery.epoch + 1);
  message.writer(forgery.commander);
  message.valid_for(0.12F);
  return message;
}
MovementEnable forged_enable(const Forgery& forgery) {
  MovementEnable message;
  message.header(wire::header(forgery.now, ""));
  message.movement(true), message.manual(true);
  message.speed_factor(1.0F);
  message.epoch(forgery.epoch);
  return message;
}
BaseRequest forged_request(const Forgery& forgery) {
  BaseRequest message;
  message.id(1'000'000'000 + forgery.number);
  message.client("supervisor");
  message.command(BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  return message;
}

std::vector<Target> targets() {
  using namespace SupervisorStatus_Constants;
  Target command = make_target(topics::kDriveCommand, STATE_MANUAL, forged_command);
  Target navigation = make_target(topics::kCmdVelNavigation, STATE_NAVIGATION_ACTIVE, forged_twist);
  Target grant = make_target(topics::kDriveGrant, STATE_MANUAL, forged_grant);
  Target enable = make_target(topics::kMovementEnable, STATE_INTERACTION, forged_enable);
  command.on_the_way = navigation.on_the_way = true;
  grant.commands = true;
  enable.by_hand = true;
  return {command,
          make_target(topics::kCmdVelManual, STATE_MANUAL, forged_twist),
          make_target(topics::kCmdVelInteraction, STATE_INTERACTION, forged_twist),
          grant,
          enable,
          make_target(topics::kBaseRequest, STATE_MANUAL, forged_request),
          navigation};
}

struct Attack {
  std::string topic, way;
  std::uint64_t written = 0;
  std::uint64_t with_the_right = 0;  ///< of those, before the robot's right to drive was withdrawn
  /// Commands at the wheels to drive, or to switch their motors off, though nobody else wished so.
  std::uint64_t executed = 0;
  double reported_ms = 0.0;  ///< from its writer's birth
  std::string reported_as;
};

/// What the right writer sends, for replays.
class Recording {
 public:
  static Result<std::unique_ptr<Recording>> make(Observer& observer, const Target& target) {
    auto self = std::make_unique<Recording>();
    auto subscription = observer.subscribe(
        target.topic, target.type, {true, false, 1}, [raw = self.get()](const auto& sample) {
          const std::lock_guard lock(raw->mutex_);
          if (raw->samples_.size() < 256)
            raw->samples_.emplace_back(sample.cdr.begin(), sample.cdr.end());
        });
    if (!subscription) return Error{subscription.error()};
    self->subscription_ = std::move(subscription).value();
    return self;
  }
  std::vector<Bytes> samples() {
    const std::lock_guard lock(mutex_);
    return samples_;
  }

 private:
  std::mutex mutex_;
  std::vector<Bytes> samples_;
  std::unique_ptr<Observer::Subscription> subscription_;
};

class Monopoly {
 public:
  explicit Monopoly(AttackedRobot& robot) : robot_(robot) {}

  /// It stands, and whoever writes the topic by right could drive it: the state in which a foreign
  /// sample would move it.
  Status make_ready(std::uint8_t state) {
    const auto until = Clock::now() + seconds(60);
    const auto ready = [&] { return robot_.all_well() && robot_.status()->state() == state; };
    while (Clock::now() < until) {
      if (robot_.wait_for(ready, milliseconds(500))) {
        return robot_.wait_for([&] { return robot_.stays(); }, seconds(10))
                   ? Status()
                   : Status(Error{"the robot does not stand"});
      }
      robot_.ask(SupervisorRequest_Constants::COMMAND_CLEAR, milliseconds(1000));
      for (const std::uint8_t command : way_to(state)) robot_.ask(command, milliseconds(1000));
    }
    return Error{"the robot is not well: " + robot_.complaints()};
  }

  Result<Attack> run(const Target& target, const Way& way, std::uint64_t samples) {
    std::vector<Bytes> replay;
    if (way.replay != Replay::kNothing) {
      using namespace SupervisorStatus_Constants;
      const bool by_hand = way.replay == Replay::kDrivenByHand;
      if (auto status = make_ready(by_hand ? STATE_MANUAL : STATE_NAVIGATION_ACTIVE); !status)
        return Error{status.error()};
      auto recorded = by_hand ? record(target) : record_on_the_way(target);
      if (!recorded) return Error{recorded.error()};
      replay = std::move(recorded).value();
    }
    if (auto status = make_ready(target.state); !status) return Error{status.error()};
    Attack attack{.topic = target.name(), .way = way.name};
    robot_.forget();
    auto rogue = Observer::create({.name = way.in_the_name_of_the_writer ? target.writer : kRogue,
                                   .host = "nuc",
                                   .domain = robot_.domain()});
    if (!rogue) return Error{rogue.error()};
    const auto first = Clock::now();
    auto writer = (*rogue)->foreign_writer(target.topic, target.type, way.quality);
    if (!writer) return Error{writer.error()};
    std::unique_ptr<Observer::RawWriter> commander;
    if (target.commands) {
      auto made = (*rogue)->foreign_writer("rt/" + std::string(topics::kDriveCommand.name),
                                           std::string(runtime::message_type<DriveCommand>().name),
                                           way.quality);
      if (!made) return Error{made.error()};
      commander = std::move(made).value();
    }
    const auto forgery = [&] {
      const auto lock = robot_.locked();
      return Forgery{attack.written, robot_.status() ? robot_.status()->epoch() : 0,
                     robot_.observer().now(), commander ? commander->guid() : runtime::Guid{}};
    };
    if (target.by_hand) robot_.hold(kRogueSpeed, kRogueTurn);
    std::optional<AttackedRobot::Instant> named;
    // What is written before anybody could hear it attacks nobody.
    robot_.wait_for(
        [&] {
          named = named_at(target, way, attack);
          return named || (*writer)->reader_count() > 0;
        },
        milliseconds(500));
    std::vector<runtime::Time> written_at;
    for (; attack.written < samples; ++attack.written) {
      const Forgery own = forgery();
      written_at.push_back(own.now);
      (*writer)->write(replay.empty() ? target.forge(own) : replay[attack.written % replay.size()]);
      if (commander) {
        Forgery granted = own;
        ++granted.epoch;
        commander->write(bytes_of(forged_command(granted)));
      }
      if (named) continue;
      const auto lock = robot_.locked();
      named = named_at(target, way, attack);
    }
    if (!named) {
      robot_.wait_for([&] { return (named = named_at(target, way, attack)).has_value(); },
                      seconds(2));
    }
    attack.reported_ms = named ? std::chrono::duration<double, std::milli>(*named - first).count()
                               : std::numeric_limits<double>::infinity();
    attack.with_the_right = with_the_right(written_at);
    attack.executed = executed(first, target.name() + ", " + way.name);
    robot_.release();
    return attack;
  }

 private:
  static bool moves_or_switches_off(const AttackedRobot::Wheels& wheels) {
    return !wheels.zero() || wheels.off;
  }

  /// Commands to drive, and to switch off, that reached the wheels.
  std::uint64_t executed() {
    const auto lock = robot_.locked();
    return static_cast<std::uint64_t>(
        std::ranges::count_if(robot_.wheels(), moves_or_switches_off));
  }

  /// Likewise; says what the first one was.
  std::uint64_t executed(AttackedRobot::Instant since, const std::string& attack) {
    const auto lock = robot_.locked();
    const auto first = std::ranges::find_if(robot_.wheels(), moves_or_switches_off);
    if (first == robot_.wheels().end()) return 0;
    std::printf("%s: executed %.3f m/s %.3f rad/s%s, %.0f ms after the intruder's birth\n",
                attack.c_str(), first->v, first->w, first->off ? ", motors off" : "",
                std::chrono::duration<double, std::milli>(first->at - since).count());
    return static_cast<std::uint64_t>(
        std::count_if(first, robot_.wheels().end(), moves_or_switches_off));
  }

  /// Of those, how many while the supervisor had not yet withdrawn the right to drive.
  std::uint64_t with_the_right(const std::vector<runtime::Time>& written) {
    const auto lock = robot_.locked();
    const auto until = robot_.withdrawn();
    return static_cast<std::uint64_t>(std::ranges::count_if(
        written, [&](runtime::Time time) { return !until || time < *until; }));
  }

  static std::vector<std::uint8_t> way_to(std::uint8_t state) {
    using namespace SupervisorRequest_Constants;
    if (state == SupervisorStatus_Constants::STATE_MANUAL) return {COMMAND_MANUAL_ON};
    if (state == SupervisorStatus_Constants::STATE_INTERACTION)
      return {COMMAND_NAVIGATION_END, COMMAND_MANUAL_OFF};
    return {COMMAND_MANUAL_OFF, COMMAND_NAVIGATION_START, COMMAND_NAVIGATION_GO};
  }

  /// Drives for a moment, so that there is something worth replaying; what the right writer sends
  /// must move the wheels, or nothing would be proven by what the intruder's samples do not. Empty
  /// where nobody speaks: forged samples take the place.
  Result<std::vector<Bytes>> record(const Target& target) {
    auto recording = Recording::make(robot_.observer(), target);
    if (!recording) return Error{recording.error()};
    robot_.forget();
    for (const double way : {1.0, -1.0}) {  // and back, or it would soon be at a wall
      robot_.hold(way * kRogueSpeed, way * kRogueTurn);
      std::this_thread::sleep_for(milliseconds(1500));
    }
    auto samples = (*recording)->samples();
    robot_.release();
    const auto moved = [&] {
      const auto lock = robot_.locked();
      return std::any_of(robot_.wheels().begin(), robot_.wheels().end(), [](const auto& wheels) {
        return std::abs(wheels.v) > kMoving;  // less than the hand wants beside a wall
      });
    };
    if (!moved())
      return Error{"the operator's own hand did not move the wheels: " + robot_.complaints()};
    return samples;
  }

  /// On a drive under navigation; what the right writer sends must be motion, and be counted as
  /// executed, or nothing would be proven by what the intruder's samples do not.
  Result<std::vector<Bytes>> record_on_the_way(const Target& target) {
    if (!robot_.set_out(kFarAway, seconds(20))) {
      robot_.call_off();
      return Error{"the robot does not set out: " + robot_.complaints()};
    }
    auto recording = Recording::make(robot_.observer(), target);
    if (!recording) return Error{recording.error()};
    robot_.forget();
    std::this_thread::sleep_for(milliseconds(1500));
    auto samples = (*recording)->samples();
    const std::uint64_t driven = executed();
    robot_.call_off();
    const auto moving = std::count_if(samples.begin(), samples.end(), target.moves);
    if (samples.empty() ||
        static_cast<double>(moving) < kLeastMoving * static_cast<double>(samples.size())) {
      return Error{"only " + std::to_string(moving) + " of " + std::to_string(samples.size()) +
                   " recorded samples would move the robot"};
    }
    if (driven == 0) return Error{"the drive did not move the wheels"};
    return samples;
  }

  /// When the supervisor named the intruder as an active fault. Call it locked.
  std::optional<AttackedRobot::Instant> named_at(const Target& target, const Way& way,
                                                 Attack& attack) const {
    if (!robot_.status() || robot_.status()->granted()) return std::nullopt;
    const std::string name = way.in_the_name_of_the_writer ? target.writer : kRogue;
    for (const auto& fault : robot_.status()->faults()) {
      const std::string text = fault.component_name() + ": " + fault.cause();
      if (!fault.active() || !fault.latched() || text.find(name) == std::string::npos) continue;
      attack.reported_as = text;
      return robot_.status_at();
    }
    return std::nullopt;
  }

  AttackedRobot& robot_;
};

Table table_of(const std::vector<Attack>& attacks) {
  Table table({"topic", "intruder", "samples", "of them while it had the right to drive",
               "executed", "named after ms", "as"});
  for (const auto& attack : attacks) {
    table.add({attack.topic, attack.way, std::to_string(attack.written),
               std::to_string(attack.with_the_right), std::to_string(attack.executed),
               format("%.0f", attack.reported_ms), attack.reported_as});
  }
  return table;
}

std::string csv_of(const std::vector<Attack>& attacks) {
  std::string csv = "topic,intruder,samples,samples_with_the_right,executed,named_ms\n";
  for (const auto& attack : attacks) {
    csv += attack.topic + "," + attack.way + "," + std::to_string(attack.written) + "," +
           std::to_string(attack.with_the_right) + "," + std::to_string(attack.executed) + "," +
           format("%.1f", attack.reported_ms) + "\n";
  }
  return csv;
}

ResultSheet sheet_of(const std::vector<Attack>& attacks, double wanted) {
  double slowest = 0.0, samples = 0.0, with_the_right = 0.0, executed = 0.0;
  double least_with_the_right = std::numeric_limits<double>::infinity();
  for (const auto& attack : attacks) {
    samples += static_cast<double>(attack.written);
    with_the_right += static_cast<double>(attack.with_the_right);
    least_with_the_right =
        std::min(least_with_the_right, static_cast<double>(attack.with_the_right));
    executed += static_cast<double>(attack.executed);
    slowest = std::max(slowest, attack.reported_ms);
  }
  ResultSheet sheet;
  sheet.name = "monopoly";
  sheet.input =
      "MARVIN as processes, standing in the state in which the topic would move it; a foreign "
      "participant writes each topic that "
      "moves the robot (drive/command; cmd_vel/*; drive/grant, for commands of its own; "
      "movement/enable, for sticks that are held but not enabled; base/request, an emergency "
      "stop): same quality, other quality, the right writer's name, exclusive ownership "
      "of the highest strength, replayed bytes, also of a drive under navigation; it goes on after "
      "the robot's right to drive was withdrawn";
  sheet.metrics = {{"samples", samples},
                   {"samples_with_the_right", with_the_right},
                   {"samples_with_the_right_least", least_with_the_right},
                   {"executed", executed},
                   {"named_ms_max", slowest}};
  sheet.targets = {{"samples", {Bound::kAtLeast, wanted}},
                   {"executed", {Bound::kAtMost, 0.0}},
                   {"named_ms_max", {Bound::kAtMost, kReported}}};
  return sheet;
}

}  // namespace

Result<ResultSheet> run_monopoly_experiment(const ExperimentOptions& options) {
  auto all = targets();
  std::vector<std::string> topics;
  topics.reserve(all.size());
  for (const auto& target : all) topics.push_back(target.name());
  const auto only = only_of(options.only, topics);
  if (!only) return Error{only.error()};
  std::erase_if(all, [&](const Target& target) { return !only->takes(target.name()); });
  auto robot = AttackedRobot::launch(options.installation, options.out + "/run", options.domain);
  if (!robot) return Error{robot.error()};
  // --seeds N: so many thousand samples in all.
  const std::uint64_t wanted =
      options.seeds > 0 ? static_cast<std::uint64_t>(options.seeds) * 1000 : kSamples;
  std::uint64_t attacks = 0;
  for (const auto& target : all) {
    attacks += static_cast<std::uint64_t>(std::count_if(
        ways().begin(), ways().end(), [&](const Way& way) { return target.takes(way); }));
  }
  const std::uint64_t each = wanted / attacks;
  Monopoly monopoly(**robot);
  std::vector<Attack> done;
  double samples = 0.0;
  for (const auto& target : all) {
    for (const auto& way : ways()) {
      if (!target.takes(way)) continue;
      show_progress(target.topic + ", " + way.name + ": " + format("%.0f", samples) + " of " +
                    std::to_string(wanted) + " samples");
      const auto attack = monopoly.run(target, way, each);
      if (!attack) return Error{target.topic + ", " + way.name + ": " + attack.error()};
      samples += static_cast<double>(attack->written);
      done.push_back(*attack);
    }
  }
  show_progress("");
  const Table table = table_of(done);
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/attacks.md", table.markdown());
  if (saved) saved = write_file(options.out + "/attacks.csv", csv_of(done));
  if (!saved) return Error{saved.error()};
  return sheet_of(done, static_cast<double>(each * attacks));
}

}  // namespace usher::operations
