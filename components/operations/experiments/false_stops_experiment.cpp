#include <algorithm>
#include <cmath>

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
constexpr double kRadius = 1.0;                   // [m] around this place of the foyer
constexpr double kCenterX = 3.5, kCenterY = 4.5;  // [m]

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

/// Keeps the robot on its circle however long it drives.
void steer(AttackedRobot& robot) {
  double distance = kRadius;
  {
    const auto lock = robot.locked();
    if (!robot.motions().empty()) {
      const auto& motion = robot.motions().back();
      distance = std::hypot(motion.x - kCenterX, motion.y - kCenterY);
    }
  }
  robot.hold(kSpeed, std::clamp(kSpeed / kRadius + 0.4 * (distance - kRadius), 0.3, 0.7));
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
  steer(robot);
  if (!robot.wait_for([&] { return robot.drives(0.8 * kSpeed); }, seconds(15)))
    return Error{"the robot does not drive: " + robot.complaints()};

  const BusyLoops busy(2);
  std::this_thread::sleep_for(seconds(1));
  robot.forget();
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
                 " s: " + (robot.status() ? robot.status()->reason() : "") + "\n";
        }
        zero = wheels.zero();
      }
      for (const auto& motion : robot.motions()) {
        if (place) metres += std::hypot(motion.x - place->x, motion.y - place->y);
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
