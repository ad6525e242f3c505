// Whom the people detector finds in rendered images of the office, and whom the model says that it
// would find there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "simulation/people_chain.hpp"

namespace usher::world {
namespace {

constexpr const char* kOffice = USHER_SOURCE_DIR "/config/sites/office/world.yaml";
constexpr int kPlaces = 60;
constexpr int kImages = 4;  // at each

/// How the two show the clothes of those whom both found.
struct Colors {
  int people = 0, by_pixels = 0, by_model = 0, both = 0, agree = 0;
  std::array<double, 3> off{};  // of the model from the pixels: L*, a*, b*

  void take(const imaging::ClothesColor& pixels, const imaging::ClothesColor& model) {
    ++people;
    by_pixels += pixels.known();
    by_model += model.known();
    if (!pixels.known() || !model.known()) return;
    ++both;
    const std::array<double, 3> away{model.color.lightness - pixels.color.lightness,
                                     model.color.a - pixels.color.a,
                                     model.color.b - pixels.color.b};
    for (std::size_t k = 0; k < 3; ++k) off[k] += away[k];
    agree += std::abs(away[0]) < 8.0 && std::abs(away[1]) < 4.0 && std::abs(away[2]) < 4.0;
  }
  double bias(std::size_t k) const { return off[k] / both; }
};

/// What the two say of their heights.
struct Heights {
  int people = 0, hidden_by_pixels = 0, hidden_by_model = 0, hidden = 0;
  int measured = 0;
  double off = 0.0, squares = 0.0;  // of pixels from the true height

  void take(const people_detector::Sighting& pixels, const ModelledSighting& model, double truth) {
    if (!(pixels.height > 0.0 && model.height > 0.0)) return;
    ++people;
    hidden_by_pixels += pixels.head_hidden;
    hidden_by_model += model.head_hidden;
    hidden += pixels.head_hidden && model.head_hidden;
    if (pixels.head_hidden || model.head_hidden) return;
    ++measured;
    off += pixels.height - truth, squares += (pixels.height - truth) * (pixels.height - truth);
  }
  double bias() const { return off / measured; }
  double sigma() const { return std::sqrt(squares / measured - bias() * bias()); }
};

/// A robot somewhere in the office, people around it.
std::optional<World> somewhere(Random& random, const Building& building, bool behind) {
  const std::vector<Pose2> places{{3.0, 5.0, 0.2},   {12.0, 10.0, 0.0}, {26.0, 4.5, 0.5},
                                  {27.9, 14.0, 1.6}, {14.0, 14.0, 2.0}, {20.0, 7.0, -0.7}};
  Pose2 robot = places[random.below(places.size())];
  robot.yaw += random.uniform(-0.7, 0.7);
  std::vector<PersonPlan> people;
  const auto count = 1 + random.below(4);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double forward = random.uniform(0.8, 6.0);
    const Pose2 looking = behind ? robot * Pose2{0.0, 0.0, geometry::kPi} : robot;
    const Point2 place = looking * Point2(forward, random.uniform(-0.7, 0.7) * forward);
    PersonPlan plan{.name = std::string(1, static_cast<char>('a' + i)),
                    .start = place,
                    .yaw = random.uniform(-3.1, 3.1)};
    plan.height = random.uniform(1.5, 1.95);
    people.push_back(plan);
  }
  World world({}, building, people, robot, random.next());
  for (const Person& person : world.people()) {
    if (world.scene().nearest(person.position, 1.7, 0.3).distance < 0.25) return std::nullopt;
  }
  return world;
}

/// What a camera's pixels and its model say, compared.
struct Comparison {
  Colors upper, legs;
  Heights heights;
  Agreement found;

  void take(const World& world, const Looks& looks) {
    found.take(world, looks);
    compare_looks(world, looks);
  }

 private:
  void compare_looks(const World& world, const Looks& looks) {
    for (const Person& person : world.people()) {
      // Of two who are close to each other one sighting may be either.
      if (std::ranges::any_of(world.people(), [&](const Person& other) {
            return &other != &person && (other.position - person.position).norm() < 2.0 * kSame;
          }))
        continue;
      const Point2 where = inverse(looks.origin) * person.position;
      const auto* by_pixels = nearest(looks.pixels, where);
      const auto* by_model = nearest(looks.modelled, where);
      if (by_pixels == nullptr || by_model == nullptr) continue;
      upper.take(by_pixels->appearance.upper, by_model->appearance.upper);
      legs.take(by_pixels->appearance.legs, by_model->appearance.legs);
      heights.take(*by_pixels, *by_model, person.height);
    }
  }
};

Comparison compare(bool backward) {
  const auto building = load_building(kOffice).value();
  PeopleChain chain(backward);
  Random random(7);
  Comparison comparison;
  Looks looks;
  for (int place = 0; place < kPlaces;) {
    auto world = somewhere(random, building, backward);
    if (!world) continue;
    ++place;
    const std::uint64_t camera_seed = random.next();
    chain.enter(camera_seed, random.next());
    comparison.found.move_on();
    for (int step = 0; step < 30 + 7 * kImages; ++step) {
      chain.step(*world);
      if (step < 30 || step % 7 != 0) continue;
      chain.look(*world, world->base().truth().pitch, looks);
      comparison.take(*world, looks);
    }
  }
  return comparison;
}

void expect_alike(const Colors& part, const char* name, bool upper_in_rear) {
  std::printf(
      "%s: known of %d by pixels %d, by the model %d, both %d, who agree %d; off by %.1f, %.1f, "
      "%.1f\n",
      name, part.people, part.by_pixels, part.by_model, part.both, part.agree, part.bias(0),
      part.bias(1), part.bias(2));
  EXPECT_NEAR(part.by_model, part.by_pixels, 0.1 * part.people);
  EXPECT_GT(part.both, 8 * std::min(part.by_pixels, part.by_model) / 10);
  // Upper bodies in the rear image, cut off above, come out redder than the model says.
  EXPECT_GT(part.agree, (upper_in_rear ? 8 : 9) * part.both / 10);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(part.bias(k)), 2.0);
}

void expect_alike(const Heights& heights) {
  std::printf(
      "heights: of %d people heads hidden by pixels %d, by the model %d, both %d; of %d "
      "off by %.3f +- %.3f m\n",
      heights.people, heights.hidden_by_pixels, heights.hidden_by_model, heights.hidden,
      heights.measured, heights.bias(), heights.sigma());
  ASSERT_GT(heights.measured, 0);
  EXPECT_LT(std::abs(heights.bias()), 0.06);
  EXPECT_LT(heights.sigma(), 0.1);
  EXPECT_NEAR(heights.hidden_by_model, heights.hidden_by_pixels, 0.05 * heights.people);
}

class PeopleModelOf : public testing::TestWithParam<bool> {};

TEST_P(PeopleModelOf, AgreesWithTheRenderedChain) {
  const bool backward = GetParam();
  const Comparison all = compare(backward);
  const Found &pixels = all.found.pixels, &modelled = all.found.modelled;
  all.found.print(backward ? "rear" : "front");
  expect_alike(all.upper, "upper", backward);
  expect_alike(all.legs, "legs", false);
  expect_alike(all.heights);
  // The model knows no false alarms; those of the pixels shall not become more.
  EXPECT_LE(pixels.false_alarms, backward ? 8 : 2);
  EXPECT_EQ(modelled.false_alarms, 0);
  EXPECT_NEAR(modelled.recall(), pixels.recall(), 0.05);
  EXPECT_GT(all.found.same, 85 * all.found.either / 100);
  EXPECT_NEAR(modelled.bias(), pixels.bias(), 0.05);
  EXPECT_NEAR(modelled.along_sigma(), pixels.along_sigma(), 0.04);
  EXPECT_NEAR(modelled.across_sigma(), pixels.across_sigma(), 0.03);
}

INSTANTIATE_TEST_SUITE_P(KinectAndRearCamera, PeopleModelOf, testing::Bool());

/// How unlike somebody looks to himself and to others in the light of a building, to the camera
/// that learnt him and to another one: what imaging::kAlike and kAnother are made for.
TEST(PeopleModel, PeopleLookLikeThemselvesInAnyLight) {
  constexpr int kPeople = 400;
  Random random(11);
  std::array<int, 2> alike{}, another{}, others_alike{}, others_another{};
  for (int i = 0; i < kPeople; ++i) {
    const rendering::Lighting light(random.next());
    std::array<rendering::ColorCamera, 2> cameras{rendering::ColorCamera(random.next()),
                                                  rendering::ColorCamera(random.next())};
    const auto anywhere = [&] { return Point2(random.uniform(0, 30), random.uniform(0, 20)); };
    const auto seen = [&](const rendering::Clothes& clothes, std::size_t camera) {
      const Point2 place = anywhere();
      const Point2 robot = place + Point2(random.uniform(-3, 3), random.uniform(-3, 3));
      const auto gains = cameras[camera].gains(light, place, robot);
      const auto color = [&](const rendering::Clothes::Color& part) {
        std::array<double, 3> linear{};
        for (std::size_t k = 0; k < 3; ++k)
          linear[k] = std::min(1.0, 0.85 * gains[k] * imaging::to_linear(part[k]));
        return imaging::ClothesColor{imaging::to_lab(linear), 5};
      };
      imaging::Appearances appearances;
      appearances[camera] = {color(clothes.upper), color(clothes.legs)};
      return appearances;
    };
    const auto one = rendering::draw_clothes(random), other = rendering::draw_clothes(random);
    const auto learnt = seen(one, 0);
    for (const std::size_t camera : {0U, 1U}) {
      cameras[camera].advance(60.0);
      const double own = imaging::unlikeness(learnt, seen(one, camera)).value();
      const double of_others = imaging::unlikeness(learnt, seen(other, camera)).value();
      alike[camera] += own < imaging::kAlike;
      another[camera] += own > imaging::kAnother;
      others_alike[camera] += of_others < imaging::kAlike;
      others_another[camera] += of_others > imaging::kAnother;
    }
  }
  for (const std::size_t camera : {0U, 1U}) {
    std::printf("%s camera: himself alike %.3f, another %.3f; others alike %.3f, another %.3f\n",
                camera == 0 ? "the same" : "the other", double(alike[camera]) / kPeople,
                double(another[camera]) / kPeople, double(others_alike[camera]) / kPeople,
                double(others_another[camera]) / kPeople);
    EXPECT_GT(alike[camera], 0.9 * kPeople);
    EXPECT_LE(another[camera], 0.01 * kPeople);
    EXPECT_LT(others_alike[camera], 0.3 * kPeople);
    EXPECT_GT(others_another[camera], 0.5 * kPeople);
  }
}

}  // namespace
}  // namespace usher::world
