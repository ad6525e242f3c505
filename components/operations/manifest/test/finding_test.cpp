#include "operations/manifest/finding.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

std::string told(const std::string& error) {
  return to_string(finding_of(Verdict::kUnreadable, error, "m.yaml"));
}

TEST(FindingOf, TakesThePlaceFromTheErrorsEnd) {
  EXPECT_EQ(told("not valid YAML (base.yaml:7)"), "base.yaml:7: unreadable: not valid YAML");
  EXPECT_EQ(told("got (a, b) (base.yaml:7)"), "base.yaml:7: unreadable: got (a, b)");
  EXPECT_EQ(told("it is a directory (deploy (old)/m.yaml)"),
            "deploy (old)/m.yaml: unreadable: it is a directory");
}

TEST(FindingOf, KeepsTheOriginWhereTheErrorNamesNoPlace) {
  EXPECT_EQ(told("no contract"), "m.yaml: unreadable: no contract");
  EXPECT_EQ(told("f(x)"), "m.yaml: unreadable: f(x)");
  EXPECT_EQ(told(")"), "m.yaml: unreadable: )");
  EXPECT_EQ(told(""), "m.yaml: unreadable: ");
}

}  // namespace
}  // namespace usher::operations
