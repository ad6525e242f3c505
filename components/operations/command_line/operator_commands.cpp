#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "foundation/grid/map_file.hpp"
#include "idl/topics.hpp"
#include "mapping/map_server/core/map_from_log.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/locating.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using namespace usher_msgs::msg;

constexpr auto kStatusPatience = std::chrono::seconds(1);
constexpr double kStands = 0.1;  // [m/s], [rad/s]: a base that balances sways

int ask_supervisor(std::uint32_t domain, std::uint8_t command, const std::string& done) {
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  if (const auto told = tell_supervisor(**observer, command); !told) return fail(told.error());
  std::cout << done << "\n";
  return 0;
}

/// Lifts the stop, and says when that alone lets nothing drive.
int move_on(std::uint32_t domain) {
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  auto reader = (*observer)->reader(topics::kSupervisorStatus);
  if (!reader) return fail(reader.error());
  const auto before = newest_status(*reader, kStatusPatience);
  if (const auto told =
          tell_supervisor(**observer, SupervisorRequest_Constants::COMMAND_MOVEMENT_ON);
      !told)
    return fail(told.error());
  const std::string done =
      before && before->stopped_by().empty() ? "nobody held a stop" : "the stop is lifted";
  const auto after = newest_status(*reader, kStatusPatience);
  if (after && after->state() == SupervisorStatus_Constants::STATE_FAULT)
    return fail(done + ", but the robot stands: " + after->reason() +
                " (`usher clear` clears a fault whose cause is gone)");
  std::cout << done << "\n";
  return 0;
}

/// Clears what is latched, and says when nothing was.
int clear(std::uint32_t domain) {
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  auto reader = (*observer)->reader(topics::kSupervisorStatus);
  if (!reader) return fail(reader.error());
  const auto before = newest_status(*reader, kStatusPatience);
  if (const auto told = tell_supervisor(**observer, SupervisorRequest_Constants::COMMAND_CLEAR);
      !told)
    return fail(told.error());
  const bool none = before && std::ranges::none_of(before->faults(), [](const auto& fault) {
                      return fault.active() && fault.latched();
                    });
  std::cout << (none ? "no fault was latched\n" : "cleared\n");
  return 0;
}

struct Standing {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

/// A pose is of the moment it is told: a robot that rolls has left it.
Status judge_standing(Observer& observer) {
  auto reader = observer.reader(topics::kOdom);
  if (!reader) return Error{reader.error()};
  const auto odom = reader->take(kStatusPatience);
  if (!odom) return {};
  const auto& twist = odom->twist().twist();
  if (std::abs(twist.linear().x()) < kStands && std::abs(twist.angular().z()) < kStands) return {};
  return Error{"the robot drives; `usher stop` holds it"};
}

/// Tells a robot that is lost where it stands.
int locate(std::uint32_t domain, const Standing& here) {
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  if (const auto inside = judge_place(**observer, here.x, here.y); !inside)
    return fail(inside.error());
  if (const auto stands = judge_standing(**observer); !stands) return fail(stands.error());
  const auto found = tell_pose(**observer, {here.x, here.y, here.yaw});
  if (!found) return fail(found.error());
  std::cout << "by its scan it stands at " << format("%.2f", found->x) << " "
            << format("%.2f", found->y) << " " << format("%.2f", found->yaw) << "\n";
  return 0;
}

/// A map that is written replaces none: people edit theirs.
std::string not_a_new_map(const std::string& path) {
  const std::filesystem::path file(path);
  if (file.extension() != ".yaml" && file.extension() != ".yml")
    return "a map's file ends with .yaml, got " + path;
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) ? path + " is there already" : std::string();
}

int save_map(std::uint32_t domain, const std::string& path) {
  auto observer = Observer::create(reach_robot(kOperatorName, domain));
  if (!observer) return fail(observer.error());
  auto reader = (*observer)->reader(topics::kMap);
  if (!reader) return fail(reader.error());
  const auto message = reader->take(std::chrono::seconds(5));
  if (!message) return fail(nobody_there("map", domain));
  const auto map = wire::from_message(*message);
  if (!map) return fail(map.error());
  if (const auto saved = grid::save_map(*map, path); !saved) return fail(saved.error());
  std::cout << "saved " << map->width() << " x " << map->height() << " cells to " << path << "\n";
  return 0;
}

struct MapFromLogArguments {
  std::string log;
  std::string reference;
  std::string out;
  std::size_t every = 1;
  double resolution = 0.05;
};

int map_from_log(const MapFromLogArguments& arguments) {
  const auto scans = map_server::read_carmen_log(arguments.log);
  if (!scans) return fail(scans.error());
  const auto reference = map_server::read_reference_poses(arguments.reference);
  if (!reference) return fail(reference.error());
  const auto map = map_server::map_from_log(*scans, *reference, arguments.every,
                                            {.resolution = arguments.resolution});
  if (!map) return fail(arguments.log + ": " + map.error());
  if (const auto saved = grid::save_map(*map, arguments.out); !saved) return fail(saved.error());
  std::cout << "saved " << map->width() << " x " << map->height() << " cells of "
            << (scans->size() + arguments.every - 1) / arguments.every << " of " << scans->size()
            << " scans to " << arguments.out << "\n";
  return 0;
}

}  // namespace

void add_operator_commands(CLI::App& app, int& exit_code) {
  using namespace SupervisorRequest_Constants;
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  const auto with_domain = [domain](CLI::App* command) {
    add_domain_option(*command, *domain);
    return command;
  };

  auto emergency = std::make_shared<bool>(false);
  auto* stop_command = with_domain(
      app.add_subcommand("stop", "Stop the robot; it stays stopped until `usher move`"));
  stop_command->add_flag("--emergency", *emergency,
                         "Motors off: a Segway drops on its tilt limiters");
  stop_command->callback([=, &exit_code] {
    exit_code =
        ask_supervisor(meant_domain(*domain), *emergency ? COMMAND_EMERGENCY_STOP : COMMAND_STOP,
                       *emergency ? "emergency stop" : "stopped");
  });
  with_domain(app.add_subcommand("move", "Lift `usher stop`; a latched fault needs `usher clear`"))
      ->callback([=, &exit_code] { exit_code = move_on(meant_domain(*domain)); });
  with_domain(app.add_subcommand(
                  "clear", "Clear latched faults (an emergency stop is one) whose cause is gone"))
      ->callback([=, &exit_code] { exit_code = clear(meant_domain(*domain)); });

  auto here = std::make_shared<Standing>();
  auto* locate_command = with_domain(
      app.add_subcommand("locate", "Tell a robot that is lost where it stands in the map"));
  const auto coordinate = [&](const char* name, double& value, double most, const char* text) {
    locate_command->add_option(name, value, text)->required()->check(within(-most, most));
  };
  coordinate("x", here->x, 1e4, "[m], to half a meter");
  coordinate("y", here->y, 1e4, "[m]");
  coordinate("yaw", here->yaw, 6.3, "[rad], to a quarter of a radian; 0 looks along x");
  locate_command->callback([=, &exit_code] { exit_code = locate(meant_domain(*domain), *here); });

  auto path = std::make_shared<std::string>();
  auto* map_command = app.add_subcommand("map", "Work with maps");
  map_command->require_subcommand(1);
  auto* save_command =
      with_domain(map_command->add_subcommand("save", "Write the running robot's map to a file"));
  save_command->add_option("file", *path, "New YAML file; the picture is written beside it")
      ->check(not_a_new_map)
      ->required();
  save_command->callback([=, &exit_code] { exit_code = save_map(meant_domain(*domain), *path); });

  auto from_log = std::make_shared<MapFromLogArguments>();
  auto* log_command = map_command->add_subcommand(
      "from-log", "Make a map from a recorded log whose scans have reference poses");
  log_command->add_option("log", from_log->log, "CARMEN log (.clf, also .gz)")->required();
  log_command
      ->add_option("--reference", from_log->reference,
                   "Pose of each scan, one line `index time x y yaw` (.txt, also .gz)")
      ->required();
  log_command->add_option("--out", from_log->out, "New YAML file; the picture is written beside it")
      ->check(not_a_new_map)
      ->required();
  log_command->add_option("--every", from_log->every, "Use every Nth scan")
      ->check(within(1, 1000))
      ->capture_default_str();
  log_command->add_option("--resolution", from_log->resolution, "Side of a cell [m]")
      ->check(within(0.01, 1))
      ->capture_default_str();
  log_command->callback([=, &exit_code] { exit_code = map_from_log(*from_log); });
}

}  // namespace usher::operations
