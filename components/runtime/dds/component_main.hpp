#pragma once

#include <span>

#include "runtime/api/host.hpp"

namespace usher::runtime {

/// The main program of a component: reads --parameters FILE, runs it as a DDS participant until
/// SIGINT or SIGTERM.
/// --contract prints what the component declares as YAML, --help the same for people, --version the
/// version. Without --parameters it runs with its contract's defaults in domain 0, named like its
/// type. Exit code: 0 asked to stop (or printed), 2 wrong options or parameters, 3 fault.
int component_main(const ComponentFactory& factory, int argc, char** argv);

/// Several components in one process, where a manifest groups them: one --parameters FILE for each,
/// which names its component among `factories`. Each has its own participant and dispatcher thread.
/// When one ends, all are stopped, and its exit code is the program's.
int group_main(std::span<const ComponentFactory> factories, int argc, char** argv);

}  // namespace usher::runtime
