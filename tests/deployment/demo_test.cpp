// The README's demo of the meeting assistant, as a visitor of the project types it: real processes,
// in real time.
#include <gmock/gmock.h>

#include "deployment/running_robot.hpp"

namespace usher::test {
namespace {

using testing::HasSubstr;

TEST(Demo, OfTheMeetingBringsTwoPeople) {
  const Folder folder;
  // A machine that was busy meanwhile may have fallen behind: such a run does not count.
  for (int attempt = 0; attempt < 3; ++attempt) {
    Process demo({usher_program(), "demo", "meeting", "--out", folder.path()});
    const int code = demo.wait(std::chrono::minutes(6));
    const std::string output = demo.output();
    if (code != 0 && output.find("| kept_pace                 | no") != std::string::npos) continue;
    EXPECT_EQ(code, 0) << output << demo.errors();
    EXPECT_THAT(output, HasSubstr("2 of 2 there"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() + "/run.png"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() + "/result.json"));
    return;
  }
  FAIL() << "the simulation fell behind three times";
}

}  // namespace
}  // namespace usher::test
