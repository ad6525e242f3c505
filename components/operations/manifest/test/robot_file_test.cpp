#include "operations/manifest/robot_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/folder.hpp"

namespace usher::operations {
namespace {

using testing::HasSubstr;

constexpr const char* kFile = R"(# A robot.
wheel_radius: 0.2 m

kinect:               # on a servo
  model: v2
  mount_z: 0.665 m    # by ruler
  servo_offset: 0.0 rad

torso:
  servo_gain: 3.0     # another one
)";

TEST(RobotFile, KeepsCommentsAndEverythingElse) {
  const auto changed =
      with_values(kFile, "robot.yaml", "kinect", {{"mount_z", "0.6812 m"}, {"servo_gain", "1.05"}});
  ASSERT_TRUE(changed.ok()) << changed.error();
  EXPECT_EQ(*changed, R"(# A robot.
wheel_radius: 0.2 m

kinect:               # on a servo
  model: v2
  mount_z: 0.6812 m   # by ruler
  servo_offset: 0.0 rad
  servo_gain: 1.05

torso:
  servo_gain: 3.0     # another one
)");
}

TEST(RobotFile, ASectionThatIsNotThereIsAdded) {
  const auto changed = with_values("wheel_radius: 0.2 m\n", "robot.yaml", "kinect",
                                   {{"mount_z", "1.0 m"}, {"servo_gain", "1.05"}});
  ASSERT_TRUE(changed.ok()) << changed.error();
  EXPECT_EQ(*changed, "wheel_radius: 0.2 m\n\nkinect:\n  mount_z: 1.0 m\n  servo_gain: 1.05\n");
}

TEST(RobotFile, WhatCannotBeChangedStaysAsItWas) {
  const test::Folder folder;
  for (const char* text : {"kinect: {mount_z: 1 m}\n", "kinect: [\n"}) {
    const std::string path = folder.file("robot.yaml", text);
    const auto status = set_values(path, "kinect", {{"mount_z", "2 m"}});
    ASSERT_FALSE(status.ok());
    EXPECT_THAT(status.error(), HasSubstr("robot.yaml"));
    EXPECT_EQ(test::content_of(path), text);
  }
  EXPECT_FALSE(set_values(folder.path() + "/none.yaml", "kinect", {{"mount_z", "2 m"}}).ok());
}

}  // namespace
}  // namespace usher::operations
