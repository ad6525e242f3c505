#pragma once

#include <map>
#include <string>
#include <vector>

#include "operations/manifest/manifest.hpp"
#include "runtime/api/contract.hpp"

namespace usher::operations {

/// By component type.
using Contracts = std::map<std::string, runtime::Contract>;

/// Every *.yaml of a directory, as the build and the installation put them there.
Result<Contracts> read_contracts(const std::string& directory);

/// A value given on the command line: `--set amcl.max_beams=60`.
struct Override {
  std::string component;
  std::string parameter;
  std::string value;
};

/// What a component has to do with the robot's movement, from its contract.
enum class Movement {
  kNone,
  kCommands,    ///< writes cmd_vel/*: without it nobody wants the robot to move
  kBaseDriver,  ///< writes base/status: it keeps the base standing, and is the last to be stopped
};

/// A manifest with every component's parameters in place, and everything that is wrong with it.
struct Deployment {
  Manifest manifest;
  std::vector<runtime::ParameterFile> files;  ///< in the order of manifest.components
  std::map<std::string, Movement> movement;   ///< by component name; kNone where it is missing
  std::vector<Finding> findings;
};

/// Lays contract default < robot < site < manifest < command line, derives the manifest.* facts,
/// and judges wiring, values, site and the dialogue's texts. It reads the robot's and the site's
/// file, the map and the texts, and looks whether other named files exist; it starts nothing.
Deployment resolve(const Manifest& manifest, const Contracts& contracts,
                   const std::vector<Override>& overrides);

}  // namespace usher::operations
