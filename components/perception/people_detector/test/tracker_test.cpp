#include "perception/people_detector/core/tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/random/random.hpp"
#include "simulation/rendering/core/clothes.hpp"
#include "simulation/rendering/core/light.hpp"

namespace usher::people_detector {
namespace {

using geometry::Point2;

constexpr double kPeriod = 1.0 / 15.0;  // [s]

Eigen::Matrix2d round(double sigma) { return sigma * sigma * Eigen::Matrix2d::Identity(); }

Observation at(double x, double y, double height = 1.7) { return {{x, y}, round(0.06), height}; }

TEST(Assignment, FindsTheLeastSumAndLeavesAloneWhoDoesNotFit) {
  Assignment assignment;
  const std::vector<double> costs{4, 1, 3, 2, 0, 5, 3, 2, 2};
  const auto pairs = assignment.solve(costs, 3, 3, 100);
  EXPECT_EQ(std::vector<int>(pairs.begin(), pairs.end()), (std::vector<int>{1, 0, 2}));
  const auto alone = assignment.solve(std::vector<double>{200, 1, 300, 2}, 2, 2, 100);
  EXPECT_EQ(std::vector<int>(alone.begin(), alone.end()), (std::vector<int>{1, -1}));
  EXPECT_EQ(assignment.solve(std::vector<double>{5, 1, 3}, 1, 3, 100)[0], 1);
  const auto tall = assignment.solve(std::vector<double>{5, 1, 3}, 3, 1, 100);
  EXPECT_EQ(std::vector<int>(tall.begin(), tall.end()), (std::vector<int>{-1, 0, -1}));
  EXPECT_TRUE(assignment.solve({}, 0, 0, 100).empty());
  EXPECT_EQ(assignment.solve({}, 2, 0, 100)[1], -1);
}

TEST(Tracker, BelievesACameraAfterSomeSightingsAndTheLaserWhenLegsWalk) {
  Tracker tracker({});
  double time = 10.0;
  for (int i = 0; i < 3; ++i, time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{at(2, 0)});
  EXPECT_TRUE(tracker.people().empty());
  tracker.update(time, Source::kKinect, std::vector{at(2, 0)});
  ASSERT_EQ(tracker.people().size(), 1U);
  EXPECT_EQ(tracker.people()[0].id, 1U);

  Tracker legs({});
  for (int i = 0; i < 30; ++i, time += kPeriod)
    legs.update(time, Source::kLaser, std::vector{at(2, 0, 0)});
  EXPECT_TRUE(legs.people().empty());  // a chair stands as still
  for (int i = 0; i < 15; ++i, time += kPeriod)
    legs.update(time, Source::kLaser, std::vector{at(2, 0.8 * i * kPeriod, 0)});
  EXPECT_EQ(legs.people().size(), 1U);
}

TEST(Tracker, WhatTheLaserAloneSeesStandForLongIsAChairThatSomebodyMoved) {
  Tracker legs({}), seen({});
  double time = 10.0, y = 0.0;
  const auto go = [&](double seconds, double speed) {
    for (const double end = time + seconds; time < end; time += kPeriod, y += speed * kPeriod) {
      legs.update(time, Source::kLaser, std::vector{at(2, y, 0)});
      seen.update(time, Source::kLaser, std::vector{at(2, y, 0)});
    }
  };
  go(2.0, 0.8);
  for (int i = 0; i < 4; ++i) seen.update(time, Source::kRearCamera, std::vector{at(2, y)});
  ASSERT_EQ(legs.people().size(), 1U);
  const auto id = legs.people()[0].id;
  go(15.0, 0.0);
  EXPECT_EQ(legs.people().size(), 1U) << "somebody waits";
  go(10.0, 0.0);
  EXPECT_TRUE(legs.people().empty());
  EXPECT_EQ(seen.people().size(), 1U) << "a camera saw that it is somebody";
  go(2.0, 0.8);
  ASSERT_EQ(legs.people().size(), 1U) << "walks on";
  EXPECT_EQ(legs.people()[0].id, id);
}

TEST(Tracker, KnowsPositionAndVelocity) {
  Tracker tracker({});
  Random random(3);
  for (int i = 0; i < 45; ++i) {
    const double time = i * kPeriod;
    const double x = 1.0 + 0.9 * time + random.gaussian(0, 0.05);
    tracker.update(time, Source::kKinect,
                   std::vector{at(x, 0.4 * time + random.gaussian(0, 0.05))});
  }
  ASSERT_EQ(tracker.people().size(), 1U);
  const Track& person = tracker.people()[0];
  EXPECT_NEAR(person.velocity().x(), 0.9, 0.3);
  EXPECT_NEAR(person.velocity().y(), 0.4, 0.3);
  EXPECT_NEAR(person.position().x(), 1.0 + 0.9 * 44 * kPeriod, 0.1);
  EXPECT_LT(person.covariance(0, 0), 0.01);
  EXPECT_EQ(tracker.find(person.id), &person);
  EXPECT_EQ(tracker.find(77), nullptr);
}

TEST(Tracker, FindsWhoWasHiddenAgain) {
  Tracker tracker({});
  for (int i = 0; i < 150; ++i) {
    const double time = i * kPeriod;
    const bool hidden = time > 3.0 && time < 5.0;  // behind a pillar
    std::vector<Observation> seen;
    if (!hidden) seen.push_back(at(3.0, -2.0 + 0.7 * std::min(time, 4.0)));
    tracker.update(time, Source::kKinect, seen);
    if (time > 1.0) {
      ASSERT_EQ(tracker.people().size(), 1U) << time;
    }
  }
  EXPECT_EQ(tracker.people()[0].id, 1U);
  for (int i = 0; i < 100; ++i) tracker.update(10.0 + i * kPeriod, Source::kKinect, {});
  EXPECT_TRUE(tracker.people().empty());
}

/// Somebody of 1.7 m walks behind something at 3, 0; 3 s later somebody comes out.
std::uint64_t who_comes_out(const geometry::Point2& place, double height, Source source) {
  Tracker tracker({});
  double time = 0.0;
  for (; time < 3.0; time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{at(3.0, 0.7 * (time - 3.0))});
  EXPECT_EQ(tracker.people().size(), 1U);
  for (; time < 6.0; time += kPeriod) tracker.update(time, Source::kKinect, {});
  const double out = time;
  for (; time < out + 1.2; time += kPeriod)
    tracker.update(time, source,
                   std::vector{at(place.x(), place.y() + 0.7 * (time - out), height)});
  std::uint64_t id = 0;
  for (const Track& person : tracker.people()) {
    if (person.last_seen() > out) id = person.id;
  }
  return id;
}

TEST(Tracker, KnowsWhoComesOutByPlaceAndHeight) {
  EXPECT_EQ(who_comes_out({3.0, 2.5}, 1.72, Source::kKinect), 1U) << "he has walked on";
  EXPECT_NE(who_comes_out({3.0, 2.5}, 1.5, Source::kKinect), 1U) << "another one";
  EXPECT_EQ(who_comes_out({3.0, 1.0}, 0.0, Source::kLaser), 1U) << "where he is expected";
  EXPECT_NE(who_comes_out({3.0, 2.5}, 0.0, Source::kLaser), 1U) << "legs elsewhere may be anyone's";
}

Observation half_hidden(double x, double y, double at_least) {
  Observation one = at(x, y, at_least);
  one.head_hidden = true;
  return one;
}

TEST(Tracker, WhoseHeadIsHiddenMayBeTallerAndKeepsTheHeight) {
  Tracker tracker({});
  double time = 0.0;
  const auto see = [&](const Observation& one, int images) {
    for (int i = 0; i < images; ++i, time += kPeriod)
      tracker.update(time, Source::kKinect, std::vector{one});
  };
  see(at(3.0, 0.0, 1.75), 20);
  see(half_hidden(3.0, 0.0, 1.4), 20);
  ASSERT_EQ(tracker.people().size(), 1U);
  EXPECT_NEAR(tracker.people()[0].height, 1.75, 1e-9);
  for (int i = 0; i < 20; ++i, time += kPeriod) tracker.update(time, Source::kKinect, {});
  see(half_hidden(3.0, 0.0, 2.0), 20);
  EXPECT_EQ(tracker.people().size(), 2U) << "he is not so tall";
}

TEST(Tracker, WaitsForTheHeadOfWhoComesOut) {
  for (const double height : {1.7, 1.5}) {
    Tracker tracker({});
    double time = 0.0;
    for (; time < 3.0; time += kPeriod)
      tracker.update(time, Source::kKinect, std::vector{at(3.0, 0.7 * (time - 3.0))});
    for (; time < 6.0; time += kPeriod) tracker.update(time, Source::kKinect, {});
    for (int i = 0; i < 5; ++i, time += kPeriod)
      tracker.update(time, Source::kKinect, std::vector{half_hidden(3.0, 2.5, 1.3)});
    EXPECT_EQ(tracker.people().size(), 1U) << "who he is, is not known yet";
    for (int i = 0; i < 10; ++i, time += kPeriod)
      tracker.update(time, Source::kKinect, std::vector{at(3.0, 2.5, height)});
    EXPECT_EQ(tracker.people().size(), height == 1.7 ? 1U : 2U);
  }
}

TEST(Tracker, OfTwoWhoAreHiddenTakesTheOneOfThatHeight) {
  Tracker tracker({});
  double time = 0.0;
  for (; time < 3.0; time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{at(3, 0.0, 1.62), at(3, 0.8, 1.86)});
  const std::uint64_t tall = tracker.people()[1].id;
  for (; time < 5.0; time += kPeriod) tracker.update(time, Source::kKinect, {});
  for (int i = 0; i < 10; ++i, time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{at(3, -0.3, 1.85)});
  const Track* found = tracker.find(tall);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->position().y(), -0.3, 0.1);
}

constexpr imaging::LabColor kRed{37.0, 52.0, 30.0}, kNavy{18.0, 4.0, -20.0};

Observation dressed(double x, double y, const imaging::LabColor& upper) {
  Observation one = at(x, y);
  one.appearance = {{upper, 1}, {}};
  return one;
}

/// Somebody in red walks behind something at 3, 0; so many seconds later somebody comes out.
std::uint64_t who_comes_out_in(const imaging::LabColor& upper, double y, double hidden) {
  Tracker tracker({});
  double time = 0.0;
  for (; time < 3.0; time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{dressed(3.0, 0.7 * (time - 3.0), kRed)});
  for (const double out = time + hidden; time < out; time += kPeriod)
    tracker.update(time, Source::kKinect, {});
  const double out = time;
  for (; time < out + 1.2; time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{dressed(3.0, y + 0.7 * (time - out), upper)});
  std::uint64_t id = 0;
  for (const Track& person : tracker.people()) {
    if (person.last_seen() > out) id = person.id;
  }
  return id;
}

TEST(Tracker, KnowsWhoComesOutByTheColorsOfTheClothes) {
  const imaging::LabColor other_light{47.0, 57.0, 33.0};
  EXPECT_EQ(who_comes_out_in(kRed, 2.5, 3.0), 1U);
  EXPECT_EQ(who_comes_out_in(other_light, 2.5, 3.0), 1U);
  EXPECT_NE(who_comes_out_in(kNavy, 2.5, 3.0), 1U) << "another one, of the same height";
  EXPECT_NE(who_comes_out_in(kNavy, 0.2, 0.6), 1U) << "where he is expected";
  EXPECT_NE(who_comes_out_in(kRed, 8.0, 3.0), 1U) << "so far nobody walks";
}

TEST(Tracker, WhoStepsIntoOtherLightIsTheSame) {
  Tracker tracker({});
  for (int i = 0; i < 60; ++i)
    tracker.update(i * kPeriod, Source::kKinect,
                   std::vector{dressed(3.0, 0.5 * i * kPeriod, i < 30 ? kRed : kNavy)});
  ASSERT_EQ(tracker.people().size(), 1U);
  EXPECT_EQ(tracker.people()[0].id, 1U);
}

TEST(Tracker, OfTwoWhoAreHiddenTakesTheOneInThoseClothes) {
  Tracker tracker({});
  double time = 0.0;
  for (; time < 3.0; time += kPeriod)
    tracker.update(time, Source::kKinect,
                   std::vector{dressed(3, 0.0, kNavy), dressed(3, 0.8, kRed)});
  const std::uint64_t red = tracker.people()[1].id;
  for (; time < 5.0; time += kPeriod) tracker.update(time, Source::kKinect, {});
  for (int i = 0; i < 10; ++i, time += kPeriod)
    tracker.update(time, Source::kKinect, std::vector{dressed(3, -0.3, kRed)});
  const Track* found = tracker.find(red);
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->position().y(), -0.3, 0.1);
}

TEST(Tracker, KeepsColorsOfEachCameraAndNoneOfTheOthers) {
  Tracker tracker({});
  for (int i = 0; i < 10; ++i) {
    tracker.update(i * kPeriod, Source::kRearCamera, std::vector{dressed(3, 0, kRed)});
    tracker.update(i * kPeriod, Source::kFace, std::vector{dressed(3, 0, kNavy)});
    tracker.update(i * kPeriod, Source::kLaser, std::vector{dressed(3, 0, kNavy)});
  }
  ASSERT_EQ(tracker.people().size(), 1U);
  const Track& track = tracker.people()[0];
  EXPECT_FALSE(track.appearances[0].known());
  EXPECT_NEAR(track.appearances[1].upper.color.a, kRed.a, 1e-9);
  EXPECT_EQ(track.appearances[1].upper.images, imaging::ClothesColor::kImages);
  EXPECT_FALSE(track.appearances[1].legs.known());
}

TEST(Tracker, WhoIsNewFromALateImageIsLessCertain) {
  const auto spread = [](double late) {
    Tracker tracker({});
    tracker.update(1.0, Source::kLaser, std::vector{at(9, 9, 0)});
    for (int i = 0; i < 4; ++i) tracker.update(1.0 - late, Source::kKinect, std::vector{at(3, 0)});
    return tracker.people().front().covariance(0, 0);
  };
  EXPECT_GT(spread(0.25), 1.2 * spread(0.0));
}

TEST(Tracker, ComparesWhatIsLateWithWherePeopleWereThen) {
  const auto follow = [](double late) {
    Tracker tracker({});
    for (int i = 0; i < 60; ++i) {
      const double time = i * kPeriod;
      tracker.update(time, Source::kLaser, std::vector{at(1.2 * time, 0, 0)});
      const double then = time + 0.02 - late;
      tracker.update(then, Source::kKinect, std::vector{at(1.2 * then, 0)});
    }
    return tracker;
  };
  const Tracker prompt = follow(0.0), late = follow(0.2);
  ASSERT_EQ(late.people().size(), 1U);
  EXPECT_NEAR(late.people()[0].position().x(), 1.2 * late.now(), 0.03);
  EXPECT_NEAR(late.people()[0].velocity().x(), 1.2, 0.05);
  EXPECT_GT(late.people()[0].covariance(0, 0), prompt.people()[0].covariance(0, 0));
}

TEST(Tracker, MindsInWhichDirectionASightingIsUncertain) {
  const Eigen::Matrix2d ahead = covariance_along(0.0, 0.3, 0.05);
  EXPECT_NEAR(ahead(0, 0), 0.09, 1e-12);
  EXPECT_NEAR(ahead(1, 1), 0.0025, 1e-12);
  const Eigen::Matrix2d left = covariance_along(geometry::kPi / 2, 0.3, 0.05);
  EXPECT_NEAR(left(1, 1), 0.09, 1e-12);
  Tracker tracker({});
  for (int i = 0; i < 30; ++i)
    tracker.update(i * kPeriod, Source::kKinect, std::vector{Observation{{3, 0}, ahead, 1.7}});
  ASSERT_EQ(tracker.people().size(), 1U);
  EXPECT_GT(tracker.people()[0].covariance(0, 0), 3.0 * tracker.people()[0].covariance(1, 1));
}

TEST(Tracker, IgnoresWhatIsNotFiniteAndTimesOfThePast) {
  Tracker tracker({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 6; ++i) {
    tracker.update(1.0 + i * kPeriod, Source::kKinect,
                   std::vector{at(nan, 0), at(2, 0), at(1, 1, nan)});
    EXPECT_FALSE(tracker.update(0.0, Source::kKinect, std::vector{at(2, 0)}));
  }
  EXPECT_FALSE(tracker.update(nan, Source::kKinect, std::vector{at(5, 5)}));
  Observation flat = at(5, 5);
  flat.covariance(0, 0) = 0.0;
  tracker.update(1.5, Source::kKinect, std::vector{flat});
  ASSERT_EQ(tracker.people().size(), 1U);
  EXPECT_TRUE(tracker.people()[0].state.allFinite());
  std::vector<Observation> crowd;
  crowd.reserve(500);
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 25; ++column) crowd.push_back(at(column, row));
  }
  for (int i = 0; i < 6; ++i) tracker.update(2.0 + i * kPeriod, Source::kKinect, crowd);
  EXPECT_LE(tracker.people().size(), Tracker::kMost);
}

constexpr std::size_t kPeople = 4;
constexpr int kColorsEvery = 3;  // images
constexpr double kApart = 0.05;  // [m] from whose height nobody's is who passes by one followed
constexpr double kSame = 0.75;   // [m] gate of CLEAR-MOT

struct Figures {
  int truths = 0, misses = 0, false_alarms = 0, switches = 0;
  int first_missed = 0, first_hidden = 0, first_switches = 0;  // of the first person
  double mota() const { return 1.0 - double(misses + false_alarms + switches) / truths; }
};

/// What four people do: walk across the view, to and fro, each at a distance of their own; walk
/// anywhere; or the first stays with the robot, swaying, while the others pass, one before him.
enum class Ways : std::uint8_t { kLanes, kAnywhere, kFollowed };

/// Four people who walk about, cross, stand still and hide each other before a camera at 0, 0.
class Room {
 public:
  /// `colors`: the camera shows how they are dressed, five times a second.
  Room(std::uint64_t seed, Ways ways, bool colors = false)
      : random_(seed), ways_(ways), colors_(colors), lighting_(seed), camera_(seed) {
    Random wardrobe(stream_seed(seed, "clothes"));
    for (auto& clothes : clothes_) clothes = rendering::draw_clothes(wardrobe);
    for (std::size_t i = 0; i < kPeople; ++i) {
      place_[i] = goal_[i] = anywhere();
      do {
        height_[i] = random_.uniform(1.55, 1.9);
      } while (ways == Ways::kFollowed && i > 0 && std::abs(height_[i] - height_[0]) < kApart);
    }
  }

  std::vector<Observation> step() {
    ++frames_;
    if (frames_ % kColorsEvery == 0) camera_.advance(kColorsEvery * kPeriod);
    for (std::size_t i = 0; i < kPeople; ++i) move(i);
    std::vector<Observation> seen;
    for (std::size_t i = 0; i < kPeople; ++i) {
      visible_[i] = is_visible(i);
      if (!visible_[i] || random_.uniform() > 0.96) continue;
      const Point2 error(random_.gaussian(0, 0.07), random_.gaussian(0, 0.05));
      seen.push_back({place_[i] + error, round(0.08), height_[i] + random_.gaussian(0, 0.04)});
      if (colors_ && frames_ % kColorsEvery == 0) seen.back().appearance = appearance_of(i);
    }
    if (random_.uniform() < 0.02)  // of nobody
      seen.push_back({anywhere(), round(0.08), random_.uniform(0.8, 1.9)});
    return seen;
  }

  /// What a laser makes of their legs in the same moment.
  std::vector<Observation> legs() {
    std::vector<Observation> seen;
    for (std::size_t i = 0; i < kPeople; ++i) {
      if (!visible_[i] || random_.uniform() > 0.9) continue;
      const Point2 error(random_.gaussian(0, 0.06), random_.gaussian(0, 0.06));
      seen.push_back({place_[i] + error, round(0.1), 0.0});
    }
    return seen;
  }

  /// Compares the tracks with the truth (CLEAR-MOT [bernardin2008clear]).
  void judge(const Tracker& tracker, double now, Figures& figures) {
    std::vector<bool> used(tracker.people().size());
    std::array<std::size_t, kPeople> match{};
    for (std::size_t i = 0; i < kPeople; ++i) {
      match[i] = track_of(i, tracker, used, true);
      if (match[i] < used.size()) used[match[i]] = true;
    }
    for (std::size_t i = 0; i < kPeople; ++i) {
      figures.first_hidden += i == 0 && !visible_[i];
      if (!visible_[i]) continue;
      ++figures.truths;
      if (match[i] == used.size()) match[i] = track_of(i, tracker, used, false);
      if (match[i] == used.size()) {
        ++figures.misses;
        figures.first_missed += i == 0;
        continue;
      }
      used[match[i]] = true;
      const std::uint64_t id = tracker.people()[match[i]].id;
      const bool switched = identity_[i] != 0 && identity_[i] != id;
      figures.switches += switched;
      figures.first_switches += i == 0 && switched;
      identity_[i] = id;
    }
    for (std::size_t k = 0; k < used.size(); ++k) {
      const Track& track = tracker.people()[k];
      const bool nobody = std::none_of(place_.begin(), place_.end(), [&](const Point2& place) {
        return (place - track.position()).norm() < kSame;
      });
      figures.false_alarms += !used[k] && nobody && now - track.last_seen() < 0.5;
    }
  }

 private:
  /// In the Kinect's field of view.
  Point2 anywhere() {
    const double forward = random_.uniform(1.0, 6.0);
    return {forward, random_.uniform(-0.6, 0.6) * forward};
  }

  void move(std::size_t i) {
    if (ways_ == Ways::kLanes) {
      cross(i, 1.6 + static_cast<double>(i));
    } else if (ways_ == Ways::kFollowed && i == 0) {
      const double time = frames_ * kPeriod;
      place_[i] = {2.0 + 0.4 * std::sin(0.31 * time), 0.6 * std::sin(0.23 * time)};
    } else if (ways_ == Ways::kFollowed) {
      cross(i, i == 1 ? 1.0 : 1.2 + static_cast<double>(i));
    } else {
      walk(i);
    }
  }

  void cross(std::size_t i, double forward) {
    const auto lane = static_cast<double>(i);
    place_[i] = {forward, 1.3 * std::sin((0.55 + 0.07 * lane) * frames_ * kPeriod + lane)};
  }

  void walk(std::size_t i) {
    const Point2 way = goal_[i] - place_[i];
    if (way.norm() < 0.1) {
      wait_[i] -= kPeriod;
      if (wait_[i] > 0.0) return;
      goal_[i] = anywhere();
      speed_[i] = random_.uniform(0.5, 1.3);
      wait_[i] = random_.uniform(0.0, 4.0);
      return;
    }
    Point2 step = speed_[i] * kPeriod * way.normalized();
    for (std::size_t j = 0; j < kPeople; ++j) {  // nobody walks through anybody
      const Point2 gap = place_[i] - place_[j];
      if (j != i && gap.norm() < 0.5)
        step += 0.04 * (gap + Point2(-gap.y(), gap.x())) / std::max(0.1, gap.norm());
    }
    place_[i] += step;
  }

  /// In the light of the place, as a camera that adapts shows it.
  imaging::Appearance appearance_of(std::size_t i) const {
    const auto gains = camera_.gains(lighting_, place_[i], {0, 0});
    const auto color = [&](const rendering::Clothes::Color& clothes) {
      std::array<double, 3> linear{};
      for (std::size_t k = 0; k < 3; ++k) linear[k] = gains[k] * imaging::to_linear(clothes[k]);
      return imaging::ClothesColor{imaging::to_lab(linear), 1};
    };
    return {color(clothes_[i].upper), color(clothes_[i].legs)};
  }

  bool is_visible(std::size_t i) const {
    const auto bearing = [](const Point2& p) { return std::atan2(p.y(), p.x()); };
    for (std::size_t j = 0; j < kPeople; ++j) {
      const double near = place_[j].norm();
      if (j == i || near > place_[i].norm()) continue;
      if (std::abs(bearing(place_[i]) - bearing(place_[j])) * near < 0.25) return false;
    }
    return true;
  }

  /// The track that had this person before, while it fits, or the nearest.
  std::size_t track_of(std::size_t i, const Tracker& tracker, const std::vector<bool>& used,
                       bool before) const {
    std::size_t best = used.size();
    double nearest = kSame;
    for (std::size_t k = 0; k < used.size(); ++k) {
      const double away = (tracker.people()[k].position() - place_[i]).norm();
      if (used[k] || away >= nearest || (before && tracker.people()[k].id != identity_[i]))
        continue;
      best = k, nearest = away;
    }
    return best;
  }

  Random random_;
  Ways ways_;
  bool colors_;
  rendering::Lighting lighting_;
  rendering::ColorCamera camera_;
  std::array<rendering::Clothes, kPeople> clothes_;
  int frames_ = 0;
  std::array<Point2, kPeople> place_, goal_;
  std::array<double, kPeople> speed_{}, height_{}, wait_{};
  std::array<bool, kPeople> visible_{};
  std::array<std::uint64_t, kPeople> identity_{};
};

Figures follow(Room room, int minutes = 10, bool legs = false) {
  Tracker tracker({});
  Figures figures;
  for (int frame = 0; frame < minutes * 60 * 15; ++frame) {
    tracker.update(frame * kPeriod, Source::kKinect, room.step());
    if (legs) tracker.update(frame * kPeriod, Source::kLaser, room.legs());
    if (frame > 15) room.judge(tracker, frame * kPeriod, figures);
  }
  std::printf("MOTA %.4f, %d misses, %d false alarms, %d switches of %d\n", figures.mota(),
              figures.misses, figures.false_alarms, figures.switches, figures.truths);
  return figures;
}

TEST(Tracker, KeepsFourPeopleApartWhoCross) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Figures figures = follow({seed, Ways::kLanes});
    EXPECT_GE(figures.mota(), 0.9) << "seed " << seed;
    EXPECT_LE(figures.switches, 4) << "seed " << seed;
  }
}

TEST(Tracker, FollowsFourPeopleWhoWalkAnywhereAndHideEachOtherForSeconds) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Figures figures = follow({seed, Ways::kAnywhere});
    EXPECT_GE(figures.mota(), 0.9) << "seed " << seed;
    EXPECT_LE(figures.switches, 80) << "seed " << seed;
  }
}

TEST(Tracker, MistakesFewerOfThemWhereItSeesTheirClothes) {
  for (const Ways ways : {Ways::kLanes, Ways::kAnywhere}) {
    int without = 0, with = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      without += follow({seed, ways}).switches;
      const Figures figures = follow({seed, ways, true});
      with += figures.switches;
      EXPECT_GE(figures.mota(), 0.97) << "seed " << seed;
    }
    std::printf("%d switches in ten runs without colors, %d with\n", without, with);
    EXPECT_LT(3 * with, 2 * without);
  }
}

TEST(Tracker, FollowsOneForTwentyMinutesWhileOthersPassAndHideHim) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Figures figures = follow({seed, Ways::kFollowed}, 20, true);
    EXPECT_GT(figures.first_hidden, 300) << "of 18,000 images, seed " << seed;
    EXPECT_EQ(figures.first_switches, 0) << "seed " << seed;
    EXPECT_LE(figures.first_missed, 20) << "seed " << seed;
  }
}

}  // namespace
}  // namespace usher::people_detector
