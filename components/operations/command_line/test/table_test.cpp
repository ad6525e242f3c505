#include "operations/command_line/table.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace usher::operations {
namespace {

TEST(Table, HasADashWhereThereIsNoFigure) {
  EXPECT_EQ(figure("%.2f", 1.5), "1.50");
  EXPECT_EQ(figure("%.2f", std::numeric_limits<double>::quiet_NaN()), "-");
  EXPECT_EQ(figure("%.2f", -std::numeric_limits<double>::quiet_NaN()), "-");
  EXPECT_EQ(figure("%.2f", std::numeric_limits<double>::infinity()), "-");
  Table table({"object", "seen from m"});
  table.add({"bin", figure("%.2f", 1.5)});
  table.add({"bar", figure("%.2f", std::numeric_limits<double>::quiet_NaN())});
  EXPECT_EQ(table.text(), "object  seen from m\nbin            1.50\nbar               -\n");
}

}  // namespace
}  // namespace usher::operations
