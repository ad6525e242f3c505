#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cassert>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace usher {

/// DDS domains that no other test program of this machine uses while this process lives: tests run
/// side by side and must not meet. Their UDP ports lie below those that the kernel hands out. One
/// thread only.
inline std::uint32_t test_domain(std::size_t which = 0) {
  static std::vector<std::uint32_t> domains;
  const auto claim = [] {
    const std::string prefix = std::filesystem::temp_directory_path() / "usher-test-domain-";
    for (std::uint32_t i = 0; i < 100; ++i) {
      const std::uint32_t candidate = 1 + (static_cast<std::uint32_t>(::getpid()) + i) % 100;
      const int file =
          ::open((prefix + std::to_string(candidate)).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) == 0)
        return candidate;  // held until the process ends
      if (file >= 0) ::close(file);
    }
    assert(!"100 test programs hold a DDS domain");
    return 0U;
  };
  while (domains.size() <= which) domains.push_back(claim());
  return domains[which];
}

}  // namespace usher
