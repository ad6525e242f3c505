#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "operations/command_line/table.hpp"
#include "operations/experiments/attacked_robot.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/line_plot.hpp"
#include "operations/experiments/only.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = AttackedRobot::Clock;
using Instant = AttackedRobot::Instant;
using namespace usher_msgs::msg;

constexpr int kRounds = 5;
constexpr double kSpeed = 0.5, kTurn = 0.5;       // a circle of 1 m in the foyer
constexpr auto kReleased = milliseconds(150);     // the button, so that a press is a new one
constexpr double kStoppingTime = 1.48;            // [s] times the speed: table 8.1 of the thesis
constexpr double kMedian = 140.0, kMost = 200.0;  // [ms]
constexpr double kReturn = 1.0;                   // [s]
constexpr double kStandstill = 1.1;  // share of the stopping distance; the table's own spread
constexpr auto kSettles = milliseconds(500);  // the tablet's buttons, before they are touched
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kTouched = "tablet";
constexpr double kMostTouched = 250.0;  // [ms] from a finger on Stop to the first zero

/// What happens to the victim: the tablet is only touched, on Stop.
enum class Harm : std::uint8_t { kKill, kHang, kTouch };

const char* name(Harm harm) {
  return harm == Harm::kKill ? "kill -9" : harm == Harm::kHang ? "hang" : "touch of Stop";
}

struct Trial {
  std::string victim;
  Harm harm = Harm::kKill;
  /// From the harm to the first zero at the wheels; NaN: who was killed was back before it was
  /// missed.
  double zero_ms = kNone;
  double standstill = kNone;  ///< way from there to a standstill over the stopping distance; NaN
  double back_s = 0.0;        ///< from kill -9 to: heard again and the right to drive granted
  double on_its_way_s = 0.0;  ///< to: moves again as wanted
  bool contact = false;
};

double ms(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

class Attack {
 public:
  explicit Attack(AttackedRobot& robot) : robot_(robot) {}

  /// The robot drives its circle under the operator's hand; an error says why it does not.
  Status get_going() {
    robot_.release();
    if (!robot_.wait_for([&] { return robot_.all_well(); }, seconds(60)))
      return Error{"the robot is not well: " + robot_.complaints()};
    if (auto status = take_over(); !status) return status;
    std::this_thread::sleep_for(kReleased);
    robot_.hold(kSpeed, kTurn);
    if (!robot_.wait_for([&] { return robot_.drives(0.8 * kSpeed); }, seconds(15)))
      return Error{"the robot does not drive: " + robot_.complaints()};
    std::this_thread::sleep_for(milliseconds(500));
    return {};
  }

  Result<Trial> run(const std::string& victim, Harm harm, int round) {
    if (auto status = get_going(); !status) return Error{status.error()};
    Trial trial{.victim = victim, .harm = harm};
    // Every phase between two heartbeats is met in turn.
    std::this_thread::sleep_for(milliseconds((round * 7) % 20));
    const pid_t process = robot_.process(victim);
    std::optional<runtime::Guid> life;
    std::uint32_t contacts = 0;
    {
      const auto lock = robot_.locked();
      life = robot_.life_of(victim);
      contacts = robot_.motions().back().contacts;
    }
    if (process == 0 || !life) return Error{victim + " does not run"};
    robot_.forget();
    const Instant harmed = Clock::now();
    kill(process, harm == Harm::kKill ? SIGKILL : SIGSTOP);
    std::optional<Instant> heard_again;
    const auto zero = first_zero(harmed, [&] {
      if (!heard_again && robot_.life_of(victim) != life) heard_again = Clock::now();
    });
    const bool back_in_time = heard_again && ms(*heard_again - harmed) <= kMost;
    if (!zero && !back_in_time) return Error{victim + ": no zero at the wheels within 2 s"};
    if (zero) trial.zero_ms = ms(*zero - harmed);
    Instant killed = harmed;
    if (harm == Harm::kHang && zero) {
      auto share = come_to_rest(*zero);
      if (!share) return Error{victim + ": " + share.error()};
      trial.standstill = *share;
      killed = Clock::now();
      if (robot_.process(victim) == process) kill(process, SIGKILL);
    }
    trial.back_s = wait_for_return(victim, *life, killed);
    const bool goes_on = robot_.wait_for([&] { return robot_.drives(0.8 * kSpeed); }, seconds(4));
    if (!goes_on) {
      // The button was released, or who was restarted does not know that an operator drives.
      if (auto status = get_going(); !status) return Error{victim + ": " + status.error()};
    }
    trial.on_its_way_s = ms(Clock::now() - killed) / 1e3;
    const auto lock = robot_.locked();
    trial.contact = robot_.motions().back().contacts > contacts;
    return trial;
  }

  /// A finger on the tablet's Stop while the operator holds the stick, then one on Start.
  Result<Trial> touch_stop(int round) {
    if (auto status = get_going(); !status) return Error{status.error()};
    std::this_thread::sleep_for(milliseconds((round * 7) % 20));
    robot_.forget();
    const Instant touched = Clock::now();
    if (auto status = robot_.touch("tablet:stop"); !status) return Error{status.error()};
    const auto zero = first_zero(touched, [] {});
    if (!zero) return Error{"tablet: no zero at the wheels within 2 s of the touch"};
    auto share = come_to_rest(*zero);
    if (!share) return Error{"tablet: " + share.error()};
    const Instant at_rest = Clock::now();
    std::this_thread::sleep_for(kSettles);
    if (auto status = robot_.touch("tablet:start"); !status) return Error{status.error()};
    if (auto status = get_going(); !status) return Error{"tablet: " + status.error()};
    return Trial{.victim = kTouched,
                 .harm = Harm::kTouch,
                 .zero_ms = ms(*zero - touched),
                 .standstill = *share,
                 .back_s = kNone,
                 .on_its_way_s = ms(Clock::now() - at_rest) / 1e3};
  }

 private:
  template <class Look>
  std::optional<Instant> first_zero(Instant harmed, const Look& look_meanwhile) {
    std::optional<Instant> zero;
    const auto stopped = [&] {
      look_meanwhile();
      for (const auto& wheels : robot_.wheels()) {
        if (!wheels.zero() || wheels.at < harmed) continue;
        zero = wheels.at;
        return true;
      }
      return false;
    };
    robot_.wait_for(stopped, seconds(2));
    return zero;
  }

  /// The way from the first zero to a standstill over the stopping distance.
  Result<double> come_to_rest(Instant zero) {
    robot_.release();  // so that a return does not end the stop that is measured
    if (!robot_.wait_for([&] { return robot_.stands(); }, seconds(6)))
      return Error{"no standstill within 6 s"};
    return standstill_share(zero);
  }

  Status take_over() {
    const auto manual = [&] {
      return robot_.status() &&
             robot_.status()->state() == SupervisorStatus_Constants::STATE_MANUAL;
    };
    if (robot_.wait_for(manual, milliseconds(100))) return {};
    robot_.ask(SupervisorRequest_Constants::COMMAND_MANUAL_ON, seconds(10));
    if (robot_.wait_for(manual, seconds(5))) return {};
    return Error{"the supervisor does not let the operator drive: " + robot_.complaints()};
  }

  double standstill_share(Instant zero) {
    const auto lock = robot_.locked();
    double way = 0.0, speed = 0.0;
    const AttackedRobot::Motion* last = nullptr;
    for (const auto& motion : robot_.motions()) {
      if (motion.at < zero) {
        speed = motion.v;
        last = &motion;
        continue;
      }
      if (last != nullptr) way += geometry::distance(last->pose, motion.pose);
      last = &motion;
    }
    return way / (kStoppingTime * speed);
  }

  double wait_for_return(const std::string& victim, const runtime::Guid& life, Instant killed) {
    const auto back = [&] {
      const auto now = robot_.life_of(victim);
      return now && *now != life && robot_.all_well() && robot_.status_at() > killed;
    };
    robot_.wait_for(back, seconds(30));
    return ms(Clock::now() - killed) / 1e3;
  }

  AttackedRobot& robot_;
};

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}

template <class Value>
std::vector<double> select(const std::vector<Trial>& trials, const Value& value) {
  std::vector<double> values;
  for (const Trial& trial : trials) {
    const double v = value(trial);
    if (std::isfinite(v)) values.push_back(v);
  }
  return values;
}

std::string trials_csv(const std::vector<Trial>& trials) {
  std::string csv = "victim,harm,zero_ms,standstill_share,back_s,on_its_way_s,contact\n";
  for (const Trial& trial : trials) {
    csv += trial.victim + "," + name(trial.harm) + format(",%.1f", trial.zero_ms) +
           format(",%.3f", trial.standstill) + format(",%.3f", trial.back_s) +
           format(",%.2f", trial.on_its_way_s) + (trial.contact ? ",1\n" : ",0\n");
  }
  return csv;
}

Table by_victim(const std::vector<Trial>& trials, const std::vector<std::string>& victims) {
  Table table({"component", "harm", "trials", "back before it was missed", "zero p50 ms",
               "zero max ms", "way / d(v) max", "back max s"});
  for (const auto& victim : victims) {
    for (const Harm harm : {Harm::kKill, Harm::kHang, Harm::kTouch}) {
      std::vector<Trial> own;
      for (const Trial& trial : trials) {
        if (trial.victim == victim && trial.harm == harm) own.push_back(trial);
      }
      if (own.empty()) continue;
      const auto zero = select(own, [](const Trial& t) { return t.zero_ms; });
      const auto way = select(own, [](const Trial& t) { return t.standstill; });
      const auto back = select(own, [](const Trial& t) { return t.back_s; });
      table.add({victim, name(harm), std::to_string(own.size()),
                 std::to_string(own.size() - zero.size()),
                 zero.empty() ? "-" : format("%.0f", percentile(zero, 0.5)),
                 zero.empty() ? "-" : format("%.0f", percentile(zero, 1.0)),
                 way.empty() ? "-" : format("%.2f", percentile(way, 1.0)),
                 back.empty() ? "-" : format("%.2f", percentile(back, 1.0))});
    }
  }
  return table;
}

Status draw(const std::vector<Trial>& trials, const std::string& out) {
  std::vector<Curve> curves{
      {"kill -9", 200, 60, 40, {}}, {"hang", 40, 90, 190, {}}, {"touch of Stop", 50, 140, 60, {}}};
  for (std::size_t i = 0; i < curves.size(); ++i) {
    auto values = select(trials, [&](const Trial& t) {
      return static_cast<std::size_t>(t.harm) == i ? t.zero_ms : kNone;
    });
    std::sort(values.begin(), values.end());
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double count = static_cast<double>(values.size());
      curves[i].points.emplace_back(values[k], 100.0 * static_cast<double>(k) / count);
      curves[i].points.emplace_back(values[k], 100.0 * static_cast<double>(k + 1) / count);
    }
  }
  return draw_plot(curves, "From the loss of a critical component to the first zero at the base",
                   "time [ms]", "trials [%]", out + "/reaction.png");
}

void judge(const std::vector<Trial>& trials, ResultSheet& sheet) {
  const auto zero =
      select(trials, [](const Trial& t) { return t.harm != Harm::kTouch ? t.zero_ms : kNone; });
  const auto touched =
      select(trials, [](const Trial& t) { return t.harm == Harm::kTouch ? t.zero_ms : kNone; });
  const auto way = select(trials, [](const Trial& t) { return t.standstill; });
  const auto is_chain = [](const Trial& t) {
    return t.victim == "supervisor" || t.victim == "movement_control" || t.victim == "segway_rmp";
  };
  const auto back = select(trials, [](const Trial& t) { return t.back_s; });
  const auto chain_back = select(trials, [&](const Trial& t) {
    return is_chain(t) && t.harm == Harm::kKill ? t.back_s : kNone;
  });
  const auto contacts = select(trials, [](const Trial& t) { return t.contact ? 1.0 : kNone; });
  sheet.metrics["trials"] = static_cast<double>(trials.size());
  sheet.metrics["back_before_it_was_missed"] = static_cast<double>(
      trials.size() - select(trials, [](const Trial& t) { return t.zero_ms; }).size());
  sheet.metrics["contacts"] = static_cast<double>(contacts.size());
  sheet.targets["contacts"] = {Bound::kAtMost, 0.0};
  // What was not tried has no figure.
  const auto judged = [&](const char* key, const std::vector<double>& values, double share,
                          std::optional<double> most) {
    if (values.empty()) return;
    sheet.metrics[key] = percentile(values, share);
    if (most) sheet.targets[key] = {Bound::kAtMost, *most};
  };
  judged("zero_ms_p50", zero, 0.5, kMedian);
  judged("zero_ms_max", zero, 1.0, kMost);
  judged("touch_zero_ms_max", touched, 1.0, kMostTouched);
  judged("standstill_share_max", way, 1.0, kStandstill);
  judged("drive_chain_back_s_max", chain_back, 1.0, kReturn);
  judged("all_back_s_max", back, 1.0, {});
}

}  // namespace

Result<ResultSheet> run_reaction_experiment(const ExperimentOptions& options) {
  auto robot = AttackedRobot::launch(options.installation, options.out + "/run", options.domain);
  if (!robot) return Error{robot.error()};
  auto victims = (*robot)->components("stop");
  auto names = victims;
  names.emplace_back(kTouched);
  const auto only = only_of(options.only, names);
  if (!only) return Error{only.error()};
  std::erase_if(victims, [&](const auto& name) { return !only->takes(name); });
  const bool touches = only->takes(kTouched);
  const int rounds = options.seeds > 0 ? options.seeds : kRounds;
  Attack attack(**robot);
  std::vector<Trial> trials;
  const auto progress = [&](int round, const std::string& victim, Harm harm) {
    show_progress("round " + std::to_string(round + 1) + " of " + std::to_string(rounds) + ": " +
                  victim + ", " + name(harm));
  };
  for (int round = 0; round < rounds; ++round) {
    for (const auto& victim : victims) {
      for (const Harm harm : {Harm::kKill, Harm::kHang}) {
        progress(round, victim, harm);
        auto trial = attack.run(victim, harm, round);
        if (!trial) return Error{trial.error()};
        trials.push_back(*trial);
      }
    }
    if (!touches) continue;
    progress(round, kTouched, Harm::kTouch);
    auto trial = attack.touch_stop(round);
    if (!trial) return Error{trial.error()};
    trials.push_back(*trial);
  }
  if (touches) victims.emplace_back(kTouched);
  show_progress("");
  ResultSheet sheet;
  sheet.name = "reaction";
  sheet.input = "MARVIN as processes with driver, guard and emulated base, circles at " +
                format("%.1f", kSpeed) +
                " m/s; kill -9 and SIGSTOP of each critical component, a finger "
                "on the tablet's Stop, " +
                std::to_string(rounds) + " times";
  judge(trials, sheet);
  const Table table = by_victim(trials, victims);
  std::printf("%s\n", table.text().c_str());
  Status saved = write_file(options.out + "/trials.csv", trials_csv(trials));
  if (saved) saved = write_file(options.out + "/components.md", table.markdown());
  if (saved) saved = draw(trials, options.out);
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
