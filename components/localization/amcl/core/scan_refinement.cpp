#include "localization/amcl/core/scan_refinement.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace usher::amcl {
namespace {

struct Linearized {
  double cost = 0.0;
  Eigen::Matrix3d hessian;
  Eigen::Vector3d gradient;
};

/// The signed distance of a beam's end from the surface that faces the beam. Behind a surface the
/// field says nothing (it is zero inside walls and rises again beyond thin ones), so the distance
/// is taken a little before the end, where the beam still flies, and carried on along its gradient.
/// A beam that grazes something else there is measured at its end.
grid::DistanceField::Sample facing_distance(const grid::DistanceField& field,
                                            const geometry::Point2& end,
                                            const geometry::Point2& direction) {
  constexpr double kBefore = 3.0;  // [cells]
  constexpr double kFacing = 0.3;  // cosine of the angle between beam and surface normal
  const double before = kBefore * field.geometry().resolution;
  auto sample = field.interpolated(end - before * direction);
  const double approach = sample.gradient.dot(direction);
  if (approach > -kFacing) return field.interpolated(end);
  sample.distance += before * approach;
  return sample;
}

Linearized linearize(const grid::DistanceField& field, std::span<const Beam> beams,
                     const geometry::Pose2& pose, const Eigen::Vector3d& from_start,
                     const Eigen::Matrix3d& prior, double sigma) {
  Linearized result;
  result.hessian = prior;
  result.gradient = prior * from_start;
  result.cost = from_start.dot(result.gradient);
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  const double information = 1.0 / (sigma * sigma);
  for (const Beam& beam : beams) {
    const double dx = c * beam.x - s * beam.y;
    const double dy = s * beam.x + c * beam.y;
    const geometry::Point2 end(pose.x + dx, pose.y + dy);
    const geometry::Point2 direction(c * beam.direction_x - s * beam.direction_y,
                                     s * beam.direction_x + c * beam.direction_y);
    const auto sample = facing_distance(field, end, direction);
    const double square = sample.distance * sample.distance * information;
    const double weight = information / ((1.0 + square) * (1.0 + square));
    const Eigen::Vector3d jacobian(sample.gradient.x(), sample.gradient.y(),
                                   sample.gradient.y() * dx - sample.gradient.x() * dy);
    result.cost += square / (1.0 + square);
    result.gradient += weight * sample.distance * jacobian;
    result.hessian += weight * jacobian * jacobian.transpose();
  }
  return result;
}

}  // namespace

Refinement refine(const grid::DistanceField& field, std::span<const Beam> beams,
                  const geometry::Pose2& start, const Eigen::Matrix3d& prior,
                  const RefinementParameters& parameters) {
  geometry::Pose2 pose = start;
  Eigen::Vector3d from_start = Eigen::Vector3d::Zero();
  Linearized now = linearize(field, beams, pose, from_start, prior, parameters.sigma);
  double fraction = 1.0;
  for (int i = 0; i < parameters.iterations; ++i) {
    const Eigen::LDLT<Eigen::Matrix3d> solver(now.hessian);
    if (solver.info() != Eigen::Success || !solver.isPositive()) break;
    const Eigen::Vector3d step = -fraction * solver.solve(now.gradient);
    if (!step.allFinite() || step.cwiseAbs().maxCoeff() < 1e-5) break;
    const Eigen::Vector3d next_from_start = from_start + step;
    const geometry::Pose2 next{start.x + next_from_start[0], start.y + next_from_start[1],
                               geometry::normalized(start.yaw + next_from_start[2])};
    const Linearized after =
        linearize(field, beams, next, next_from_start, prior, parameters.sigma);
    if (after.cost < now.cost) {
      pose = next;
      from_start = next_from_start;
      now = after;
    } else {
      fraction *= 0.5;  // the field has creases: a shorter step of the same direction may do
    }
  }
  const bool moved = from_start.squaredNorm() > 0.0;
  const bool near = from_start.head<2>().norm() <= parameters.max_shift &&
                    std::abs(from_start[2]) <= parameters.max_turn;
  return moved && near ? Refinement{pose, true} : Refinement{start, false};
}

double range_offset(const grid::DistanceField& field, std::span<const Beam> beams,
                    const geometry::Pose2& pose, double sigma) {
  constexpr double kHeld = 10.0;  // [beams]
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  const double information = 1.0 / (sigma * sigma);
  double gradient = 0.0;
  double hessian = kHeld * information;
  for (const Beam& beam : beams) {
    const geometry::Point2 end(pose.x + c * beam.x - s * beam.y, pose.y + s * beam.x + c * beam.y);
    const geometry::Point2 direction(c * beam.direction_x - s * beam.direction_y,
                                     s * beam.direction_x + c * beam.direction_y);
    const auto sample = facing_distance(field, end, direction);
    const double square = sample.distance * sample.distance * information;
    const double weight = information / ((1.0 + square) * (1.0 + square));
    const double jacobian = sample.gradient.dot(direction);
    gradient += weight * sample.distance * jacobian;
    hessian += weight * jacobian * jacobian;
  }
  return -gradient / hessian;
}

}  // namespace usher::amcl
