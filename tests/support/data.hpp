#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace usher {

/// The path of `relative` inside the folder with real data (environment variable USHER_TEST_DATA);
/// empty when the variable is unset or nothing lies there.
inline std::string test_data(const std::string& relative) {
  const char* folder = std::getenv("USHER_TEST_DATA");
  if (folder == nullptr) return {};
  const std::filesystem::path path = std::filesystem::path(folder) / relative;
  std::error_code error;
  return std::filesystem::exists(path, error) ? path.string() : std::string{};
}

}  // namespace usher

/// In a GoogleTest: declares `path`, or skips the test with a line that names what is absent.
#define USHER_REQUIRE_DATA(path, relative)               \
  const std::string path = usher::test_data((relative)); \
  if ((path).empty()) GTEST_SKIP() << "no " << (relative) << " below USHER_TEST_DATA"
