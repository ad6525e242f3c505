#pragma once

#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/security/permissions.hpp"

namespace usher::operations {

// A folder of keys:
//
//   ca.pem ca.key          the robot's CA; the key belongs off the robot once all is made
//   governance.smime       what holds for everybody
//   NAME/certificate.pem   who NAME is
//   NAME/key.pem           its private key, mode 0600
//   NAME/permissions.smime what it may write and read
//
// A host needs ca.pem, governance.smime and the folders of what runs there, the launcher with it.
// An operator's commands need that of the operator.

struct KeysOptions {
  int days = 3650;     ///< that certificates and permissions are valid
  bool renew = false;  ///< make everything new, the CA too
};

/// What became of one file of the folder.
struct KeysEntry {
  std::string name;   ///< of the identity; "ca" for the CA
  bool made = false;  ///< else it was there and was kept
};

/// Makes what is missing and signs governance and permissions anew; a key that is there stays,
/// unless all is renewed. Private files get mode 0600, the folder 0700. Names of identities become
/// names of folders; each must be one path component.
Result<std::vector<KeysEntry>> make_keys(const std::string& folder, const std::string& robot,
                                         const std::vector<Permissions>& identities,
                                         const KeysOptions& options);

/// Whether there is a CA already.
bool has_keys(const std::string& folder);

/// Judges the keys that a manifest names: nothing when it names none. A component without identity
/// is told where this machine has keys of its host at all, or of no host; those of other hosts are
/// theirs to have. Every host needs the launcher's.
void judge_keys(const Manifest& manifest, const Contracts& contracts,
                std::vector<Finding>& findings);

}  // namespace usher::operations
