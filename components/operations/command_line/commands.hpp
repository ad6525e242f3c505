#pragma once

#include <CLI/CLI.hpp>
#include <vector>

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Each adds its subcommands. A command sets `exit_code`; 0 only when what was asked happened.
void add_deployment_commands(CLI::App& app, int& exit_code);  ///< check components graph
void add_launch_command(CLI::App& app, int& exit_code);       ///< launch
void add_inspection_commands(CLI::App& app, int& exit_code);  ///< status topics
void add_goto_command(CLI::App& app, int& exit_code);         ///< goto
void add_operator_commands(CLI::App& app, int& exit_code);    ///< stop move clear locate map
void add_meeting_command(CLI::App& app, int& exit_code);      ///< meet
void add_teleop_command(CLI::App& app, int& exit_code);       ///< teleop
void add_host_commands(CLI::App& app, int& exit_code);        ///< keys install doctor
void add_calibrate_command(CLI::App& app, int& exit_code);    ///< calibrate
/// `calibrate faces`, below it.
void add_calibrate_faces(CLI::App& calibrate_command, int& exit_code);
void add_demo_command(CLI::App& app, int& exit_code);  ///< demo
void add_measuring_commands(
    CLI::App& app, int& exit_code);  ///< experiment bench: other programs of the installation

/// `--set COMPONENT.PARAMETER=VALUE`, any number of them.
void add_set_option(CLI::App& command, std::vector<Override>& overrides);

}  // namespace usher::operations
