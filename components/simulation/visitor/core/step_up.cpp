#include "simulation/visitor/core/step_up.hpp"

namespace usher::visitor {

namespace {

constexpr double kThere = 0.35;   ///< [m] from the place is there
constexpr double kBeside = 1.2;   ///< [m] from the robot's middle, on the way round it
constexpr double kPassing = 0.5;  ///< [m] ahead, likewise

}  // namespace

std::optional<geometry::Point2> step_up(const geometry::Pose2& robot,
                                        const geometry::Point2& visitor, double range) {
  const geometry::Point2 at = inverse(robot) * visitor;
  const geometry::Point2 place(range, 0.0);
  if ((at - place).norm() < kThere) return std::nullopt;
  if (at.x() < 0.0) return robot * geometry::Point2(kPassing, at.y() < 0.0 ? -kBeside : kBeside);
  return robot * place;
}

}  // namespace usher::visitor
