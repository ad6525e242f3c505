#pragma once

#include <thread>

namespace usher::test {

/// How much longer things may take in a program that is built with a sanitizer: what the
/// sanitizers' documentation calls typical (address 2, undefined behavior 1.2, thread 5 to 15),
/// times 2.5 since these presets compile at -O1. 1 without. Bounds of wall time are multiplied with
/// it, as ctest's are in cmake/UsherBuild.cmake.
#if defined(__SANITIZE_THREAD__)
inline constexpr double kSanitizerFactor = 15.0;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr double kSanitizerFactor = 6.0;
#else
inline constexpr double kSanitizerFactor = 1.0;
#endif

/// Twenty processes that sign, slowed down by a sanitizer, starve on two cores: nothing is in time,
/// and nothing would be tested.
inline bool signing_robot_starves() {
  return kSanitizerFactor > 1.0 && std::thread::hardware_concurrency() < 4;
}
inline constexpr const char* kSigningRobotStarves =
    "a whole signing robot under a sanitizer needs 4 cores";

}  // namespace usher::test
