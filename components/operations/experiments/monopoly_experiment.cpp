#include <signal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <utility>

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
using Instant = AttackedRobot::Instant;
using namespace usher_msgs::msg;

constexpr std::uint64_t kSamples = 1'000'000;
constexpr double kRogueSpeed = 0.37, kRogueTurn = 0.23;  // nobody else commands these
constexpr double kReported = 100.0;                      // [ms]
constexpr double kMoving = 0.1, kTurning = 0.1;          // [m/s], [rad/s]
constexpr std::size_t kLeastRecorded = 20;               // samples that move, of a recording
constexpr auto kUnderWay = milliseconds(500);            // from the last sample to the count
constexpr auto kHandReaches = milliseconds(100);         // the wheels, if it were enabled
constexpr const char* kFarAway = "lounge";
constexpr const char* kRogue = "intruder";
constexpr const char* kSupervisor = "supervisor";

// While the supervisor is held up, what it granted holds on for 120 ms from its last word, which is
// up to 20 ms old: 40 ms are left for a late end. Afterwards somebody else would be believed, as is
// who comes after a supervisor that died.
constexpr auto kHeldUp = milliseconds(60);
constexpr auto kMatched = milliseconds(10);  // the robot's readers, with a writer that was made
constexpr std::uint64_t kStrikes = 3;
constexpr std::uint64_t kStrikeSamples = 3000;  // at the most; written in 0.15 s
constexpr double kLeastWithTheRight = 1.0;      // of each attack that can get so far

/// What of the right writer's bytes is replayed.
enum class Replay : std::uint8_t { kNothing, kDrivenByHand, kSearching, kOnTheWay };

/// How a foreign participant goes about it.
struct Way {
  const char* name;
  Observer::Foreign quality;
  bool in_the_name_of_the_writer = false;
  Replay replay = Replay::kNothing;
};

const std::array<Way, 8>& ways() {
  static const std::array<Way, 8> all{{
      {"same quality", {}},
      {"latched", {.latched = true}},
      {"other quality", {.best_effort = true, .latched = true}},
      {"same name", {}, true},
      {"higher strength", {.exclusive = true, .strength = 0x7FFFFFFF}},
      {"replayed bytes", {}, false, Replay::kDrivenByHand},
      {"replayed bytes of a search", {}, false, Replay::kSearching},
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
  std::string reader;      ///< who would obey
  std::string refusals;    ///< what the reader counts for each sample of a writer that it refuses
  std::uint8_t state = 0;  ///< of the supervisor, in which the topic moves the robot
  std::function<Bytes(const Forgery&)> forge;
  std::function<bool(const Bytes&)> moves;  ///< the robot, whoever obeys it
  /// What the right writer does that is worth replaying: it moves the robot.
  std::vector<Replay> replays = {};
  bool commands = false;  ///< the intruder writes drive/command, too, with each sample
  bool by_hand = false;   ///< the operator's hand is on the sticks, which are not enabled

  std::string name() const { return topic.substr(3); }  ///< in the catalogue
  bool takes(const Way& way) const {
    return way.replay == Replay::kNothing || std::ranges::count(replays, way.replay) > 0;
  }
  /// Whether its samples can come to the reader while the robot has the right to drive. The readers
  /// match nobody who offers less than they ask for, or wants the topic for himself; and two who
  /// grant in the supervisor's name end the right at the base at once.
  bool can_get_through(const Way& way) const {
    const bool matches = !way.quality.best_effort && !way.quality.exclusive;
    return matches && !(commands && way.in_the_name_of_the_writer);
  }
  /// Under which names they are counted then. The reader's host keeps what is old from it.
  std::vector<std::string> counters(const Way& way) const {
    if (way.replay == Replay::kNothing) return {refusals};
    return {refusals, name() + ": late"};
  }
};

bool would_move(double v, double w) { return std::abs(v) > kMoving || std::abs(w) > kTurning; }
bool would_move(const DriveCommand& message) { return would_move(message.v(), message.w()); }
bool would_move(const geometry_msgs::msg::TwistStamped& message) {
  return would_move(message.twist().linear().x(), message.twist().angular().z());
}
/// With the hand on the sticks.
bool would_move(const MovementEnable& message) { return message.movement() && message.manual(); }

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
  return {.topic = "rt/" + std::string(topic.name),
          .type = std::string(runtime::message_type<Message>().name),
          .writer = std::string(writers.substr(0, writers.find(' '))),
          .reader = "movement_control",
          .refusals = std::string(topic.name) + ": from a second writer",
          .state = state,
          .forge = [make](const Forgery& forgery) { return bytes_of(make(forgery)); },
          .moves =
              [](const Bytes& cdr) {
                if constexpr (requires(const Message& m) { would_move(m); }) {
                  const auto message = runtime::message_type<Message>().deserialize(cdr);
                  return message != nullptr &&
                         would_move(*static_cast<const Message*>(message.get()));
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
  Target manual = make_target(topics::kCmdVelManual, STATE_MANUAL, forged_twist);
  Target interaction = make_target(topics::kCmdVelInteraction, STATE_INTERACTION, forged_twist);
  Target navigation = make_target(topics::kCmdVelNavigation, STATE_NAVIGATION_ACTIVE, forged_twist);
  Target grant = make_target(topics::kDriveGrant, STATE_MANUAL, forged_grant);
  Target enable = make_target(topics::kMovementEnable, STATE_INTERACTION, forged_enable);
  Target request = make_target(topics::kBaseRequest, STATE_MANUAL, forged_request);
  const auto at_the_base = [](Target& target, const char* what) {
    target.reader = "segway_rmp";
    target.refusals = std::string(what) + ": foreign writer";
  };
  at_the_base(command, "commands");
  at_the_base(grant, "grants");
  at_the_base(request, "requests");
  command.replays = {Replay::kDrivenByHand, Replay::kOnTheWay};
  manual.replays = enable.replays = {Replay::kDrivenByHand};
  interaction.replays = {Replay::kSearching};
  navigation.replays = {Replay::kOnTheWay};
  grant.commands = true;
  enable.by_hand = true;
  return {command, manual, interaction, grant, enable, request, navigation};
}

struct Attack {
  std::string topic, way;
  bool can_get_through = false;  ///< see Target
  std::uint64_t written = 0;
  /// Of those, what the reader had counted as refused by its last heartbeat before the robot's
  /// right to drive ended: less than came, since a flood overflows its mailbox.
  std::uint64_t with_the_right = 0;
  /// Commands at the wheels to drive or turn, or to switch their motors off, though nobody else
  /// wished so.
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

/// A foreign participant, and its writers while it has them.
class Intruder {
 public:
  /// When the supervisor named it, and how.
  struct Named {
    Instant at;
    std::string text;
  };

  /// Everything must outlive it. An empty replay: it forges.
  Intruder(AttackedRobot& robot, const Target& target, const Way& way,
           const std::vector<Bytes>& replay)
      : robot_(robot), target_(target), way_(way), replay_(replay) {}

  /// As a participant that writes nothing yet.
  Status join() {
    auto made = Observer::create({.name = name(), .host = "nuc", .domain = robot_.domain()});
    if (!made) return Error{made.error()};
    participant_ = std::move(made).value();
    return {};
  }
  bool finds_the_reader(seconds limit) const {
    return participant_->wait_for(
        [this](const Observer& observer) {
          const auto endpoints = observer.endpoints();
          return std::ranges::any_of(endpoints, [this](const auto& endpoint) {
            return !endpoint.writer && endpoint.topic == target_.topic &&
                   endpoint.participant == target_.reader;
          });
        },
        limit);
  }
  Status open() {
    Status status = open(target_.topic, target_.type, writer_);
    if (!status || !target_.commands) return status;
    return open("rt/" + std::string(topics::kDriveCommand.name),
                std::string(runtime::message_type<DriveCommand>().name), commander_);
  }
  void close() {
    commander_.reset();
    writer_.reset();
  }
  void leave() {
    close();
    participant_.reset();
  }
  bool is_matched() const { return writer_->reader_count() > 0; }

  void write(std::uint64_t number) {
    const Forgery own = forgery(number);
    writer_->write(replay_.empty() ? target_.forge(own) : replay_[number % replay_.size()]);
    if (!commander_) return;
    Forgery granted = own;
    ++granted.epoch;
    commander_->write(bytes_of(forged_command(granted)));
  }

  /// As an active fault, which ended the right to drive. Call it locked.
  std::optional<Named> named() const {
    if (!robot_.status() || robot_.status()->granted()) return std::nullopt;
    for (const auto& fault : robot_.status()->faults()) {
      const std::string text = fault.component_name() + ": " + fault.cause();
      if (fault.active() && fault.latched() && text.find(name()) != std::string::npos)
        return Named{robot_.status_at(), text};
    }
    return std::nullopt;
  }

 private:
  std::string name() const { return way_.in_the_name_of_the_writer ? target_.writer : kRogue; }
  Status open(const std::string& topic, const std::string& type,
              std::unique_ptr<Observer::RawWriter>& writer) {
    auto made = participant_->foreign_writer(topic, type, way_.quality);
    if (!made) return Error{made.error()};
    writer = std::move(made).value();
    return {};
  }
  Forgery forgery(std::uint64_t number) const {
    const auto lock = robot_.locked();
    return {number, robot_.status() ? robot_.status()->epoch() : 0, robot_.observer().now(),
            commander_ ? commander_->guid() : runtime::Guid{}};
  }

  AttackedRobot& robot_;
  const Target& target_;
  const Way& way_;
  const std::vector<Bytes>& replay_;
  std::unique_ptr<Observer> participant_;
  std::unique_ptr<Observer::RawWriter> writer_, commander_;
};

/// A process that stands still for a moment, at the longest while this lives.
class HeldUp {
 public:
  HeldUp(pid_t process, milliseconds time) : process_(process), until_(Clock::now() + time) {
    ::kill(process_, SIGSTOP);
  }
  ~HeldUp() { end(); }
  HeldUp(const HeldUp&) = delete;
  HeldUp& operator=(const HeldUp&) = delete;

  /// Goes on when its time has come.
  void end_in_time() {
    if (Clock::now() >= until_) end();
  }
  void wait() {
    std::this_thread::sleep_until(until_);
    end();
  }

 private:
  void end() {
    if (process_ != 0) ::kill(std::exchange(process_, 0), SIGCONT);
  }

  pid_t process_;
  const Instant until_;
};

class Monopoly {
 public:
  explicit Monopoly(AttackedRobot& robot) : robot_(robot) { robot_.let_it_search(false); }

  /// A newcomer that writes at once, and goes on when it is named; then strikes of one that has
  /// been there for a while.
  Result<Attack> run(const Target& target, const Way& way, std::uint64_t samples) {
    std::vector<Bytes> replay;
    if (way.replay != Replay::kNothing) {
      auto recorded = record(target, way.replay);
      if (!recorded) return Error{recorded.error()};
      replay = std::move(recorded).value();
    }
    if (!robot_.count(target.reader, target.counters(way)))
      return Error{target.reader + " is not heard"};
    Attack attack{
        .topic = target.name(), .way = way.name, .can_get_through = target.can_get_through(way)};
    const std::uint64_t each =
        attack.can_get_through ? std::min(kStrikeSamples, samples / (kStrikes + 1)) : 0;
    Intruder newcomer(robot_, target, way, replay);
    if (auto status = come(newcomer, target, samples - kStrikes * each, attack); !status)
      return Error{status.error()};
    if (each == 0) return attack;
    Intruder sleeper(robot_, target, way, replay);
    if (auto status = sleeper.join(); !status) return Error{status.error()};
    if (!sleeper.finds_the_reader(seconds(5)))
      return Error{"the intruder does not find " + target.reader + "'s reader"};
    for (std::uint64_t i = 0; i < kStrikes; ++i) {
      if (auto status = strike(sleeper, target, each, attack); !status)
        return Error{status.error()};
    }
    return attack;
  }

 private:
  /// It stands, and whoever writes the topic by right could drive it: the state in which a foreign
  /// sample would move it.
  Status make_ready(std::uint8_t state) {
    const auto until = Clock::now() + seconds(60);
    const auto ready = [&] { return robot_.all_well() && robot_.status()->state() == state; };
    milliseconds patience(0);  // what stopped it is over only when that is asked for
    while (Clock::now() < until) {
      const bool stands = robot_.wait_for(ready, patience) &&
                          robot_.wait_for([&] { return robot_.stays(); }, seconds(3));
      if (stands) return {};
      robot_.ask(SupervisorRequest_Constants::COMMAND_CLEAR, milliseconds(1000));
      for (const std::uint8_t command : way_to(state)) robot_.ask(command, milliseconds(1000));
      patience = milliseconds(500);
    }
    return Error{"the robot is not well or does not stand: " + robot_.motion_story() + "\n" +
                 robot_.complaints()};
  }

  /// Ready for the attack, and nothing is noted yet.
  Status prepare(const Target& target) {
    if (auto status = make_ready(target.state); !status) return status;
    if (target.by_hand) {
      robot_.hold(kRogueSpeed, kRogueTurn);
      std::this_thread::sleep_for(kHandReaches);
    }
    robot_.forget();
    return {};
  }

  /// Somebody whom nobody has met yet: how soon is it named?
  Status come(Intruder& intruder, const Target& target, std::uint64_t samples, Attack& attack) {
    if (auto status = prepare(target); !status) return status;
    if (auto status = intruder.join(); !status) return status;
    const Instant born = Clock::now();
    if (auto status = intruder.open(); !status) return status;
    std::optional<Intruder::Named> named;
    // What is written before anybody could hear it attacks nobody.
    robot_.wait_for(
        [&] {
          named = intruder.named();
          return named || intruder.is_matched();
        },
        milliseconds(500));
    flood(intruder, samples, nullptr, attack, named);
    attack.reported_ms = named ? std::chrono::duration<double, std::milli>(named->at - born).count()
                               : std::numeric_limits<double>::infinity();
    if (named) attack.reported_as = named->text;
    judge(born, attack);
    intruder.leave();
    return {};
  }

  /// Somebody who knows the robot's readers, and makes a writer while the supervisor is held up and
  /// what it granted holds: all that comes meanwhile meets a robot that may drive.
  Status strike(Intruder& intruder, const Target& target, std::uint64_t samples, Attack& attack) {
    if (auto status = prepare(target); !status) return status;
    const pid_t supervisor = robot_.process(kSupervisor);
    if (supervisor <= 0) return Error{"the supervisor does not run"};
    const Instant born = Clock::now();
    std::optional<Intruder::Named> named;
    {
      HeldUp held_up(supervisor, kHeldUp);
      if (auto status = intruder.open(); !status) return status;
      std::this_thread::sleep_for(kMatched);
      flood(intruder, samples, &held_up, attack, named);
    }
    if (!named) attack.reported_ms = std::numeric_limits<double>::infinity();
    judge(born, attack);
    intruder.close();
    return {};
  }

  /// Writes so many samples, and waits a while to be named.
  void flood(Intruder& intruder, std::uint64_t samples, HeldUp* held_up, Attack& attack,
             std::optional<Intruder::Named>& named) {
    for (std::uint64_t i = 0; i < samples; ++i) {
      if (held_up != nullptr) held_up->end_in_time();
      intruder.write(attack.written++);
      if (named) continue;
      const auto lock = robot_.locked();
      named = intruder.named();
    }
    if (held_up != nullptr) held_up->wait();
    if (named) return;
    robot_.wait_for([&] { return (named = intruder.named()).has_value(); }, seconds(2));
  }

  /// Its writers are still there: what is under way arrives.
  void judge(Instant since, Attack& attack) {
    std::this_thread::sleep_for(kUnderWay);
    attack.executed += executed(since, attack.topic + ", " + attack.way);
    {
      const auto lock = robot_.locked();
      attack.with_the_right += robot_.counted_with_the_right();
    }
    robot_.release();
  }

  /// Commands to drive, to turn or to switch off that reached the wheels; says what the first one
  /// was.
  std::uint64_t executed(Instant since, const std::string& attack) {
    const auto obeys = [](const AttackedRobot::Wheels& wheels) {
      return !wheels.still() || wheels.off;
    };
    const auto lock = robot_.locked();
    const auto first = std::ranges::find_if(robot_.wheels(), obeys);
    if (first == robot_.wheels().end()) return 0;
    std::printf("%s: executed %.3f m/s %.3f rad/s%s, %.0f ms after the intruder's birth\n",
                attack.c_str(), first->v, first->w, first->off ? ", motors off" : "",
                std::chrono::duration<double, std::milli>(first->at - since).count());
    return static_cast<std::uint64_t>(std::count_if(first, robot_.wheels().end(), obeys));
  }

  static std::vector<std::uint8_t> way_to(std::uint8_t state) {
    using namespace SupervisorRequest_Constants;
    if (state == SupervisorStatus_Constants::STATE_MANUAL) return {COMMAND_MANUAL_ON};
    if (state == SupervisorStatus_Constants::STATE_INTERACTION)
      return {COMMAND_NAVIGATION_END, COMMAND_MANUAL_OFF};
    return {COMMAND_MANUAL_OFF, COMMAND_NAVIGATION_START, COMMAND_NAVIGATION_GO};
  }

  /// Of what the right writer sends meanwhile, the samples that move the robot. What it sends must
  /// move the wheels, or nothing would be proven by what the intruder's samples do not.
  Result<std::vector<Bytes>> record(const Target& target, Replay replay) {
    using namespace SupervisorStatus_Constants;
    if (auto status = make_ready(replay == Replay::kDrivenByHand ? STATE_MANUAL
                                 : replay == Replay::kSearching  ? STATE_INTERACTION
                                                                 : STATE_NAVIGATION_ACTIVE);
        !status)
      return Error{status.error()};
    if (replay == Replay::kOnTheWay && !robot_.set_out(kFarAway, seconds(20))) {
      robot_.call_off();
      return Error{"the robot does not set out: " + robot_.complaints()};
    }
    auto recording = Recording::make(robot_.observer(), target);
    if (!recording) return Error{recording.error()};
    robot_.forget();
    move(replay);
    auto samples = (*recording)->samples();
    const std::size_t all = samples.size();
    std::erase_if(samples, [&](const Bytes& sample) { return !target.moves(sample); });
    if (samples.size() < kLeastRecorded) {
      return Error{"only " + std::to_string(samples.size()) + " of " + std::to_string(all) +
                   " recorded samples would move the robot"};
    }
    const auto lock = robot_.locked();
    const bool moved = std::ranges::any_of(
        robot_.wheels(), [](const auto& wheels) { return would_move(wheels.v, wheels.w); });
    if (!moved) return Error{"what the right writer sent did not move the wheels"};
    return samples;
  }

  /// As is worth replaying.
  void move(Replay replay) {
    constexpr auto kTime = milliseconds(1500);
    switch (replay) {
      case Replay::kNothing:
        return;
      case Replay::kDrivenByHand:
        for (const double way : {1.0, -1.0}) {  // and back, or it would soon be at a wall
          robot_.hold(way * kRogueSpeed, way * kRogueTurn);
          std::this_thread::sleep_for(kTime);
        }
        robot_.release();
        return;
      case Replay::kSearching:
        robot_.let_it_search(true);
        std::this_thread::sleep_for(2 * kTime);
        robot_.let_it_search(false);
        return;
      case Replay::kOnTheWay:
        std::this_thread::sleep_for(kTime);
        robot_.call_off();
        return;
    }
  }

  AttackedRobot& robot_;
};

Table table_of(const std::vector<Attack>& attacks) {
  Table table({"topic", "intruder", "samples", "refused while it had the right to drive",
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
    if (attack.can_get_through) {
      least_with_the_right =
          std::min(least_with_the_right, static_cast<double>(attack.with_the_right));
    }
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
      "stop): same quality, latched, best effort, the right writer's name, exclusive ownership "
      "of the highest strength, and what the right writer sent that moved the robot, replayed; "
      "first as a newcomer that goes on after the robot's right to drive was withdrawn, then three "
      "times as one that is there already and begins while the supervisor is held up for 60 ms. "
      "Executed is what reaches the wheels until 0.5 s after the last sample: a speed, a turn "
      "rate, or an order to switch off. samples_with_the_right is what the component that would "
      "obey says that it refused, in its last heartbeat before the right to drive ended: less than "
      "came, since it counts what its mailbox holds in each of its turns. The least is of one "
      "attack; left out are best effort and exclusive ownership, which no reader matches, and "
      "drive/grant in the supervisor's name, which ends the right itself";
  sheet.metrics = {{"samples", samples},
                   {"samples_with_the_right", with_the_right},
                   {"samples_with_the_right_least", least_with_the_right},
                   {"executed", executed},
                   {"named_ms_max", slowest}};
  sheet.targets = {{"samples", {Bound::kAtLeast, wanted}},
                   {"samples_with_the_right_least", {Bound::kAtLeast, kLeastWithTheRight}},
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
  Monopoly monopoly(**robot);
  std::vector<Attack> done;
  double samples = 0.0;
  for (const auto& target : all) {
    for (const auto& way : ways()) {
      if (!target.takes(way)) continue;
      show_progress(target.topic + ", " + way.name + ": " + format("%.0f", samples) + " of " +
                    std::to_string(wanted) + " samples");
      const auto number = static_cast<std::uint64_t>(done.size());
      const std::uint64_t share =
          wanted * (number + 1) / attacks - wanted * number / attacks;  // none is left over
      const auto attack = monopoly.run(target, way, share);
      if (!attack) return Error{target.topic + ", " + way.name + ": " + attack.error()};
      if (attack->executed > 0) {
        std::printf("%s, %s: %lu executed\n", attack->topic.c_str(), attack->way.c_str(),
                    attack->executed);
      }
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
  return sheet_of(done, static_cast<double>(wanted));
}

}  // namespace usher::operations
