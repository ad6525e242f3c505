// People of every posture, in pairs and groups, and before a robot that drives and leans: whom the
// people detector finds in rendered images, and whom the model says that it would find.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "simulation/people_chain.hpp"

namespace usher::world {
namespace {

using rendering::Posture;

constexpr int kPlaces = 12;
constexpr int kSettle = 30;  // steps until the tilt servo stands
constexpr int kImages = 2;   // at each place
constexpr int kEvery = 7;    // steps between them

using People = std::vector<PersonPlan>;

std::string hall_with(const People& people) {
  std::string text = R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[-9, -7], [9, -7], [9, 7], [-9, 7], [-9, -7]]}
furniture:
  - {name: cupboard, box: [8.5, 6.5, 0, 0.5, 0.5], height: [0, 1.8]}
)";
  for (const PersonPlan& one : people) {
    if (one.posture != Posture::kSitting) continue;
    text += "  - {name: seat of " + one.name + ", chair: [" + std::to_string(one.start.x()) + ", " +
            std::to_string(one.start.y()) + ", " + std::to_string(one.yaw) + "]}\n";
  }
  return text;
}

void add(People& people, Random& random, const Point2& place, double yaw, Posture posture) {
  people.push_back({.name = "p" + std::to_string(people.size()), .start = place, .yaw = yaw});
  people.back().posture = posture;
  people.back().height = random.uniform(1.5, 1.95);
}

/// Before a camera, inside of its image's columns.
Point2 somewhere(Random& random, double nearest, double farthest) {
  const double forward = random.uniform(nearest, farthest), side = 0.6 * forward - 0.3;
  return {forward, random.uniform(-side, side)};
}

/// Three who have nothing to do with each other.
People apart(Random& random, Posture posture, double nearest) {
  People people;
  for (int tries = 0; tries < 40 && people.size() < 3; ++tries) {
    const Point2 place = somewhere(random, nearest, nearest + 4.4);
    if (std::ranges::all_of(people,
                            [&](const auto& one) { return (one.start - place).norm() > 1.3; }))
      add(people, random, place, random.uniform(-3.1, 3.1), posture);
  }
  return people;
}

/// So many who stand round a point and look at it.
People round(Random& random, int count, double radius) {
  People people;
  const Point2 middle = somewhere(random, 2.2, 4.6);
  const double turn = random.uniform(-3.1, 3.1);
  for (int i = 0; i < count; ++i) {
    const double angle = turn + 2.0 * geometry::kPi * i / count;
    add(people, random, middle + radius * Point2(std::cos(angle), std::sin(angle)),
        geometry::normalized(angle + geometry::kPi), Posture::kStanding);
  }
  return people;
}

/// What is said of heights.
struct Tops {
  int people = 0, hidden_by_pixels = 0, hidden_by_model = 0, measured = 0;
  double pixels = 0.0, model = 0.0;  // off from the highest point of the body

  void take(const people_detector::Sighting& by_pixels, const ModelledSighting& by_model,
            double truth) {
    if (!(by_pixels.height > 0.0 && by_model.height > 0.0)) return;
    ++people;
    hidden_by_pixels += by_pixels.head_hidden, hidden_by_model += by_model.head_hidden;
    if (by_pixels.head_hidden || by_model.head_hidden) return;
    ++measured;
    pixels += by_pixels.height - truth, model += by_model.height - truth;
  }
};

struct Comparison {
  Agreement found;
  Tops tops;
  double steepest = 0.0;  // [rad]

  void take(const World& world, const Looks& looks) {
    found.take(world, looks);
    steepest = std::max(steepest, std::abs(world.base().truth().pitch));
    for (const Person& person : world.people()) {
      const Point2 where = inverse(looks.origin) * person.position;
      const auto* by_pixels = nearest(looks.pixels, where);
      const auto* by_model = nearest(looks.modelled, where);
      if (by_pixels != nullptr && by_model != nullptr)
        tops.take(*by_pixels, *by_model, rendering::top_of(person.posture, person.height));
    }
  }
};

struct Case {
  const char* name;
  std::function<People(Random&)> draw;
  bool drives = false;
};

/// Stands, or sets off towards them and brakes.
void run(const Case& each, bool backward, World& world, PeopleChain& chain, Comparison& all) {
  const int every = each.drives ? 3 * kEvery : kEvery;
  const int end = kSettle + (each.drives ? 10 : kImages) * every;
  Looks looks;
  for (int step = 1; step <= end; ++step) {
    if (each.drives && step > kSettle)
      world.base().command({step < kSettle + 120 ? (backward ? -1.0 : 1.0) : 0.0, 0.0});
    chain.step(world);
    if (step <= kSettle || (step - kSettle) % every != 0) continue;
    chain.look(world, world.base().readings().pitch, looks);
    all.take(world, looks);
  }
}

Comparison compare(const Case& each, bool backward) {
  PeopleChain chain(backward);
  Random random(7);
  Comparison all;
  for (int place = 0; place < kPlaces; ++place) {
    People people = each.draw(random);
    for (PersonPlan& one : people) {
      if (backward) one.start = -one.start, one.yaw = geometry::normalized(one.yaw + geometry::kPi);
    }
    const auto hall = parse_building(hall_with(people), "hall.yaml").value();
    World world({.moves_people = false}, hall, people, {0.0, 0.0, 0.0}, random.next());
    const std::uint64_t camera_seed = random.next();
    chain.enter(camera_seed, random.next());
    all.found.move_on();
    run(each, backward, world, chain, all);
  }
  return all;
}

void print(const Case& each, bool backward, const Comparison& all) {
  all.found.print(std::string(each.name) + (backward ? ", rear" : ", front"));
  const Tops& tops = all.tops;
  std::printf(
      "  up to %.1f deg; tops of %d: hidden by pixels %d, by the model %d; of %d off by "
      "%.3f, %.3f m\n",
      geometry::degrees(all.steepest), tops.people, tops.hidden_by_pixels, tops.hidden_by_model,
      tops.measured, tops.pixels / tops.measured, tops.model / tops.measured);
}

Case people_who(const char* name, Posture posture) {
  return {name, [posture](Random& random) { return apart(random, posture, 1.2); }};
}
Case group_of(const char* name, int count, double nearest, double farthest) {
  return {name, [=](Random& random) {
            const double radius = random.uniform(nearest, farthest);
            return round(random, count, radius);
          }};
}

const Case kCases[] = {
    people_who("standing", Posture::kStanding),
    people_who("sitting", Posture::kSitting),
    people_who("squatting", Posture::kSquatting),
    people_who("bending", Posture::kBending),
    people_who("with arms out", Posture::kArmsOut),
    group_of("two close together", 2, 0.23, 0.35),
    group_of("three", 3, 0.35, 0.6),
    group_of("four", 4, 0.45, 0.7),
    {"before a robot that drives",
     [](Random& random) { return apart(random, Posture::kStanding, 2.4); }, true},
};

class PeopleModelOf : public testing::TestWithParam<std::tuple<Case, bool>> {};

TEST_P(PeopleModelOf, AgreesWithTheRenderedChain) {
  const auto& [each, backward] = GetParam();
  const Comparison all = compare(each, backward);
  print(each, backward, all);
  const Found &pixels = all.found.pixels, &modelled = all.found.modelled;
  // The rear camera finds fewer who squat or bend than the model says: by up to 0.153.
  EXPECT_NEAR(modelled.recall(), pixels.recall(), 0.16);
  EXPECT_LE(pixels.false_alarms, 2);
  EXPECT_LT(std::abs(all.tops.model) / all.tops.measured, 0.06);
  EXPECT_LT(std::abs(all.tops.pixels) / all.tops.measured, 0.12);
  EXPECT_NEAR(modelled.bias(), pixels.bias(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Cameras, PeopleModelOf,
                         testing::Combine(testing::ValuesIn(kCases), testing::Bool()));

}  // namespace
}  // namespace usher::world
