#pragma once

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace usher::operations {

/// What may go wrong with a robot that drives.
enum class FaultKind : std::uint8_t {
  kCrash,         ///< kill -9 of a component, which is back later
  kHang,          ///< a component's handlers do not return
  kSlow,          ///< its handlers take most of the time
  kBaseLink,      ///< the line between base driver and base
  kTopicSilence,  ///< nothing that is written on a topic arrives
  kBadCommand,    ///< the right writer's commands are none that may be driven
  kRogue,         ///< a foreign participant writes a topic that moves the robot
  kLink,          ///< loss, delay, disorder or cuts between two hosts
  kClock,         ///< the clock of a host jumps
  kLaser,         ///< the laser is silent, frozen, not finite or biased
  kWhiskers,      ///< the whiskers are silent or stuck
  kOdometry,      ///< the base's encoders and gyroscope are frozen, not finite or biased
  kFlood,         ///< a participant writes a topic as fast as it can
  kStick,         ///< an operator's stick is held though nobody asked for manual driving
  // Of a robot that has depth cameras.
  kDepth,       ///< a depth camera, or both, is silent, frozen or not finite
  kUltrasonic,  ///< the ultrasonic sensors are silent or not finite, or one is stuck at something
                ///< near
  kPeople,      ///< what is said of people is silent or frozen, or there is one who is not there
};
inline constexpr std::size_t kBlindFaultKinds = 14;  ///< of a robot without depth cameras
inline constexpr std::size_t kFaultKinds = 17;

std::string_view text(FaultKind kind);

/// One thing that goes wrong.
struct Fault {
  FaultKind kind = FaultKind::kCrash;
  std::string target;   ///< component, topic, host or pair of hosts; empty where there is one only
  std::string variant;  ///< how; empty where there is one way only
  double duration = 0.0;  ///< [s] {> 0} from the hit on
  double amount =
      0.0;  ///< of a bias [m] [rad/s], a delay [s], a loss [-], a jump [s]; a distance [m]

  /// "laser frozen for 3.2 s"
  std::string text() const;
};

/// What the laws of the movement chain demand while a fault lasts.
struct Expectation {
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  /// [s] after the hit the wheels get zero, and the robot stands within its stopping distance from
  /// there; kNever: it may drive on.
  double zero_within = kNever;
  double forward_barred_within = kNever;  ///< [s] likewise, but it may still drive backwards
  double revoked_within = kNever;         ///< [s] after the hit nobody has the right to drive
  /// The line to the base is cut: what it touches meanwhile no software keeps it from.
  bool deaf = false;
  double lasts = 0.0;              ///< [s] after the hit these hold
  double read_within = 2.5;        ///< [s] after that an operator reads the reason
  std::vector<std::string> words;  ///< one of them is in the reason that an operator reads
};

/// A window: where the robot starts, where it goes, when what hits it.
struct WindowPlan {
  std::uint64_t seed = 0;
  std::size_t start = 0;       ///< of the places where it may start
  double yaw = 0.0;            ///< [rad] there
  std::size_t goal = 0;        ///< of the site's locations
  double delay = 0.0;          ///< [s] from the first moment at which it drives to the hit
  bool sensing_apart = false;  ///< laser, sensor board and scan filter run on a host of their own
  std::vector<Fault> faults;   ///< one or two, at the same moment

  /// "two at once" or the kind of the one.
  std::string kind() const;
  std::string text() const;
};

/// Whom faults may hit.
struct FaultTargets {
  std::vector<std::string> components;
  std::set<std::string> critical;  ///< without which nobody may drive
  std::string base_driver;         ///< its loss leaves the base to the guard process
  std::size_t starts = 0;          ///< {> 0} places where the robot may start
  std::size_t locations = 0;       ///< {> 0} places that it may go to
  bool sees = false;               ///< it has depth cameras
};

/// The participant that floods.
inline constexpr const char* kFlooder = "flooder";

/// How long a window lasts after its hit [s].
inline constexpr double kWindow = 20.0;

/// The same seed and attempt give the same plan.
WindowPlan draw_window(std::uint64_t seed, int attempt, const FaultTargets& targets);

Expectation expectation(const Fault& fault, const FaultTargets& targets);

/// Of all faults of a plan, minding what they mean for each other.
std::vector<Expectation> expectations(const WindowPlan& plan, const FaultTargets& targets);

}  // namespace usher::operations
