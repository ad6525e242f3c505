// Every parameter of every component says what it is, in which unit, between which bounds, and has
// a default that the same judge would take from a file. Every shipped manifest resolves.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "runtime/parameters/interpret.hpp"
#include "support/process.hpp"

namespace usher::contract {
namespace {

namespace fs = std::filesystem;
using runtime::Contract;
using runtime::ParameterKind;

std::vector<Contract> contracts() {
  std::vector<Contract> all;
  for (const auto& entry :
       fs::directory_iterator(std::string(USHER_BINARY_DIR) + "/share/usher/contracts")) {
    auto contract =
        runtime::contract_from_yaml(test::content_of(entry.path()), entry.path().string());
    EXPECT_TRUE(contract) << contract.error();
    if (contract) all.push_back(std::move(contract).value());
  }
  return all;
}

bool is_numeric(ParameterKind kind) {
  return kind == ParameterKind::kNumber || kind == ParameterKind::kInteger ||
         kind == ParameterKind::kNumbers;
}

/// What is wrong with how it is declared; empty when nothing is.
std::string fault(const Contract::Parameter& parameter) {
  if (parameter.name.empty()) return "it has no name";
  if (parameter.text.size() < 8 || parameter.text.back() != '.')
    return "its text is no sentence: '" + parameter.text + "'";
  if (is_numeric(parameter.kind)) {
    if (parameter.unit.empty()) return "it has no unit (\"-\" where there is none)";
    if (!std::isfinite(parameter.range.low) || !std::isfinite(parameter.range.high) ||
        !(parameter.range.low < parameter.range.high))
      return "its range is no interval";
  }
  if (parameter.kind == ParameterKind::kChoice && parameter.options.size() < 2)
    return "there is nothing to choose from";
  for (const auto& field : parameter.fields) {
    const bool number = is_numeric(field.kind);
    if (field.text.empty()) return "its column " + field.name + " has no text";
    if (number && field.unit.empty()) return "its column " + field.name + " has no unit";
    if (number && !(field.range.low < field.range.high))
      return "the range of its column " + field.name + " is no interval";
  }
  const bool list =
      parameter.kind == ParameterKind::kNumbers || parameter.kind == ParameterKind::kRecords;
  if (parameter.required || (list && parameter.fallback.empty())) return {};  // no default
  const auto judged =
      runtime::interpret(parameter, {parameter.name, parameter.fallback, "its default"});
  return judged ? "" : judged.error();
}

TEST(ContractParameters, HaveUnitRangeTextAndADefaultThatLiesInTheRange) {
  std::size_t seen = 0;
  for (const Contract& contract : contracts()) {
    std::set<std::string> names;
    for (const auto& parameter : contract.parameters) {
      ++seen;
      EXPECT_EQ(fault(parameter), "") << contract.component << "." << parameter.name;
      EXPECT_TRUE(names.insert(parameter.name).second)
          << contract.component << "." << parameter.name << " is declared twice";
    }
  }
  EXPECT_GT(seen, 200U) << "the contracts were not found";
}

// The robot's and the site's facts are read by several components: with one unit and one kind.
TEST(ContractParameters, OfTheRobotAndTheSiteMeanTheSameToEverybody) {
  std::map<std::string, Contract::Parameter> first;
  for (const Contract& contract : contracts()) {
    for (const auto& parameter : contract.parameters) {
      if (!parameter.name.starts_with("robot.") && !parameter.name.starts_with("site.")) continue;
      const auto [entry, is_new] = first.try_emplace(parameter.name, parameter);
      EXPECT_EQ(entry->second.unit, parameter.unit) << contract.component << "." << parameter.name;
      EXPECT_EQ(entry->second.kind, parameter.kind) << contract.component << "." << parameter.name;
    }
  }
}

TEST(ContractParameters, TheRuleFindsWhatItForbids) {
  Contract::Parameter good{.name = "reach",
                           .unit = "m",
                           .fallback = "0.5",
                           .text = "How far it reaches.",
                           .range = {0.1, 2.0}};
  EXPECT_EQ(fault(good), "");
  const auto broken = [&](auto change) {
    auto parameter = good;
    change(parameter);
    return fault(parameter);
  };
  EXPECT_NE(broken([](auto& p) { p.fallback = "3"; }), "");
  EXPECT_NE(broken([](auto& p) { p.fallback = "0.5 kg"; }), "");
  EXPECT_NE(broken([](auto& p) { p.unit.clear(); }), "");
  EXPECT_NE(broken([](auto& p) { p.text = "reach"; }), "");
  EXPECT_NE(broken([](auto& p) { p.range = {2.0, 0.1}; }), "");
  EXPECT_NE(broken([](auto& p) { p.range.high = HUGE_VAL; }), "");
}

TEST(ShippedConfigs, Resolve) {
  int manifests = 0;
  for (const auto& entry : fs::directory_iterator(std::string(USHER_SOURCE_DIR) + "/deploy")) {
    if (entry.path().extension() != ".yaml") continue;
    // One process for each: it asks every component's program, and a slow machine has 30 s for one.
    test::Process check({std::string(USHER_BINARY_DIR) + "/bin/usher", "check", entry.path()});
    EXPECT_EQ(check.wait(), 0) << entry.path() << check.output() << check.errors();
    ++manifests;
  }
  EXPECT_GT(manifests, 3);
}

}  // namespace
}  // namespace usher::contract
