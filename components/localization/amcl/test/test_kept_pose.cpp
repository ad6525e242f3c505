#include <gtest/gtest.h>

#include "foundation/grid/fingerprint.hpp"
#include "localization/amcl/core/kept_pose.hpp"

namespace usher::amcl {
namespace {

TEST(KeptPose, ReadsBackWhatItWrites) {
  const KeptPose kept{0xfedcba9876543210ULL, {1.0 / 3.0, -2.5, 3.1}, {0.1, 1e-17, -0.7}};
  const auto read = read_kept_pose(to_text(kept), kept.map);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->map_T_base.x, kept.map_T_base.x);
  EXPECT_EQ(read->map_T_base.yaw, kept.map_T_base.yaw);
  EXPECT_EQ(read->odom_T_base.y, kept.odom_T_base.y);
}

TEST(KeptPose, OfAnotherMapIsRefused) {
  const auto read = read_kept_pose(to_text({7, {1, 2, 3}, {1, 2, 3}}), 8);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(), "the kept pose was refused: it was kept on another map");
}

TEST(KeptPose, ThatIsNoneIsRefused) {
  for (const char* text : {"", "1 2 3 4 5 6", "pose-on-map", "pose-on-map 7 1 2 3 4 5",
                           "pose-on-map 7 1 2 3 4 5 nan", "pose-on-map 7 1 2 x 4 5 6"}) {
    EXPECT_FALSE(read_kept_pose(text, 7)) << text;
  }
}

TEST(Fingerprint, TellsMapsApart) {
  grid::OccupancyGrid map({40, 30, 0.05, -1.0, 0.0}, grid::kFree);
  const std::uint64_t one = grid::fingerprint(map);
  EXPECT_EQ(grid::fingerprint(map), one);
  map.at({7, 5}) = grid::kOccupied;
  EXPECT_NE(grid::fingerprint(map), one);
  map.at({7, 5}) = grid::kFree;
  EXPECT_EQ(grid::fingerprint(map), one);
  map.set_origin(-1.0, 0.05);
  EXPECT_NE(grid::fingerprint(map), one) << "the same rooms elsewhere";
  EXPECT_NE(grid::fingerprint(grid::OccupancyGrid({30, 40, 0.05, -1.0, 0.0}, grid::kFree)), one);
}

}  // namespace
}  // namespace usher::amcl
