// What the shipped manifests say of the devices that they name.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "operations/manifest/resolve.hpp"

namespace usher::operations {
namespace {

namespace fs = std::filesystem;

const std::string kSource = USHER_SOURCE_DIR;

/// A parameter as a component gets it; empty where the contract's default holds.
std::string value_of(const runtime::ParameterFile& file, const std::string& name) {
  for (const auto& given : file.values) {
    if (given.name == name) return given.yaml;
  }
  return {};
}

TEST(ShippedManifests, WhoReadsImagesOfALiveKinectKnowsThatItIsAV1) {
  const auto contracts = read_contracts(std::string(USHER_BINARY_DIR) + "/share/usher/contracts");
  ASSERT_TRUE(contracts.ok()) << contracts.error();
  int live = 0, readers = 0;
  for (const auto& entry : fs::directory_iterator(kSource + "/deploy")) {
    if (entry.path().extension() != ".yaml") continue;
    const auto manifest = read_manifest(entry.path().string(), {kSource + "/config"});
    ASSERT_TRUE(manifest.ok()) << manifest.error();
    const Deployment deployment = resolve(*manifest, *contracts, {});
    const auto is_live = [](const auto& file) { return value_of(file, "source") == "live"; };
    if (std::none_of(deployment.files.begin(), deployment.files.end(), is_live)) continue;
    ++live;
    for (const auto& file : deployment.files) {
      for (const auto& parameter : contracts->at(file.component).parameters) {
        if (parameter.name != "robot.kinect.model") continue;
        ++readers;
        EXPECT_EQ(value_of(file, parameter.name), "v1") << entry.path() << ", " << file.name;
      }
    }
  }
  EXPECT_GE(live, 2);
  EXPECT_GE(readers, 1);
}

}  // namespace
}  // namespace usher::operations
