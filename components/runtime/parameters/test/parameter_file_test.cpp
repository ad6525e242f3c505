#include "runtime/parameters/parameter_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace usher::runtime {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFile = R"(component: amcl
name: amcl_1
host: nuc
domain: 7
seed: 18446744073709551615
critical: true
run_directory: /run/usher/marvin
clock_anchor: 1700000000000000000
peers: ["10.0.0.2", 10.0.0.3]
parameters:
  max_beams: {value: 60, origin: "deploy/demo.yaml:31"}
  robot.laser.mount_x:
    value: 0.2 m
    origin: "config/robots/marvin.yaml:12"
  plain: 3 s
  list: {value: [1, 2 m, three], origin: "a:1"}
  records: {value: [{x: 1, name: "a: b"}], origin: "a:2"}
  mapping: {value: "60", origin: "a:3"}
)";

std::string error_of(const std::string& text) {
  const auto file = parse_parameter_file(text, "f.yaml");
  return file.ok() ? "" : file.error();
}

TEST(ParameterFile, ReadsWhatTheLauncherWrites) {
  const auto file = parse_parameter_file(kFile, "amcl.yaml");
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_EQ(file->component, "amcl");
  EXPECT_EQ(file->name, "amcl_1");
  EXPECT_EQ(file->host, "nuc");
  EXPECT_EQ(file->domain, 7U);
  EXPECT_EQ(file->seed, UINT64_MAX);
  EXPECT_TRUE(file->critical);
  EXPECT_EQ(file->run_directory, "/run/usher/marvin");
  EXPECT_EQ(file->clock_anchor, 1700000000000000000);
  EXPECT_EQ(file->peers, (std::vector<std::string>{"10.0.0.2", "10.0.0.3"}));
  ASSERT_EQ(file->values.size(), 6U);
  EXPECT_EQ(file->values[0].yaml, "60");
  EXPECT_EQ(file->values[0].origin, "deploy/demo.yaml:31");
  EXPECT_EQ(file->values[1].name, "robot.laser.mount_x");
  EXPECT_EQ(file->values[1].yaml, "0.2 m");
  EXPECT_EQ(file->values[2].yaml, "3 s");
  EXPECT_EQ(file->values[2].origin, "amcl.yaml:15");
  EXPECT_EQ(file->values[3].yaml, "[1, 2 m, three]");
  EXPECT_EQ(file->values[4].yaml, "[{x: 1, name: \"a: b\"}]");
}

TEST(ParameterFile, NamesFileAndLineOfEachMistake) {
  const std::string head = "component: a\nname: b\nhost: c\n";
  EXPECT_EQ(error_of(head), "");
  EXPECT_EQ(error_of(head + "parameters:\n"), "");
  EXPECT_EQ(error_of(head + "colour: red\n"), "unknown key colour (f.yaml:4)");
  EXPECT_EQ(error_of(head + "domain: 500\n"), "domain must be in [0, 232], got 500 (f.yaml:4)");
  EXPECT_EQ(error_of(head + "domain: -1\n"),
            "domain must be a whole number, got \"-1\" (f.yaml:4)");
  EXPECT_EQ(error_of(head + "seed: 1.5\n"), "seed must be a whole number, got \"1.5\" (f.yaml:4)");
  EXPECT_EQ(error_of(head + "critical: yes\n"),
            "critical must be true or false, got \"yes\" (f.yaml:4)");
  EXPECT_EQ(error_of(head + "peers: 10.0.0.2\n"), "peers must be a list of addresses (f.yaml:4)");
  EXPECT_EQ(error_of(head + "name: d\n"), "key name is given twice (f.yaml:4)");
  EXPECT_EQ(error_of(head + "parameters: [1]\n"), "parameters must be a mapping (f.yaml:4)");
  EXPECT_EQ(error_of(head + "parameters:\n  x: 1\n  x: 2\n"), "key x is given twice (f.yaml:6)");
  EXPECT_EQ(error_of(head + "parameters:\n  x:\n"), "x has no value (f.yaml:5)");
  EXPECT_EQ(error_of(head + "parameters:\n  x: {origin: y}\n"),
            "parameter x has no value (f.yaml:5)");
  EXPECT_EQ(error_of(head + "parameters:\n  x: {value: 1, unit: m}\n"),
            "unknown key unit of parameter x, expected value and origin (f.yaml:5)");
  EXPECT_EQ(error_of("name: b\nhost: c\n"), "component must be set (f.yaml:1)");
  EXPECT_THAT(error_of("a: [1\nb: 2\n"), HasSubstr("not YAML: "));
  EXPECT_EQ(error_of(""), "a parameter file must be a mapping (f.yaml:1)");
  EXPECT_EQ(read_parameter_file("/nowhere/x.yaml").error(), "cannot read the file /nowhere/x.yaml");
}

TEST(ParameterFile, SurvivesGarbageAndDepth) {
  std::string deep;
  for (int i = 0; i < 200; ++i) deep += "[";
  for (int i = 0; i < 200; ++i) deep += "]";
  EXPECT_THAT(flatten("x: " + deep, "f").error(), HasSubstr("nested deeper than 32"));
  EXPECT_FALSE(flatten("x: &a [*a]", "f").ok()) << "a list that contains itself";
  EXPECT_FALSE(flatten("x: &a {b: *a}", "f").ok());
  EXPECT_FALSE(flatten(std::string("\0\xff\xfe", 3), "f").ok());
  std::string bytes;
  std::uint64_t state = 1;
  for (int round = 0; round < 2000; ++round) {
    bytes.clear();
    for (int i = 0; i < 40; ++i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      bytes += "{}[]:,-&*!|>'\"%@ \n\tab01#?"[(state >> 33) % 26];
    }
    static_cast<void>(flatten(bytes, "f"));
    static_cast<void>(parse_parameter_file(bytes, "f"));
  }
}

TEST(Flatten, NestsNamesWithDotsAndRemembersLines) {
  const auto values = flatten(
      "laser:\n  mount: {x: 0.2 m, z: 30 cm}\n  angles: [1, 2]\nname: \"a: b\"\nempty: \"\"\n"
      "records:\n  - {x: 1}\n  - {x: 2}\n",
      "marvin.yaml");
  ASSERT_TRUE(values.ok()) << values.error();
  ASSERT_EQ(values->size(), 6U);
  const auto check = [&](std::size_t i, const char* name, const char* yaml, const char* origin) {
    EXPECT_EQ((*values)[i].name, name);
    EXPECT_EQ((*values)[i].yaml, yaml);
    EXPECT_EQ((*values)[i].origin, origin);
  };
  check(0, "laser.mount.x", "0.2 m", "marvin.yaml:2");
  check(1, "laser.mount.z", "30 cm", "marvin.yaml:2");
  check(2, "laser.angles", "[1, 2]", "marvin.yaml:3");
  check(3, "name", "\"a: b\"", "marvin.yaml:4");
  check(4, "empty", "\"\"", "marvin.yaml:5");
  check(5, "records", "[{x: 1}, {x: 2}]", "marvin.yaml:6");
  EXPECT_TRUE(flatten("", "f")->empty());
}

TEST(Flatten, RefusesWhatIsSaidTwice) {
  EXPECT_EQ(flatten("a: 1\nb: 2\na: 3", "f").error(), "key a is given twice (f:3)");
  EXPECT_EQ(flatten("a: {b: 1}\na.b: 2", "f").error(), "key a.b is given twice (f:2)");
  EXPECT_EQ(flatten("a:\n  b: 1\n  b: 2", "f").error(), "key b is given twice (f:3)");
  EXPECT_EQ(flatten("a:", "f").error(), "a has no value (f:1)");
  EXPECT_EQ(flatten("[1]", "f").error(), "expected a mapping (f:1)");
  EXPECT_EQ(flatten("[a]: 1", "f").error(), "a key must be a plain value (f:1)");
}

}  // namespace
}  // namespace usher::runtime
