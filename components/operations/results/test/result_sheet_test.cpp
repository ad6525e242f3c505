#include "operations/results/result_sheet.hpp"

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>

#include "support/folder.hpp"

namespace usher::operations {
namespace {

ResultSheet sheet() {
  ResultSheet made;
  made.name = "demo";
  made.input = "a \"b\"\n\\";
  made.metrics = {{"time_s", 1.5}, {"contacts", 0.0}};
  made.flags = {{"reached", true}};
  made.published = {{"time_s", 2.0}};
  made.targets = {{"contacts", {Bound::kAtMost, 0.0}}, {"time_s", {Bound::kAtLeast, 1.0}}};
  return made;
}

TEST(ResultSheet, PassesWhenEveryTargetAndFlagHolds) {
  EXPECT_TRUE(sheet().pass());
  auto failed = sheet();
  failed.flags["reached"] = false;
  EXPECT_FALSE(failed.pass());
  failed = sheet();
  failed.metrics["contacts"] = 1.0;
  EXPECT_FALSE(failed.pass());
  failed = sheet();
  failed.metrics["time_s"] = 0.99;
  EXPECT_FALSE(failed.pass());
}

TEST(ResultSheet, FailsWhereAFigureIsAbsentOrNotANumber) {
  auto failed = sheet();
  failed.metrics.erase("contacts");
  EXPECT_FALSE(failed.pass());
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    failed = sheet();
    failed.metrics["contacts"] = bad;
    EXPECT_FALSE(failed.pass());
  }
}

TEST(ResultSheet, IsOneObjectOfNumbers) {
  auto made = sheet();
  made.metrics["tenth"] = 0.1;
  made.metrics["third"] = 1.0 / 3.0;
  made.metrics["off"] = std::nan("");
  const auto json = YAML::Load(made.json());  // JSON is YAML
  EXPECT_EQ(json["name"].as<std::string>(), "demo");
  EXPECT_EQ(json["input"].as<std::string>(), "a \"b\"\n\\");
  EXPECT_EQ(json["metrics"]["third"].as<double>(), 1.0 / 3.0) << "no digit is lost";
  EXPECT_EQ(json["metrics"]["tenth"].Scalar(), "0.1") << "and none is added";
  EXPECT_TRUE(json["metrics"]["off"].IsNull());
  EXPECT_TRUE(json["metrics"]["reached"].as<bool>());
  EXPECT_EQ(json["published"]["time_s"].as<double>(), 2.0);
  EXPECT_EQ(json["targets"]["time_s"].as<double>(), 1.0);
  EXPECT_TRUE(json["pass"].as<bool>());
  EXPECT_EQ(YAML::Load(ResultSheet{}.json())["metrics"].size(), 0U);
}

TEST(ResultSheet, MarksMissedTargetsInTheTable) {
  auto made = sheet();
  made.metrics["contacts"] = 2.0;
  const auto table = made.markdown();
  EXPECT_THAT(table, testing::ContainsRegex("contacts +\\| +2 +\\| at most 0 \\(missed\\)"));
  EXPECT_THAT(table, testing::ContainsRegex("time_s +\\| +1.5 +\\| at least 1 +\\| +2"));
  EXPECT_THAT(table, testing::ContainsRegex("reached +\\| +yes"));
}

TEST(WriteFile, SaysWhatItCannotWrite) {
  const test::Folder folder;
  ASSERT_TRUE(write_file(folder.path() + "/a", "x\n"));
  ASSERT_TRUE(write_file(folder.path() + "/a", "y\n"));
  EXPECT_EQ(test::content_of(folder.path() + "/a"), "y\n");
  const auto failed = write_file(folder.path() + "/none/a", "x");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error(), "cannot write " + folder.path() + "/none/a");
}

}  // namespace
}  // namespace usher::operations
