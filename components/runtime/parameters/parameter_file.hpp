#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::runtime {

/// A value as it was written, with the place that set it.
struct ParameterValue {
  std::string name;    ///< dotted: "max_beams", "robot.laser.mount_x"
  std::string yaml;    ///< `60`, `0.2 m`, `[1, 2, 3]`; lists in flow style
  std::string origin;  ///< "config/robots/marvin.yaml:12"
};

/// The file that the launcher writes for one component (`--parameters FILE`): who it is, where it
/// lives, its values.
struct ParameterFile {
  std::string component;           ///< type = name of the component's folder
  std::string name;                ///< in the manifest = name of the DDS participant
  std::string host;                ///< in the manifest
  std::uint32_t domain = 0;        ///< DDS domain, 0..232
  std::uint64_t seed = 1;          ///< of the world
  bool critical = false;           ///< heartbeat at 50 Hz instead of 10 Hz
  std::string run_directory;       ///< empty = nothing is kept over restarts
  std::int64_t clock_anchor = 0;   ///< [ns] added to CLOCK_MONOTONIC gives stamps
  std::vector<std::string> peers;  ///< addresses of further initial peers
  std::string discovery_server;    ///< "10.0.0.1:11811"; empty = everybody announces to everybody
  std::string identity;            ///< folder with the keys of this one; empty = without security
  std::string robot;               ///< name in the fleet; empty = belongs to none
  std::uint32_t fleet_domain = 0;  ///< DDS domain of the fleet, other than `domain`; 0..232
  std::vector<std::string> fleet_peers;  ///< addresses of the other robots, besides multicast
  std::vector<ParameterValue> values;
};

/// Errors name file and line: unknown or repeated key, wrong type, missing `component`, `name` or
/// `host`.
Result<ParameterFile> read_parameter_file(const std::string& path);
/// The same from text; `where` stands for the file in origins and errors.
Result<ParameterFile> parse_parameter_file(const std::string& text, const std::string& where);

/// The values of a robot's, site's or manifest's mapping under dotted names: maps nest, everything
/// else stays one value. For the launcher. A repeated key, a key with a dot that another one spells
/// out, or an empty key is an error.
Result<std::vector<ParameterValue>> flatten(const std::string& yaml, const std::string& where);
Result<std::vector<ParameterValue>> flatten_file(const std::string& path);

}  // namespace usher::runtime
