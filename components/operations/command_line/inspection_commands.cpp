#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "drivers/base_obedience/core/writer_id.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;

constexpr const char* kPrefix = "rt/";
constexpr std::size_t kItemsShown = 8;
constexpr std::size_t kWritersShown = 3;           // everybody has a heartbeat
constexpr double kLongest = 3600.0;                // [s] to look or to wait
constexpr auto kGoalPatience = milliseconds(500);  // a robot without navigator has none

const char* state_name(std::uint8_t state) {
  constexpr const char* kNames[] = {
      "Initialise",        "Inactive",       "Interaction", "Navigation start",
      "Navigation active", "Navigation end", "Manual",      "Fault"};
  return state < std::size(kNames) ? kNames[state] : "?";
}

const char* health_name(std::uint8_t health) {
  constexpr const char* kNames[] = {"missing", "ok", "degraded", "fault", "other IDL"};
  return health < std::size(kNames) ? kNames[health] : "?";
}

void show_refusals(const std::vector<runtime::Refusal>& refusals) {
  for (const auto& refusal : refusals) std::cout << to_string(refusal) << "\n";
}

/// "goal printer of operator: 34 %, 12.3 m left, 25 s, 1 recovery; an obstacle 0.4 m ahead", or
/// "goal printer of operator failed with 12.3 m left: no progress for 6 s"; empty when there is
/// none of either.
std::string goal_line(const usher_msgs::msg::NavigateStatus& status) {
  namespace goal_state = usher_msgs::msg::GoalStatus_Constants;
  const bool failed = status.state() == goal_state::STATE_FAILED;
  if (!failed && status.state() != goal_state::STATE_ACTIVE &&
      status.state() != goal_state::STATE_WAITING)
    return {};
  const auto& goal = status.goal().pose().position();
  const std::string left = format("%.1f m left", status.remaining());
  std::string line =
      "goal " +
      (status.location().empty() ? format("%.1f", goal.x()) + " " + format("%.1f", goal.y())
                                 : status.location()) +
      " of " + status.client();
  if (failed)
    return line + " failed" + (status.remaining() > 0 ? " with " + left : "") +
           (status.reason().empty() ? "" : ": " + status.reason());
  line += ": " + format("%.0f %%", 100.0 * status.progress()) + ", " + left;
  if (std::isfinite(status.eta())) line += ", " + format("%.0f s", status.eta());
  if (const auto n = status.recoveries(); n > 0)
    line += ", " + std::to_string(n) + (n == 1 ? " recovery" : " recoveries");
  if (!status.reason().empty()) line += "; " + status.reason();
  return line;
}

struct StatusArguments {
  double patience = 2.0;  ///< [s]
  bool writers = false, faults = false;
};

/// Seconds before the status was written, with a decimal.
std::string ago(const usher_msgs::msg::SupervisorStatus& status,
                const builtin_interfaces::msg::Time& stamp) {
  return format("%.1f", runtime::seconds(wire::from_message(status.header().stamp()) -
                                         wire::from_message(stamp)));
}

/// Who writes what moves the robot, since when, and whether he may.
Table writers_table(const usher_msgs::msg::SupervisorStatus& status) {
  Table table({"topic", "writer", "host", "since s ago", "may write it", "id"});
  for (const auto& one : status.writers()) {
    table.add({one.topic(), one.participant(), one.host(), ago(status, one.since()),
               one.granted()   ? "yes, has the right to drive"
               : one.allowed() ? "yes"
                               : "NO",
               drive::to_string(one.writer())});
  }
  return table;
}

/// What went wrong, newest first, and how it ended.
Table faults_table(const usher_msgs::msg::SupervisorStatus& status) {
  Table table({"s ago", "whom", "what", "ended s ago", "by"});
  const auto& faults = status.faults();
  for (auto one = faults.rbegin(); one != faults.rend(); ++one) {
    table.add({ago(status, one->stamp()), one->component_name(), one->cause(),
               one->active() ? "-" : ago(status, one->ended()),
               one->active()             ? (one->latched() ? "until usher clear" : "-")
               : one->ended_by().empty() ? "itself"
                                         : one->ended_by()});
  }
  return table;
}

/// What the supervisor thinks, and what the navigator is about; exit code 0 only when nothing is
/// wrong.
int status(std::uint32_t domain, const StatusArguments& arguments) {
  auto observer = Observer::create(reach_robot("status", domain));
  if (!observer) return fail(observer.error());
  auto reader = (*observer)->reader(topics::kSupervisorStatus);
  auto goals = (*observer)->reader(topics::kNavigateStatus);
  if (!reader || !goals) return fail(!reader ? reader.error() : goals.error());
  const auto message = reader->take(runtime::from_seconds(arguments.patience));
  if (!message) return fail(nobody_there("supervisor", domain));
  const auto goal = goals->take(kGoalPatience);
  const std::string stopped = stopped_by(*message);
  std::cout << "state " << state_name(message->state())
            << (!message->granted()         ? ", may not drive: " + message->reason()
                : !stopped.empty()          ? ", stands: stopped by " + stopped
                : message->reason().empty() ? ", may drive"
                                            : ", may drive; " + message->reason())
            << "\n";
  if (const auto line = goal ? goal_line(*goal) : ""; !line.empty()) std::cout << line << "\n";
  Table table({"component", "health", "loss means", "heard s ago", "why"});
  constexpr const char* kCriticality[] = {"stop", "degrade", "notify"};
  bool well = true;
  for (const auto& component : message->components()) {
    well = well && component.health() == usher_msgs::msg::SupervisorStatus_Constants::HEALTH_OK;
    table.add({component.name(), health_name(component.health()),
               kCriticality[std::min<std::uint8_t>(component.criticality(), 2)],
               component.age() < 0 ? "never" : format("%.2f", component.age()),
               component.reason()});
  }
  std::cout << table.text();
  for (const auto& fault : message->faults()) {
    if (!fault.active()) continue;
    well = false;
    std::cout << (fault.latched() ? "latched fault: " : "fault: ") << fault.component_name() << ": "
              << fault.cause() << "\n";
  }
  if (arguments.writers) std::cout << "\n" << writers_table(*message).text();
  if (arguments.faults) std::cout << "\n" << faults_table(*message).text();
  show_refusals((*observer)->refusals());
  return well ? 0 : 1;
}

struct TopicRow {
  std::string type;
  std::vector<std::string> writers, readers;
  bool latched = false;
  std::unique_ptr<Observer::Subscription> subscription;
};

std::string joined(const std::vector<std::string>& names, std::size_t shown) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), shown); ++i)
    out += (out.empty() ? "" : " ") + names[i];
  if (names.size() > shown) out += " +" + std::to_string(names.size() - shown);
  return out.empty() ? "-" : out;
}

int list_topics(std::uint32_t domain, double duration) {
  auto observer = Observer::create(reach_robot("topics", domain));
  if (!observer) return fail(observer.error());
  std::this_thread::sleep_for(milliseconds(500));  // discovery
  std::map<std::string, TopicRow> rows;
  for (const auto& endpoint : (*observer)->endpoints()) {
    if (!endpoint.topic.starts_with(kPrefix)) continue;
    auto& row = rows[endpoint.topic.substr(std::strlen(kPrefix))];
    row.type = endpoint.type;
    row.latched = row.latched || (endpoint.writer && endpoint.latched);
    (endpoint.writer ? row.writers : row.readers).push_back(endpoint.participant);
  }
  for (auto& [name, row] : rows) {
    if (row.writers.empty()) continue;
    auto subscription =
        (*observer)->subscribe(kPrefix + name, row.type, {false, row.latched, 32}, {});
    if (subscription) row.subscription = std::move(subscription).value();
  }
  std::this_thread::sleep_for(runtime::from_seconds(duration));
  Table table({"topic", "type", "QoS", "Hz", "p50 ms", "p99 ms", "writers", "readers"});
  for (auto& [name, row] : rows) {
    const auto s = row.subscription ? row.subscription->statistics() : Observer::Statistics{};
    const bool timed = s.latency_p99 > runtime::Duration{};
    table.add({name, row.type, row.latched ? "latched" : "volatile",
               s.rate_hz > 0 ? format("%.1f", s.rate_hz) : "-",
               timed ? format("%.2f", runtime::seconds(s.latency_p50) * 1e3) : "-",
               timed ? format("%.2f", runtime::seconds(s.latency_p99) * 1e3) : "-",
               joined(row.writers, kWritersShown), joined(row.readers, row.readers.size())});
  }
  std::cout << table.text();
  return rows.empty() ? fail(nobody_there("topic", domain)) : 0;
}

struct EchoArguments {
  std::string topic;
  int count = 0;  ///< 0 = until Ctrl-C
  double patience = 5.0;
};

int echo(std::uint32_t domain, const EchoArguments& arguments) {
  auto observer = Observer::create(reach_robot("echo", domain));
  if (!observer) return fail(observer.error());
  const std::string wire_name = kPrefix + arguments.topic;
  runtime::EndpointInfo writer;
  const bool found = (*observer)->wait_for(
      [&](const Observer& o) {
        for (const auto& endpoint : o.endpoints()) {
          if (endpoint.writer && endpoint.topic == wire_name) {
            writer = endpoint;
            return true;
          }
        }
        return false;
      },
      runtime::from_seconds(arguments.patience));
  if (!found) {
    std::vector<std::string> written;
    for (const auto& endpoint : (*observer)->endpoints()) {
      if (endpoint.writer && endpoint.topic.starts_with(kPrefix))
        written.push_back(endpoint.topic.substr(std::strlen(kPrefix)));
    }
    return fail(nobody_writes(arguments.topic, domain, written));
  }
  const auto* layout = runtime::MessageLayouts::built_in().find(writer.type);
  if (layout == nullptr) return fail("the type " + writer.type + " is not known here");

  std::mutex mutex;
  std::condition_variable changed;
  int seen = 0;
  auto subscription = (*observer)->subscribe(
      wire_name, writer.type, {writer.reliable, writer.latched, 16},
      [&](const Observer::RawSample& sample) {
        const std::lock_guard lock(mutex);
        if (arguments.count > 0 && seen >= arguments.count) return;
        std::cout << runtime::to_yaml(*layout, sample.cdr, kItemsShown) << "---\n" << std::flush;
        ++seen;
        changed.notify_all();
      });
  if (!subscription) return fail(subscription.error());
  std::unique_lock lock(mutex);
  while (arguments.count == 0 || seen < arguments.count) {
    const int before = seen;
    changed.wait_for(lock, runtime::from_seconds(arguments.patience));
    if (seen == before && arguments.count > 0)
      return fail("no sample of " + arguments.topic + " within " +
                  format("%.0f", arguments.patience) + " s");
  }
  return 0;
}

}  // namespace

void add_inspection_commands(CLI::App& app, int& exit_code) {
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  auto seconds = std::make_shared<double>(2.0);
  auto* status_command = app.add_subcommand(
      "status",
      "What the supervisor thinks of the running robot; exit code 0 only when nothing is wrong: "
      "a degraded component, such as a tablet without display, makes it 1");
  add_domain_option(*status_command, *domain);
  auto shown = std::make_shared<StatusArguments>();
  status_command->add_option("--seconds", shown->patience, "How long to look for it")
      ->check(within(0.1, kLongest))
      ->capture_default_str();
  status_command->add_flag("--writers", shown->writers,
                           "Also who writes what moves the robot, since when, and whether he may");
  status_command->add_flag("--faults", shown->faults,
                           "Also the fault log: what, when, how it ended, and who cleared it");
  status_command->callback([=, &exit_code] { exit_code = status(meant_domain(*domain), *shown); });

  auto arguments = std::make_shared<EchoArguments>();
  auto* topics_command = app.add_subcommand(
      "topics", "Topics with type, quality of service, rate, latency, writers and readers");
  add_domain_option(*topics_command, *domain);
  topics_command->add_option("--seconds", *seconds, "How long to measure")
      ->check(within(0.1, kLongest))
      ->capture_default_str();
  auto* echo_command = topics_command->add_subcommand("echo", "Print the samples of a topic");
  add_domain_option(*echo_command, *domain);
  echo_command->add_option("topic", arguments->topic, "Name, for example scan/filtered")
      ->required();
  echo_command->add_option("--count", arguments->count, "How many; 0 = until Ctrl-C")
      ->check(within(0, 1e6))
      ->capture_default_str();
  echo_command
      ->add_option("--patience", arguments->patience, "Seconds to wait for a writer or a sample")
      ->check(within(0.1, kLongest))
      ->capture_default_str();
  topics_command->callback([=, &exit_code] {
    const std::uint32_t meant = meant_domain(*domain);
    exit_code = echo_command->parsed() ? echo(meant, *arguments) : list_topics(meant, *seconds);
  });
}

}  // namespace usher::operations
