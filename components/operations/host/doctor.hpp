#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace usher::operations {

/// What one examination of this machine found.
struct Diagnosis {
  enum class Verdict {
    kGood,
    kWarning,  ///< works, but worse than it could
    kBad,      ///< the robot will not work with it
  };
  std::string subject;
  Verdict verdict = Verdict::kGood;
  std::string found;
  std::string remedy;  ///< what to do; empty when all is good
};
std::string to_string(Diagnosis::Verdict verdict);

/// UDP buffers [bytes] that large messages need, in both directions.
inline constexpr int kSocketBuffer = 4 << 20;

/// Examines socket buffers, the sysctl file, multicast on each interface, the clock, shared memory,
/// rights of serial devices, run directory and disk, limits and precedence. Changes nothing; takes
/// less than 2 s.
std::vector<Diagnosis> examine_host(const std::string& run_directory);

/// The keys of a folder: readable, private, and valid today, by what they say about themselves.
std::vector<Diagnosis> examine_keys(const std::string& folder);

/// The sysctl settings that examine_host() asks for, as a file of /etc/sysctl.d.
std::string sysctl_file();
inline constexpr const char* kSysctlPath = "/etc/sysctl.d/60-usher.conf";

}  // namespace usher::operations
