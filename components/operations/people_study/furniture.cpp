#include "operations/people_study/furniture.hpp"

#include <cmath>

namespace usher::people_study {

using geometry::Point2;
using geometry::Pose2;
using rendering::Model;

namespace {

constexpr double kSeat = 0.45;  // [m]

Pose2 at(const Pose2& pose, double x, double y) { return pose * Pose2{x, y, 0.0}; }

void add_legs(Model& model, const Pose2& pose, double depth, double width, double top) {
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5})
      add_box(model, at(pose, x * depth, y * width), 0.04, 0.04, 0.0, top);
  }
}

void add_coat_stand(Model& model, const Point2& place) {
  add_pole(model, place, 0.03, 1.75);
  for (int hook = 0; hook < 6; ++hook) {
    const Pose2 arm{place.x(), place.y(), hook * geometry::kPi / 3.0};
    add_box(model, at(arm, 0.1, 0.0), 0.2, 0.03, 1.6 + 0.02 * hook, 1.65 + 0.02 * hook);
  }
}

void add_desk(Model& model, const Pose2& pose, Random& random) {
  add_table(model, pose, random.uniform(1.0, 1.8), random.uniform(0.6, 0.9));
  if (random.uniform() < 0.5)
    add_box(model, pose, 0.05, random.uniform(0.45, 0.7), 0.78, random.uniform(1.1, 1.3));
}

}  // namespace

Model empty_room(double wall) {
  Model model;
  add_box(model, {wall, 0.0, 0.0}, 0.1, 1.64 * wall, 0.0, 2.7);
  return model;
}

Model random_room(Random& random) {
  Model model;
  const double far = random.uniform(3.0, 9.0), turn = random.gaussian(0.0, 0.25);
  const double left = random.uniform(1.2, 5.0), right = random.uniform(1.2, 5.0);
  const Pose2 room{0.0, 0.0, turn};
  add_box(model, at(room, far, 0.0), 0.1, 14.0, 0.0, 2.7);
  add_box(model, at(room, 5.0, left), 12.0, 0.1, 0.0, 2.7);
  add_box(model, at(room, 5.0, -right), 12.0, 0.1, 0.0, 2.7);
  for (auto pilasters = random.below(4); pilasters > 0; --pilasters) {
    const double y = random.uniform(-right, left), width = random.uniform(0.15, 1.2);
    add_box(model, at(room, far - random.uniform(0.05, 0.5), y), random.uniform(0.1, 0.6), width,
            0.0, 2.7);
  }
  return model;
}

void add_box(Model& model, const Pose2& pose, double depth, double width, double bottom,
             double top) {
  rendering::Prism prism;
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    prism.outline.push_back(pose * Point2(x * depth, y * width));
  prism.bottom = bottom;
  prism.top = top;
  model.prisms.push_back(std::move(prism));
}

void add_pole(Model& model, const Point2& place, double radius, double top, double bottom) {
  constexpr int kCorners = 16;
  rendering::Prism prism;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * geometry::kPi * i / kCorners;
    prism.outline.emplace_back(place + radius * Point2(std::cos(angle), std::sin(angle)));
  }
  prism.bottom = bottom;
  prism.top = top;
  model.prisms.push_back(std::move(prism));
}

void add_chair(Model& model, const Pose2& pose, double back) {
  add_box(model, at(pose, 0.12, 0.0), 0.45, 0.45, kSeat - 0.06, kSeat);
  add_box(model, at(pose, -0.16, 0.0), 0.05, 0.42, kSeat, kSeat + back);
  add_legs(model, at(pose, 0.12, 0.0), 0.4, 0.4, kSeat - 0.06);
}

void add_wheelchair(Model& model, const Pose2& pose) {
  add_box(model, at(pose, 0.12, 0.0), 0.45, 0.45, kSeat - 0.06, kSeat);
  add_box(model, at(pose, -0.16, 0.0), 0.04, 0.42, kSeat, 0.95);
  for (const double side : {-0.3, 0.3}) add_box(model, at(pose, 0.0, side), 0.56, 0.04, 0.0, 0.58);
  add_box(model, at(pose, 0.5, 0.0), 0.15, 0.35, 0.08, 0.12);
}

void add_table(Model& model, const Pose2& pose, double width, double depth) {
  add_box(model, pose, depth, width, 0.70, 0.74);
  add_legs(model, pose, depth - 0.08, width - 0.08, 0.70);
}

void add_railing(Model& model, const Pose2& pose, double width) {
  add_box(model, pose, 0.04, width, 0.95, 1.0);
  constexpr double kApart = 0.25;  // [m]
  for (int i = 0; i * kApart <= width; ++i)
    add_box(model, at(pose, 0.0, i * kApart - 0.5 * width), 0.03, 0.03, 0.0, 0.95);
}

void add_lamp(Model& model, const Point2& place) {
  add_pole(model, place, 0.15, 0.03);
  add_pole(model, place, 0.015, 1.4);
  add_pole(model, place, 0.2, 1.7, 1.4);
}

void add_any(Model& model, Random& random, const Point2& place) {
  const Pose2 pose{place.x(), place.y(), random.uniform(-3.14, 3.14)};
  switch (random.below(12)) {
    case 0:
      return add_chair(model, pose, random.uniform(0.35, 0.7));
    case 1:
      return add_desk(model, pose, random);
    case 2:
      return add_box(model, pose, random.uniform(0.25, 0.6), random.uniform(0.4, 1.2), 0.0,
                     random.uniform(0.6, 2.2));
    case 3:
      return add_box(model, pose, random.uniform(0.02, 0.06), random.uniform(0.3, 1.2), 0.0,
                     random.uniform(1.0, 2.2));
    case 4:
      return add_pole(model, place, random.uniform(0.02, 0.1), random.uniform(1.0, 2.7));
    case 5:
      return add_pole(model, place, random.uniform(0.15, 0.35), random.uniform(0.5, 1.3));
    case 6:
      return add_pole(model, place, random.uniform(0.12, 0.35), 2.7);
    case 7:
      return add_lamp(model, place);
    case 8:
      return add_railing(model, pose, random.uniform(0.8, 2.5));
    case 9:
      return add_coat_stand(model, place);
    case 10:
      return add_wheelchair(model, pose);
    default:
      add_box(model, pose, random.uniform(0.3, 0.6), random.uniform(0.3, 0.6), 0.0,
              random.uniform(0.3, 0.9));
      add_box(model, at(pose, random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)),
              random.uniform(0.15, 0.5), random.uniform(0.15, 0.5), 0.3, random.uniform(0.9, 1.9));
  }
}

}  // namespace usher::people_study
