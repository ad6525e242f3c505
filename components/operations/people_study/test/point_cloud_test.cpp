#include "operations/people_study/point_cloud.hpp"

#include <gtest/gtest.h>

#include <string>

#include "foundation/random/random.hpp"

namespace usher::people_study {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// One row of two points; their 32 bytes as one literal run.
Bytes small_cloud() {
  std::string text =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgba\nWIDTH 2\nHEIGHT 1\nDATA binary_compressed\n";
  const float values[8] = {0.0F, 0.0F, 0.0F, 0.0F, 1.25F, -1.0F, 0.0F, 0.0F};
  text += std::string("\x21\0\0\0\x20\0\0\0\x1f", 9);
  text += std::string(reinterpret_cast<const char*>(values), sizeof values);
  return {text.begin(), text.end()};
}

TEST(PointCloud, HasTheDepthOfItsPoints) {
  const auto cloud = parse_point_cloud(small_cloud());
  ASSERT_TRUE(cloud) << cloud.error();
  EXPECT_EQ(cloud->millimeters, (std::vector<std::uint16_t>{1250, 0}));
}

TEST(PointCloud, ThatIsNoneIsRefused) {
  EXPECT_FALSE(parse_point_cloud({}));
  Bytes bytes = small_cloud();
  bytes.resize(bytes.size() - 1);
  EXPECT_FALSE(parse_point_cloud(bytes));
  EXPECT_NE(read_point_cloud("/nowhere.pcd").error().find("cannot read"), std::string::npos);
}

TEST(PointCloud, SurvivesAnyBytes) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes = small_cloud();
    for (int k = 0; k < 4; ++k)
      bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.next());
    bytes.resize(random.below(bytes.size() + 1));
    (void)parse_point_cloud(bytes);
  }
}

}  // namespace
}  // namespace usher::people_study
