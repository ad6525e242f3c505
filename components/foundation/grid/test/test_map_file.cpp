#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "foundation/grid/map_file.hpp"
#include "foundation/random/random.hpp"
#include "support/data.hpp"

namespace usher::grid {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kYaml =
    "image: floor.pgm\nresolution: 0.050000\norigin: [-12.30, -7.80, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

class MapFile : public testing::Test {
 protected:
  MapFile() : folder_(fs::path(testing::TempDir()) / ("map_file_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~MapFile() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

std::span<const std::uint8_t> bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string image_error(const std::string& text, std::size_t max_cells = kMaxMapCells) {
  const auto image = decode_map_image(bytes(text), "m.pgm", max_cells);
  return image ? "" : image.error();
}

std::vector<std::uint16_t> samples(const std::string& text) {
  const auto image = decode_map_image(bytes(text), "m.pgm");
  EXPECT_TRUE(image.ok()) << (image ? "" : image.error());
  return image ? image->samples : std::vector<std::uint16_t>{};
}

std::string yaml_error(const std::string& text) {
  const auto description = parse_map_description(text, "m.yaml");
  return description ? "" : description.error();
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kYaml;
  return text.replace(text.find(from), from.size(), to);
}

MapDescription thresholds(MapMode mode, bool negate = false) {
  MapDescription description;
  description.mode = mode;
  description.resolution = 0.05;
  description.negate = negate;
  description.occupied_threshold = 0.65;
  description.free_threshold = 0.196;
  return description;
}

std::int8_t grey(std::uint16_t pixel, const MapDescription& description, int max_value = 255) {
  return to_occupancy({1, 1, 1, max_value, {pixel}}, description)[0];
}

// ---- YAML

TEST(MapDescription, ReadsEveryKey) {
  const auto d = parse_map_description(kYaml + "mode: scale\n", "m.yaml");
  ASSERT_TRUE(d.ok()) << d.error();
  EXPECT_EQ(d->image, "floor.pgm");
  EXPECT_EQ(d->mode, MapMode::kScale);
  EXPECT_EQ(d->resolution, 0.05);
  EXPECT_EQ(d->origin, (geometry::Pose2{-12.3, -7.8, 0.0}));
  EXPECT_FALSE(d->negate);
  EXPECT_EQ(d->occupied_threshold, 0.65);
  EXPECT_EQ(d->free_threshold, 0.196);
}

TEST(MapDescription, ReadsCarriageReturnsAndAMissingLastNewline) {
  std::string text = kYaml;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\r\n");
  text.resize(text.size() - 2);
  const auto d = parse_map_description(text, "m.yaml");
  ASSERT_TRUE(d.ok()) << d.error();
  EXPECT_EQ(d->image, "floor.pgm");
  EXPECT_EQ(d->free_threshold, 0.196);
}

TEST(MapDescription, ReadsNegateAsNumberOrWord) {
  EXPECT_TRUE(parse_map_description(with("negate: 0", "negate: 1"), "")->negate);
  EXPECT_TRUE(parse_map_description(with("negate: 0", "negate: true"), "")->negate);
  EXPECT_FALSE(parse_map_description(with("negate: 0", "negate: false"), "")->negate);
}

TEST(MapDescription, NamesFileAndLineOfWhatIsWrong) {
  EXPECT_THAT(yaml_error(kYaml + "colour: red\n"), HasSubstr("m.yaml:7: unknown key colour"));
  EXPECT_THAT(yaml_error(kYaml + "negate: 1\n"), HasSubstr("m.yaml:7: key negate occurs twice"));
  EXPECT_THAT(yaml_error(with("negate: 0\n", "")), HasSubstr("expected the key negate"));
  EXPECT_THAT(yaml_error(with("negate: 0", "negate: maybe")),
              HasSubstr("m.yaml:4: negate must be"));
  EXPECT_THAT(yaml_error(with("0.050000", "0")),
              HasSubstr("m.yaml:2: resolution must be a number in"));
  EXPECT_THAT(yaml_error(with("0.050000", "5")), HasSubstr("in [0.0001, 1]"));
  EXPECT_THAT(yaml_error(with("0.050000", ".nan")), HasSubstr("m.yaml:2: resolution"));
  EXPECT_THAT(yaml_error(with("0.050000", "5 cm")), HasSubstr("got '5 cm'"));
  EXPECT_THAT(yaml_error(with("-7.80, 0.0", "-7.80")),
              HasSubstr("m.yaml:3: origin must be three numbers"));
  EXPECT_THAT(yaml_error(with("-7.80", ".inf")), HasSubstr("m.yaml:3: origin"));
  EXPECT_THAT(yaml_error(with("0.65", "65")),
              HasSubstr("m.yaml:5: occupied_thresh must be a number in [0, 1]"));
  EXPECT_THAT(yaml_error(with("0.196", "0.7")), HasSubstr("m.yaml:6: free_thresh must be at most"));
  EXPECT_THAT(yaml_error(with("negate: 0", "mode: colour\nnegate: 0")),
              HasSubstr("m.yaml:4: mode must be"));
  EXPECT_THAT(yaml_error("image: [a\n"), HasSubstr("m.yaml:"));
  EXPECT_THAT(yaml_error(""), HasSubstr("m.yaml:1: expected keys"));
}

// ---- picture

TEST(MapImage, ReadsBinaryAndText) {
  EXPECT_EQ(samples(std::string("P5\n3 1\n255\n\x01\x02\xff", 14)),
            (std::vector<std::uint16_t>{1, 2, 255}));
  EXPECT_EQ(samples("P2 3 1 255 1\n2\t255"), (std::vector<std::uint16_t>{1, 2, 255}));
}

TEST(MapImage, ReadsCommentsAfterEveryToken) {
  const std::vector<std::uint16_t> expected = {7, 8};
  EXPECT_EQ(samples("P2 # magic\n# CREATOR\n2 # width\n1#height\n#x\n9 # most\n7 # first\n8"),
            expected);
  EXPECT_EQ(samples("P5 # magic\n2#w\n#h\n1 #\n9\n\x07\x08"), expected);
  EXPECT_EQ(samples("P5\n2 1\n9\n# after the largest value\n\x07\x08"), expected);
  EXPECT_EQ(samples("P5\r\n2 1\r\n9\r\n\x07\x08"), expected);
}

TEST(MapImage, TakesNoSampleForAComment) {
  EXPECT_EQ(samples("P5\n3 1\n255\n#\na"), (std::vector<std::uint16_t>{'#', '\n', 'a'}));
}

TEST(MapImage, ReadsSixteenBits) {
  EXPECT_EQ(samples(std::string("P5\n2 1\n65535\n\x01\x02\xff\xff", 17)),
            (std::vector<std::uint16_t>{258, 65535}));
  EXPECT_EQ(samples("P2\n2 1\n65535\n258 65535\n"), (std::vector<std::uint16_t>{258, 65535}));
}

TEST(MapImage, NamesWhatIsWrong) {
  EXPECT_THAT(image_error(""), HasSubstr("m.pgm:1: expected a PGM"));
  EXPECT_THAT(image_error("P6\n1 1\n255\nabc"), HasSubstr("expected a PGM"));
  EXPECT_THAT(image_error("P5\n2"),
              HasSubstr("m.pgm:2: expected a height, found the end of the file"));
  EXPECT_THAT(image_error("P5\n2 x"), HasSubstr("m.pgm:2: expected a height, found byte 120"));
  EXPECT_THAT(image_error("P5\n-2 1\n255\n"), HasSubstr("expected a width"));
  EXPECT_THAT(image_error("P5\n0 1\n255\n"), HasSubstr("expected a picture of 1 to"));
  EXPECT_THAT(image_error("P5\n1 1\n0\na"), HasSubstr("m.pgm:3: expected a largest value"));
  EXPECT_THAT(image_error("P5\n1 1\n65536\na"), HasSubstr("expected a largest value"));
  EXPECT_THAT(image_error("P5\n2 2\n255\nabc"), HasSubstr("expected 4 bytes of samples, found 3"));
  EXPECT_THAT(image_error("P2\n2 1\n255\n1"), HasSubstr("expected 2 samples, found"));
  EXPECT_THAT(image_error("P2\n2 1\n255\n12 "), HasSubstr("expected a sample, found the end"));
  EXPECT_THAT(image_error("P2\n2 1\n100\n1\n101"),
              HasSubstr("m.pgm:5: expected samples up to 100, found 101"));
}

TEST(MapImage, RefusesAnAbsurdHeaderWithoutAllocating) {
  EXPECT_THAT(image_error("P5\n4294967295 4294967295\n255\n"),
              HasSubstr("found 4294967295 x 4294967295"));
  EXPECT_THAT(image_error("P5\n99999999999999999999 1\n255\n"), HasSubstr("expected a width"));
  EXPECT_THAT(image_error("P5\n1000 1000\n255\n", 999'999), HasSubstr("1 to 999999 pixels"));
  EXPECT_THAT(image_error("P2\n8000 8000\n255\n1 2 3"), HasSubstr("expected 64000000 samples"));
  std::string png(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\0\0\0\0\0\0\0\0", 33);
  EXPECT_THAT(image_error(png), HasSubstr("found 2147483647 x 2147483647"));
}

std::string png_of(const cv::Mat& picture) {
  std::vector<std::uint8_t> encoded;
  cv::imencode(".png", picture, encoded);
  return {encoded.begin(), encoded.end()};
}

TEST(MapImage, ReadsPngOfAllKinds) {
  cv::Mat wide(1, 2, CV_16U);
  wide.at<std::uint16_t>(0) = 300;
  wide.at<std::uint16_t>(1) = 65535;
  EXPECT_EQ(samples(png_of(wide)), (std::vector<std::uint16_t>{300, 65535}));
  const cv::Mat colour(1, 1, CV_8UC4, cv::Scalar(1, 2, 3, 4));
  const std::string encoded = png_of(colour);
  const auto image = decode_map_image(bytes(encoded), "m.png");
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image->channels, 4);
  EXPECT_EQ(image->samples[3], 4);
}

TEST(MapImage, RefusesADamagedPng) {
  cv::Mat picture(64, 64, CV_8U);
  cv::randu(picture, 0, 255);
  const std::string encoded = png_of(picture);
  EXPECT_NE(image_error(encoded.substr(0, 20)), "");
  EXPECT_NE(image_error(encoded.substr(0, 40)), "");
  std::string damaged = encoded;
  damaged[30] = static_cast<char>(damaged[30] ^ 0xff);  // checksum of the header
  EXPECT_NE(image_error(damaged), "");
}

// ---- pixel values

TEST(ToOccupancy, TrinaryComparesStrictly) {
  const MapDescription d = thresholds(MapMode::kTrinary);
  EXPECT_EQ(grey(254, d), kFree);
  EXPECT_EQ(grey(0, d), kOccupied);
  EXPECT_EQ(grey(205, d), kUnknown);  // 50 / 255 = 0.19608 is not below 0.196
  EXPECT_EQ(grey(206, d), kFree);
  EXPECT_EQ(grey(128, d), kUnknown);
  MapDescription exact = d;
  exact.free_threshold = 0.2;  // 51 / 255
  exact.occupied_threshold = 0.8;
  EXPECT_EQ(grey(204, exact), kUnknown);
  EXPECT_EQ(grey(51, exact), kUnknown);
  EXPECT_EQ(grey(50, exact), kOccupied);
}

TEST(ToOccupancy, ScaleIsLinearBetweenTheThresholds) {
  const MapDescription d = thresholds(MapMode::kScale);
  EXPECT_EQ(grey(128, d), 67);
  EXPECT_EQ(grey(254, d), kFree);
  EXPECT_EQ(grey(0, d), kOccupied);
  EXPECT_EQ(grey(205, d), 0);
}

TEST(ToOccupancy, RawKeepsZeroToHundred) {
  for (const bool negate : {false, true}) {
    const MapDescription d = thresholds(MapMode::kRaw, negate);
    EXPECT_EQ(grey(0, d), 0);
    EXPECT_EQ(grey(100, d), 100);
    EXPECT_EQ(grey(101, d), kUnknown);
    EXPECT_EQ(grey(255, d), kUnknown);
  }
}

TEST(ToOccupancy, NegateSwapsBlackAndWhite) {
  const MapDescription d = thresholds(MapMode::kTrinary, true);
  EXPECT_EQ(grey(254, d), kOccupied);
  EXPECT_EQ(grey(0, d), kFree);
}

TEST(ToOccupancy, AlphaCountsAsAChannelInTrinaryAndHidesInScale) {
  const MapImage opaque{1, 1, 4, 255, {0, 0, 0, 255}};
  const MapImage clear{1, 1, 4, 255, {0, 0, 0, 0}};
  EXPECT_EQ(to_occupancy(opaque, thresholds(MapMode::kTrinary))[0], kOccupied);  // 1 - 1/4 > 0.65
  EXPECT_EQ(to_occupancy({1, 1, 4, 255, {120, 120, 120, 255}}, thresholds(MapMode::kTrinary))[0],
            kUnknown);
  EXPECT_EQ(to_occupancy(opaque, thresholds(MapMode::kScale))[0], kOccupied);
  EXPECT_EQ(to_occupancy(clear, thresholds(MapMode::kScale))[0], kUnknown);
  EXPECT_EQ(to_occupancy({1, 1, 4, 255, {50, 50, 50, 0}}, thresholds(MapMode::kRaw))[0], 50);
}

TEST(ToOccupancy, PutsTheLastRowAtTheBottom) {
  const OccupancyGrid map = to_occupancy({1, 2, 1, 255, {0, 254}}, thresholds(MapMode::kTrinary));
  EXPECT_EQ(map.at({0, 1}), kOccupied);
  EXPECT_EQ(map.at({0, 0}), kFree);
}

TEST(ToOccupancy, TakesTheLargestValueAsWhite) {
  EXPECT_EQ(grey(65535, thresholds(MapMode::kTrinary), 65535), kFree);
  EXPECT_EQ(grey(255, thresholds(MapMode::kTrinary), 65535), kOccupied);
}

// ---- files

TEST_F(MapFile, SavedMapsReadBackTheSame) {
  Random random(1);
  OccupancyGrid map({57, 31, 0.05, -12.3, 104.85});
  for (auto& cell : map)
    cell = std::array<std::int8_t, 3>{kFree, kOccupied, kUnknown}[random.below(3)];
  ASSERT_TRUE(save_map(map, path("floor: 1.yaml")).ok());
  const auto loaded = load_map(path("floor: 1.yaml"));
  ASSERT_TRUE(loaded.ok()) << loaded.error();
  EXPECT_EQ(*loaded, map);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2)
      << "no partial file stays behind";
}

TEST_F(MapFile, SaverDecidesWithTheUsualThresholds) {
  OccupancyGrid map({6, 1, 0.05, 0.0, 0.0});
  map.values() = {25, 26, 64, 65, 99, -1};
  ASSERT_TRUE(save_map(map, path("t.yaml")).ok());
  EXPECT_EQ(load_map(path("t.yaml"))->values(),
            (std::vector<std::int8_t>{0, -1, -1, 100, 100, -1}));
}

TEST_F(MapFile, SaysWhatCannotBeWritten) {
  EXPECT_THAT(save_map(OccupancyGrid(), path("t.yaml")).error(), HasSubstr("empty"));
  EXPECT_THAT(save_map(OccupancyGrid({1, 1, 1, 0, 0}), path("none/t.yaml")).error(),
              HasSubstr("cannot be written"));
}

TEST_F(MapFile, SaysWhatCannotBeRead) {
  EXPECT_THAT(load_map(path("absent.yaml")).error(), HasSubstr("absent.yaml: expected a file"));
  EXPECT_THAT(load_map(folder_.string()).error(), HasSubstr("expected a file"));
  EXPECT_THAT(load_map(write("m.yaml", kYaml)).error(), HasSubstr("floor.pgm: expected a file"));
  EXPECT_THAT(load_map(write("long.yaml", std::string(70000, '#'))).error(),
              HasSubstr("expected at most 65536 bytes"));
}

TEST_F(MapFile, FindsThePictureBesideTheYamlOrByItsFullPath) {
  write("floor.pgm", "P2 1 1 255 0");
  EXPECT_EQ(load_map(write("m.yaml", kYaml))->at({0, 0}), kOccupied);
  fs::create_directories(folder_ / "below");
  const std::string full = with("floor.pgm", path("floor.pgm"));
  EXPECT_EQ(load_map(write("below/m.yaml", full))->at({0, 0}), kOccupied);
}

TEST_F(MapFile, LimitsTheSize) {
  write("floor.pgm", "P2 2 2 255 0 0 0 0");
  EXPECT_THAT(load_map(write("m.yaml", kYaml), 3).error(), HasSubstr("1 to 3 pixels"));
  EXPECT_THAT(load_map(write("y.yaml", with(", 0.0]", ", 0.7]")), 4).error(),
              HasSubstr("after turning upright"));
}

// ---- turning

/// Whether free or unknown cells connect two cells over shared edges.
bool connected(const OccupancyGrid& map, Cell from, Cell to) {
  Grid<std::uint8_t> seen(map.geometry());
  std::deque<Cell> open = {from};
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop_front();
    if (!map.geometry().contains(cell) || seen.at(cell) != 0 || map.at(cell) == kOccupied) continue;
    seen.at(cell) = 1;
    for (const Cell step : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      open.push_back({cell.x + step.x, cell.y + step.y});
  }
  return seen.at(to) != 0;
}

TEST(TurnedUpright, QuarterTurnsOnlyMoveCells) {
  Random random(2);
  OccupancyGrid map({13, 7, 0.05, 0.0, 0.0});
  for (auto& cell : map)
    cell = std::array<std::int8_t, 3>{kFree, kOccupied, kUnknown}[random.below(3)];
  for (int quarter = 1; quarter < 4; ++quarter) {
    const geometry::Pose2 origin{2.0, 3.0, quarter * geometry::kPi / 2};
    const auto turned = turned_upright(map, origin);
    ASSERT_TRUE(turned.ok());
    ASSERT_EQ(turned->size(), map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
      const geometry::Point2 center = origin * map.geometry().center(map.geometry().cell(i));
      EXPECT_EQ(turned->at(turned->geometry().cell_at(center)), map[i]);
    }
  }
}

TEST(TurnedUpright, KeepsThinWallsClosed) {
  for (int degrees = 1; degrees < 90; degrees += 4) {
    OccupancyGrid map({60, 60, 0.05, 0.0, 0.0}, kFree);
    for (int i = 10; i <= 50; ++i)
      map.at({i, 10}) = map.at({i, 50}) = map.at({10, i}) = map.at({50, i}) = kOccupied;
    for (int i = 0; i <= 20; ++i)
      map.at({30 + i, 10 + i}) = kOccupied;  // cells that touch at corners only
    const geometry::Pose2 origin{-4.0, 1.5, geometry::radians(degrees)};
    const auto turned = turned_upright(map, origin);
    ASSERT_TRUE(turned.ok());
    const auto cell_of = [&](Cell cell) {
      return turned->geometry().cell_at(origin * map.geometry().center(cell));
    };
    EXPECT_FALSE(connected(*turned, cell_of({5, 5}), cell_of({20, 30}))) << degrees;
    EXPECT_FALSE(connected(*turned, cell_of({45, 15}), cell_of({20, 30}))) << degrees;
    EXPECT_TRUE(connected(*turned, cell_of({20, 30}), cell_of({40, 40}))) << degrees;
  }
}

TEST(TurnedUpright, KeepsEveryOccupiedCellInItsPlace) {
  Random random(3);
  OccupancyGrid map({80, 50, 0.05, 0.0, 0.0}, kFree);
  for (auto& cell : map) cell = random.uniform() < 0.05 ? kOccupied : kFree;
  const geometry::Pose2 origin{10.0, -3.0, 0.3};
  const auto turned = turned_upright(map, origin);
  ASSERT_TRUE(turned.ok());
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] != kOccupied) continue;
    EXPECT_EQ(turned->at(turned->geometry().cell_at(origin *
                                                    map.geometry().center(map.geometry().cell(i)))),
              kOccupied);
  }
  EXPECT_EQ(turned->at({0, 0}), kUnknown) << "what the turned map does not cover";
}

TEST(MapFileData, LoadsEveryBuilding) {
  USHER_REQUIRE_DATA(folder, "maps");
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    const auto map = load_map(entry.path().string());
    ASSERT_TRUE(map.ok()) << map.error();
    EXPECT_GT(map->size(), 10000U);
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST(MapFileData, TurnsTheStataBasement) {
  USHER_REQUIRE_DATA(yaml, "maps/mit_stata_basement/basement_fixed.map.yaml");
  const auto map = load_map(yaml);
  ASSERT_TRUE(map.ok()) << map.error();
  // 1300 x 1300 pixels of 0.0504 m, turned by 3.14 rad about (25.9, 48.5).
  EXPECT_NEAR(map->geometry().origin_x,
              25.9 - 65.52 * std::cos(3.14 - geometry::kPi) - 65.52 * std::sin(3.14), 1e-6);
  EXPECT_EQ(map->resolution(), 0.0504);
  EXPECT_NEAR(map->width(), 1303, 1);

  // The same pixels without the yaw: about as many occupied cells, each at its turned place.
  const fs::path picture = fs::path(yaml).parent_path() / "basement_fixed.png";
  std::ifstream file(picture, std::ios::binary);
  const std::string png((std::istreambuf_iterator<char>(file)), {});
  MapDescription description = thresholds(MapMode::kTrinary);
  description.resolution = 0.0504;
  const OccupancyGrid flat = to_occupancy(*decode_map_image(bytes(png), "basement"), description);
  const auto occupied = static_cast<double>(std::count(flat.begin(), flat.end(), kOccupied));
  const auto turned_occupied = static_cast<double>(std::count(map->begin(), map->end(), kOccupied));
  EXPECT_GE(turned_occupied, occupied * 0.99);
  EXPECT_LE(turned_occupied, occupied * 1.1);  // closing of diagonals
  const geometry::Pose2 origin{25.9, 48.5, 3.14};
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (flat[i] != kOccupied) continue;
    ASSERT_EQ(
        map->at(map->geometry().cell_at(origin * flat.geometry().center(flat.geometry().cell(i)))),
        kOccupied);
  }
}

}  // namespace
}  // namespace usher::grid
