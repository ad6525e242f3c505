#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "runtime/dds/observer.hpp"

namespace usher::operations {

/// Adds --keys, which holds for every command that talks to a robot.
void add_robot_options(CLI::App& app);

/// What --keys says, as an absolute path; empty = not given.
std::string keys_folder();

/// How a program of the operator reaches the robot of a domain: as `usher launch` left it on this
/// machine (peers, discovery server, clock, keys), else by multicast. With keys it has the identity
/// `operator`, whatever its name.
runtime::Observer::Options reach_robot(const std::string& name, std::uint32_t domain);

/// "no WHO in domain N", and where on this machine robots were launched instead.
std::string nobody_there(const std::string& who, std::uint32_t domain);

}  // namespace usher::operations
