#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/bench.hpp"

namespace usher::bench {
namespace {

struct Output {
  int exit_code = 0;
  std::string text;
};

Output run(Bench& bench, std::vector<std::string> options) {
  options.insert(options.begin(), {"bench", "--benchmark_filter=."});  // it outlives a run
  options.emplace_back("--benchmark_min_time=0.001");
  std::vector<char*> arguments;
  for (std::string& option : options) arguments.push_back(option.data());
  testing::internal::CaptureStdout();
  Output output;
  output.exit_code = bench.run(static_cast<int>(arguments.size()), arguments.data());
  output.text = testing::internal::GetCapturedStdout();
  return output;
}

TEST(Bench, PrintsOneJsonObjectWithNumbersAsMeasured) {
  Bench bench("shape", "an \"input\"\nof two lines");
  bench.time("work_us", 1e-6, [] {});
  bench.metric("third", [] { return 1.0 / 3.0; });
  bench.published("third", 0.5, "a peer");
  bench.target("third", Bound::kAtMost, 0.4);
  bench.target("counted_instructions", Bound::kAtMost, 1);  // not measured: does not count
  const Output output = run(bench, {"--json"});
  EXPECT_EQ(output.exit_code, 0);

  const YAML::Node json = YAML::Load(output.text);  // JSON is YAML
  ASSERT_EQ(json.size(), 6U);
  EXPECT_EQ(json["name"].as<std::string>(), "shape");
  EXPECT_EQ(json["input"].as<std::string>(), "an \"input\"\nof two lines");
  EXPECT_EQ(json["metrics"]["third"].as<double>(), 1.0 / 3.0);
  EXPECT_GT(json["metrics"]["reference_loop_ms"].as<double>(), 0.0);
  EXPECT_GE(json["metrics"]["work_us"].as<double>(), 0.0);
  EXPECT_EQ(json["published"]["third (a peer)"].as<double>(), 0.5);
  EXPECT_EQ(json["targets"]["third"].as<double>(), 0.4);
  EXPECT_TRUE(json["pass"].as<bool>());
}

TEST(Bench, AFilterLeavesOutWhatIsComputedFromTheOthersToo) {
  Bench bench("filtered", "none");
  bench.time("one_us", 1e-6, [] {});
  bench.time("other_us", 1e-6, [] {});
  bench.metric("twice_one", [&] { return 2.0 * bench.metrics().at("one_us"); });
  bench.metric("twice_other", [&] { return 2.0 * bench.metrics().at("other_us"); });
  const Output output = run(bench, {"--json", "--benchmark_filter=one"});
  const YAML::Node metrics = YAML::Load(output.text)["metrics"];
  EXPECT_TRUE(metrics["twice_one"]);
  EXPECT_FALSE(metrics["twice_other"]);
}

TEST(Bench, FailsWhenATargetIsMissed) {
  Bench bench("missed", "none");
  bench.metric("speed", [] { return 1.0; });
  bench.target("speed", Bound::kAtLeast, 2.0);
  const Output output = run(bench, {"--json"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_FALSE(YAML::Load(output.text)["pass"].as<bool>());
}

TEST(Bench, JudgesTimesByTheRatioOnASlowMachineOnly) {
  Bench bench("slow", "none");
  const auto ratio = [&] { return std::max(1.0, bench.metrics().at("machine_ratio")); };
  bench.metric("in_time_ms", [&] { return 2.0 * ratio(); });
  bench.metric("late_ms", [&] { return 2.01 * ratio(); });
  bench.metric("exact", [&] { return 2.0; });
  bench.target("in_time_ms", Bound::kAtMost, 2.0);
  bench.target("exact", Bound::kAtMost, 2.0);
  EXPECT_EQ(run(bench, {"--json"}).exit_code, 0);
  bench.target("late_ms", Bound::kAtMost, 2.0);
  EXPECT_EQ(run(bench, {"--json"}).exit_code, 1);
}

TEST(Bench, PrintsNullForWhatIsNotANumberAndMissesItsTarget) {
  Bench bench("nan", "none");
  bench.metric("speed", [] { return std::numeric_limits<double>::quiet_NaN(); });
  bench.target("speed", Bound::kAtMost, 2.0);
  const Output output = run(bench, {"--json"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_TRUE(YAML::Load(output.text)["metrics"]["speed"].IsNull());
}

TEST(Bench, ComputedFiguresMayReadTheTimings) {
  Bench bench("ratio", "none");
  bench.time("work_ms", 1e-3, [] {});
  bench.metric("ratio", [&] {
    return bench.metrics().at("work_ms") / bench.metrics().at("reference_loop_ms");
  });
  run(bench, {"--json"});
  EXPECT_LT(bench.metrics().at("ratio"), 1.0);
}

TEST(Bench, RefusesAnUnknownOption) {
  Bench bench("options", "none");
  EXPECT_EQ(run(bench, {"--jsn"}).exit_code, 2);
}

TEST(Bench, SaysThatInputDataIsAbsent) {
  Bench bench("data", "none");
  EXPECT_EQ(bench.data("no/such/file"), "");
  EXPECT_EQ(run(bench, {}).exit_code, 4);
}

TEST(Bench, ExplainsItself) {
  Bench bench("help", "none");
  const Output output = run(bench, {"--help"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_THAT(output.text, testing::HasSubstr("--instructions"));
}

}  // namespace
}  // namespace usher::bench
