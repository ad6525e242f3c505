#include "operations/command_line/commands.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/usage.hpp"

namespace {

/// Each command that heeds an option of the program says so: its own help is all that many read.
void name_program_options(CLI::App& app) {
  const CLI::Option* keys = app.get_option("--keys");
  for (const char* name :
       {"check", "launch", "install", "doctor", "status", "topics", "goto", "stop", "move", "clear",
        "locate", "map", "meet", "teleop", "calibrate"}) {
    CLI::App* command = app.get_subcommand(name);
    const std::string text = "Of every command: --keys FOLDER\n  " + keys->get_description() +
                             "\n\n" + usher::operations::kExitCodes;
    command->footer(text);
    for (CLI::App* below : command->get_subcommands({})) below->footer(text);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Usher: the software of an indoor guide robot", "usher");
  app.require_subcommand(1);
  app.set_version_flag("--version", USHER_VERSION);
  app.footer(usher::operations::kExitCodes);
  app.fallthrough();  // options of the program may follow its command
  usher::operations::add_robot_options(app);
  int exit_code = 0;
  usher::operations::add_deployment_commands(app, exit_code);
  usher::operations::add_launch_command(app, exit_code);
  usher::operations::add_inspection_commands(app, exit_code);
  usher::operations::add_goto_command(app, exit_code);
  usher::operations::add_operator_commands(app, exit_code);
  usher::operations::add_meeting_command(app, exit_code);
  usher::operations::add_teleop_command(app, exit_code);
  usher::operations::add_host_commands(app, exit_code);
  usher::operations::add_calibrate_command(app, exit_code);
  usher::operations::add_demo_command(app, exit_code);
  usher::operations::add_measuring_commands(app, exit_code);
  name_program_options(app);
  if (const auto ended = usher::operations::ended_by(app, argc, argv)) return *ended;
  return exit_code;
}
