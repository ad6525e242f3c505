#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "mapping/map_server/core/carmen_log.hpp"
#include "support/data.hpp"

namespace usher::map_server {
namespace {

using testing::HasSubstr;

const std::string kLine = "FLASER 3 1.5 2 81.91 1 2 0.5 1.1 2 0.5 12.25 host 0.1\n";

std::string log_error(const std::string& text) {
  const auto scans = parse_carmen_log(text, "a.clf");
  return scans ? "" : scans.error();
}

TEST(CarmenLog, ReadsScansAndPassesOverTheRest) {
  const auto scans =
      parse_carmen_log("# comment\nPARAM robot x\n" + kLine + "ODOM 1 2 3\r\n\n" + kLine, "a.clf");
  ASSERT_TRUE(scans.ok()) << scans.error();
  ASSERT_EQ(scans->size(), 2U);
  const CarmenScan& scan = scans->back();
  EXPECT_EQ(scan.ranges, (std::vector<float>{1.5F, 2.0F, 81.91F}));
  EXPECT_EQ(scan.odom_T_laser, (geometry::Pose2{1, 2, 0.5}));
  EXPECT_EQ(scan.time, 12.25);
  EXPECT_EQ(scan.line, 6U);
}

TEST(CarmenLog, KnowsTheUsualAngles) {
  CarmenScan scan;
  for (const auto& [count, degrees] : {std::pair{180, 1.0}, {181, 1.0}, {360, 0.5}, {361, 0.5}}) {
    scan.ranges.resize(static_cast<std::size_t>(count));
    EXPECT_NEAR(scan.angle_increment(), geometry::radians(degrees), 1e-12);
  }
  scan.ranges.resize(1);
  EXPECT_EQ(scan.angle_increment(), 0.0);
}

TEST(CarmenLog, NamesTheLineOfWhatIsWrong) {
  EXPECT_THAT(log_error(kLine + "FLASER"),
              HasSubstr("a.clf:2: expected a count of up to 4096 beams, found the end"));
  EXPECT_THAT(log_error("FLASER -1"), HasSubstr("found '-1'"));
  EXPECT_THAT(log_error("FLASER 999999999 1 2"), HasSubstr("found '999999999'"));
  EXPECT_THAT(log_error("FLASER 3 1 2"),
              HasSubstr("a.clf:1: expected range 3 of 3, found the end of the line"));
  EXPECT_THAT(log_error("FLASER 1 x 0 0 0 0 0 0 0 h 0"), HasSubstr("found 'x'"));
  EXPECT_THAT(log_error("FLASER 1 nan 0 0 0 0 0 0 0 h 0"), HasSubstr("found 'nan'"));
  EXPECT_THAT(log_error("FLASER 1 1 0 0 0 0 0"), HasSubstr("expected two poses"));
  EXPECT_THAT(log_error("FLASER 1 1 0 0 0 0 0 0 soon"), HasSubstr("expected a time, found 'soon'"));
}

TEST(ReferencePoses, AreCountedFromZero) {
  const auto poses = parse_reference_poses("# head\n0 1.5 1 2 0.1\n1 1.7 3 4 0.2", "r");
  ASSERT_TRUE(poses.ok()) << poses.error();
  EXPECT_EQ(poses->at(1), (geometry::Pose2{3, 4, 0.2}));
  EXPECT_THAT(parse_reference_poses("0 1 2 3 4\n2 1 2 3 4", "r").error(),
              HasSubstr("r:2: expected index 1"));
  EXPECT_THAT(parse_reference_poses("0 1 2 3", "r").error(),
              HasSubstr("r:1: expected a time and a pose"));
}

TEST(CarmenLog, ReadsGzipAndNoticesDamage) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("carmen_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "a.clf.gz").string();
  gzFile file = gzopen(path.c_str(), "wb");
  for (int i = 0; i < 2000; ++i) gzwrite(file, kLine.data(), static_cast<unsigned>(kLine.size()));
  gzclose(file);
  EXPECT_EQ(read_carmen_log(path)->size(), 2000U);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_FALSE(read_carmen_log(path).ok());
  EXPECT_THAT(read_carmen_log((folder / "absent").string()).error(),
              HasSubstr("absent: cannot be opened"));
  std::filesystem::remove_all(folder);
}

TEST(CarmenLogData, ReadsTheFreiburgLog) {
  USHER_REQUIRE_DATA(log, "carmen/rawodom/freiburg-079.clf.gz");
  USHER_REQUIRE_DATA(reference, "carmen/rawodom/freiburg-079.ref.txt.gz");
  const auto scans = read_carmen_log(log);
  const auto poses = read_reference_poses(reference);
  ASSERT_TRUE(scans.ok()) << scans.error();
  ASSERT_TRUE(poses.ok()) << poses.error();
  EXPECT_EQ(scans->size(), 4791U);
  EXPECT_EQ(poses->size(), 4791U);
}

}  // namespace
}  // namespace usher::map_server
