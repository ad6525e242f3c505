#pragma once

namespace usher::runtime {

/// The main program of a discovery server: reads --parameters FILE (its `discovery_server` is the
/// address that it listens at) and serves until SIGINT or SIGTERM. Exit code: 0 asked to stop, 2
/// wrong options or parameters.
int discovery_server_main(int argc, char** argv);

}  // namespace usher::runtime
