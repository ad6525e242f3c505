#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "operations/command_line/table.hpp"
#include "operations/experiments/attacked_robot.hpp"
#include "operations/experiments/experiment.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = AttackedRobot::Clock;
using namespace usher_msgs::msg;

constexpr double kMinutes = 60.0;
constexpr double kSpeed = 0.5;
constexpr double kRadius = 1.0;                   // [m] around this place of the foyer:
constexpr double kCenterX = 3.9, kCenterY = 3.9;  // [m] a metre from everything on its circle
constexpr double kInward = 1.0;                   // [rad/m]
constexpr double kTurnIn = 1.0;                   // [1/s]

/// Threads that compute as fast as they can.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int i = 0; i < count; ++i) {
      threads_.emplace_back([this] {
        while (!ends_.load(std::memory_order_relaxed)) {
        }
      });
    }
  }
  ~BusyLoops() {
    ends_ = true;
    for (auto& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> ends_{false};
  std::vector<std::thread> threads_;
};

/// The longest pause on a topic, as somebody beside the robot hears it.
template <class Message>
class Pauses {
 public:
  Pauses(runtime::Observer& observer, const topics::Topic<Message>& topic)
      : reader_(observer.reader(topic, [this](const auto&, const auto&) {
          const auto now = Clock::now();
          const std::lock_guard lock(mutex_);
          if (last_) longest_ = std::max(longest_, now - *last_);
          last_ = now;
        })) {}
  Status status() const { return reader_ ? Status() : Status(Error{reader_.error()}); }
  void forget() {
    const std::lock_guard lock(mutex_);
    longest_ = {};
  }
  double longest_ms() const {
    const std::lock_guard lock(mutex_);
    return std::chrono::duration<double, std::milli>(longest_).count();
  }

 private:
  mutable std::mutex mutex_;
  std::optional<Clock::time_point> last_;
  Clock::duration longest_{};
  Result<runtime::Observer::Reader<Message>> reader_;  ///< ends first
};

/// Who walks through the circle, or stands beside it, would stop the robot for a cause.
class PeopleAway {
 public:
  explicit PeopleAway(AttackedRobot& robot)
      : writer_(robot.observer().writer(topics::kSimPersonGoal)) {}
  Status status() const { return writer_ ? Status() : Status(Error{writer_.error()}); }
  /// To be called again and again: who is there would go his own way.
  void send() {
    struct Place {
      const char* name;
      double x, y;
    };
    constexpr Place kPlaces[] = {{"visitor", 2.0, 7.6}, {"dijkstra", 8.5, 10.0}};
    for (const auto& place : kPlaces) {
      usher_sim_msgs::msg::PersonGoal goal;
      goal.name(place.name);
      goal.x(place.x);
      goal.y(place.y);
      goal.speed(1.2);
      writer_->write(goal);
    }
  }

 private:
  Result<runtime::Observer::Writer<usher_sim_msgs::msg::PersonGoal>> writer_;
};

/// Keeps the robot on its circle however long it drives, and whatever slows it for a moment.
void steer(AttackedRobot& robot) {
  geometry::Pose2 pose;
  {
    const auto lock = robot.locked();
    if (robot.motions().empty()) return;
    pose = robot.motions().back().pose;
  }
  const geometry::Point2 out = pose.position() - geometry::Point2(kCenterX, kCenterY);
  const double inward = std::clamp(kInward * (out.norm() - kRadius), -1.0, 1.0);  // [rad]
  const double heading = std::atan2(out.x(), -out.y()) + inward;
  const double error = geometry::shortest_turn(pose.yaw, heading);
  robot.hold(kSpeed, std::clamp(kSpeed / kRadius + kTurnIn * error, 0.0, 0.8));
}

}  // namespace

Result<ResultSheet> run_false_stops_experiment(const ExperimentOptions& options) {
  const double minutes = options.minutes > 0.0 ? options.minutes : kMinutes;
  auto launched = AttackedRobot::launch(options.installation, options.out + "/run", options.domain);
  if (!launched) return Error{launched.error()};
  AttackedRobot& robot = **launched;
  if (!robot.wait_for([&] { return robot.all_well(); }, seconds(60)) ||
      !robot.ask(SupervisorRequest_Constants::COMMAND_MANUAL_ON, seconds(10)))
    return Error{"the robot is not well: " + robot.complaints()};
  PeopleAway people(robot);
  if (!people.status()) return Error{people.status().error()};
  for (int i = 0; i < 100; ++i) {  // until they are there
    people.send();
    std::this_thread::sleep_for(milliseconds(100));
  }
  Pauses commands_heard(robot.observer(), topics::kDriveCommand);
  Pauses grants_heard(robot.observer(), topics::kDriveGrant);
  if (!commands_heard.status()) return Error{commands_heard.status().error()};
  if (!grants_heard.status()) return Error{grants_heard.status().error()};
  std::mutex mutex;
  std::string limit;
  const auto movement =
      robot.observer().reader(topics::kMovementStatus, [&](const auto& message, const auto&) {
        const std::lock_guard lock(mutex);
        limit = message.limit_reason();
      });
  if (!movement) return Error{movement.error()};
  steer(robot);
  if (!robot.wait_for([&] { return robot.drives(0.8 * kSpeed); }, seconds(15)))
    return Error{"the robot does not drive: " + robot.complaints()};

  const BusyLoops busy(2);
  std::this_thread::sleep_for(seconds(1));
  robot.forget();
  commands_heard.forget();
  grants_heard.forget();
  std::uint64_t grants_lost_before = 0;
  {
    const auto lock = robot.locked();
    grants_lost_before = robot.grants_lost();
  }
  std::uint64_t commands = 0, stops = 0;
  double longest_gap = 0.0, metres = 0.0;
  std::uint32_t contacts = 0;
  bool zero = false;
  std::optional<AttackedRobot::Motion> place;
  std::string log;
  const auto begin = Clock::now();
  const auto end = begin + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double, std::ratio<60>>(minutes));
  auto last = begin;
  while (Clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(100));
    steer(robot);
    people.send();
    {
      const auto lock = robot.locked();
      for (const auto& wheels : robot.wheels()) {
        ++commands;
        longest_gap =
            std::max(longest_gap, std::chrono::duration<double>(wheels.at - last).count());
        last = wheels.at;
        if (wheels.zero() && !zero) {
          ++stops;
          log += format("%.3f", std::chrono::duration<double>(wheels.at - begin).count()) +
                 " s: " + (robot.status() ? robot.status()->reason() : "");
          const std::lock_guard also(mutex);
          log += (limit.empty() ? "" : "; movement_control: " + limit) + "\n";
        }
        zero = wheels.zero();
      }
      for (const auto& motion : robot.motions()) {
        if (place) metres += geometry::distance(place->pose, motion.pose);
        place = motion;
        contacts = std::max(contacts, motion.contacts);
      }
    }
    robot.forget();
    show_progress(
        format("%.1f",
               std::chrono::duration<double, std::ratio<60>>(Clock::now() - begin).count()) +
        " of " + format("%.0f", minutes) + " minutes, " + std::to_string(stops) + " stops");
  }
  show_progress("");
  ResultSheet sheet;
  sheet.name = "false-stops";
  sheet.input = "MARVIN as processes with driver, guard and emulated base, " +
                format("%.0f", minutes) + " minutes of circles at " + format("%.1f", kSpeed) +
                " m/s beside two busy loops";
  sheet.metrics["minutes"] = minutes;
  sheet.metrics["metres"] = metres;
  sheet.metrics["commands"] = static_cast<double>(commands);
  sheet.metrics["false_stops"] = static_cast<double>(stops);
  sheet.metrics["longest_gap_ms"] = longest_gap * 1e3;
  sheet.metrics["longest_command_pause_ms"] = commands_heard.longest_ms();
  sheet.metrics["longest_grant_pause_ms"] = grants_heard.longest_ms();
  sheet.metrics["contacts"] = contacts;
  {
    const auto lock = robot.locked();
    sheet.metrics["grants_lost"] = static_cast<double>(robot.grants_lost() - grants_lost_before);
  }
  sheet.targets = {{"false_stops", {Bound::kAtMost, 0.0}},
                   {"grants_lost", {Bound::kAtMost, 0.0}},
                   {"contacts", {Bound::kAtMost, 0.0}}};
  if (auto saved = write_file(options.out + "/stops.txt", log); !saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
