#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace usher::operations {

/// How every command ends: 0 = what was asked happened, 1 = it did not, 2 = the command line asks
/// for nothing that there is.
inline constexpr const char* kExitCodes =
    "Exit codes: 0 what was asked happened, 1 it did not, 2 wrong usage";

/// Says why on stderr; the exit code 1.
int fail(const std::string& message);
/// The same of a command line that nobody can follow, whatever robot or manifest it meets; 2.
int misused(const std::string& message);

/// Reads the command line and runs its callbacks. The exit code where the program has to end then:
/// 0 after help and version, 2 after wrong usage, which is told with what may have been meant.
std::optional<int> ended_by(CLI::App& app, int argc, const char* const* argv);

/// A number in [low, high], and not NaN.
CLI::Validator within(double low, double high);
/// A DDS domain.
CLI::Validator domain_number();

}  // namespace usher::operations
