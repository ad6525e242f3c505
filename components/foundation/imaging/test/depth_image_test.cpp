#include "foundation/imaging/depth_image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace usher::imaging {
namespace {

using testing::HasSubstr;

TEST(Widen, FollowsEquation49AndDropsInvalidValues) {
  const std::vector<std::uint8_t> image{0, 1, 2, 100, 254, 255};
  std::vector<std::uint16_t> depth(image.size());
  widen(image, 12.0, depth);
  EXPECT_THAT(depth, testing::ElementsAre(0, 0, 94, 4706, 11953, 0));
}

TEST(Intrinsics, ThatCannotBeAreNamed) {
  EXPECT_TRUE(check(Intrinsics{}).ok());
  Intrinsics camera;
  camera.width = 5000;
  EXPECT_THAT(check(camera).error(), HasSubstr("width"));
  camera = {};
  camera.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(check(camera).error(), HasSubstr("fx"));
  camera = {};
  camera.cy = -3.0;
  EXPECT_THAT(check(camera).error(), HasSubstr("cy"));
}

}  // namespace
}  // namespace usher::imaging
