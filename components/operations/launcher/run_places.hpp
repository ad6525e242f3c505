#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::operations {

/// Where a deployment runs on this machine by default: one place for each user and DDS domain that
/// a boot leaves, so that what is latched stays so: in XDG_STATE_HOME/usher, else in
/// HOME/.local/state/usher, and where there is no home beside the locks. Those are in
/// XDG_RUNTIME_DIR/usher, else in /run/user/UID/usher, else in /tmp/usher-UID, which the launcher
/// takes only when it belongs to this user alone.
std::string default_run_directory(std::uint32_t domain, const std::string& host);

/// Where a launcher leaves how its robot is reached (a parameter file without parameters), and
/// where it is looked for: that of this user first, then that of a service.
std::vector<std::string> operator_files(std::uint32_t domain);
/// Domains in which a robot was launched on this machine, by this user or as a service, and whose
/// launcher lives; rising.
std::vector<std::uint32_t> launched_domains();

/// Makes the directory of the locks for this user alone. Where anybody may write beside it (/tmp),
/// one that was there and is not ours, or that others may write, could hold somebody else's memory
/// of our robot.
Status make_lock_directory();
/// The lock of a host's launcher in a domain.
std::string launcher_lock(std::uint32_t domain, const std::string& host);
/// A file that is open and locked until it is closed, with this process and the boot in it. The
/// error names the process that holds it.
Result<int> take_lock(const std::string& path);
/// Whether a lock was taken since the machine started.
bool written_since_boot(const std::string& lock_file);

}  // namespace usher::operations
