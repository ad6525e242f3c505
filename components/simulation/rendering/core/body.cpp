#include "simulation/rendering/core/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace usher::rendering {

namespace {

using Eigen::Vector3d;

// Shares of the standing height (anthropometry of [winter2009biomechanics], rounded).
constexpr double kAnkle = 0.039, kKnee = 0.285, kHip = 0.53, kShoulder = 0.818, kHead = 0.93;
constexpr double kUpperArm = 0.186, kForearm = 0.20, kHalfShoulder = 0.115, kHalfHip = 0.055;
constexpr double kFoot = 0.12;
constexpr double kSeat = 0.45;  // [m]

/// Angles in the plane of walking: 0 hangs down, positive swings forward.
struct Leg {
  double thigh = 0.0, shin = 0.0;
};
struct Arm {
  double swing = 0.0, elbow = 0.15, aside = 0.08;
};
struct Pose {
  std::array<Leg, 2> legs;  // left, right
  std::array<Arm, 2> arms;
  double trunk = 0.0;  // lean forward
};

Pose pose_of(const Body& body) {
  Pose pose;
  switch (body.posture) {
    case Posture::kStanding:
      break;
    case Posture::kWalking: {
      const double swing = 0.38 * std::sin(body.phase);
      const double bent = 0.35 * std::max(0.0, std::cos(body.phase));
      const double other = 0.35 * std::max(0.0, -std::cos(body.phase));
      pose.legs = {Leg{swing, swing - bent}, Leg{-swing, -swing - other}};
      pose.arms = {Arm{-0.8 * swing, 0.3, 0.08}, Arm{0.8 * swing, 0.3, 0.08}};
      pose.trunk = 0.04;
      break;
    }
    case Posture::kSitting:
      pose.legs = {Leg{1.5, 0.0}, Leg{1.5, 0.0}};
      pose.arms = {Arm{0.5, 1.0, 0.1}, Arm{0.5, 1.0, 0.1}};
      break;
    case Posture::kSquatting:
      pose.legs = {Leg{1.9, -0.7}, Leg{1.9, -0.7}};
      pose.arms = {Arm{1.0, 0.5, 0.1}, Arm{1.0, 0.5, 0.1}};
      pose.trunk = 0.45;
      break;
    case Posture::kBending:
      pose.legs = {Leg{-0.12, -0.12}, Leg{-0.12, -0.12}};
      pose.arms = {Arm{0.0, 0.1, 0.05}, Arm{0.0, 0.1, 0.05}};
      pose.trunk = 1.35;
      break;
    case Posture::kArmsOut:
      pose.arms = {Arm{0.0, 0.0, 1.5}, Arm{0.0, 0.0, 1.5}};
      break;
  }
  return pose;
}

Vector3d down(double angle) { return {std::sin(angle), 0.0, -std::cos(angle)}; }

class Builder {
 public:
  Builder(const Body& body, std::vector<Limb>& limbs) : body_(body), limbs_(limbs) {}

  void add(const Vector3d& from, double from_radius, const Vector3d& to, double to_radius) {
    const double girth = body_.height * body_.width;
    limbs_.push_back({place(from), place(to), static_cast<float>(from_radius * girth),
                      static_cast<float>(to_radius * girth)});
  }

 private:
  Eigen::Vector3f place(const Vector3d& p) const {
    const geometry::Point2 flat = body_.pose * geometry::Point2(p.x(), p.y());
    return Vector3d(flat.x(), flat.y(), p.z()).cast<float>();
  }

  const Body& body_;
  std::vector<Limb>& limbs_;
};

double hip_height(const Body& body, const Pose& pose) {
  if (body.posture == Posture::kSitting) return kSeat + 0.06 * body.height;
  double highest = 0.0;  // the standing foot carries
  for (const Leg& leg : pose.legs) {
    highest = std::max(highest, (kHip - kKnee) * std::cos(leg.thigh) +
                                    (kKnee - kAnkle) * std::cos(leg.shin) + kAnkle);
  }
  return highest * body.height;
}

// Order in which make_limbs() adds the trunk's limb of each side.
constexpr std::size_t kTrunk = 5, kLimbsOfASide = 7;
constexpr double kBelt = 0.055;  // of the height, above the hips: over the thighs of who sits

}  // namespace

double top_of(Posture posture, double height) {
  switch (posture) {
    case Posture::kSitting:
      return kSeat + 0.53 * height;
    case Posture::kSquatting:
      return 0.58 * height;
    case Posture::kBending:
      return 0.67 * height;
    default:
      return height;
  }
}

Waist waist_of(const Body& body, const std::vector<Limb>& limbs) {
  const Limb& left = limbs[kTrunk];
  const Limb& right = limbs[kTrunk + kLimbsOfASide];
  const Eigen::Vector3f up = (left.to + right.to - left.from - right.from).normalized();
  const auto belt = static_cast<float>(kBelt * body.height);
  return {0.5F * (left.from + right.from) + belt * up, up};
}

void make_limbs(const Body& body, std::vector<Limb>& limbs) {
  limbs.clear();
  Builder builder(body, limbs);
  const Pose pose = pose_of(body);
  const double h = body.height;
  const double hip = hip_height(body, pose);
  const Vector3d up(std::sin(pose.trunk), 0.0, std::cos(pose.trunk));
  const Vector3d left(0.0, 1.0, 0.0);
  const Vector3d pelvis(0.0, 0.0, hip);
  const Vector3d neck = pelvis + (kShoulder - kHip) * h * up;
  const Vector3d crown = pelvis + (kHead - kHip) * h * up;
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1.0 : -1.0;
    const Vector3d aside = sign * left;
    const Leg& leg = pose.legs[static_cast<std::size_t>(side)];
    const Vector3d joint = pelvis + kHalfHip * h * aside;
    const Vector3d knee = joint + (kHip - kKnee) * h * down(leg.thigh);
    const Vector3d ankle = knee + (kKnee - kAnkle) * h * down(leg.shin);
    builder.add(joint, 0.052, knee, 0.034);
    builder.add(knee, 0.034, ankle, 0.024);
    builder.add(ankle, 0.022, ankle + kFoot * h * Vector3d(1.0, 0.0, 0.0), 0.018);

    const Arm& arm = pose.arms[static_cast<std::size_t>(side)];
    const Vector3d shoulder = neck + kHalfShoulder * h * aside;
    const auto reach = [&](double angle) -> Vector3d {
      return (std::cos(arm.aside) * down(angle) + std::sin(arm.aside) * aside).normalized();
    };
    const Vector3d elbow = shoulder + kUpperArm * h * reach(arm.swing);
    builder.add(shoulder, 0.032, elbow, 0.025);
    builder.add(elbow, 0.025, elbow + kForearm * h * reach(arm.swing + arm.elbow), 0.02);
    builder.add(pelvis + 0.04 * h * aside, 0.062, neck + 0.05 * h * aside - 0.03 * h * up, 0.066);
    builder.add(neck - 0.02 * h * up, 0.05, shoulder, 0.034);
  }
  builder.add(neck, 0.035, crown, 0.058);
  builder.add(crown, 0.058, crown + 0.02 * h * up, 0.05);
}

}  // namespace usher::rendering
