#include "wire/images.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace usher::wire {
namespace {

using testing::HasSubstr;

sensor_msgs::msg::Image message_of(const std::vector<std::uint16_t>& values, int width) {
  sensor_msgs::msg::Image message;
  to_message(runtime::Time(std::chrono::seconds(3)), "camera",
             imaging::DepthImage{width, static_cast<int>(values.size()) / width, values}, message);
  return message;
}

TEST(DepthImageMessage, ComesBackAsItWas) {
  const std::vector<std::uint16_t> values{1, 2, 300, 4000, 50000, 65535};
  const auto message = message_of(values, 3);
  EXPECT_EQ(message.encoding(), "16UC1");
  EXPECT_EQ(message.step(), 6U);
  std::vector<std::uint16_t> read;
  const auto image = depth_image(message, 12.0, read);
  ASSERT_TRUE(image.ok()) << image.error();
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(read, values);
}

TEST(DepthImageMessage, OfEightBitsIsThatOfTheThesis) {
  auto message = message_of({0, 0}, 2);
  message.encoding("8UC1");
  message.step(2);
  message.height(2);
  message.data() = {0, 100, 255, 2};
  std::vector<std::uint16_t> read;
  ASSERT_TRUE(depth_image(message, 12.0, read).ok());
  EXPECT_THAT(read, testing::ElementsAre(0, 4706, 0, 94));
}

TEST(ColorImageMessage, IsReadInEachOrderOfItsColors) {
  const std::vector<std::uint8_t> values{1, 2, 3, 4, 5, 6};
  sensor_msgs::msg::Image message;
  to_color_message(runtime::Time(std::chrono::seconds(3)), "camera", 2, values, message);
  std::vector<std::uint8_t> copy;
  const auto image = color_image(message, copy);
  ASSERT_TRUE(image.ok()) << image.error();
  EXPECT_EQ(image->width, 2);
  EXPECT_EQ(image->height, 1);
  EXPECT_THAT(image->rgb, testing::ElementsAreArray(values));
  message.encoding("bgr8");
  EXPECT_THAT(color_image(message, copy)->rgb, testing::ElementsAre(3, 2, 1, 6, 5, 4));
  message.encoding("mono8");
  message.step(2);
  message.data() = {7, 8};
  EXPECT_THAT(color_image(message, copy)->rgb, testing::ElementsAre(7, 7, 7, 8, 8, 8));
}

TEST(ColorImageMessage, IsRefusedWhenItsBytesDoNotFit) {
  const std::vector<std::uint8_t> values{1, 2, 3, 4, 5, 6};
  std::vector<std::uint8_t> copy;
  sensor_msgs::msg::Image good;
  to_color_message(runtime::Time(std::chrono::seconds(3)), "camera", 2, values, good);
  auto message = good;
  message.data().pop_back();
  EXPECT_THAT(color_image(message, copy).error(), HasSubstr("carries 5"));
  message = good;
  message.encoding("yuv422");
  EXPECT_THAT(color_image(message, copy).error(), HasSubstr("yuv422"));
  message = good;
  message.width(0x80000000U);
  EXPECT_FALSE(color_image(message, copy).ok());
  EXPECT_FALSE(color_image({}, copy).ok());
}

TEST(DepthImageMessage, IsRefusedWhenItsBytesDoNotFit) {
  std::vector<std::uint16_t> read;
  auto message = message_of({1, 2, 3, 4}, 2);
  message.data().pop_back();
  EXPECT_THAT(depth_image(message, 12.0, read).error(), HasSubstr("carries 7"));
  message = message_of({1, 2, 3, 4}, 2);
  message.encoding("32FC1");
  EXPECT_THAT(depth_image(message, 12.0, read).error(), HasSubstr("32FC1"));
  message = message_of({1, 2, 3, 4}, 2);
  message.is_bigendian(1);
  EXPECT_FALSE(depth_image(message, 12.0, read).ok());
  message = message_of({1, 2, 3, 4}, 2);
  message.width(0x80000000U);
  message.step(0);
  EXPECT_FALSE(depth_image(message, 12.0, read).ok());
  EXPECT_FALSE(depth_image({}, 12.0, read).ok());
}

TEST(CameraInfoMessage, ComesBackAndIsRefusedWhenItCannotBe) {
  const imaging::Intrinsics camera{640, 480, 525.0, 526.0, 319.5, 239.5};
  auto message = to_message({}, "camera", camera);
  ASSERT_TRUE(from_message(message).ok());
  EXPECT_EQ(*from_message(message), camera);
  message.d()[0] = 0.1;
  EXPECT_THAT(from_message(message).error(), HasSubstr("rectified"));
  message.d()[0] = 0.0;
  message.k()[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(from_message(message).error(), HasSubstr("fx"));
  message.width(1U << 31U);
  EXPECT_FALSE(from_message(message).ok());
}

/// As ROS drivers write it beside image_rect: D and K of the lens, P of the image.
TEST(CameraInfoMessage, OfARectifiedImageIsReadFromP) {
  const imaging::Intrinsics lens{512, 424, 365.0, 366.0, 255.5, 211.5};
  const imaging::Intrinsics rectified{512, 424, 351.0, 352.0, 257.0, 209.0};
  auto message = to_message({}, "camera", lens);
  message.d({0.09, -0.27, 0.0, 0.0, 0.09});
  message.p(to_message({}, "camera", rectified).p());
  ASSERT_TRUE(from_message(message).ok()) << from_message(message).error();
  EXPECT_EQ(*from_message(message), rectified);
}

TEST(CameraInfoMessage, OfADistortedImageIsRefused) {
  const imaging::Intrinsics lens{512, 424, 365.0, 366.0, 255.5, 211.5};
  auto message = to_message({}, "camera", lens);
  message.d({0.09, -0.27, 0.0, 0.0, 0.09});
  const auto* const reason =
      "the depth image must be rectified: its camera_info has a distortion that is not zero and no "
      "P of a rectified image";
  EXPECT_EQ(from_message(message).error(), reason) << "P is K";
  message.p({});
  EXPECT_EQ(from_message(message).error(), reason) << "no P";
  message.p()[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(from_message(message).error(), reason) << "no P";
}

}  // namespace
}  // namespace usher::wire
