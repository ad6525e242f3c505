#include "navigation/local_planner/core/contact.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::local_planner {
namespace {

using geometry::Point2;
using Costs = grid::Grid<std::uint8_t>;

std::vector<Point2> regular(int corners, double radius) {
  std::vector<Point2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * geometry::kPi * i / corners;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

/// The part of a convex polygon on the inner side of normal . p <= offset (Sutherland and Hodgman).
std::vector<Point2> clipped(const std::vector<Point2>& polygon, const Point2& normal,
                            double offset) {
  std::vector<Point2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[(i + 1) % polygon.size()];
    const double da = normal.dot(a) - offset;
    const double db = normal.dot(b) - offset;
    if (da <= 0.0) kept.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0))
      kept.push_back(a + (b - a) * (da / (da - db)));
  }
  return kept;
}

/// Reference without any of the tested code's ideas: clip the polygon with each lethal cell's
/// square, or ask whether the cell's center lies in the polygon. In metres, in the grid's frame.
bool reference_touches(const Costs& costs, const Footprint& footprint, CellExtent extent,
                       const geometry::Pose2& pose) {
  std::vector<Point2> polygon;
  for (const Point2& corner : footprint.corners()) polygon.push_back(pose * corner);
  const grid::GridGeometry& g = costs.geometry();
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      if (costs.at({x, y}) != grid::kLethalCost) continue;
      const Point2 c = g.center({x, y});
      if (std::hypot(c.x() - pose.x, c.y() - pose.y) >
          footprint.circumscribed_radius() + g.resolution)
        continue;
      if (extent == CellExtent::kCenter) {
        const Point2 p = inverse(pose) * c;
        bool inside = true;
        for (const Footprint::Side& s : footprint.sides()) {
          inside = inside && s.normal_x * p.x() + s.normal_y * p.y() <= s.offset;
        }
        if (inside) return true;
        continue;
      }
      const double h = 0.5 * g.resolution;
      std::vector<Point2> rest = clipped(polygon, {1, 0}, c.x() + h);
      rest = clipped(rest, {-1, 0}, -(c.x() - h));
      rest = clipped(rest, {0, 1}, c.y() + h);
      rest = clipped(rest, {0, -1}, -(c.y() - h));
      if (!rest.empty()) return true;
    }
  }
  return false;
}

Costs random_costs(Random& random, int width, int height, double resolution, double share) {
  Costs costs({width, height, resolution, random.uniform(-5, 5), random.uniform(-5, 5)});
  for (std::uint8_t& cost : costs) {
    cost =
        random.uniform() < share ? grid::kLethalCost : static_cast<std::uint8_t>(random.below(253));
  }
  return costs;
}

struct Shape {
  const char* name;
  Footprint footprint;
};

std::vector<Shape> shapes() {
  const std::array<Point2, 3> triangle{Point2{0.6, 0.0}, Point2{-0.3, 0.4}, Point2{-0.3, -0.4}};
  const std::array<Point2, 6> odd{Point2{0.41, 0.1},  Point2{0.2, 0.33},    Point2{-0.25, 0.3},
                                  Point2{-0.4, 0.02}, Point2{-0.31, -0.28}, Point2{0.3, -0.35}};
  return {{"square", Footprint::rectangle(0.61, 0.61)},
          {"rectangle", Footprint::rectangle(0.7, 0.55)},
          {"16-gon", Footprint::make(regular(16, 0.3)).value()},
          {"triangle", Footprint::make(triangle).value()},
          {"odd", Footprint::make(odd).value()},
          {"long", Footprint::rectangle(3.1, 0.4)}};
}

class Contact : public testing::TestWithParam<cpu::Simd> {
 protected:
  void SetUp() override {
    if (GetParam() > cpu::best_simd()) GTEST_SKIP() << "this processor lacks the instruction set";
  }
};

INSTANTIATE_TEST_SUITE_P(InstructionSets, Contact,
                         testing::Values(cpu::Simd::kPortable, cpu::Simd::kAvx2));

TEST_P(Contact, EqualsTheReferenceOnRandomPoses) {
  Random random(7);
  constexpr int kPoses = 100000;
  int touching = 0;
  int wrong = 0;
  const std::vector<Shape> all = shapes();
  TurnedFootprint turned;
  LethalBits bits;
  for (int done = 0; done < kPoses;) {
    const Shape& shape = all[static_cast<std::size_t>(random.below(all.size() - 1))];
    const CellExtent extent = random.below(2) == 0 ? CellExtent::kWhole : CellExtent::kCenter;
    const Costs costs = random_costs(random, 40 + static_cast<int>(random.below(30)),
                                     40 + static_cast<int>(random.below(30)), 0.05, 0.01);
    const ContactTest contact(shape.footprint, extent, GetParam());
    bits.assign(costs, false, contact.reach_cells(0.05));
    for (int i = 0; i < 200; ++i, ++done) {
      const double x = random.uniform(17.0, costs.width() - 17.0);
      const double y = random.uniform(17.0, costs.height() - 17.0);
      const double yaw = random.uniform(-geometry::kPi, geometry::kPi);
      contact.turn(std::cos(yaw), std::sin(yaw), 0.05, turned);
      const bool found = contact.touches(bits, turned, x, y);
      const geometry::Pose2 pose{costs.geometry().origin_x + x * 0.05,
                                 costs.geometry().origin_y + y * 0.05, yaw};
      wrong += found != reference_touches(costs, shape.footprint, extent, pose);
      touching += found;
      EXPECT_FALSE(found && contact.clear_around(bits, x, y));
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(touching, kPoses / 5);
  EXPECT_LT(touching, kPoses * 4 / 5);
}

TEST_P(Contact, EqualsTheReferenceForAFootprintWiderThanAWord) {
  Random random(8);
  const Footprint footprint = Footprint::rectangle(3.1, 0.4);
  const ContactTest contact(footprint, CellExtent::kWhole, GetParam());
  TurnedFootprint turned;
  LethalBits bits;
  int touching = 0;
  for (int round = 0; round < 40; ++round) {
    const Costs costs = random_costs(random, 150, 150, 0.03, 0.0006);
    bits.assign(costs, false, contact.reach_cells(0.03));
    for (int i = 0; i < 50; ++i) {
      const double x = random.uniform(55.0, 95.0);
      const double y = random.uniform(55.0, 95.0);
      const double yaw = random.uniform(-geometry::kPi, geometry::kPi);
      contact.turn(std::cos(yaw), std::sin(yaw), 0.03, turned);
      const bool found = contact.touches(bits, turned, x, y);
      const geometry::Pose2 pose{costs.geometry().origin_x + x * 0.03,
                                 costs.geometry().origin_y + y * 0.03, yaw};
      ASSERT_EQ(found, reference_touches(costs, footprint, CellExtent::kWhole, pose));
      touching += found;
    }
  }
  EXPECT_GT(touching, 200);
  EXPECT_LT(touching, 1800);
}

TEST_P(Contact, HoldsAtAllRightAngles) {
  const Footprint footprint = Footprint::rectangle(0.6, 0.4);  // 12 x 8 cells
  const ContactTest contact(footprint, CellExtent::kWhole, GetParam());
  Costs costs({60, 60, 0.05, 0.0, 0.0});
  costs.at({30, 30}) = grid::kLethalCost;
  LethalBits bits;
  bits.assign(costs, false, contact.reach_cells(0.05));
  TurnedFootprint turned;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double yaw = quarter * geometry::kPi / 2;
    contact.turn(std::cos(yaw), std::sin(yaw), 0.05, turned);
    const double reach = quarter % 2 == 0 ? 6.0 : 4.0;
    EXPECT_TRUE(contact.touches(bits, turned, 30.0 - reach + 0.001, 30.5));
    EXPECT_FALSE(contact.touches(bits, turned, 30.0 - reach - 0.001, 30.5));
    EXPECT_TRUE(contact.touches(bits, turned, 31.0 + reach - 0.001, 30.5));
    EXPECT_FALSE(contact.touches(bits, turned, 31.0 + reach + 0.001, 30.5));
  }
}

TEST_P(Contact, OutsideOfTheGridIsAContact) {
  const ContactTest contact(Footprint::rectangle(0.6, 0.6), CellExtent::kCenter, GetParam());
  const Costs costs({40, 40, 0.05, 0.0, 0.0});
  LethalBits bits;
  bits.assign(costs, false, contact.reach_cells(0.05));
  TurnedFootprint turned;
  contact.turn(1.0, 0.0, 0.05, turned);
  EXPECT_FALSE(contact.touches(bits, turned, 20.0, 20.0));
  EXPECT_FALSE(contact.touches(bits, turned, 6.0, 20.0));
  for (const double x :
       {5.0, 0.0, -3.0, -1000.0, 35.0, 41.0, 1e9, -1e300, std::numeric_limits<double>::quiet_NaN(),
        std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(contact.touches(bits, turned, x, 20.0)) << x;
    EXPECT_TRUE(contact.touches(bits, turned, 20.0, x)) << x;
  }
}

TEST_P(Contact, UnknownCellsCountWhenAsked) {
  const ContactTest contact(Footprint::rectangle(0.6, 0.6), CellExtent::kCenter, GetParam());
  Costs costs({40, 40, 0.05, 0.0, 0.0});
  costs.at({20, 20}) = grid::kUnknownCost;
  LethalBits bits;
  TurnedFootprint turned;
  contact.turn(1.0, 0.0, 0.05, turned);
  bits.assign(costs, false, contact.reach_cells(0.05));
  EXPECT_FALSE(contact.touches(bits, turned, 20.0, 20.0));
  bits.assign(costs, true, contact.reach_cells(0.05));
  EXPECT_TRUE(contact.touches(bits, turned, 20.0, 20.0));
}

TEST_P(Contact, ErasingWhatIsTouchedEndsTheContact) {
  Random random(9);
  const ContactTest contact(Footprint::rectangle(0.7, 0.5), CellExtent::kWhole, GetParam());
  LethalBits bits;
  TurnedFootprint turned;
  int erased = 0;
  for (int i = 0; i < 200; ++i) {
    const Costs costs = random_costs(random, 70, 70, 0.05, 0.05);
    bits.assign(costs, false, contact.reach_cells(0.05));
    const double yaw = random.uniform(-geometry::kPi, geometry::kPi);
    contact.turn(std::cos(yaw), std::sin(yaw), 0.05, turned);
    const double x = random.uniform(20.0, 50.0);
    const double y = random.uniform(20.0, 50.0);
    erased += contact.erase_touched(bits, turned, x, y);
    EXPECT_FALSE(contact.touches(bits, turned, x, y));
  }
  EXPECT_GT(erased, 1000);
}

TEST(LethalBits, HoldsEveryCell) {
  Random random(3);
  for (const int width : {1, 15, 16, 17, 63, 64, 65, 80, 129}) {
    const Costs costs = random_costs(random, width, 7, 0.05, 0.3);
    LethalBits bits;
    bits.assign(costs, false, 11);
    for (int y = -11; y < 7 + 11; ++y) {
      for (int x = -11; x < width + 11; ++x) {
        EXPECT_EQ(bits.test(x + 11, y + 11),
                  costs.value_or({x, y}, grid::kLethalCost) == grid::kLethalCost)
            << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace usher::local_planner
