#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "contract/idl_reader.hpp"

namespace usher::contract {
namespace {

std::string content(const std::string& relative) {
  std::ifstream stream(std::filesystem::path(USHER_SOURCE_DIR) / relative);
  EXPECT_TRUE(stream) << relative;
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A group of constants is told by the first word: STATE_OK and STATE_FAULT are one enumeration.
std::set<std::string> groups_without_zero(const IdlFile& file) {
  std::map<std::string, std::set<std::string>> values;
  for (const IdlConstant& constant : file.constants) {
    values[constant.module + " " + constant.name.substr(0, constant.name.find('_'))].insert(
        constant.value);
  }
  std::set<std::string> result;
  for (const auto& [group, numbers] : values) {
    if (numbers.count("0") == 0) result.insert(group);
  }
  return result;
}

TEST(IdlReader, ReadsWhatWeWrite) {
  const IdlFile file = read_idl(
      "// module no { };\n#include \"ros2.idl\"\nmodule p { module msg {\n  module A_Constants {\n"
      "    const octet STATE_X = 0;  // comment;\n    const octet STATE_Y = 1;\n  };\n"
      "  struct A { double x; sequence<p::msg::B> bs; };\n"
      "  struct B {\n    octet id[16];  ///< [-] (-) {0..; 3} Who.\n    @default(1.0) double w;\n  "
      "};\n}; };\n");
  ASSERT_EQ(file.structs.size(), 2U);
  EXPECT_EQ(file.structs[0].package, "p");
  ASSERT_EQ(file.structs[0].fields.size(), 2U);
  EXPECT_EQ(file.structs[0].fields[1].type, "sequence<p::msg::B>");
  ASSERT_EQ(file.structs[1].fields.size(), 2U);
  EXPECT_EQ(file.structs[1].fields[0].type, "octet[16]");
  EXPECT_EQ(file.structs[1].fields[0].comment, "[-] (-) {0..; 3} Who.");
  EXPECT_EQ(file.structs[1].fields[0].line, 10);
  EXPECT_EQ(file.structs[1].fields[1].name, "w");
  ASSERT_EQ(file.constants.size(), 2U);
  EXPECT_EQ(file.constants[1].module, "A_Constants");
  EXPECT_TRUE(groups_without_zero(file).empty());
}

TEST(IdlReader, FindsWhatTheLintForbids) {
  EXPECT_EQ(comment_breach("[m] (map) {0..} How far."), "");
  EXPECT_EQ(comment_breach("[m] or [rad] (map) {finite} How far or how much."), "");
  for (const char* wrong : {"", "How far.", "[m] (map) How far.", "[m] {0..} How far.",
                            "(map) {0..} How far.", "[m] (map) {0..}", "[m] (map) {0..} How far",
                            "[] (map) {0..} How far.", "[m] (map) {} How far."}) {
    EXPECT_NE(comment_breach(wrong), "") << wrong;
  }
  const IdlFile file = read_idl("module p { module A_Constants { const octet STATE_X = 1; }; };");
  EXPECT_EQ(groups_without_zero(file).count("A_Constants STATE"), 1U);
}

class UsherIdl : public ::testing::TestWithParam<const char*> {};

TEST_P(UsherIdl, SaysUnitFrameRangeAndASentenceAboutEveryField) {
  const IdlFile file = read_idl(content(GetParam()));
  EXPECT_GT(file.structs.size(), 3U);
  for (const IdlStruct& each : file.structs) {
    EXPECT_FALSE(each.fields.empty()) << each.name;
    for (const IdlField& field : each.fields) {
      EXPECT_EQ(comment_breach(field.comment), "")
          << GetParam() << ":" << field.line << ": " << each.name << "." << field.name;
    }
  }
}

TEST_P(UsherIdl, GivesEveryEnumerationAZeroValue) {
  for (const std::string& group : groups_without_zero(read_idl(content(GetParam())))) {
    ADD_FAILURE() << GetParam() << ": the enumeration " << group << " has no zero value";
  }
}

TEST_P(UsherIdl, NamesConstantsAfterTheTypeThatUsesThem) {
  const IdlFile file = read_idl(content(GetParam()));
  std::string all = content(GetParam());
  for (const IdlConstant& constant : file.constants) {
    EXPECT_TRUE(constant.module.ends_with("_Constants")) << constant.module;
    // Somewhere a field says which constants it takes.
    EXPECT_NE(all.find("{" + constant.module), std::string::npos)
        << constant.module << " is used by no field";
  }
}

INSTANTIATE_TEST_SUITE_P(Files, UsherIdl,
                         ::testing::Values("idl/usher_msgs.idl", "idl/usher_sim_msgs.idl"),
                         [](const auto& each) {
                           return std::filesystem::path(each.param).stem().string();
                         });

TEST(Ros2Idl, HasTheMembersOfRos2Humble) {
  std::map<std::string, std::string> expected;
  std::istringstream table(content("tests/contract/ros2_humble_messages.txt"));
  for (std::string line; std::getline(table, line);) {
    if (line.starts_with('#')) continue;
    const auto colon = line.find(':');
    ASSERT_NE(colon, std::string::npos) << line;
    std::istringstream members(line.substr(colon + 1));
    std::string normal;
    for (std::string member; std::getline(members, member, ';');) {
      std::istringstream words(member);
      std::string type, name;
      words >> type >> name;
      if (!name.empty()) normal += ros_type(type) + " " + name + "; ";
    }
    expected[line.substr(0, colon)] = normal;
  }
  expected["std_msgs/Empty"] = "uint8 structure_needs_at_least_one_member; ";
  const IdlFile file = read_idl(content("idl/ros2.idl"));
  EXPECT_EQ(file.structs.size(), expected.size());
  for (const IdlStruct& each : file.structs) {
    std::string members;
    for (const IdlField& field : each.fields)
      members += ros_type(field.type) + " " + field.name + "; ";
    const std::string name = each.package + "/" + each.name;
    ASSERT_EQ(expected.count(name), 1U)
        << name << " is missing in tests/contract/ros2_humble_messages.txt";
    EXPECT_EQ(members, expected[name]) << name;
  }
}

}  // namespace
}  // namespace usher::contract
