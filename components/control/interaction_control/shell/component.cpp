#include "control/interaction_control/shell/component.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "control/interaction_control/shell/read_posing.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::interaction_control {

namespace {

using geometry::Point2;
using geometry::Pose2;
using std::chrono::milliseconds;
using namespace usher_msgs::msg::FaceTarget_Constants;

constexpr auto kPeriod = milliseconds(50);
constexpr int kStatusEvery = 4;  // 5 Hz
constexpr auto kTargetAge = milliseconds(500);
constexpr auto kOdometryAge = milliseconds(200);
constexpr auto kEnableAge = milliseconds(120);
constexpr auto kPeopleAge = milliseconds(500);
constexpr auto kGuideAge = milliseconds(1500);
constexpr auto kTorsoAge = milliseconds(300);
constexpr auto kSpeechAge = milliseconds(2000);
constexpr auto kLevelAge = milliseconds(200);
constexpr float kMostUnseen = 0.7F;  // [s] then a person counts as gone

/// Nothing without odometry, or with one that is no pose in the plane.
std::optional<Pose2> pose_of(const nav_msgs::msg::Odometry* odometry) {
  if (odometry == nullptr) return std::nullopt;
  const auto pose = wire::to_planar(odometry->pose().pose());
  return pose ? std::optional(*pose) : std::nullopt;
}

}  // namespace

Parameters InteractionControlComponent::read_parameters(runtime::Host& host) {
  auto& parameters = host.parameters();
  Parameters p;
  p.dead_zone = parameters.number("dead_zone", "rad", {0.02, 0.7}, p.dead_zone,
                                  "An error up to this is facing.");
  p.resume_zone = parameters.number("resume_zone", "rad", {0.03, 1.5}, p.resume_zone,
                                    "From this error on it turns again; above dead_zone.");
  p.gain = parameters.number("gain", "-", {0.2, 4}, p.gain, "Turn rate per error, in 1/s.");
  p.max_rate = parameters.number("max_rate", "rad/s", {0.1, 1}, p.max_rate, "Fastest turn.");
  p.min_rate = parameters.number("min_rate", "rad/s", {0, 0.1}, p.min_rate,
                                 "Slower than this the base does not turn.");
  p.search_rate = parameters.number("search_rate", "rad/s", {0.05, 0.5}, p.search_rate,
                                    "Of the turn while nobody is found.");
  if (p.resume_zone <= p.dead_zone) {
    std::ostringstream wrong;
    wrong << "resume_zone must be above dead_zone, got " << p.resume_zone << " rad and "
          << p.dead_zone << " rad";
    host.fault(wrong.str());
  }
  return p;
}

InteractionControlComponent::InteractionControlComponent(runtime::Host& host)
    : host_(host),
      parameters_(read_parameters(host)),
      face_(parameters_),
      thresholds_(read_thresholds(host.parameters())),
      posing_(read_posing(host, thresholds_)),
      rejected_(host.health().counter("targets: rejected")),
      rejected_people_(host.health().counter("people: rejected")) {
  target_ = host.input(
      topics::kInteractionTarget,
      {.max_age = kTargetAge, .on_loss = "turns no further", .optional = true},
      [this](const auto& target, const auto&) { aim(target); }, [this] { face_.stand(); });
  odom_ = host.input(topics::kOdom, {.max_age = kOdometryAge, .on_loss = "stands"});
  enable_ = host.input(topics::kMovementEnable,
                       {.max_age = kEnableAge, .on_loss = "stands, the torso holds still"});
  people_ = host.input(topics::kPeople,
                       {.max_age = kPeopleAge, .on_loss = "poses for nobody", .optional = true});
  guide_ = host.input(topics::kGuideStatus,
                      {.max_age = kGuideAge, .on_loss = "seeks nobody", .optional = true});
  torso_ = host.input(topics::kTorsoStatus,
                      {.max_age = kTorsoAge,
                       .on_loss = "tells the torso nothing; starts from where it is afterwards",
                       .optional = true});
  speech_ =
      host.input(topics::kSpeechStatus,
                 {.max_age = kSpeechAge, .on_loss = "holds still for nobody", .optional = true});
  level_ = host.input(topics::kSpeechLevel,
                      {.max_age = kLevelAge, .on_loss = "eyes as in silence", .optional = true});
  command_ = host.output(topics::kCmdVelInteraction);
  frame_ = host.output(topics::kTorsoFrame);
  status_ = host.output(topics::kInteractionStatus);
  timer_ = host.timer("drive", kPeriod, [this](auto) { tick(); });
  host.health().set(runtime::HealthState::kOk);
}

void InteractionControlComponent::aim(const usher_msgs::msg::FaceTarget& target) {
  const auto odom_T_base = pose_of(odom_.fresh());
  const bool known = target.mode() <= MODE_SEARCH && std::isfinite(target.bearing());
  if (!known) ++rejected_;
  if (known && target.mode() == MODE_SEARCH) {
    face_.search(target.bearing() >= 0.0);
  } else if (known && target.mode() == MODE_FACE && odom_T_base) {
    face_.face(odom_T_base->yaw + target.bearing());
  } else {
    face_.stand();
  }
}

std::vector<Sighting> InteractionControlComponent::people_around(const Pose2& odom_T_base) {
  std::vector<Sighting> people;
  const auto* known = people_.fresh();
  if (known == nullptr) return people;
  const Pose2 base_T_odom = inverse(odom_T_base);
  people.reserve(known->people().size());
  for (const auto& person : known->people()) {
    const Point2 place = base_T_odom * Point2(person.x(), person.y());
    if (!place.allFinite()) {
      ++rejected_people_;
    } else if (person.unseen() < kMostUnseen) {
      people.push_back({person.id(), {place.norm(), std::atan2(place.y(), place.x())}});
    }
  }
  return people;
}

Occasion InteractionControlComponent::occasion() const {
  const auto* enable = enable_.fresh();
  if (enable == nullptr || !enable->movement()) return Occasion::kHold;
  if (enable->interaction_control()) return Occasion::kInteract;
  return enable->navigation() || enable->manual() ? Occasion::kDrive : Occasion::kHold;
}

bool InteractionControlComponent::listens() const {
  namespace state = usher_msgs::msg::SpeechStatus_Constants;
  const auto* speech = speech_.fresh();
  return speech != nullptr && (speech->hears() || speech->state() == state::STATE_LISTENING ||
                               speech->state() == state::STATE_ASKING);
}

/// Somebody speaks, whose words the motors would drown.
bool InteractionControlComponent::hears() const {
  const auto* speech = speech_.fresh();
  return speech != nullptr && speech->hears();
}

/// The guide has nobody to serve, and nobody is there either.
bool InteractionControlComponent::seeks() const {
  const auto* guide = guide_.fresh();
  return guide != nullptr && guide->seeks() && posing_.zone() == nullptr;
}

std::optional<kinematics::TorsoPose> InteractionControlComponent::torso() const {
  const auto* status = torso_.fresh();
  if (status == nullptr || !status->moves() || !kinematics::finite(status->joints()))
    return std::nullopt;
  return status->joints();
}

void InteractionControlComponent::tick() {
  const auto odom_T_base = pose_of(odom_.fresh());
  pose(odom_T_base);
  drive(odom_T_base);
  if (++ticks_ % kStatusEvery == 0) publish_status(odom_T_base.has_value());
}

void InteractionControlComponent::pose(const std::optional<Pose2>& odom_T_base) {
  const auto people = odom_T_base ? people_around(*odom_T_base) : std::vector<Sighting>{};
  const auto* level = level_.fresh();
  posing_.step({.occasion = occasion(),
                .people = people,
                .torso = torso(),
                .listens = listens(),
                .level = level != nullptr ? level->level() : 0.0},
               runtime::seconds(kPeriod));
  if (!posing_.shows()) return;
  usher_msgs::msg::TorsoFrame frame;
  frame.header(wire::header(host_.now(), ""));
  frame.joints(posing_.joints());
  frame.left_eye(posing_.eyes().left());
  frame.right_eye(posing_.eyes().right());
  frame_.publish(frame);
}

void InteractionControlComponent::drive(const std::optional<Pose2>& odom_T_base) {
  // Who tells it whom to face knows better than the zones.
  if (target_.fresh() == nullptr && odom_T_base) {
    if (posing_.tracks()) {
      face_.face(odom_T_base->yaw + posing_.person()->place.bearing);
    } else if (seeks()) {
      face_.search(true);
    } else {
      face_.stand();
    }
  }
  // Whoever talks somewhere in the room does not end the search.
  const bool hushes = hears() && !face_.searches();
  const auto* enable = enable_.fresh();
  geometry::Twist2 twist;
  if (odom_T_base && enable != nullptr && enable->interaction_control() && !hushes)
    twist.w = face_.step(odom_T_base->yaw);
  auto message = wire::to_message(host_.now(), twist);
  message.header().frame_id(frames::kBaseFootprint);
  command_.publish(message);
}

void InteractionControlComponent::publish_status(bool located) {
  constexpr float kNobody = std::numeric_limits<float>::quiet_NaN();
  const auto* enable = enable_.fresh();
  const auto& person = posing_.person();
  const bool torso_obeys = !posing_.has_zones() || torso().has_value();
  usher_msgs::msg::InteractionStatus message;
  message.header(wire::header(host_.now(), ""));
  message.zone_change_range_threshold(static_cast<float>(thresholds_.range));
  message.zone_change_bearing_threshold(static_cast<float>(thresholds_.bearing));
  message.segway_tracking_deadzone(static_cast<float>(parameters_.dead_zone));
  message.enable_interaction(enable != nullptr && enable->interaction_control());
  message.human_detected(person.has_value());
  message.segway_tracking(posing_.tracks());
  message.ok(located && enable != nullptr && torso_obeys);
  message.human_range(person ? static_cast<float>(person->place.range) : kNobody);
  message.human_bearing(person ? static_cast<float>(person->place.bearing) : kNobody);
  message.zone(posing_.zone() != nullptr ? posing_.zone()->name : "");
  message.pose(posing_.pose() != nullptr ? posing_.pose()->name : "");
  message.posed(posing_.posed());
  message.listens(listens());
  status_.publish(message);
  host_.health().set(torso_obeys ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
                     torso_obeys ? "" : "the torso does not obey");
}

}  // namespace usher::interaction_control
