#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "perception/people_detector/core/clothes.hpp"
#include "perception/people_detector/core/depth_detector.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "simulation/rendering/core/painter.hpp"
#include "simulation/world/core/people_model.hpp"

namespace usher::world {

constexpr double kSame = 0.5;   // [m]
constexpr double kReach = 6.0;  // [m]

/// Who is found at one moment, seen from the camera's place on the floor.
struct Looks {
  Pose2 origin;
  std::vector<people_detector::Sighting> pixels;
  std::vector<ModelledSighting> modelled;
};

/// One of MARVIN's depth cameras with depth pipeline and people detector behind its rendered
/// images, and beside them the model of all that.
class PeopleChain {
 public:
  explicit PeopleChain(bool backward) : backward_(backward) {
    if (backward) {
      config_.sensor = rendering::rear_camera();
      config_.mount = {.x = -0.2, .z = 0.9, .yaw = geometry::kPi, .pitch = kRearDown};
    }
    const auto intrinsics = rendering::intrinsics_of(config_.sensor.lens);
    pipeline_.emplace(depth_pipeline::DepthPipeline::make(intrinsics, {.origin = 0.2}).value());
    detector_.emplace(people_detector::DepthDetector::make(intrinsics, {}).value());
    clothes_.emplace(intrinsics);
  }

  /// Another world.
  void enter(std::uint64_t camera_seed, std::uint64_t model_seed) {
    camera_.emplace(config_, camera_seed);
    camera_->set_tilt(backward_ ? 0.0 : geometry::radians(-5.0));
    renderer_.emplace();
    PeopleModelConfig model;
    model.lens = config_.sensor.lens;
    model_.emplace(model, model_seed);
  }
  void step(World& world) {
    world.step();
    camera_->step(world.base().truth());
  }
  double burst() const { return camera_->burst(); }

  /// @param pitch [rad] of the base, as the pipeline knows it
  void look(const World& world, double pitch, Looks& looks) {
    ASSERT_TRUE(renderer_->update(world));
    camera_->measure(camera_->exposure(world), renderer_->renderer(), millimeters_);
    const auto& lens = config_.sensor.lens;
    const depth_pipeline::Mount mount{
        .x = config_.mount.x, .z = config_.mount.z, .backward = backward_};
    const auto pose =
        depth_pipeline::camera_pose(mount, backward_ ? -kRearDown : camera_->tilt(), pitch);
    const auto view = pipeline_->process({lens.width, lens.height, millimeters_}, pose).value();
    const imaging::DepthImage image{lens.width, lens.height, view.processed};
    const people_detector::View camera{pose.height, pose.down, 0.0};
    const auto found = detector_->find(image, camera).value();
    model_->find(world, *camera_, true, looks.modelled);
    const Pose2 base = world.base().truth().pose;
    looks.origin = Pose2{base.x, base.y, backward_ ? base.yaw + geometry::kPi : base.yaw} *
                   Pose2{kOrigin, 0.0, 0.0};
    paint(world);
    looks.pixels.assign(found.begin(), found.end());
    for (auto& one : looks.pixels) {
      one.appearance = clothes_->look(image, {lens.width, lens.height, rgb_}, camera, one);
      one.forward += pose.forward - kOrigin;
    }
  }

 private:
  static constexpr double kRearDown = geometry::radians(15.0);
  static constexpr double kOrigin = 0.2;  // [m] ahead of the axle, where the camera looks

  void paint(const World& world) {
    gains_.clear();
    for (const Person& person : world.people())
      gains_.push_back(camera_->gains(world, person.position));
    painter_.paint(camera_->truth(), config_.sensor.lens, camera_->pose(world), renderer_->bodies(),
                   gains_, rgb_);
  }

  bool backward_;
  DepthCameraConfig config_;
  std::optional<depth_pipeline::DepthPipeline> pipeline_;
  std::optional<people_detector::DepthDetector> detector_;
  std::optional<people_detector::Clothes> clothes_;
  rendering::Painter painter_{std::vector<rendering::Texture>{}};
  std::optional<DepthCamera> camera_;
  std::optional<WorldRenderer> renderer_;
  std::optional<PeopleModel> model_;
  std::vector<std::uint16_t> millimeters_;
  std::vector<rendering::Gains> gains_;
  std::vector<std::uint8_t> rgb_;
};

/// The places of findings.
template <class Findings>
std::vector<Point2> places_of(const Findings& findings) {
  std::vector<Point2> places;
  places.reserve(findings.size());
  for (const auto& one : findings) places.emplace_back(one.forward, one.left);
  return places;
}

/// Of those found, the one nearest to a place, seen from the same one.
template <class Findings>
auto nearest(const Findings& findings, const Point2& place) {
  decltype(findings.data()) best = nullptr;
  double least = kSame;
  for (const auto& one : findings) {
    const double away = (Point2(one.forward, one.left) - place).norm();
    if (away < least) least = away, best = &one;
  }
  return best;
}

/// Counts of one way to find people.
struct Found {
  int people = 0, found = 0, false_alarms = 0;
  double along = 0.0, along_squares = 0.0, across_squares = 0.0;
  int missed = 0, missed_again = 0;  // in one image of a place, and in the next one
  std::vector<bool> before;          // who was found in the last image of this place
  double recall() const { return static_cast<double>(found) / people; }
  double bias() const { return along / found; }
  double along_sigma() const { return std::sqrt(along_squares / found - bias() * bias()); }
  double across_sigma() const { return std::sqrt(across_squares / found); }

  /// True positions against findings, both from the camera's place. Returns what is left of the
  /// findings: nobody is there.
  std::vector<Point2> take(const std::vector<Point2>& truths, const std::vector<Point2>& others,
                           std::vector<Point2> findings, std::vector<bool>& who) {
    who.assign(truths.size(), false);
    people += static_cast<int>(truths.size());
    for (std::size_t i = 0; i < truths.size(); ++i) {
      std::size_t best = findings.size();
      double nearest = kSame;
      for (std::size_t k = 0; k < findings.size(); ++k) {
        const double away = (findings[k] - truths[i]).norm();
        if (away < nearest) nearest = away, best = k;
      }
      if (best == findings.size()) continue;
      const Point2 sight = truths[i].normalized();
      const Point2 off = findings[best] - truths[i];
      const double away = off.dot(sight), aside = off.dot(Point2(-sight.y(), sight.x()));
      along += away, along_squares += away * away, across_squares += aside * aside;
      who[i] = true;
      ++found;
      findings.erase(findings.begin() + static_cast<std::ptrdiff_t>(best));
    }
    for (std::size_t i = 0; before.size() == who.size() && i < who.size(); ++i)
      missed += !before[i], missed_again += !before[i] && !who[i];
    before = who;
    std::erase_if(findings, [&](const Point2& finding) {
      return std::any_of(others.begin(), others.end(),
                         [&](const Point2& other) { return (other - finding).norm() < kSame; });
    });
    false_alarms += static_cast<int>(findings.size());
    return findings;
  }
};

/// Whom the pixels and whom the model finds of the same people.
struct Agreement {
  Found pixels, modelled;
  int images = 0;
  int same = 0, either = 0;  // who is found by both, and by at least one of them

  /// Before the first image of another place.
  void move_on() { pixels.before.clear(), modelled.before.clear(); }

  void take(const World& world, const Looks& looks) {
    ++images;
    std::vector<Point2> truths, others;
    for (const Person& person : world.people()) {
      const Point2 where = inverse(looks.origin) * person.position;
      (counts(where) ? truths : others).push_back(where);
    }
    std::vector<bool> by_pixels, by_model;
    pixels.take(truths, others, places_of(looks.pixels), by_pixels);
    modelled.take(truths, others, places_of(looks.modelled), by_model);
    for (std::size_t i = 0; i < truths.size(); ++i) {
      either += by_pixels[i] || by_model[i];
      same += by_pixels[i] && by_model[i];
    }
  }

  void print(const std::string& name) const {
    std::printf("%s: same %d of %d\n", name.c_str(), same, either);
    for (const Found* one : {&pixels, &modelled})
      std::printf(
          "  %s: %d people, recall %.3f, %d false in %d images, along %.3f +- %.3f, across %.3f m; "
          "of %d missed %d again\n",
          one == &pixels ? "pixels" : "model", one->people, one->recall(), one->false_alarms,
          images, one->bias(), one->along_sigma(), one->across_sigma(), one->missed,
          one->missed_again);
  }

 private:
  static constexpr double kLeast = 0.8;   // [m] ahead
  static constexpr double kAside = 0.62;  // of that, to either side: inside of the image

  /// Who is so near before the camera must be found; of others nobody says whether.
  static bool counts(const Point2& where) {
    return where.x() > kLeast && where.x() < kReach && std::abs(where.y()) < kAside * where.x();
  }
};

}  // namespace usher::world
