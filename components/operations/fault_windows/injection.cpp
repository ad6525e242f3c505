#include "operations/fault_windows/injection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "idl/topics.hpp"
#include "operations/experiments/errand.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Bytes;
using runtime::Duration;
using runtime::from_seconds;
using runtime::Guid;
using runtime::LockstepWorld;
using runtime::Time;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr auto kSlowPeriod = milliseconds(100);
constexpr auto kRoguePeriod = milliseconds(10);
constexpr auto kFloodPeriod = microseconds(500);
constexpr auto kJoyPeriod = milliseconds(40);
/// Before and after the fault a link is as the world has it by itself.
const runtime::Link kWell = runtime::NetworkOptions{}.between_hosts;

Time end_of(const Fault& fault, const LockstepWorld& world) {
  return world.now() + from_seconds(fault.duration);
}

/// Calls `act` now and again until the end.
void repeat(LockstepWorld& world, Time until, Duration period, std::function<void()> act) {
  if (world.now() >= until) return;
  act();
  world.at(world.now() + period, [&world, until, period, act = std::move(act)]() mutable {
    repeat(world, until, period, std::move(act));
  });
}

/// Changes what is written on the topic until the end.
template <class Message>
void tamper_until(LockstepWorld& world, const topics::Topic<Message>& topic, Time until,
                  std::function<void(Message&)> change) {
  world.tamper(topic, [&world, until, change = std::move(change)](const Guid&, Message& message) {
    if (world.now() < until) change(message);
    return true;
  });
}

void silence(LockstepWorld& world, const std::string& topic, Time until) {
  world.tamper_bytes(topic, [&world, until](const Guid&, Bytes&) { return world.now() >= until; });
}

/// The first message that is written from now on, again and again.
template <class Message>
std::function<Message(const Message&)> frozen() {
  return [first = std::make_shared<std::optional<Message>>()](const Message& message) {
    if (!*first) *first = message;
    return **first;
  };
}

void break_component(const Fault& fault, LockstepWorld& world) {
  const Duration duration = from_seconds(fault.duration);
  if (fault.kind == FaultKind::kCrash) {
    world.kill(fault.target, duration);
  } else if (fault.kind == FaultKind::kHang) {
    world.hang(fault.target, duration);
  } else {
    const auto busy = from_seconds(fault.amount * runtime::seconds(kSlowPeriod));
    repeat(world, end_of(fault, world), kSlowPeriod,
           [&world, name = fault.target, busy] { world.hang(name, busy); });
  }
}

void cut_base_line(const Fault& fault, LockstepWorld& world) {
  const Time until = end_of(fault, world);
  if (fault.variant != "feedback") silence(world, std::string(topics::kSimBaseCommand.name), until);
  if (fault.variant != "commands")
    silence(world, std::string(topics::kSimBaseFeedback.name), until);
}

void spoil_commands(const Fault& fault, LockstepWorld& world) {
  using usher_msgs::msg::DriveCommand;
  const auto first = frozen<DriveCommand>();
  tamper_until<DriveCommand>(world, topics::kDriveCommand, end_of(fault, world),
                             [first, variant = fault.variant](DriveCommand& command) {
                               if (variant == "repeated") {
                                 const auto stamp = command.stamp();
                                 command = first(command);
                                 command.stamp(stamp);
                               } else if (variant == "old epoch") {
                                 command.epoch(command.epoch() - 1);
                               } else if (variant == "not finite") {
                                 command.v(kNan);
                               } else {
                                 command.v(std::copysign(5.0, command.v()));
                               }
                             });
}

/// What a participant that must not be there wants: to drive, to let itself drive, to switch the
/// motors off.
class RogueWriter {
 public:
  RogueWriter(LockstepWorld& world, const Fault& fault)
      : world_(world), name_(fault.variant), v_(fault.amount) {}

  void write(const std::string& topic) {
    const auto stamp = wire::to_message(world_.now());
    if (topic == topics::kDriveCommand.name) {
      usher_msgs::msg::DriveCommand command;
      command.stamp(stamp);
      command.epoch(*epoch_ + (granted_ ? 1 : 0));
      command.number(*number_ + 1000 + ++count_);
      command.v(v_);
      command.w(v_);
      world_.publish(topics::kDriveCommand, command, name_);
    } else if (topic == topics::kDriveGrant.name) {
      usher_msgs::msg::DriveGrant grant;
      grant.stamp(stamp);
      grant.granted(true);
      grant.epoch(*epoch_ + 1);
      grant.writer(world_.writer_guid(topics::kDriveCommand, name_));
      grant.valid_for(0.12F);
      granted_ = true;
      world_.publish(topics::kDriveGrant, grant, name_);
    } else if (topic == topics::kMovementEnable.name) {
      usher_msgs::msg::MovementEnable enable;
      enable.header(wire::header(world_.now(), ""));
      enable.movement(true), enable.manual(true), enable.navigation(true);
      enable.speed_factor(1.0F);
      enable.epoch(*epoch_);
      world_.publish(topics::kMovementEnable, enable, name_);
    } else if (topic == topics::kBaseRequest.name) {
      usher_msgs::msg::BaseRequest request;
      request.id(++count_);
      request.client(name_);
      request.command(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
      world_.publish(topics::kBaseRequest, request, name_);
    } else {
      write_wish(topic);
    }
  }
  /// Those that a judge has to know.
  std::vector<Guid> writers(const std::string& topic) {
    if (topic == topics::kDriveCommand.name)
      return {world_.writer_guid(topics::kDriveCommand, name_)};
    if (topic == topics::kDriveGrant.name) {
      return {world_.writer_guid(topics::kDriveCommand, name_),
              world_.writer_guid(topics::kDriveGrant, name_)};
    }
    if (topic == topics::kMovementEnable.name)
      return {world_.writer_guid(topics::kMovementEnable, name_)};
    if (topic == topics::kCmdVelManual.name)
      return {world_.writer_guid(topics::kCmdVelManual, name_)};
    if (topic == topics::kCmdVelInteraction.name)
      return {world_.writer_guid(topics::kCmdVelInteraction, name_)};
    if (topic == topics::kCmdVelNavigation.name)
      return {world_.writer_guid(topics::kCmdVelNavigation, name_)};
    return {};
  }
  /// Knows what it needs to look right.
  void listen() {
    world_.observe(topics::kDriveCommand,
                   [epoch = epoch_, number = number_](const auto& command, const auto&) {
                     *epoch = std::max(*epoch, command.epoch());
                     *number = std::max(*number, command.number());
                   });
  }

 private:
  void write_wish(const std::string& topic) {
    const auto message = wire::to_message(world_.now(), geometry::Twist2{v_, v_});
    if (topic == topics::kCmdVelManual.name) {
      world_.publish(topics::kCmdVelManual, message, name_);
    } else if (topic == topics::kCmdVelInteraction.name) {
      world_.publish(topics::kCmdVelInteraction, message, name_);
    } else {
      world_.publish(topics::kCmdVelNavigation, message, name_);
    }
  }

  LockstepWorld& world_;
  std::string name_;
  double v_;
  std::uint64_t count_ = 0;
  bool granted_ = false;  ///< the right to himself
  std::shared_ptr<std::uint64_t> epoch_ = std::make_shared<std::uint64_t>(0);
  std::shared_ptr<std::uint64_t> number_ = std::make_shared<std::uint64_t>(0);
};

std::vector<Guid> let_rogue_in(const Fault& fault, LockstepWorld& world) {
  const auto rogue = std::make_shared<RogueWriter>(world, fault);
  rogue->listen();
  const Time until = end_of(fault, world);
  auto writers = rogue->writers(fault.target);
  // Not before the caller knows its writers.
  world.at(world.now(), [&world, rogue, until, topic = fault.target] {
    repeat(world, until, kRoguePeriod, [rogue, topic] {
      rogue->write(topic);
      // Who grants himself the right means to use it.
      if (topic == topics::kDriveGrant.name) rogue->write(std::string(topics::kDriveCommand.name));
    });
  });
  world.at(until, [&world, name = fault.variant] { world.leave(name); });
  return writers;
}

void trouble_link(const Fault& fault, LockstepWorld& world) {
  const std::string& host = fault.target;
  const Time until = end_of(fault, world);
  if (fault.variant == "cut") {
    world.cut("nuc", host, world.now(), until);
  } else if (fault.variant == "cut from nuc") {
    world.cut_one_way("nuc", host, world.now(), until);
  } else if (fault.variant == "cut to nuc") {
    world.cut_one_way(host, "nuc", world.now(), until);
  } else {
    runtime::Link link = kWell;
    if (fault.variant == "loss") link.loss = fault.amount;
    if (fault.variant == "delay") link.latency = from_seconds(fault.amount);
    if (fault.variant == "disorder") link.jitter = from_seconds(fault.amount);
    world.set_link("nuc", host, link);
    world.at(until, [&world, host] { world.set_link("nuc", host, kWell); });
  }
}

void break_laser(const Fault& fault, LockstepWorld& world) {
  using sensor_msgs::msg::LaserScan;
  const Time until = end_of(fault, world);
  if (fault.variant == "silent") {
    silence(world, std::string(topics::kSimScan.name), until);
    return;
  }
  const auto first = frozen<LaserScan>();
  tamper_until<LaserScan>(
      world, topics::kSimScan, until,
      [first, variant = fault.variant, bias = static_cast<float>(fault.amount)](LaserScan& scan) {
        if (variant == "frozen") scan.ranges(first(scan).ranges());
        if (variant == "frozen") return;
        for (float& range : scan.ranges()) range = variant == "biased" ? range + bias : kNan;
      });
}

void break_whiskers(const Fault& fault, LockstepWorld& world) {
  using usher_sim_msgs::msg::SensorBoardReading;
  const Time until = end_of(fault, world);
  if (fault.variant == "silent") {
    silence(world, std::string(topics::kSimSensorBoard.name), until);
    return;
  }
  tamper_until<SensorBoardReading>(
      world, topics::kSimSensorBoard, until,
      [pressed = fault.variant == "pressed"](SensorBoardReading& board) {
        board.front_left(pressed), board.front_right(pressed);
        if (!pressed) board.back_left(false), board.back_right(false);
      });
}

void break_odometry(const Fault& fault, LockstepWorld& world) {
  using usher_sim_msgs::msg::BaseFeedback;
  const auto first = frozen<BaseFeedback>();
  tamper_until<BaseFeedback>(
      world, topics::kSimBaseFeedback, end_of(fault, world),
      [first, variant = fault.variant, bias = fault.amount](BaseFeedback& feedback) {
        if (variant == "frozen") {
          const auto header = feedback.header();
          feedback = first(feedback);
          feedback.header(header);
        } else if (variant == "not finite") {
          feedback.left_velocity(kNan), feedback.left_travel(kNan);
        } else {
          feedback.yaw_rate(feedback.yaw_rate() + bias);
          feedback.left_velocity(feedback.left_velocity() * (1.0 + bias));
          feedback.right_velocity(feedback.right_velocity() * (1.0 + bias));
        }
      });
}

/// All that the camera's model says, with its own stamps where it is frozen.
template <class Message>
void break_picture(LockstepWorld& world, const topics::Topic<Message>& topic, const Fault& fault,
                   const std::function<void(Message&)>& spoil) {
  const Time until = end_of(fault, world);
  if (fault.variant == "silent") {
    silence(world, std::string(topic.name), until);
  } else if (fault.variant == "not finite") {
    tamper_until<Message>(world, topic, until, spoil);
  } else {
    tamper_until<Message>(world, topic, until, [first = frozen<Message>()](Message& message) {
      const auto header = message.header();
      message = first(message);
      message.header(header);
    });
  }
}

void break_cameras(const Fault& fault, LockstepWorld& world) {
  const std::function<void(sensor_msgs::msg::LaserScan&)> no_ranges = [](auto& scan) {
    for (float& range : scan.ranges()) range = kNan;
  };
  const std::function<void(usher_sim_msgs::msg::Sightings&)> no_places = [](auto& people) {
    for (auto& sighting : people.sightings()) sighting.forward(kNan);
  };
  if (fault.target != "rear camera") {
    break_picture(world, topics::kSimKinectScan, fault, no_ranges);
    break_picture(world, topics::kSimKinectScanLow, fault, no_ranges);
    break_picture(world, topics::kSimKinectPeople, fault, no_places);
  }
  if (fault.target != "kinect") {
    break_picture(world, topics::kSimRearScan, fault, no_ranges);
    break_picture(world, topics::kSimRearPeople, fault, no_places);
  }
}

void break_ultrasonic(const Fault& fault, LockstepWorld& world) {
  using usher_sim_msgs::msg::SensorBoardReading;
  const Time until = end_of(fault, world);
  if (fault.variant == "silent") {
    silence(world, std::string(topics::kUltrasonic.name), until);
    return;
  }
  tamper_until<SensorBoardReading>(
      world, topics::kSimSensorBoard, until,
      [near = fault.variant == "near",
       distance = static_cast<float>(fault.amount)](SensorBoardReading& board) {
        auto& ranges = board.ranges();
        if (near && !ranges.empty()) ranges[ranges.size() / 2] = distance;
        if (!near) std::ranges::fill(ranges, kNan);
      });
}

/// Stands before the robot where that was at the hit.
class Ghost {
 public:
  explicit Ghost(double distance) : ahead_(distance) {}
  void join(const nav_msgs::msg::Odometry& odom) {
    if (place_) return;
    if (const auto pose = wire::to_planar(odom.pose().pose()))
      place_ = *pose * geometry::Point2(ahead_, 0.0);
  }
  void join(usher_msgs::msg::People& people) const {
    if (!place_) return;
    auto& ghost = people.people().emplace_back();
    ghost.id(1'000'000);
    ghost.x(place_->x());
    ghost.y(place_->y());
    for (const std::size_t i : {0U, 5U, 10U, 15U}) ghost.covariance()[i] = 0.01;
    ghost.height(1.7F);
    ghost.age(1.0F);
    ghost.by_kinect(true);
  }

 private:
  double ahead_;
  std::optional<geometry::Point2> place_;
};

void spoil_people(const Fault& fault, LockstepWorld& world) {
  using usher_msgs::msg::People;
  using usher_msgs::msg::PersonAhead;
  if (fault.variant != "false") {
    break_picture<People>(world, topics::kPeople, fault, {});
    break_picture<PersonAhead>(world, topics::kPersonAhead, fault, {});
    return;
  }
  const auto ghost = std::make_shared<Ghost>(fault.amount);
  world.observe(topics::kOdom, [ghost](const auto& odom, const auto&) { ghost->join(odom); });
  tamper_until<People>(world, topics::kPeople, end_of(fault, world),
                       [ghost](People& people) { ghost->join(people); });
}

/// Of no meaning to anybody, and very many.
void flood_once(LockstepWorld& world, const std::string& topic, std::uint64_t number) {
  if (topic == topics::kHeartbeat.name) {
    usher_msgs::msg::Heartbeat heartbeat;
    heartbeat.component_name("nobody");
    world.publish(topics::kHeartbeat, heartbeat, kFlooder);
  } else if (topic == topics::kSupervisorRequest.name) {
    usher_msgs::msg::SupervisorRequest request;
    request.id(number);
    request.client(kFlooder);
    world.publish(topics::kSupervisorRequest, request, kFlooder);
  } else if (topic == topics::kTf.name) {
    tf2_msgs::msg::TFMessage frames;
    frames.transforms().emplace_back().child_frame_id("nowhere");
    world.publish(topics::kTf, frames, kFlooder);
  } else if (topic == topics::kJoy.name) {
    world.publish(topics::kJoy, sensor_msgs::msg::Joy(), kFlooder);
  } else {
    world.publish(topics::kPeople, usher_msgs::msg::People(), kFlooder);
  }
}

void flood(const Fault& fault, LockstepWorld& world) {
  repeat(world, end_of(fault, world), kFloodPeriod,
         [&world, topic = fault.target, number = std::uint64_t{0}]() mutable {
           flood_once(world, topic, ++number);
         });
}

void hold_stick(const Fault& fault, LockstepWorld& world) {
  // Held from the beginning it would not count: first it is seen released.
  repeat(world, end_of(fault, world), kJoyPeriod,
         [&world, held = 0, deflection = static_cast<float>(fault.amount)]() mutable {
           sensor_msgs::msg::Joy joy;
           joy.axes({0.0F, deflection, 0.0F, deflection});
           joy.buttons({0, 0, 0, 0, held});
           held = 1;
           world.publish(topics::kJoy, joy, Errand::kClient);
         });
}

}  // namespace

std::vector<Guid> inject(const Fault& fault, LockstepWorld& world) {
  switch (fault.kind) {
    case FaultKind::kCrash:
    case FaultKind::kHang:
    case FaultKind::kSlow:
      break_component(fault, world);
      break;
    case FaultKind::kBaseLink:
      cut_base_line(fault, world);
      break;
    case FaultKind::kTopicSilence:
      silence(world, fault.target, end_of(fault, world));
      break;
    case FaultKind::kBadCommand:
      spoil_commands(fault, world);
      break;
    case FaultKind::kRogue:
      return let_rogue_in(fault, world);
    case FaultKind::kLink:
      trouble_link(fault, world);
      break;
    case FaultKind::kClock:
      world.jump_clock(fault.target, from_seconds(fault.amount));
      break;
    case FaultKind::kLaser:
      break_laser(fault, world);
      break;
    case FaultKind::kWhiskers:
      break_whiskers(fault, world);
      break;
    case FaultKind::kOdometry:
      break_odometry(fault, world);
      break;
    case FaultKind::kFlood:
      flood(fault, world);
      break;
    case FaultKind::kStick:
      hold_stick(fault, world);
      break;
    case FaultKind::kDepth:
      break_cameras(fault, world);
      break;
    case FaultKind::kUltrasonic:
      break_ultrasonic(fault, world);
      break;
    case FaultKind::kPeople:
      spoil_people(fault, world);
      break;
  }
  return {};
}

}  // namespace usher::operations
