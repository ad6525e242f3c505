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

/// The closed list of what can be wrong with a deployment.
enum class Verdict {
  kUnreadable,    ///< a file that is named cannot be read or parsed
  kUnknownType,   ///< no contract for a component's type
  kUnknownKey,    ///< a key that nobody declares
  kWrongValue,    ///< wrong type, unit or range
  kMissingValue,  ///< a required parameter that nobody sets
  kMissingFile,   ///< a parameter names a file that is not there
  kMisplaced,     ///< a robot.* or site.* value set elsewhere than in the robot's or site's file
  kNoWriter,      ///< an input that nobody writes
  kTwoWriters,    ///< two writers of a topic that has one
  kUnauthorizedWriter,  ///< a component that may not write a topic
  kTypeMismatch,        ///< one topic, two types; or a topic that the catalogue does not know
  kQosMismatch,         ///< reader and writer would not match
  kRateTooLow,          ///< a writer too slow for the age that a reader accepts
  kUnsafePolicy,        ///< a component of the drive chain that is not critical or not restarted
  kSplitDriveChain,     ///< the drive chain spread over several hosts
  kSplitGroup,          ///< a group spread over several hosts
  kWrongIdl,            ///< a contract made from other IDL
};
std::string to_string(Verdict verdict);

struct Finding {
  Verdict verdict;
  std::string text;
  std::string origin;  ///< file:line
};

/// A value given on the command line: `--set amcl.max_beams=60`.
struct Override {
  std::string component;
  std::string parameter;
  std::string value;
};

/// A manifest with every component's parameters in place, and everything that is wrong with it.
struct Deployment {
  Manifest manifest;
  std::vector<runtime::ParameterFile> files;  ///< in the order of manifest.components
  std::vector<Finding> findings;
};

/// Lays contract default < robot < site < manifest < command line, derives the manifest.* facts,
/// and judges wiring and values. It reads the robot's and the site's file and looks whether named
/// files exist; it starts nothing.
Deployment resolve(const Manifest& manifest, const Contracts& contracts,
                   const std::vector<Override>& overrides);

}  // namespace usher::operations
