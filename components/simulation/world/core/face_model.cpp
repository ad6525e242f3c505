#include "simulation/world/core/face_model.hpp"

#include <algorithm>
#include <cmath>

namespace usher::world {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMost = 32;
constexpr double kAhead = 0.10;     // [m] of a face before the body's middle
constexpr double kEyes = 0.93;      // of the height of somebody upright
constexpr double kSeated = 0.75;    // share of the standing height
constexpr double kSpread = 0.002;   // [rad] between the beams of a line of sight
constexpr double kNearFalse = 0.8;  // [m] where false faces begin

Vector3d face_of(const Person& person) {
  const bool upright = person.posture == rendering::Posture::kStanding ||
                       person.posture == rendering::Posture::kWalking ||
                       person.posture == rendering::Posture::kArmsOut;
  return {person.position.x() + kAhead * std::cos(person.yaw),
          person.position.y() + kAhead * std::sin(person.yaw),
          kEyes * (upright ? 1.0 : kSeated) * person.height};
}

}  // namespace

FaceModel::FaceModel(const FaceModelConfig& config, std::uint64_t seed)
    : config_(config), random_(stream_seed(seed, "face model")), sight_(-kSpread, kSpread, 3) {
  see_through_.assign(static_cast<std::size_t>(sight_.count()), 0);
}

/// Whether a thing or somebody else stands between the camera and a face.
bool FaceModel::hidden(const World& world, std::size_t person, const Vector3d& camera,
                       const Vector3d& face) {
  const auto people = world.people();
  others_.clear();
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (i != person)
      others_.push_back({people[i].position, people[i].radius, kEyes * people[i].height + 0.12});
  }
  const Vector3d way = face - camera;
  const double distance = way.norm();
  const double yaw = std::atan2(way.y(), way.x());
  const double pitch = -std::asin(std::clamp(way.z() / distance, -1.0, 1.0));
  caster_.cast(world.scene(), sight_, {camera, geometry::from_roll_pitch_yaw(0.0, pitch, yaw)},
               {.max_range = distance + 1.0, .glass_flags = see_through_, .glass_cosine = 2.0},
               others_, hits_);
  return static_cast<double>(hits_.range[1]) < distance - 0.02;
}

bool FaceModel::tell(const World& world, const geometry::Pose3& camera, double column, double row,
                     double side, double depth, std::vector<ModelledFace>& faces) const {
  const rendering::Lens& lens = config_.lens;
  const double half = 0.5 * side;
  if (column - half < 0.0 || column + half > lens.width || row - half < 0.0 ||
      row + half > lens.height || faces.size() == kMost)
    return false;
  const Vector3d at = camera * Vector3d(depth, -(column - 0.5 - lens.cx) / lens.fx * depth,
                                        -(row - 0.5 - lens.cy) / lens.fy * depth);
  const Point2 in_base = inverse(world.base().truth().pose) * Point2(at.x(), at.y());
  faces.push_back({column - half, row - half, side, depth, in_base.norm(),
                   std::atan2(in_base.y(), in_base.x()), at.z()});
  return true;
}

void FaceModel::find(const World& world, const DepthCamera& camera,
                     std::vector<ModelledFace>& faces) {
  faces.clear();
  const geometry::Pose3 pose = camera.pose(world);
  const rendering::Lens& lens = config_.lens;
  const auto people = world.people();
  for (std::size_t i = 0; i < people.size(); ++i) {
    const Vector3d face = face_of(people[i]);
    const Vector3d seen = inverse(pose) * face;
    if (seen.x() < config_.nearest || seen.x() > config_.farthest) continue;
    const double column = lens.cx + 0.5 - lens.fx * seen.y() / seen.x();
    const double row = lens.cy + 0.5 - lens.fy * seen.z() / seen.x();
    if (column < 0.0 || column > lens.width || row < 0.0 || row > lens.height) continue;
    const Vector3d to_camera = pose.translation - face;
    const double past =
        std::abs(geometry::shortest_turn(people[i].yaw, std::atan2(to_camera.y(), to_camera.x())));
    if (past > config_.turned || hidden(world, i, pose.translation, face)) continue;
    const double depth = seen.x() * (1.0 + random_.gaussian(0.0, config_.depth_spread));
    const double side =
        lens.fx * config_.side / seen.x() * (1.0 + random_.gaussian(0.0, config_.side_spread));
    const double across = random_.gaussian(0.0, config_.pixels);
    const double down = random_.gaussian(0.0, config_.pixels);
    if (random_.uniform() < config_.missed) continue;
    tell(world, pose, column + across, row + down, side, depth, faces);
  }
  std::erase_if(false_, [this](const False&) { return random_.uniform() >= config_.again; });
  if (random_.uniform() < config_.false_alarms) {
    false_.push_back({lens.width * random_.uniform(), lens.height * random_.uniform(),
                      kNearFalse + (config_.farthest - kNearFalse) * random_.uniform()});
  }
  for (const False& one : false_)
    tell(world, pose, one.column, one.row, lens.fx * config_.side / one.depth, one.depth, faces);
  std::sort(faces.begin(), faces.end(),
            [](const ModelledFace& a, const ModelledFace& b) { return a.depth < b.depth; });
}

}  // namespace usher::world
