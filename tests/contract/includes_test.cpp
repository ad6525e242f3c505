#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "contract/include_rules.hpp"

namespace usher::contract {
namespace {

TEST(IncludeRules, RefuseWhatBreaksTheHouse) {
  const auto refused = [](const char* path, const char* include) {
    EXPECT_NE(include_breach(path, include), "") << path << " includes " << include;
  };
  refused("navigation/costmap/core/costmap.cpp", "\"idl/topics.hpp\"");
  refused("navigation/costmap/core/costmap.cpp", "\"usher_msgs.h\"");
  refused("navigation/costmap/core/costmap.cpp", "\"wire/conversions.hpp\"");
  refused("navigation/costmap/core/costmap.cpp", "\"runtime/api/time.hpp\"");
  refused("navigation/costmap/core/costmap.cpp", "\"navigation/costmap/shell/component.hpp\"");
  refused("navigation/costmap/core/costmap.cpp", "\"costmap.hpp\"");
  refused("navigation/costmap/core/costmap.cpp", "<fastrtps/rtps/common/Guid.h>");
  refused("navigation/costmap/core/costmap.cpp", "<spdlog/spdlog.h>");
  refused("navigation/costmap/core/costmap.cpp", "<thread>");
  refused("navigation/costmap/core/costmap.cpp", "<yaml-cpp/yaml.h>");
  refused("navigation/costmap/shell/component.cpp", "\"navigation/navigator/core/navigator.hpp\"");
  refused("navigation/costmap/shell/component.cpp", "\"runtime/dds/dds_host.hpp\"");
  refused("navigation/costmap/shell/component.cpp", "\"runtime/lockstep/lockstep_world.hpp\"");
  refused("navigation/costmap/shell/component.cpp", "<fastcdr/Cdr.h>");
  refused("navigation/costmap/shell/component.cpp", "\"simulation/world/core/world.hpp\"");
  refused("drivers/lms100/device_sim/device.cpp", "\"simulation/world/core/world.hpp\"");
  refused("drivers/lms100/test/lms100_test.cpp", "\"simulation/world/core/world.hpp\"");
  refused("simulation/visitor/shell/component.cpp", "\"simulation/world/core/world.hpp\"");
  refused("simulation/visitor/shell/component.cpp", "\"interaction/speech/engine/espeak.hpp\"");
  refused("interaction/tablet/program/main.cpp", "\"interaction/speech/engine/espeak.hpp\"");
  refused("drivers/p3dx/core/link.hpp", "\"drivers/base_obedience/shell/obedient_base.hpp\"");
  refused("control/supervisor/shell/component.cpp",
          "\"drivers/base_obedience/shell/obedient_base.hpp\"");
  refused("drivers/p3dx/device_real/component.cpp", "\"drivers/segway_rmp/core/link.hpp\"");
  refused("foundation/grid/grid.hpp", "\"wire/conversions.hpp\"");
  refused("foundation/grid/grid.hpp", "\"runtime/api/time.hpp\"");
  refused("foundation/grid/grid.hpp", "<atomic>");
  refused("runtime/engine/engine.cpp", "<fastdds/dds/domain/DomainParticipant.hpp>");
  refused("runtime/engine/engine.cpp", "\"wire/conversions.hpp\"");
  refused("runtime/engine/engine.cpp", "\"localization/amcl/core/amcl.hpp\"");
  refused("wire/conversions.cpp", "\"runtime/engine/engine.hpp\"");
  refused("wire/conversions.cpp", "\"localization/amcl/core/amcl.hpp\"");
}

TEST(IncludeRules, AllowTheRest) {
  const auto allowed = [](const char* path, const char* include) {
    EXPECT_EQ(include_breach(path, include), "") << path << " includes " << include;
  };
  allowed("navigation/costmap/core/costmap.cpp", "\"navigation/costmap/core/costmap.hpp\"");
  allowed("navigation/costmap/core/costmap.cpp", "\"foundation/grid/grid.hpp\"");
  allowed("navigation/costmap/core/costmap.cpp", "<Eigen/Core>");
  allowed("navigation/costmap/core/costmap.cpp", "<chrono>");
  allowed("simulation/world/core/world_file.cpp", "<yaml-cpp/yaml.h>");
  allowed("navigation/costmap/shell/component.cpp", "\"navigation/costmap/core/costmap.hpp\"");
  allowed("navigation/costmap/shell/component.cpp", "\"wire/conversions.hpp\"");
  allowed("navigation/costmap/shell/component.cpp", "\"runtime/api/host.hpp\"");
  allowed("navigation/costmap/shell/component.hpp", "\"idl/topics.hpp\"");
  allowed("navigation/costmap/test/component_test.cpp", "\"runtime/testing/test_host.hpp\"");
  allowed("navigation/costmap/test/component_test.cpp", "\"support/data.hpp\"");
  allowed("drivers/segway_rmp/shell/component.cpp",
          "\"drivers/base_obedience/core/base_obedience.hpp\"");
  allowed("drivers/segway_rmp/core/base.cpp", "\"drivers/base_obedience/core/base_obedience.hpp\"");
  allowed("drivers/p3dx/shell/base_driver.hpp",
          "\"drivers/base_obedience/shell/obedient_base.hpp\"");
  allowed("control/supervisor/shell/component.cpp",
          "\"drivers/base_obedience/shell/read_response.hpp\"");
  allowed("drivers/lms100/device_real/component.hpp",
          "\"drivers/laser_scanner/shell/scanner_line.hpp\"");
  allowed("drivers/lms100/core/session.hpp", "\"drivers/laser_scanner/core/scan.hpp\"");
  allowed("simulation/world/shell/component.cpp", "\"simulation/world/core/world.hpp\"");
  allowed("simulation/visitor/program/main.cpp", "\"interaction/speech/engine/espeak.hpp\"");
  allowed("interaction/tablet/shell/component.hpp", "\"interaction/finger/core/tap.hpp\"");
  allowed("operations/experiments/guide.cpp", "\"simulation/world/core/world.hpp\"");
  allowed("operations/experiments/guide.cpp", "\"runtime/lockstep/lockstep_world.hpp\"");
  allowed("runtime/dds/dds_host.cpp", "<fastdds/dds/domain/DomainParticipant.hpp>");
  allowed("runtime/dds/dds_host.cpp", "\"runtime/engine/engine.hpp\"");
  allowed("runtime/engine/engine.cpp", "\"idl/topics.hpp\"");
  allowed("wire/transform_input.hpp", "\"runtime/api/host.hpp\"");
}

TEST(IncludeRules, FindWordsThatACoreDoesNotUse) {
  EXPECT_NE(word_breach("localization/amcl/core/amcl.cpp", "  std::random_device device;"), "");
  EXPECT_NE(word_breach("foundation/grid/grid.cpp", "auto t = std::chrono::steady_clock::now();"),
            "");
  EXPECT_EQ(word_breach("localization/amcl/core/amcl.cpp", "  // no std::random_device"), "");
  EXPECT_EQ(word_breach("localization/amcl/test/amcl_test.cpp", "std::random_device device;"), "");
  EXPECT_EQ(word_breach("localization/amcl/core/amcl.cpp", "int getenvy;"), "");
}

TEST(IncludeRules, ReadIncludesAsWritten) {
  EXPECT_EQ(
      includes_of("#include <a/b.h>\n  #  include \"c/d.hpp\"  // why\n// #include <no>\nint x;\n"),
      (std::vector<std::string>{"<a/b.h>", "\"c/d.hpp\""}));
}

TEST(Components, IncludeOnlyWhatTheyMay) {
  const std::filesystem::path root = std::filesystem::path(USHER_SOURCE_DIR) / "components";
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const auto extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp" && extension != ".in") continue;
    ++files;
    const std::string path = entry.path().lexically_relative(root).string();
    std::ifstream stream(entry.path());
    std::stringstream text;
    text << stream.rdbuf();
    for (const std::string& include : includes_of(text.str())) {
      const std::string breach = include_breach(path, include);
      EXPECT_EQ(breach, "") << "components/" << path << " includes " << include;
    }
    int number = 0;
    for (std::string line; std::getline(text, line);) {
      ++number;
      const std::string breach = word_breach(path, line);
      EXPECT_EQ(breach, "") << "components/" << path << ":" << number << ": " << line;
    }
  }
  EXPECT_GT(files, 50) << "found no sources below " << root;
}

}  // namespace
}  // namespace usher::contract
