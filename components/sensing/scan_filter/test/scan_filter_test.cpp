#include "sensing/scan_filter/core/scan_filter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "foundation/geometry/pose3.hpp"
#include "foundation/random/random.hpp"

namespace usher::scan_filter {
namespace {

using geometry::Point2;
using geometry::radians;
using testing::HasSubstr;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

ScanGeometry lms100() { return {radians(-135), radians(0.5), 0.05, 20.0}; }

ScanFilter filter(const ScanFilterConfig& config = {}) {
  auto made = ScanFilter::make(config);
  EXPECT_TRUE(made.ok());
  return std::move(made).value();
}

/// A vertical wall: all points p with normal . p = offset, in base_footprint.
struct Wall {
  double direction;  // of the normal, rad
  double offset;     // m
};

/// What an ideal scanner on MARVIN sees of walls, from floor to `top`, and of the floor.
std::vector<float> see(std::span<const Wall> walls, double pitch, double top = 2.7,
                       const ScanFilterConfig& c = {}) {
  const auto lean = geometry::from_roll_pitch_yaw(0.0, pitch, 0.0);
  const Eigen::Vector3d o = lean * Eigen::Vector3d(c.mount_x, c.mount_y, c.mount_z) +
                            Eigen::Vector3d(0, 0, c.axle_height);
  std::vector<float> ranges;
  for (int i = 0; i < 541; ++i) {
    const double beam = radians(-135 + 0.5 * i) + c.mount_yaw;
    const Eigen::Vector3d d = lean * Eigen::Vector3d(std::cos(beam), std::sin(beam), 0.0);
    double best = d.z() < 0 ? -o.z() / d.z() : 1e9;
    for (const Wall& wall : walls) {
      const Eigen::Vector3d n(std::cos(wall.direction), std::sin(wall.direction), 0.0);
      const double t = (wall.offset - n.dot(o)) / n.dot(d);
      if (n.dot(d) > 0 && t > 0 && o.z() + t * d.z() < top) best = std::min(best, t);
    }
    ranges.push_back(best > 20.0 ? kInf : static_cast<float>(best));
  }
  return ranges;
}

Point2 end_of(const PlanarScan& scan, std::size_t i) {
  const double angle =
      scan.geometry.angle_min + static_cast<double>(i) * scan.geometry.angle_increment;
  const double r = static_cast<double>(scan.ranges[i]);
  return scan.base_T_scan * Point2(r * std::cos(angle), r * std::sin(angle));
}

TEST(ScanFilter, LeavesAnUprightScanAsItIs) {
  Random random(1);
  std::vector<float> ranges(541);
  for (float& r : ranges) {
    r = random.uniform() < 0.1 ? kInf : static_cast<float>(random.uniform(0.5, 19.0));
  }
  ScanFilter f = filter({.mixed_from = 20.0});
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), ranges, {}, out).ok());
  EXPECT_EQ(out.base_T_scan, (geometry::Pose2{0.28, 0.0, 0.0}));
  const auto first = static_cast<std::size_t>(
      std::lround((out.geometry.angle_min - radians(-135)) / radians(0.5)));
  for (std::size_t i = 0; i < out.ranges.size(); ++i) {
    if (std::isinf(ranges[first + i])) {
      EXPECT_TRUE(std::isinf(out.ranges[i])) << i;
    } else {
      EXPECT_NEAR(out.ranges[i], ranges[first + i], 1e-4F * ranges[first + i]) << i;
    }
  }
}

TEST(ScanFilter, CutsBearingsBeyond2Radians) {
  ScanFilter f = filter();
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), std::vector<float>(541, 3.0F), {}, out).ok());
  const double last = out.geometry.angle_min +
                      static_cast<double>(out.ranges.size() - 1) * out.geometry.angle_increment;
  EXPECT_GE(out.geometry.angle_min, -2.0);
  EXPECT_LE(last, 2.0);
  EXPECT_EQ(out.ranges.size(), 459U);
}

// Equation 4.7 is the straight beam: range times cosine, and the sensor's own way by the lean
// (4.3).
TEST(ScanFilter, AgreesWithEquation47StraightAhead) {
  for (const double degrees : {-20.0, -8.0, -1.0, 1.0, 6.0}) {
    const double pitch = radians(degrees);
    const Wall wall{0.0, 2.0};
    const auto ranges = see(std::span(&wall, 1), pitch);
    ScanFilter f = filter();
    PlanarScan out;
    ASSERT_TRUE(f.filter(lms100(), ranges, {pitch, 0.0}, out).ok());
    const auto middle = static_cast<std::size_t>(
        std::lround(-out.geometry.angle_min / out.geometry.angle_increment));
    const double equation_4_7 = std::cos(pitch) * static_cast<double>(ranges[270]);
    const double mount_r = std::hypot(0.28, 0.065);
    const double mount_b = std::atan2(0.28, 0.065);
    const double x_local = std::sin(mount_b + pitch) * mount_r;  // 4.2, 4.3
    EXPECT_NEAR(out.ranges[middle], equation_4_7 + x_local - 0.28, 1e-4) << degrees;
    EXPECT_NEAR(out.ranges[middle], 2.0 - 0.28, 1e-4) << degrees;
  }
}

TEST(ScanFilter, KeepsWallsWhereTheyAreAndFindsNoFloor) {
  const std::vector<Wall> walls{
      {0.0, 4.0}, {radians(70), 0.7}, {radians(-90), 0.7}, {radians(140), 2.5}};
  for (double degrees = -20.0; degrees <= 22.0; degrees += 0.5) {
    const double pitch = radians(degrees);
    ScanFilter f = filter();
    PlanarScan out;
    ASSERT_TRUE(f.filter(lms100(), see(walls, pitch), {pitch, 0.0}, out).ok());
    int known = 0;
    for (std::size_t i = 0; i < out.ranges.size(); ++i) {
      if (!std::isfinite(out.ranges[i])) continue;
      ++known;
      double off = 1e9;
      for (const Wall& wall : walls) {
        const Point2 n(std::cos(wall.direction), std::sin(wall.direction));
        off = std::min(off, std::abs(n.dot(end_of(out, i)) - wall.offset));
      }
      EXPECT_LT(off, 0.03) << degrees << " degrees, angle " << i;
    }
    EXPECT_GT(known, degrees < 10.0 ? 350 : 200) << degrees;
  }
}

// A turn of the LMS100 takes 15 ms from its first beam to its last.
TEST(ScanFilter, CorrectsEachBeamWithThePitchOfItsOwnTime) {
  const std::vector<Wall> walls{{0.0, 3.0}};
  double worst = 0.0;
  double worst_of_one_pitch = 0.0;
  for (double degrees = -9.0; degrees <= 3.0; degrees += 3.0) {
    for (const double swing : {-1.5, 1.5}) {  // degrees within the turn: 1.7 rad/s
      const auto pitch_of = [&](int beam) { return radians(degrees + swing * beam / 540.0); };
      std::vector<float> ranges;
      for (int i = 0; i < 541; ++i)
        ranges.push_back(see(walls, pitch_of(i))[static_cast<std::size_t>(i)]);
      const double rate = radians(swing) / 0.015;
      const auto farthest_off = [&](const Pitch& first, const Pitch& last) {
        ScanFilter f = filter();
        PlanarScan out;
        EXPECT_TRUE(f.filter(lms100(), ranges, first, last, out).ok());
        double farthest = 0.0;
        for (std::size_t i = 0; i < out.ranges.size(); ++i) {
          if (!std::isfinite(out.ranges[i])) continue;
          double off = 1e9;
          for (const Wall& wall : walls) {
            const Point2 n(std::cos(wall.direction), std::sin(wall.direction));
            off = std::min(off, std::abs(n.dot(end_of(out, i)) - wall.offset));
          }
          farthest = std::max(farthest, off);
        }
        return farthest;
      };
      const Pitch first{pitch_of(0), rate};
      worst = std::max(worst, farthest_off(first, {pitch_of(540), rate}));
      worst_of_one_pitch = std::max(worst_of_one_pitch, farthest_off(first, first));
    }
  }
  EXPECT_LT(worst, 0.001);
  EXPECT_GT(worst_of_one_pitch, 0.01) << "the test would not see one pitch for all";
}

TEST(ScanFilter, LeavesNoHoleInAWallThatIsSeen) {
  const std::vector<Wall> walls{{0.0, 3.0}};
  for (const double degrees : {-9.0, -3.0, 0.5, 3.0}) {
    ScanFilter f = filter();
    PlanarScan out;
    ASSERT_TRUE(
        f.filter(lms100(), see(walls, radians(degrees)), {radians(degrees), 0.0}, out).ok());
    const auto middle = out.ranges.size() / 2;
    for (std::size_t i = middle - 80; i <= middle + 80; ++i) {
      EXPECT_TRUE(std::isfinite(out.ranges[i])) << degrees << " " << i;
    }
  }
}

TEST(ScanFilter, RefusesABlindScan) {
  ScanFilter filter = ScanFilter::make({.least_echoes = 20}).value();
  PlanarScan out;
  for (const float blind : {kNan, 0.0F, std::numeric_limits<float>::infinity(), 100.0F, -1.0F}) {
    std::vector<float> ranges(541, blind);
    EXPECT_THAT(filter.filter(lms100(), ranges, {}, out).error(), HasSubstr("blind")) << blind;
    std::fill(ranges.begin() + 260, ranges.begin() + 280, 3.0F);
    EXPECT_TRUE(filter.filter(lms100(), ranges, {}, out).ok()) << blind;
  }
  EXPECT_EQ(filter.counts().rejected, 5U);
}

TEST(ScanFilter, MakesTheFloorUnknownAndNotFree) {
  ScanFilter f = filter();
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), see({}, radians(12)), {radians(12), 0.0}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[out.ranges.size() / 2]));
  EXPECT_GT(f.counts().floor, 250U);
}

TEST(ScanFilter, TrustsTheFloorLessWhenThePitchMayBeWrong) {
  // A pitch that is wrong by 0.35 degrees moves the floor; the margins must still cover it.
  for (double degrees = 1.0; degrees <= 20.0; degrees += 0.5) {
    for (const double error : {-0.34, 0.34}) {
      ScanFilter f = filter();
      PlanarScan out;
      ASSERT_TRUE(
          f.filter(lms100(), see({}, radians(degrees)), {radians(degrees + error), 0.0}, out).ok());
      for (const float r : out.ranges) EXPECT_FALSE(std::isfinite(r)) << degrees << " " << error;
    }
  }
}

TEST(ScanFilter, KeepsALonePole) {
  for (double degrees = -10.0; degrees <= 6.0; degrees += 0.7) {
    const double pitch = radians(degrees);
    const std::vector<Wall> walls{{0.0, 4.0}};
    auto ranges = see(walls, pitch);
    ranges[290] = 1.2F;  // 10 degrees to the left, one beam wide
    ScanFilter f = filter();
    PlanarScan out;
    ASSERT_TRUE(f.filter(lms100(), ranges, {pitch, 0.0}, out).ok());
    int poles = 0;
    for (std::size_t i = 0; i < out.ranges.size(); ++i) {
      if (out.ranges[i] < 2.0F) ++poles;
    }
    EXPECT_EQ(poles, 1) << degrees;
  }
}

TEST(ScanFilter, DrawsNothingBetweenAPillarAndTheWallBehind) {
  for (double degrees = -9.0; degrees <= 4.0; degrees += 0.6) {
    const double pitch = radians(degrees);
    const std::vector<Wall> far{{0.0, 3.4}};
    const std::vector<Wall> near{{0.0, 2.6}};
    auto ranges = see(far, pitch);
    const auto pillar = see(near, pitch);
    std::copy(pillar.begin() + 285, pillar.begin() + 296, ranges.begin() + 285);
    ScanFilter f = filter();
    PlanarScan out;
    ASSERT_TRUE(f.filter(lms100(), ranges, {pitch, 0.0}, out).ok());
    int on_pillar = 0;
    for (std::size_t i = 0; i < out.ranges.size(); ++i) {
      if (!std::isfinite(out.ranges[i])) continue;
      const double x = end_of(out, i).x();
      EXPECT_TRUE(std::abs(x - 2.6) < 0.05 || std::abs(x - 3.4) < 0.05) << degrees << " " << x;
      if (std::abs(x - 2.6) < 0.05) ++on_pillar;
    }
    EXPECT_NEAR(on_pillar, 11, 1) << degrees;
  }
}

/// A pillar 2.6 m ahead before a wall at 3.4 m, its edge between the beams 295 and 296, and the
/// beam at its edge.
std::vector<float> pillar_with_an_edge_at(float range) {
  const std::vector<Wall> far{{0.0, 3.4}};
  const std::vector<Wall> near{{0.0, 2.6}};
  auto ranges = see(far, 0.0);
  const auto pillar = see(near, 0.0);
  std::copy(pillar.begin() + 285, pillar.begin() + 296, ranges.begin() + 285);
  ranges[296] = range;
  return ranges;
}
constexpr std::size_t kEdge = 296 - 41;  // of what is within the bearing limit

TEST(ScanFilter, KnowsNothingOfABeamBetweenTwoSurfaces) {
  PlanarScan out;
  ScanFilter f = filter();
  ASSERT_TRUE(f.filter(lms100(), pillar_with_an_edge_at(2.9F), {}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[kEdge])) << out.ranges[kEdge];
  EXPECT_EQ(f.counts().mixed, 1U);
  EXPECT_TRUE(std::isfinite(out.ranges[kEdge - 1]) && std::isfinite(out.ranges[kEdge + 1]));

  auto open = pillar_with_an_edge_at(2.9F);  // and nothing behind
  std::fill(open.begin() + 297, open.end(), kInf);
  ASSERT_TRUE(f.filter(lms100(), open, {}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[kEdge])) << out.ranges[kEdge];
}

/// As it happened: 2 / (1 / 2.6 + 1 / 3.4) = 2.95.
TEST(ScanFilter, KnowsNothingOfABeamBetweenTwoSurfacesThatLooksLikeAWallsByChance) {
  PlanarScan out;
  ScanFilter f = filter();
  ASSERT_TRUE(f.filter(lms100(), pillar_with_an_edge_at(2.95F), {}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[kEdge])) << out.ranges[kEdge];
  EXPECT_EQ(f.counts().mixed, 1U);

  auto beside_floor = pillar_with_an_edge_at(2.95F);
  beside_floor[298] = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(f.filter(lms100(), beside_floor, {}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[kEdge])) << "the other fourth one is known";
}

TEST(ScanFilter, KnowsNothingOfTwoBeamsBetweenTwoSurfaces) {
  PlanarScan out;
  for (const bool mirrored : {false, true}) {
    ScanFilter f = filter();
    auto ranges = pillar_with_an_edge_at(3.0F);
    ranges[297] = 4.5F;
    std::fill(ranges.begin() + 298, ranges.end(), kInf);
    std::size_t first = kEdge, second = kEdge + 1;
    if (mirrored) {
      std::reverse(ranges.begin(), ranges.end());
      first = out.ranges.size() - 1 - first, second = out.ranges.size() - 1 - second;
    }
    ASSERT_TRUE(f.filter(lms100(), ranges, {}, out).ok());
    EXPECT_TRUE(std::isnan(out.ranges[first])) << mirrored << ": " << out.ranges[first];
    EXPECT_TRUE(std::isnan(out.ranges[second])) << mirrored << ": " << out.ranges[second];
    EXPECT_EQ(f.counts().mixed, 2U);
  }
}

TEST(ScanFilter, KeepsAThingBeforeTwoSurfacesAndWhateverIsNear) {
  PlanarScan out;
  ScanFilter f = filter();
  ASSERT_TRUE(f.filter(lms100(), pillar_with_an_edge_at(1.9F), {}, out).ok());
  EXPECT_FLOAT_EQ(out.ranges[kEdge], 1.9F) << "a leg before both";

  auto near = pillar_with_an_edge_at(1.4F);
  std::fill(near.begin() + 285, near.begin() + 296, 1.0F);
  ASSERT_TRUE(f.filter(lms100(), near, {}, out).ok());
  EXPECT_FLOAT_EQ(out.ranges[kEdge], 1.4F) << "within a stop";
  EXPECT_EQ(f.counts().mixed, 0U);
}

TEST(ScanFilter, KeepsAWallThatIsMetAtAGrazingAngle) {
  const std::vector<Wall> beside{{radians(90), 0.2}};
  PlanarScan out;
  ScanFilter f = filter();
  ASSERT_TRUE(f.filter(lms100(), see(beside, 0.0), {}, out).ok());
  EXPECT_GT(std::count_if(out.ranges.begin(), out.ranges.end(),
                          [](float r) { return r > 4.0F && r < 15.0F; }),
            2)
      << "the wall's far end";
  EXPECT_LE(f.counts().mixed, 1U) << "its last beam";

  const std::vector<Wall> noisy{{radians(85), 0.25}};
  auto ranges = see(noisy, 0.0);
  Random random(1);
  std::uint64_t ends = 0;
  for (int scan = 0; scan < 50; ++scan) {
    for (float& r : ranges) r += static_cast<float>(random.gaussian(0.0, 0.012));
    ASSERT_TRUE(f.filter(lms100(), ranges, {}, out).ok());
    ends += static_cast<std::uint64_t>(std::count_if(out.ranges.begin(), out.ranges.end(),
                                                     [](float r) { return r > 1.5F && r < 8.0F; }));
    ranges = see(noisy, 0.0);
  }
  EXPECT_LE(f.counts().mixed, 51 + ends / 50);
}

TEST(ScanFilter, DropsWhatIsAboveTheRobot) {
  const std::vector<Wall> walls{{0.0, 18.0}};
  ScanFilter f = filter();
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), see(walls, radians(-8), 4.0), {radians(-8), 0.0}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[out.ranges.size() / 2])) << "2.8 m up";
  EXPECT_GT(f.counts().high, 0U);
}

TEST(ScanFilter, CallsOnlyLevelBeamsWithoutEchoFree) {
  const std::vector<float> nothing(541, kInf);
  ScanFilter f = filter();
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), nothing, {radians(1.0), 0.0}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[out.ranges.size() / 2])) << "should have met the floor";
  ASSERT_TRUE(f.filter(lms100(), nothing, {radians(-1.0), 0.0}, out).ok());
  EXPECT_EQ(out.ranges[out.ranges.size() / 2], kInf);
  ASSERT_TRUE(f.filter(lms100(), nothing, {radians(-8.0), 0.0}, out).ok());
  EXPECT_TRUE(std::isnan(out.ranges[out.ranges.size() / 2])) << "passes over everything";
}

TEST(ScanFilter, CountsInvalidBeamsAndPassesTheOthers) {
  std::vector<float> ranges(541, 3.0F);
  ranges[200] = kNan;
  ranges[230] = -kInf;
  ranges[260] = -1.0F;
  ranges[280] = 0.0F;
  ranges[300] = 1e30F;
  ScanFilter f = filter();
  PlanarScan out;
  ASSERT_TRUE(f.filter(lms100(), ranges, {}, out).ok());
  EXPECT_EQ(f.counts().invalid, 4U);
  const std::size_t first = 41;
  for (const std::size_t i : {200U, 230U, 260U, 280U})
    EXPECT_TRUE(std::isnan(out.ranges[i - first]));
  EXPECT_EQ(out.ranges[300 - first], kInf);
  EXPECT_NEAR(out.ranges[250 - first], 3.0F, 1e-5F);
}

TEST(ScanFilter, RejectsScansThatCannotBe) {
  ScanFilter f = filter();
  PlanarScan out;
  out.ranges = {1.0F};
  const std::vector<float> some(541, 3.0F);
  const double nan = std::nan("");
  const auto error = [&](const ScanGeometry& g, std::span<const float> ranges, const Pitch& pitch) {
    const Status status = f.filter(g, ranges, pitch, out);
    return status.ok() ? "accepted" : status.error();
  };
  EXPECT_THAT(error(lms100(), {}, {}), HasSubstr("1 to 10000 beams, got 0"));
  EXPECT_THAT(error(lms100(), std::vector<float>(20000, 1.0F), {}), HasSubstr("got 20000"));
  EXPECT_THAT(error({nan, 0.01, 0.1, 20}, some, {}), HasSubstr("angles"));
  EXPECT_THAT(error({-2.0, 0.0, 0.1, 20}, some, {}), HasSubstr("angles"));
  EXPECT_THAT(error({-2.0, 0.1, 0.1, 20}, some, {}), HasSubstr("within one turn"));
  EXPECT_THAT(error({-2.0, 0.005, nan, 20}, some, {}), HasSubstr("range_min"));
  EXPECT_THAT(error({-2.0, 0.005, 5.0, 1.0}, some, {}), HasSubstr("range_min"));
  EXPECT_THAT(error({2.5, 0.0001, 0.1, 20}, some, {}), HasSubstr("bearing limit"));
  EXPECT_THAT(error(lms100(), some, {nan, 0.0}), HasSubstr("pitch"));
  EXPECT_THAT(error(lms100(), some, {1.0, 0.0}), HasSubstr("pitch"));
  EXPECT_THAT(error(lms100(), some, {0.0, nan}), HasSubstr("pitch"));
  EXPECT_EQ(f.counts().rejected, 11U);
  EXPECT_EQ(f.counts().scans, 0U);
  EXPECT_EQ(out.ranges.size(), 1U) << "left alone";
}

TEST(ScanFilter, RefusesAnImpossibleMount) {
  EXPECT_THAT(ScanFilter::make({.mount_x = 5.0}).error(),
              HasSubstr("mount_x must be in [-2, 2] m"));
  EXPECT_THAT(ScanFilter::make({.floor_margin = std::nan("")}).error(), HasSubstr("floor_margin"));
}

TEST(ScanFilter, SurvivesAnyBits) {
  Random random(3);
  ScanFilter f = filter();
  PlanarScan out;
  for (int round = 0; round < 300; ++round) {
    std::vector<float> ranges(541);
    for (float& r : ranges) {
      const auto bits = static_cast<std::uint32_t>(random.next());
      std::memcpy(&r, &bits, sizeof r);
      if (random.uniform() < 0.5) r = static_cast<float>(random.uniform(-0.1, 21.0));
    }
    ASSERT_TRUE(f.filter(lms100(), ranges, {random.uniform(-0.6, 0.6), 0.0}, out).ok());
    for (const float r : out.ranges) ASSERT_TRUE(std::isnan(r) || r > 0.0F);
  }
}

TEST(ScanFilter, ServesTheUltrasonicRingToo) {
  // Five sensors 30 degrees apart on a ring of 0.3 m, ranges counted from its middle.
  ScanFilter f = filter({.mount_x = 0.0, .mount_z = 0.12, .joined = false});
  PlanarScan out;
  const ScanGeometry ring{radians(-60), radians(30), 0.45, 6.3};
  ASSERT_TRUE(f.filter(ring, std::vector<float>{2.0F, kInf, 1.5F, 4.0F, kInf}, {}, out).ok());
  ASSERT_EQ(out.ranges.size(), 5U);
  EXPECT_NEAR(out.ranges[0], 2.0F, 1e-5F);
  EXPECT_EQ(out.ranges[1], kInf);
  const double pitch = radians(10.0);
  ASSERT_TRUE(
      f.filter(ring, std::vector<float>{2.0F, kInf, 1.5F, 4.0F, kInf}, {pitch, 0.0}, out).ok());
  EXPECT_NEAR(out.ranges[2], 1.5 * std::cos(pitch) + 0.12 * std::sin(pitch), 1e-4);
  EXPECT_TRUE(std::isnan(out.ranges[3])) << "the floor at 2.3 m";
}

}  // namespace
}  // namespace usher::scan_filter
