#include "runtime/parameters/parameter_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <numbers>

namespace usher::runtime {
namespace {

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kWhere = "config/robots/marvin.yaml:12";

ParameterSet given(const std::string& name, const std::string& yaml) {
  return ParameterSet({{name, yaml, kWhere}}, "amcl.yaml");
}

/// The error of one number in [0.005, 0.5] m that is given as `yaml`; empty when it is fine.
std::string error_of(const std::string& yaml) {
  auto set = given("sigma_hit", yaml);
  set.number("sigma_hit", "m", {0.005, 0.5}, 0.2, "Spread.");
  const Status status = set.finish();
  return status.ok() ? "" : status.error();
}

TEST(ParameterSet, GivesDefaultsAndSiValues) {
  ParameterSet set({{"a", "470 mm", "f:1"},
                    {"b", "20 deg", "f:2"},
                    {"c", "7", "f:3"},
                    {"d", "true", "f:4"},
                    {"e", "two words", "f:5"},
                    {"f", "fast", "f:6"},
                    {"g", "[1, 20 cm, 0.3 m]", "f:7"},
                    {"h", "12 ms", "f:8"}},
                   "file");
  EXPECT_EQ(set.number("a", "m", {0, 1}, 0.1, "t"), 0.47);
  EXPECT_DOUBLE_EQ(set.number("b", "rad", {0, 1}, "t"), std::numbers::pi / 9);
  EXPECT_EQ(set.integer("c", "-", {0, 10}, 3, "t"), 7);
  EXPECT_TRUE(set.flag("d", false, "t"));
  EXPECT_EQ(set.text("e", "none", "t"), "two words");
  EXPECT_EQ(set.choice("f", {"slow", "fast"}, "slow", "t"), "fast");
  EXPECT_EQ(set.numbers("g", "m", {0, 2}, 1, 3, {}, "t"), (std::vector<double>{1, 0.2, 0.3}));
  EXPECT_EQ(set.number("h", "s", {0, 1}, 0.1, "t"), 0.012);
  EXPECT_EQ(set.number("i", "m", {0, 1}, 0.1, "t"), 0.1);
  EXPECT_EQ(set.integer("j", "-", {-5, 10}, -3, "t"), -3);
  EXPECT_FALSE(set.flag("k", false, "t"));
  EXPECT_EQ(set.text("l", "a: b # c", "t"), "a: b # c");
  EXPECT_EQ(set.text("m", "", "t"), "");
  EXPECT_EQ(set.file("n", "", "t"), "");
  EXPECT_EQ(set.number("o", "m", {0, kInfinity}, kInfinity, "t"), kInfinity);
  EXPECT_EQ(set.numbers("p", "rad", {-4, 4}, 1, 2, {0.1, -0.25}, "t"),
            (std::vector<double>{0.1, -0.25}));
  // Five numbers declared with an empty default must say so.
  const Status status = set.finish();
  EXPECT_EQ(status.ok() ? "" : status.error(),
            "programming error: g must be a list of 1 to 3 numbers in [0, 2] m, got 0 (the "
            "declared default)");
}

TEST(ParameterSet, NamesExpectedFoundAndWhere) {
  EXPECT_EQ(error_of("0.3"), "");
  EXPECT_EQ(error_of("5 m"), "sigma_hit must be in [0.005, 0.5] m, got 5 m (" + kWhere + ")");
  EXPECT_EQ(error_of("5"), "sigma_hit must be in [0.005, 0.5] m, got 5 m (" + kWhere + ")");
  EXPECT_EQ(error_of("5000 mm"),
            "sigma_hit must be in [0.005, 0.5] m, got 5000 mm (" + kWhere + ")");
  EXPECT_EQ(error_of("0.3 kg"),
            "sigma_hit must be in one of the units m, mm, cm, km, got 0.3 kg (" + kWhere + ")");
  EXPECT_EQ(error_of("wide"),
            "sigma_hit must be a number in [0.005, 0.5] m, got \"wide\" (" + kWhere + ")");
  EXPECT_EQ(error_of("[1, 2]"),
            "sigma_hit must be a number in [0.005, 0.5] m, got a list (" + kWhere + ")");
  EXPECT_EQ(error_of("{a: 1}"),
            "sigma_hit must be a number in [0.005, 0.5] m, got a mapping (" + kWhere + ")");
  EXPECT_EQ(error_of(""),
            "sigma_hit must be a number in [0.005, 0.5] m, got nothing (" + kWhere + ")");
  EXPECT_EQ(error_of(".nan"),
            "sigma_hit must be a number in [0.005, 0.5] m, got \".nan\" (" + kWhere + ")");
  EXPECT_THAT(error_of("[1, 2"), HasSubstr("sigma_hit is not YAML: "));
}

TEST(ParameterSet, NamesEveryOtherKindToo) {
  const auto error = [](const std::string& yaml, auto&& declare) {
    auto set = given("x", yaml);
    declare(set);
    const Status status = set.finish();
    return status.ok() ? std::string() : status.error();
  };
  const std::string end = " (" + kWhere + ")";
  EXPECT_EQ(error("maybe", [](auto& set) { set.flag("x", true, "t"); }),
            "x must be true or false, got \"maybe\"" + end);
  EXPECT_EQ(error("2.5",
                  [](auto& set) {
                    set.integer("x", "-", {0, 9}, 1, "t");
                  }),
            "x must be a whole number in [0, 9], got 2.5" + end);
  EXPECT_EQ(error("12",
                  [](auto& set) {
                    set.integer("x", "-", {0, 9}, 1, "t");
                  }),
            "x must be in [0, 9], got 12" + end);
  EXPECT_EQ(error("3 m",
                  [](auto& set) {
                    set.number("x", "-", {0, 9}, 1, "t");
                  }),
            "x must be without unit, got 3 m" + end);
  EXPECT_EQ(error("red",
                  [](auto& set) {
                    set.choice("x", {"a", "b"}, "a", "t");
                  }),
            "x must be one of a, b, got \"red\"" + end);
  EXPECT_EQ(error("[1]",
                  [](auto& set) {
                    set.numbers("x", "m", {0, 9}, 2, 2, {1, 2}, "t");
                  }),
            "x must be a list of 2 numbers in [0, 9] m, got 1" + end);
  EXPECT_EQ(error("[1, 10]",
                  [](auto& set) {
                    set.numbers("x", "m", {0, 9}, 2, 2, {1, 2}, "t");
                  }),
            "x[1] must be in [0, 9] m, got 10 m" + end);
  EXPECT_EQ(error("[a]", [](auto& set) { set.text("x", "", "t"); }),
            "x must be a text, got a list" + end);
  const std::string longest(1000, 'y');
  EXPECT_LT(error(longest, [](auto& set) { set.flag("x", true, "t"); }).size(), 150U);
}

TEST(ParameterSet, TellsAllErrorsOneALine) {
  ParameterSet set({{"speed", "5 m", "f:1"}, {"max_beam", "3", "f:2"}, {"zebra", "3", "f:3"}},
                   "amcl.yaml");
  EXPECT_EQ(set.number("speed", "m/s", {0.1, 1}, 0.5, "t"), 0.5) << "the default stands in";
  EXPECT_EQ(set.number("width", "m", {0.1, 1}, "How wide it is."), 0.1) << "the low end stands in";
  set.integer("max_beams", "-", {1, 9}, 3, "t");
  EXPECT_EQ(set.finish().error(),
            "speed must be in one of the units m/s, got 5 m (f:1)\n"
            "width must be set to a number in [0.1, 1] m (amcl.yaml): How wide it is.\n"
            "unknown parameter max_beam (f:2); did you mean max_beams?\n"
            "unknown parameter zebra (f:3)");
  EXPECT_EQ(set.finish(false).error(),
            "speed must be in one of the units m/s, got 5 m (f:1)\n"
            "width must be set to a number in [0.1, 1] m (amcl.yaml): How wide it is.")
      << "not all was asked for";
}

TEST(ParameterSet, FindsBadDeclarations) {
  const auto error = [](auto&& declare) {
    ParameterSet set({}, "f");
    declare(set);
    const Status status = set.finish();
    return status.ok() ? std::string() : status.error();
  };
  const auto found = [&](auto&& declare, const std::string& text) {
    EXPECT_THAT(error(declare), HasSubstr("programming error: "));
    EXPECT_THAT(error(declare), HasSubstr(text));
  };
  found(
      [](auto& set) {
        set.number("x", "m", {0, 1}, 2, "t");
      },
      "x must be in [0, 1] m, got 2 m (the declared default)");
  found([](auto& set) { set.number("x", "mm", {0, 1}, 0, "t"); }, "\"mm\", which is not SI");
  found([](auto& set) { set.number("x", "m", {1, 0}, 0, "t"); }, "has the empty range [1, 0]");
  found([](auto& set) { set.number("x", "m", {0, 1}, 0, ""); }, "has no text");
  found([](auto& set) { set.choice("x", {"a"}, "b", "t"); }, "one of a, got \"b\"");
  found([](auto& set) { set.number("x", "m", {0, 1}, std::nan(""), "t"); }, "x must be a number");
  found(
      [](auto& set) {
        set.flag("x", true, "t");
        set.flag("x", true, "t");
      },
      "parameter x is declared twice");
}

TEST(ParameterSet, MakesPathsAbsoluteFromTheFileThatSetsThem) {
  ParameterSet set({{"map", "maps/office.yaml", "/robots/config/site.yaml:3"},
                    {"log", "/var/log/x", "config/site.yaml:4"},
                    {"near", "x.yaml", "config/site.yaml:5"}},
                   "f");
  EXPECT_EQ(set.file("map", "", "t"), "/robots/config/maps/office.yaml");
  EXPECT_EQ(set.file("log", "", "t"), "/var/log/x");
  EXPECT_EQ(set.file("near", "", "t"),
            (std::filesystem::current_path() / "config/x.yaml").string());
}

const std::vector<RecordField> kMount{{"name", ParameterKind::kText, "-", {}, "Which."},
                                      {"x", ParameterKind::kNumber, "m", {-1, 1}, "Where."},
                                      {"count", ParameterKind::kInteger, "-", {0, 9}, "How many."},
                                      {"on", ParameterKind::kFlag, "-", {}, "Whether."}};

TEST(ParameterSet, ReadsRecords) {
  auto set = given(
      "mounts",
      "[{name: left, x: 20 cm, count: 3, on: true}, {name: right, x: -0.2, count: 0, on: false}]");
  const auto records = set.records("mounts", kMount, "t");
  ASSERT_TRUE(set.finish().ok());
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].text("name"), "left");
  EXPECT_EQ(records[0].number("x"), 0.2);
  EXPECT_EQ(records[0].number("count"), 3.0);
  EXPECT_TRUE(records[0].flag("on"));
  EXPECT_FALSE(records[1].flag("on"));
  EXPECT_TRUE(ParameterSet({}, "f").records("mounts", kMount, "t").empty());
}

TEST(ParameterSet, NamesTheFieldOfABadRecord) {
  const auto error = [](const std::string& yaml) {
    auto set = given("mounts", yaml);
    set.records("mounts", kMount, "t");
    return set.finish().error();
  };
  const std::string end = " (" + kWhere + ")";
  EXPECT_EQ(error("[{name: a, x: 2 m, count: 1, on: true}]"),
            "mounts[0].x must be in [-1, 1] m, got 2 m" + end);
  EXPECT_EQ(error("[{name: a, count: 1, on: true}]"), "mounts[0].x must be set" + end);
  EXPECT_EQ(error("[{name: a, x: 0, y: 1, count: 1, on: true}]"),
            "unknown field \"y\" in mounts[0]" + end);
  EXPECT_EQ(error("[{name: a, name: b, x: 0, count: 1, on: true}]"),
            "field \"name\" of mounts[0] is given twice" + end);
  EXPECT_EQ(error("[5]"), "mounts[0] must be a mapping, got \"5\"" + end);
  EXPECT_EQ(error("5"), "mounts must be a list of mappings, got \"5\"" + end);
}

TEST(ParameterSet, DescribingAsksForNothing) {
  ParameterSet set({}, "f", ParameterSet::Missing::kIsFine);
  EXPECT_EQ(set.number("width", "m", {0.1, 1}, "How wide."), 0.1);
  EXPECT_EQ(set.number("offset", "m", {-1, 1}, "Where."), 0.0);
  ASSERT_TRUE(set.finish().ok());
  ASSERT_EQ(set.declared().size(), 2U);
  EXPECT_TRUE(set.declared()[0].required);
}

}  // namespace
}  // namespace usher::runtime
