#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/rendering/core/depth_sensor.hpp"
#include "simulation/rendering/core/light.hpp"
#include "simulation/rendering/core/painter.hpp"

namespace usher::rendering {
namespace {

using geometry::Point2;
using geometry::Pose3;

Prism slab(double x0, double y0, double x1, double y1, double bottom, double top,
           Material material = Material::kMatte) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, bottom, top, material};
}

Pose3 camera(double height, double down) {
  return {{0.0, 0.0, height}, geometry::from_roll_pitch_yaw(0.0, down, 0.0)};
}

Hits seen(const Model& model, const Pose3& pose, std::span<const Body> bodies = {}) {
  Renderer renderer = Renderer::make(model).value();
  renderer.place(bodies);
  Hits hits;
  renderer.render({}, pose, 9.0, hits);
  return hits;
}

std::size_t pixel(int column, int row) { return static_cast<std::size_t>(row * 512 + column); }

TEST(Renderer, GivesTheDepthAlongTheAxis) {
  Model model;
  model.prisms = {slab(2.0, -3.0, 2.2, 3.0, 0.0, 2.7)};
  const Hits hits = seen(model, camera(1.0, 0.0));
  for (const int column : {0, 100, 256, 511}) {
    EXPECT_NEAR(hits.depth[pixel(column, 211)], 2.0, 1e-4);
  }
  const double x = (0 - 255.5) / 365.46;
  EXPECT_NEAR(hits.cosine[pixel(0, 211)], 1.0 / std::hypot(1.0, x), 1e-3);
}

TEST(Renderer, SeesFloorCeilingAndUnderTables) {
  Model model;
  model.prisms = {slab(1.5, -0.6, 2.5, 0.6, 0.70, 0.74), slab(3.0, -3, 3.1, 3, 0.0, 2.7)};
  const Hits hits = seen(model, camera(0.9, 0.1));
  const auto height = [&](int column, int row) {
    const double y = (row - 211.5) / 365.46;
    const auto depth = static_cast<double>(hits.depth[pixel(column, row)]);
    return 0.9 - depth * (std::sin(0.1) + y * std::cos(0.1));
  };
  EXPECT_NEAR(height(256, 400), 0.0, 1e-3);   // the floor before the table
  EXPECT_NEAR(height(256, 212), 0.74, 1e-3);  // its top
  EXPECT_EQ(hits.material[pixel(256, 400)], static_cast<std::uint8_t>(Material::kVinyl));
  const int below = 290;  // under the top one sees the floor, or the wall
  EXPECT_LT(height(256, below), 0.6);
  EXPECT_GT(hits.depth[pixel(256, below)], 1.6F);
}

TEST(Renderer, GlassIsNotSeen) {
  Model model;
  model.prisms = {slab(1.0, -3, 1.02, 3, 0, 2.7, Material::kGlass), slab(3.0, -3, 3.1, 3, 0, 2.7)};
  EXPECT_NEAR(seen(model, camera(1.0, 0.0)).depth[pixel(256, 211)], 3.0, 1e-4);
}

TEST(Renderer, PitsOpenTheFloorAndStepsHaveNoFenceBetween) {
  Model model;
  model.prisms = {slab(2.0, -1, 2.3, 1, -0.17, 0.0), slab(2.3, -1, 2.6, 1, -0.34, 0.0)};
  const Hits hits = seen(model, camera(0.9, 0.3));
  std::vector<double> heights;
  for (int row = 423; row > 0; --row) {
    const double y = (row - 211.5) / 365.46;
    const auto depth = static_cast<double>(hits.depth[pixel(256, row)]);
    const double forward = depth * (std::cos(0.3) - y * std::sin(0.3));
    const double height = 0.9 - depth * (std::sin(0.3) + y * std::cos(0.3));
    if (forward > 1.0 && forward < 1.99) {
      EXPECT_NEAR(height, 0.0, 1e-3);
    }
    if (forward > 2.12 && forward < 2.29) {
      EXPECT_NEAR(height, -0.17, 1e-3) << forward;
    }
    if (forward > 2.301 && forward < 2.59) {
      EXPECT_LT(height, -0.16) << forward;
    }
    if (forward > 2.61 && forward < 4.0) {
      EXPECT_NEAR(height, 0.0, 1e-3);
    }
  }
}

TEST(Bodies, HaveTheirHeightAndStandOnTheFloor) {
  std::vector<Limb> limbs;
  for (const Posture posture : {Posture::kStanding, Posture::kWalking, Posture::kSitting,
                                Posture::kSquatting, Posture::kBending, Posture::kArmsOut}) {
    for (const double phase : {0.0, 1.0, 2.5, 4.0}) {
      make_limbs({.height = 1.8, .posture = posture, .phase = phase}, limbs);
      float top = 0.0F, bottom = 9.0F, side = 0.0F;
      for (const Limb& limb : limbs) {
        for (const auto& [p, r] :
             {std::pair{limb.from, limb.from_radius}, std::pair{limb.to, limb.to_radius}}) {
          top = std::max(top, p.z() + r);
          bottom = std::min(bottom, p.z() - r);
          side = std::max(side, std::abs(p.y()) + r);
        }
      }
      EXPECT_NEAR(bottom, 0.0, 0.17) << static_cast<int>(posture);
      const double slack = posture == Posture::kWalking ? 0.05 : 0.01;
      EXPECT_NEAR(top, top_of(posture, 1.8), slack) << static_cast<int>(posture);
      EXPECT_EQ(posture == Posture::kArmsOut, side > 0.7F);
    }
  }
}

TEST(Bodies, AreSeenWhereTheyAreAndByNumber) {
  const std::vector<Body> bodies{{.pose = {2.0, 0.5, 3.14}}, {.pose = {3.0, -0.6, 0.0}}};
  const Hits hits = seen({}, camera(1.0, 0.0), bodies);
  std::array<int, 2> counts{};
  for (std::size_t i = 0; i < hits.body.size(); ++i) {
    if (hits.body[i] < 0) continue;
    ++counts[static_cast<std::size_t>(hits.body[i])];
    const bool first = hits.body[i] == 0;
    EXPECT_NEAR(hits.depth[i], first ? 2.0 : 3.0, 0.35);
    EXPECT_EQ(i % 512 < 256, first);
  }
  EXPECT_GT(counts[0], 5000);
  EXPECT_GT(counts[1], 2000);
  EXPECT_GT(counts[0], counts[1]);
}

/// Each pixel shows what its own ray meets, however near and wherever in the image somebody is.
TEST(Bodies, AreSeenWholeAtTheEdgesAndBesideTheCamera) {
  const Lens lens;
  const Pose3 pose = camera(1.0, 0.1);
  Renderer renderer = Renderer::make({}).value();
  Hits hits;
  int seen = 0;
  for (const auto& [x, y] : {std::pair{2.0, 1.4},
                             {2.0, -1.5},
                             {0.3, 0.35},
                             {0.1, -0.4},
                             {0.0, 0.3},
                             {-0.6, 0.0},
                             {1.0, 0.0}}) {
    const Body body{.pose = {x, y, 2.0}, .posture = Posture::kArmsOut};
    renderer.place({&body, 1});
    renderer.render(lens, pose, 9.0, hits);
    for (int row = 0; row < lens.height; row += 5) {
      for (int column = 0; column < lens.width; column += 5) {
        const Eigen::Vector3d along =
            pose.rotation *
            Eigen::Vector3d(1.0, (lens.cx - column) / lens.fx, (lens.cy - row) / lens.fy);
        const double length = along.norm();
        const double met = renderer.distance(pose.translation, along / length, 9.0 * length);
        const auto shown = static_cast<double>(hits.depth[pixel(column, row)]);
        ASSERT_NEAR(shown, std::isfinite(met) ? met / length : 0.0, 1e-3)
            << "at " << column << ", " << row << " of who is at " << x << ", " << y;
        seen += hits.body[pixel(column, row)] == 0;
      }
    }
  }
  EXPECT_GT(seen, 2000);
}

/// The color of the pixel that shows somebody 3 m ahead at a height [m], standing or as told.
std::array<int, 3> color_at(const Body& body, double height, const Gains& gains = {1, 1, 1}) {
  const Hits hits = seen({}, camera(1.0, 0.0), {&body, 1});
  Painter painter({});
  std::vector<std::uint8_t> rgb;
  painter.paint(hits, {}, camera(1.0, 0.0), {&body, 1}, {&gains, 1}, rgb);
  const auto row = static_cast<int>(211.5 + 365.46 * (1.0 - height) / 2.9);
  int column = 256;  // legs stand beside the middle
  while (column < 300 && hits.body[pixel(column, row)] < 0) ++column;
  EXPECT_EQ(hits.body[pixel(column, row)], 0);
  const auto i = 3 * pixel(column, row);
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

TEST(Painter, DressesPeopleFromTheHipsUpAndBelow) {
  Body body{.pose = {3.0, 0.0, geometry::kPi}, .height = 1.8};
  body.clothes = Clothes{{200, 40, 40}, {40, 60, 160}};
  const auto shirt = color_at(body, 1.3), trousers = color_at(body, 0.6);
  EXPECT_GT(shirt[0], 130);
  EXPECT_LT(shirt[2], 60);
  EXPECT_GT(trousers[2], 90);
  EXPECT_LT(trousers[0], 60);
  body.posture = Posture::kSitting;
  const auto knees = color_at(body, 0.5);
  EXPECT_GT(knees[2], knees[0]) << "the trousers of who sits";
  body.posture = Posture::kStanding;
  const auto dark = color_at(body, 1.3, {0.3, 0.3, 0.3}), warm = color_at(body, 1.3, {1.2, 1, 0.8});
  EXPECT_LT(dark[0], shirt[0] - 40);
  EXPECT_GT(warm[0], shirt[0]);
  EXPECT_LE(warm[2], shirt[2]);
}

TEST(Lighting, IsOfThePlaceAndChangesSmoothly) {
  const Lighting light(3), same(3), other(4);
  double darkest = 9.0, brightest = 0.0, step = 0.0;
  for (double x = -30.0; x < 30.0; x += 0.1) {
    const Gains here = light.at({x, 5.0});
    EXPECT_EQ(here, same.at({x, 5.0}));
    step = std::max(step, std::abs(here[1] / light.at({x + 0.1, 5.0})[1] - 1.0));
    darkest = std::min(darkest, here[1]), brightest = std::max(brightest, here[1]);
  }
  EXPECT_GT(brightest / darkest, 1.8) << "a window and a corridor";
  EXPECT_LT(step, 0.1);
  EXPECT_NE(light.at({1.0, 1.0}), other.at({1.0, 1.0}));
  EXPECT_EQ(light.at({HUGE_VAL, 0.0}), (Gains{1.0, 1.0, 1.0}));
}

TEST(ColorCamera, MakesUpForMostOfTheLightAndDrifts) {
  const Lighting light(3);
  ColorCamera camera(1), same(1);
  const Point2 place(4.0, 4.0), dark(8.0, 0.0);
  const double bare = light.at(place)[1] / light.at(dark)[1];
  const double seen = camera.gains(light, place, place)[1] / camera.gains(light, dark, dark)[1];
  EXPECT_LT(std::abs(std::log(seen)), 0.5 * std::abs(std::log(bare)));
  const Gains before = camera.gains(light, place, place);
  for (int i = 0; i < 100; ++i) camera.advance(0.2), same.advance(0.2);
  EXPECT_NE(camera.gains(light, place, place), before);
  EXPECT_EQ(camera.gains(light, place, place), same.gains(light, place, place));
}

TEST(Clothes, AreMostlyDarkAndOftenOfTheSameColor) {
  Random random(1);
  int dark = 0, colored = 0;
  for (int i = 0; i < 1000; ++i) {
    const Clothes clothes = draw_clothes(random);
    const auto [least, most] = std::ranges::minmax(clothes.upper);
    dark += most < 90;
    colored += most - least > 60;
  }
  EXPECT_GT(dark, 350);
  EXPECT_GT(colored, 120);
  EXPECT_LT(colored, 400);
}

TEST(DepthSensor, NoiseGrowsAsTheModelsSay) {
  for (const bool v2 : {true, false}) {
    for (const double distance : {1.0, 2.0, 4.0}) {
      Model model;
      model.prisms = {slab(distance, -9.0, distance + 0.1, 9.0, 0.0, 2.7)};
      Renderer renderer = Renderer::make(model).value();
      DepthSensor sensor(v2 ? kinect_v2() : kinect_v1(), 3);
      std::vector<std::uint16_t> image;
      sensor.measure(renderer, camera(1.3, 0.0), 0.0, image);
      const int width = sensor.config().lens.width, height = sensor.config().lens.height;
      double sum = 0.0, squares = 0.0;
      int count = 0, holes = 0;
      for (int row = height / 2 - 20; row < height / 2 + 20; ++row) {
        for (int column = width / 2 - 40; column < width / 2 + 40; ++column) {
          const int value = image[static_cast<std::size_t>(row * width + column)];
          if (value == 0) {
            ++holes;
            continue;
          }
          const double off = 1e-3 * value - distance;
          sum += off, squares += off * off, ++count;
        }
      }
      const double z = distance;
      const double expected =
          v2 ? 1e-3 * (1.5 - 0.5 * z + 0.3 * z * z) : 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
      const double deviation = std::sqrt(squares / count);
      EXPECT_NEAR(sum / count, 0.0, 0.25 * expected + 0.0008) << v2 << " " << distance;
      EXPECT_GT(deviation, 0.85 * expected) << v2 << " " << distance;
      EXPECT_LT(deviation, (v2 ? 1.2 : 1.5) * expected + 0.0004) << v2 << " " << distance;
      EXPECT_GT(holes, 3200 / 200);
      EXPECT_LT(holes, 3200 / 10);
    }
  }
}

TEST(DepthSensor, VinylMirrorsInPatchesAndBurstsSpoilTheImage) {
  Model model;
  model.prisms = {slab(4.0, -9.0, 4.1, 9.0, 0.0, 2.7)};
  Renderer renderer = Renderer::make(model).value();
  DepthSensor sensor(kinect_v2(), 5);
  std::vector<std::uint16_t> calm, spoilt;
  sensor.measure(renderer, camera(0.9, 0.09), 0.0, calm);
  sensor.measure(renderer, camera(0.9, 0.09), 1.0, spoilt);
  int mirrored = 0, near = 0;
  for (std::size_t i = 0; i < calm.size(); ++i) {
    const float truth = 1e3F * sensor.truth().depth[i];
    mirrored += calm[i] > truth + 150.0F;
    near += spoilt[i] > 0 && static_cast<float>(spoilt[i]) < truth - 300.0F;
  }
  EXPECT_GT(mirrored, 500);
  EXPECT_LT(mirrored, 30000);
  EXPECT_GT(near, 2000);
}

TEST(DepthSensor, NothingFliesBetweenTheEndOfARowAndTheBeginOfTheNext) {
  Model model;  // the image's left half is far, its right half near
  model.prisms = {slab(4.0, 0.0, 4.2, 9.0, 0.0, 2.7), slab(2.0, -9.0, 2.2, 0.0, 0.0, 2.7)};
  Renderer renderer = Renderer::make(model).value();
  DepthSensor sensor({}, 3);
  std::vector<std::uint16_t> image;
  sensor.measure(renderer, camera(1.0, 0.0), 0.0, image);
  for (int row = 150; row < 280; ++row) {
    const std::uint16_t left = image[pixel(0, row)];
    EXPECT_TRUE(left == 0 || std::abs(left - 4000) < 60) << row << ": " << left;
  }
}

TEST(DepthSensor, SameSeedSameImages) {
  std::vector<std::uint16_t> first, second;
  for (auto* image : {&first, &second}) {
    Renderer renderer = Renderer::make({}).value();
    renderer.place(std::vector<Body>{{.pose = {2, 0, 0}}});
    DepthSensor sensor(kinect_v2(), 7);
    for (int i = 0; i < 2; ++i) sensor.measure(renderer, camera(0.9, 0.1), 0.3, *image);
  }
  EXPECT_EQ(first, second);
}

TEST(DepthSensor, StructuredLightHasAShadowBesideNearThings) {
  Model model;
  model.prisms = {slab(1.0, -0.2, 1.1, 0.2, 0.0, 2.0), slab(3.0, -9, 3.1, 9, 0.0, 2.7)};
  Renderer renderer = Renderer::make(model).value();
  DepthSensor sensor(kinect_v1(), 5);
  std::vector<std::uint16_t> image;
  sensor.measure(renderer, camera(1.0, 0.0), 0.0, image);
  int holes = 0;
  const int row = 240;
  for (int column = 150; column < 490; ++column)
    holes += image[std::size_t(row * 640 + column)] == 0;
  // base f (1/1 m - 1/3 m) = 29 pixels, and the dropouts
  EXPECT_GT(holes, 25);
  EXPECT_LT(holes, 60);
}

TEST(Renderer, RefusesWhatCannotBe) {
  Model model;
  model.prisms = {{{{0, 0}, {1, 0}}, 0.0, 1.0}};
  EXPECT_THAT(Renderer::make(model).error(), testing::HasSubstr("corners"));
  model.prisms = {slab(0, 0, 1, 1, 1.0, 0.5)};
  EXPECT_THAT(Renderer::make(model).error(), testing::HasSubstr("bottom"));
  model.prisms = {slab(0, 0, std::numeric_limits<double>::infinity(), 1, 0.0, 0.5)};
  EXPECT_THAT(Renderer::make(model).error(), testing::HasSubstr("finite"));
}

}  // namespace
}  // namespace usher::rendering
