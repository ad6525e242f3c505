// The README of every component is one, and names each port that its contract declares to read.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "runtime/api/contract.hpp"
#include "support/process.hpp"

namespace usher::contract {
namespace {

namespace fs = std::filesystem;

/// The folder of a component: its name, that of the one whose device it simulates, or of the one
/// that it lives with.
std::string folder_of(std::string component) {
  static const std::map<std::string, std::string> kGuests{{"attendees", "visitor"},
                                                          {"segway_emulator", "segway_rmp"},
                                                          {"waypoint_follower", "local_planner"}};
  if (const auto guest = kGuests.find(component); guest != kGuests.end()) return guest->second;
  if (component.ends_with("_sim")) component.resize(component.size() - 4);
  return component;
}

/// Text of each README by its folder's name.
std::map<std::string, std::string> readmes() {
  std::map<std::string, std::string> all;
  for (const auto& room : fs::directory_iterator(USHER_SOURCE_DIR "/components")) {
    if (!room.is_directory()) continue;
    for (const auto& folder : fs::directory_iterator(room)) {
      const fs::path readme = folder.path() / "README.md";
      if (fs::exists(readme)) all[folder.path().filename()] = test::content_of(readme);
    }
  }
  return all;
}

bool names(const std::string& readme, const std::string& port) {
  const auto has = [&](const std::string& word) {
    return readme.find("`" + word + "`") != std::string::npos;
  };
  constexpr std::string_view kInfo = "/camera_info";
  return has(port) || (port == "tf_static" && has("tf")) ||  // never one without the other
         (port.ends_with(kInfo) && has("camera_info"));      // nor an image without it
}

/// No tool has reformatted them as if they were code.
TEST(ContractReadmes, AreMarkdown) {
  for (const auto& [folder, text] : readmes()) {
    EXPECT_TRUE(text.starts_with("# ")) << folder;
    if (text.find("\n|") != std::string::npos) {
      EXPECT_NE(text.find("\n|---|"), std::string::npos) << folder;
    }
  }
}

TEST(ContractReadmes, NameEveryPortThatIsRead) {
  const auto texts = readmes();
  std::size_t seen = 0;
  for (const auto& entry : fs::directory_iterator(USHER_BINARY_DIR "/share/usher/contracts")) {
    const auto contract =
        runtime::contract_from_yaml(test::content_of(entry.path()), entry.path().string());
    ASSERT_TRUE(contract) << contract.error();
    const auto readme = texts.find(folder_of(contract->component));
    ASSERT_NE(readme, texts.end()) << contract->component << " has no README.md";
    const bool device = contract->component != readme->first;
    for (const auto& input : contract->inputs) {
      if (device && input.topic.starts_with("sim/")) continue;  // the simulator's side of a device
      ++seen;
      EXPECT_TRUE(names(readme->second, input.topic))
          << contract->component << " reads " << input.topic << ", its README.md does not say so";
    }
  }
  EXPECT_GT(seen, 150U) << "the contracts were not found";
}

}  // namespace
}  // namespace usher::contract
