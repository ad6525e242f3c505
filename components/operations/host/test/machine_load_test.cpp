#include "operations/host/machine_load.hpp"

#include <gmock/gmock.h>

namespace usher::operations {
namespace {

using testing::HasSubstr;

TEST(MachineLoad, SaysNothingOnAMachineThatIsFree) {
  MachineLoad load(2);
  EXPECT_EQ(load.verdict(), "");
  for (int i = 0; i < 10; ++i) load.sample(3.0);
  load.stopped("amcl: silent");
  EXPECT_FALSE(load.too_busy());
  EXPECT_EQ(load.verdict(), "") << "then it is not the machine";
}

TEST(MachineLoad, NamesTheLoadAndWhatItDid) {
  MachineLoad load(2);
  for (int i = 0; i < 10; ++i) load.sample(i % 2 == 0 ? 18.0 : 28.0);
  EXPECT_TRUE(load.too_busy());
  EXPECT_THAT(load.verdict(),
              HasSubstr("too busy for the demo: 23 tasks for 2 cores; run it again"));
  load.stopped("amcl: silent for 0.13 s");
  load.stopped("costmap: silent for 0.2 s");
  EXPECT_THAT(load.verdict(), HasSubstr("stopped 2 times, last by: costmap: silent for 0.2 s"));
}

TEST(MachineLoad, ReadsThisMachine) {
  MachineLoad load;
  load.sample();
  EXPECT_GE(load.mean(), 0.0);
  EXPECT_LT(load.mean(), 10000.0);
}

}  // namespace
}  // namespace usher::operations
