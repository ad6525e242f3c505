#pragma once

#include <string>

namespace usher::operations {

/// The closed list of what can be wrong with a deployment.
enum class Verdict {
  kUnreadable,          ///< a file that is named cannot be read or parsed
  kUnknownType,         ///< no contract for a component's type
  kUnknownHost,         ///< a component on a host that the manifest does not have
  kUnknownKey,          ///< a key that nobody declares
  kWrongValue,          ///< wrong type, unit or range, or refused by the component
  kMissingValue,        ///< something required that nobody sets
  kMissingFile,         ///< a parameter names a file that is not there
  kMisplaced,           ///< a robot.*, site.* or manifest.* value set where it does not belong
  kNoWriter,            ///< an input that nobody writes
  kTwoWriters,          ///< two writers of a topic that has one
  kUnauthorizedWriter,  ///< a component that may not write a topic
  kTypeMismatch,        ///< one topic, two types; or a topic that the catalogue does not know
  kQosMismatch,         ///< reader and writer would not match
  kRateTooLow,          ///< a writer too slow for the age that a reader accepts
  kUnsafePolicy,     ///< what the robot drives by is not critical, or its drive chain not restarted
  kSplitDriveChain,  ///< the drive chain spread over several hosts
  kSplitGroup,       ///< a group that cannot be one process
  kWrongIdl,         ///< a contract made from other IDL
  kNoPermission,     ///< keys that do not let a component do what its contract says, or more
};
std::string to_string(Verdict verdict);

struct Finding {
  Verdict verdict;
  std::string text;
  std::string origin;  ///< file:line
};
/// What an error says; the place at its end, "... (deploy/demo.yaml:7)", counts instead of
/// `origin`.
Finding finding_of(Verdict verdict, const std::string& error, const std::string& origin);
/// "deploy/demo.yaml:7: two writers: scan is written by 'a' and by 'b'"
std::string to_string(const Finding& finding);

}  // namespace usher::operations
