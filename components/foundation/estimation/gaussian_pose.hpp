#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "foundation/geometry/pose2.hpp"
#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"

namespace usher::estimation {

/// Draws planar poses from a normal distribution; a covariance without full rank (a known yaw, say)
/// is welcome.
class GaussianPose {
 public:
  /// Refuses values that are not finite and covariances that are not symmetric or have a negative
  /// variance.
  static Result<GaussianPose> make(const geometry::Pose2& mean, const Eigen::Matrix3d& covariance) {
    if (!mean.finite() || !covariance.allFinite())
      return Error{"a pose distribution must be finite"};
    const double scale = covariance.cwiseAbs().maxCoeff();
    if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > 1e-6 * scale) {
      return Error{"a covariance must be symmetric"};
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const Eigen::Vector3d& variances = solver.eigenvalues();
    if (variances.minCoeff() < -1e-6 * scale)
      return Error{"a covariance must have no negative variance"};
    GaussianPose result;
    result.mean_ = mean;
    result.root_ = solver.eigenvectors() * variances.cwiseMax(0.0).cwiseSqrt().asDiagonal();
    return result;
  }

  geometry::Pose2 sample(Random& random) const {
    Eigen::Vector3d normal;
    for (int i = 0; i < 3; ++i) normal[i] = random.gaussian();
    const Eigen::Vector3d deviation = root_ * normal;
    return {mean_.x + deviation[0], mean_.y + deviation[1],
            geometry::normalized(mean_.yaw + deviation[2])};
  }

 private:
  geometry::Pose2 mean_;
  Eigen::Matrix3d root_ = Eigen::Matrix3d::Zero();
};

}  // namespace usher::estimation
