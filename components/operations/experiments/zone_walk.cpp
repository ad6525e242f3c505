#include "operations/experiments/zone_walk.hpp"

#include <cmath>
#include <utility>

#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;

constexpr const char* kVisitor = "visitor";
constexpr auto kSample = milliseconds(50);

/// So wide that nothing but the visitor is near.
constexpr const char* kWorld = R"(name: hall
ceiling: 3.5
rooms: [{name: hall, title: Hall, area: [-6, -6, 6, 6]}]
walls: [{name: hall, thickness: 0.1, points: [[-6, -6], [6, -6], [6, 6], [-6, 6], [-6, -6]]}]
)";
constexpr const char* kPeople = "people: [{name: visitor, at: [4.5, 0.5], yaw: 3.14}]\n";

}  // namespace

Hall ZoneWalk::hall() { return {.world = kWorld, .people = kPeople, .start = {0.0, 0.0, 0.0}}; }

Result<std::unique_ptr<ZoneWalk>> ZoneWalk::create(const Installation& installation,
                                                   const std::string& folder,
                                                   const std::vector<Override>& overrides,
                                                   std::uint64_t seed) {
  std::vector<Override> all = overrides;
  all.push_back({"world", "people", "true"});
  const auto deployment = deploy_in_hall(hall(), "marvin-sim", folder, installation, all);
  if (!deployment) return Error{deployment.error()};
  auto run = LockstepRun::create(*deployment, seed);
  if (!run) return Error{run.error()};
  return std::unique_ptr<ZoneWalk>(new ZoneWalk(std::move(run).value()));
}

ZoneWalk::ZoneWalk(std::unique_ptr<LockstepRun> run) : run_(std::move(run)) {
  auto& world = run_->world();
  world.observe(topics::kSimGroundTruth, [this](const auto& truth, const auto&) {
    if (const auto pose = wire::to_planar(truth.pose())) map_T_base_ = *pose;
    for (const auto& person : truth.people()) {
      if (person.name() == kVisitor) visitor_ = {person.x(), person.y()};
    }
    const Point2 place = inverse(map_T_base_) * visitor_;
    now_.range = place.norm();
    now_.bearing = std::atan2(place.y(), place.x());
    now_.yaw = map_T_base_.yaw;
  });
  world.observe(topics::kInteractionStatus, [this](const auto& status, const auto&) {
    now_.zone = status.zone();
    now_.pose = status.pose();
    now_.posed = status.posed();
    poses_ = status.ok() && status.enable_interaction();
  });
  world.observe(topics::kTorsoStatus, [this](const auto& status, const auto&) {
    now_.joints = status.joints();
    now_.left_eye = status.left_eye();
  });
}

void ZoneWalk::speak() {
  namespace state = usher_msgs::msg::SpeechStatus_Constants;
  usher_msgs::msg::SpeechStatus status;
  status.header(wire::header(run_->world().now(), ""));
  status.state(listens_ ? state::STATE_LISTENING : state::STATE_SILENT);
  run_->world().publish(topics::kSpeechStatus, status, "speech");
}

void ZoneWalk::run(double seconds) {
  const auto end = run_->world().now() + runtime::from_seconds(seconds);
  while (run_->world().now() < end) {
    speak();
    run_->world().run_for(kSample);
    now_.t = runtime::seconds(run_->world().elapsed());
    samples_.push_back(now_);
  }
}

Status ZoneWalk::get_ready() {
  for (int i = 0; i < 60 && !poses_; ++i) run(1.0);
  if (!poses_) return Error{"the robot does not come to pose anybody:\n" + run_->complaints()};
  samples_.clear();
  return {};
}

void ZoneWalk::send(double range, double bearing, double speed) {
  goal_ = map_T_base_ * Point2(range * std::cos(bearing), range * std::sin(bearing));
  usher_sim_msgs::msg::PersonGoal goal;
  goal.name(kVisitor);
  goal.x(goal_.x());
  goal.y(goal_.y());
  goal.speed(speed);
  run_->world().publish(topics::kSimPersonGoal, goal, kVisitor);
}

void ZoneWalk::arrive(double longest) {
  const double end = now_.t + longest;
  do {
    run(0.2);
  } while ((visitor_ - goal_).norm() > 0.15 && now_.t < end);
}

}  // namespace usher::operations
