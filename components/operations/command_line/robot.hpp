#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
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

/// Adds --domain to a command that talks to a robot.
void add_domain_option(CLI::App& command, std::optional<std::uint32_t>& given);

/// The DDS domain of the robot that an operator means, and what he should read at once; empty:
/// nothing.
struct MeantDomain {
  std::uint32_t domain = 0;
  std::string remark;
};

/// What was given, else the domain of the only robot that was launched on this machine, else 0. The
/// remark says that it took another one than 0 by itself, or where robots were launched instead.
/// @param launched as launched_domains()
MeantDomain meant_domain(const std::optional<std::uint32_t>& given,
                         const std::vector<std::uint32_t>& launched);
/// The same on this machine; the remark goes to stderr.
std::uint32_t meant_domain(const std::optional<std::uint32_t>& given);

/// "no WHO in domain N".
std::string nobody_there(const std::string& who, std::uint32_t domain);
/// "nobody writes TOPIC in domain N", and which of the topics that somebody writes was meant.
std::string nobody_writes(const std::string& topic, std::uint32_t domain,
                          const std::vector<std::string>& written);

/// Refuses a place [m] outside the running robot's map: "(40.00, 2.00) m is outside ...". Where no
/// map comes within 3 s nothing is known of it.
Status judge_place(runtime::Observer& observer, double x, double y);

/// Refuses a pace [m/s] above `fastest`, the robot's own limit where nothing is near.
Status judge_pace(double pace, float fastest);

}  // namespace usher::operations
