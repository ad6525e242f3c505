#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

#include "drivers/kinect/core/camera_model.hpp"
#include "drivers/kinect/core/recording.hpp"
#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::kinect {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::vector<std::uint8_t> pgm(const std::string& header, const std::vector<int>& bytes) {
  std::vector<std::uint8_t> all(header.begin(), header.end());
  for (const int byte : bytes) all.push_back(static_cast<std::uint8_t>(byte));
  return all;
}

TEST(Pgm, IsReadInBothByteOrders) {
  const auto bytes = pgm("P5\n# a comment\n2 1\n65535\n", {0x01, 0x02, 0xff, 0x00});
  const auto big = parse_pgm(bytes, false);
  ASSERT_TRUE(big.ok()) << big.error();
  EXPECT_EQ(big->width, 2);
  EXPECT_EQ(big->height, 1);
  EXPECT_THAT(big->millimeters, testing::ElementsAre(0x0102, 0xff00));
  EXPECT_THAT(parse_pgm(bytes, true)->millimeters, testing::ElementsAre(0x0201, 0x00ff));
}

TEST(Pgm, ThatIsNoneIsRefusedWithTheReason) {
  EXPECT_THAT(parse_pgm({}, false).error(), HasSubstr("P5"));
  EXPECT_THAT(parse_pgm(pgm("P5\n2", {}), false).error(), HasSubstr("header"));
  EXPECT_THAT(parse_pgm(pgm("P5\n2 2\n65535\n", {1, 2, 3}), false).error(),
              HasSubstr("ends early"));
  EXPECT_THAT(parse_pgm(pgm("P5\n2 2\n255\n", {1, 2, 3, 4}), false).error(), HasSubstr("16 bits"));
  EXPECT_FALSE(parse_pgm(pgm("P5\n99999 99999\n65535\n", {}), false).ok());
  EXPECT_FALSE(parse_pgm(pgm("P5\n999999999999 1\n65535\n", {}), false).ok());
  EXPECT_FALSE(parse_pgm(pgm("P5\n0 1\n65535\n", {}), false).ok());
}

TEST(Ppm, IsReadOrRefusedWithTheReason) {
  const auto color = parse_ppm(pgm("P6 2 1 255\n", {1, 2, 3, 4, 5, 6}));
  ASSERT_TRUE(color.ok()) << color.error();
  EXPECT_EQ(color->width, 2);
  EXPECT_EQ(color->height, 1);
  EXPECT_THAT(color->rgb, testing::ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(parse_ppm({}).error(), HasSubstr("P6"));
  EXPECT_THAT(parse_ppm(pgm("P6 2", {})).error(), HasSubstr("header"));
  EXPECT_THAT(parse_ppm(pgm("P6 2 1 255\n", {1, 2, 3, 4, 5})).error(), HasSubstr("ends early"));
  EXPECT_THAT(parse_ppm(pgm("P6 2 1 65535\n", {1, 2, 3, 4, 5, 6})).error(), HasSubstr("8 bits"));
  EXPECT_FALSE(parse_ppm(pgm("P6 99999 99999 255\n", {})).ok());
}

TEST(Pgm, SurvivesAnyBytes) {
  Random random(3);
  for (int round = 0; round < 5000; ++round) {
    auto bytes = pgm("P5\n4 2\n65535\n", std::vector<int>(16, 7));
    for (int i = 0; i < 3; ++i)
      bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.next());
    bytes.resize(random.below(bytes.size() + 1));
    const auto frame = parse_pgm(bytes, false);
    if (!frame) continue;
    EXPECT_LE(2 * frame->millimeters.size(), bytes.size());
  }
}

TEST(KinectV1, RawValuesBecomeTheLibrarysMillimetres) {
  EXPECT_NEAR(millimeters_of_raw(600), 705, 1);
  EXPECT_NEAR(millimeters_of_raw(800), 1193, 1);
  EXPECT_NEAR(millimeters_of_raw(1000), 3864, 2);
  EXPECT_EQ(millimeters_of_raw(2047), 0);
  EXPECT_EQ(millimeters_of_raw(1090), 0);  // beyond what it can see
  EXPECT_EQ(millimeters_of_raw(65535), 0);
}

TEST(Rectifier, StraightensWhatTheLensBends) {
  const imaging::Intrinsics camera = kinect_v2();
  const Rectifier rectifier = Rectifier::make(camera, kKinectV2Distortion, false).value();
  // Every pixel says its own column; the rectified image says where it came from.
  Frame raw{512, 424, std::vector<std::uint16_t>(std::size_t{512} * 424)}, straight;
  for (std::size_t i = 0; i < raw.millimeters.size(); ++i)
    raw.millimeters[i] = static_cast<std::uint16_t>(1 + i % 512);
  ASSERT_TRUE(rectifier.rectify(raw, straight).ok());
  for (const int column : {40, 255, 470}) {
    const double x = (column - camera.cx) / camera.fx, r2 = x * x;
    const double bent = x * (1 + r2 * (0.0905 + r2 * (-0.2682 + r2 * 0.0951)));
    const int row = 205;
    EXPECT_NEAR(straight.millimeters[static_cast<std::size_t>(row * 512 + column)] - 1,
                bent * camera.fx + camera.cx, 0.6);
  }
}

TEST(Rectifier, MirrorsAndLeavesAloneWithoutDistortion) {
  imaging::Intrinsics camera{16, 16, 16, 16, 7.5, 7.5};
  Frame raw{16, 16, std::vector<std::uint16_t>(256)}, out;
  std::iota(raw.millimeters.begin(), raw.millimeters.end(), std::uint16_t{1});
  ASSERT_TRUE(Rectifier::make(camera, {}, false).value().rectify(raw, out).ok());
  EXPECT_EQ(out.millimeters, raw.millimeters);
  ASSERT_TRUE(Rectifier::make(camera, {}, true).value().rectify(raw, out).ok());
  EXPECT_EQ(out.millimeters[0], 16);
  EXPECT_EQ(out.millimeters[15], 1);
}

TEST(Rectifier, MovesColorsWithTheDepthsOfTheirPixels) {
  const imaging::Intrinsics camera{16, 16, 16, 16, 7.5, 7.5};
  Frame depths{16, 16, std::vector<std::uint16_t>(256)}, depths_out;
  ColorFrame colors{16, 16, std::vector<std::uint8_t>(768)}, colors_out;
  for (std::size_t i = 0; i < 256; ++i) {
    depths.millimeters[i] = static_cast<std::uint16_t>(i);
    colors.rgb[3 * i] = colors.rgb[3 * i + 2] = static_cast<std::uint8_t>(i);
  }
  for (const bool mirrored : {false, true}) {
    const auto rectifier = Rectifier::make(camera, {0.3, 0, 0, 0, 0}, mirrored).value();
    ASSERT_TRUE(rectifier.rectify(depths, depths_out).ok());
    ASSERT_TRUE(rectifier.rectify(colors, colors_out).ok());
    for (std::size_t i = 0; i < 256; ++i) {
      EXPECT_EQ(colors_out.rgb[3 * i], depths_out.millimeters[i]);
      EXPECT_EQ(colors_out.rgb[3 * i + 1], 0);
      EXPECT_EQ(colors_out.rgb[3 * i + 2], depths_out.millimeters[i]);
    }
    EXPECT_NE(depths_out.millimeters, depths.millimeters);
  }
}

TEST(Rectifier, RefusesWhatCannotBe) {
  Distortion distortion{};
  distortion[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Rectifier::make(kinect_v2(), distortion, false).error(), HasSubstr("distortion"));
  Frame out;
  const Rectifier rectifier = Rectifier::make(kinect_v2(), {}, false).value();
  EXPECT_THAT(rectifier.rectify({640, 480, {}}, out).error(), HasSubstr("512 x 424"));
  ColorFrame colors;
  EXPECT_THAT(rectifier.rectify({1920, 1080, {}}, colors).error(), HasSubstr("1920 x 1080"));
}

TEST(Recording, PlaysAFolderInOrderAndByItsIndex) {
  const fs::path folder = fs::temp_directory_path() / "usher_kinect_recording_test";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto write = [&](const std::string& name, int value) {
    const auto bytes = pgm("P5\n1 1\n65535\n", {value, 0});
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  };
  EXPECT_THAT(Recording::open(folder, Values::kMillimeters).error(), HasSubstr("no depth images"));
  write("d-10.50-7.pgm", 3);
  write("d-10.00-5.pgm", 2);
  auto plain = Recording::open(folder, Values::kMillimeters).value();
  ASSERT_EQ(plain.size(), 2U);
  EXPECT_EQ(plain.read(0)->millimeters[0], 0x0200);  // big-endian, by name
  EXPECT_NEAR(plain.time(1), 1.0 / 30.0, 1e-9);
  std::ofstream(folder / "INDEX.txt") << "a-10.00-1.dump\nd-10.00-5.pgm\nd-10.50-7.pgm\n";
  auto indexed = Recording::open(folder, Values::kMillimeters).value();
  ASSERT_EQ(indexed.size(), 2U);
  EXPECT_EQ(indexed.read(1)->millimeters[0], 3);
  EXPECT_NEAR(indexed.time(1), 0.5, 1e-9);
  std::ofstream(folder / "INDEX.txt") << "d-10.00-5.pgm\nd-9.50-7.pgm\n";
  EXPECT_THAT(Recording::open(folder, Values::kMillimeters).error(), HasSubstr("go back"));
  std::ofstream(folder / "INDEX.txt") << "d-10.00-6.pgm\n";
  EXPECT_THAT(Recording::open(folder, Values::kMillimeters)->read(0).error(),
              HasSubstr("d-10.00-6.pgm"));
  fs::remove_all(folder);
  EXPECT_FALSE(Recording::open(folder, Values::kMillimeters).ok());
}

TEST(Recording, ReadsRealKinectFrames) {
  USHER_REQUIRE_DATA(folder, "depth/slambook2_rgbd");
  const auto recording = Recording::open(folder, Values::kMillimeters);
  ASSERT_TRUE(recording.ok()) << recording.error();
  EXPECT_EQ(recording->size(), 5U);
  const auto frame = recording->read(0);
  ASSERT_TRUE(frame.ok()) << frame.error();
  EXPECT_EQ(frame->width, 640);
  double sum = 0.0;
  int valid = 0;
  for (const std::uint16_t v : frame->millimeters) {
    if (v == 0) continue;
    sum += v, ++valid;
  }
  EXPECT_GT(valid, 640 * 480 / 2);
  EXPECT_GT(sum / valid, 800.0);  // a living room
  EXPECT_LT(sum / valid, 5000.0);
}

}  // namespace
}  // namespace usher::kinect
