#include "perception/visitor_tracker/shell/component.hpp"

#include <cmath>

#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::visitor_tracker {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kPeopleAge = milliseconds(400);
constexpr auto kOdometryAge = milliseconds(200);
constexpr auto kGuideAge = milliseconds(3000);

bool finite(const usher_msgs::msg::Person& person) {
  return std::isfinite(person.x()) && std::isfinite(person.y()) && std::isfinite(person.vx()) &&
         std::isfinite(person.vy()) && person.unseen() >= 0.0F && person.age() >= 0.0F;
}

}  // namespace

Config VisitorTrackerComponent::read_config(runtime::Parameters& p) {
  Config c;
  c.within = p.number("within", "m", {0.5, 6}, c.within, "Farther nobody stands before the robot.");
  c.bearing = p.number("bearing", "rad", {0.1, 1.6}, c.bearing,
                       "Nor farther than this to either side of ahead.");
  c.stands_below =
      p.number("stands_below", "m/s", {0.1, 2}, c.stands_below, "Who is slower stands.");
  c.passes_at = p.number("passes_at", "m", {0.2, 2}, c.passes_at,
                         "Who walks by the robot's middle farther off than this passes by.");
  c.dwell = p.number("dwell", "s", {0, 5}, c.dwell,
                     "So long before the robot until somebody is its visitor.");
  c.unseen = p.number("unseen", "s", {0.2, 2}, c.unseen,
                      "The visitor who is not seen for so long counts as not seen.");
  c.blind_from = p.number("blind_from", "rad", {0, 3.15}, c.blind_from,
                          "To either side: from here on the laser does not look.");
  c.blind_to =
      p.number("blind_to", "rad", {0, 3.15}, c.blind_to, "From here on the rear camera looks.");
  c.blind_for = p.number("blind_for", "s", {0, 60}, c.blind_for,
                         "A follower who went in between counts as seen for so long.");
  c.trail = p.number("trail", "m", {0.3, 3}, c.trail,
                     "So far beside the robot's way a follower may walk.");
  c.follows = p.number("follows", "s", {0.2, 5}, c.follows,
                       "So long must follow whoever is taken for a visitor whose identity broke.");
  c.farthest = p.number("farthest", "m", {2, 20}, c.farthest,
                        "The visitor whom the robot follows counts as seen up to here.");
  c.returns = p.number("returns", "s", {0.5, 10}, c.returns,
                       "So long stands at the robot whoever is the visitor whom it has lost.");
  return c;
}

VisitorTrackerComponent::VisitorTrackerComponent(runtime::Host& host)
    : host_(host),
      core_(read_config(host.parameters())),
      rejected_(host.health().counter("people: rejected")) {
  input_ = host.input(
      topics::kPeople,
      {.max_age = kPeopleAge, .on_loss = "the visitor is unknown: nobody is waited for"},
      [this](const auto& people, const auto&) { take(people); },
      [this] {
        publish(core_.lose(), host_.now());
        report();
      });
  odom_ = host.input(topics::kOdom, {.max_age = kOdometryAge,
                                     .on_loss = "the visitor is unknown: nobody is waited for"});
  guide_ = host.input(
      topics::kGuideStatus,
      {.max_age = kGuideAge, .on_loss = "looks for who stands before the robot", .optional = true});
  visitor_ = host.output(topics::kVisitor);
  report();
}

Service VisitorTrackerComponent::service() const {
  const auto* guide = guide_.fresh();
  if (guide == nullptr || !guide->serves()) return Service::kNobody;
  if (guide->follows()) return Service::kFollows;
  return guide->guides() ? Service::kGuides : Service::kTalks;
}

void VisitorTrackerComponent::take(const usher_msgs::msg::People& message) {
  people_.clear();
  people_.reserve(message.people().size());
  for (const auto& person : message.people()) {
    if (!finite(person)) {
      ++rejected_;
      continue;
    }
    people_.push_back({person.id(),
                       {person.x(), person.y()},
                       {person.vx(), person.vy()},
                       person.age(),
                       person.unseen(),
                       static_cast<double>(person.height()),
                       {wire::from_message(person.kinect_appearance()),
                        wire::from_message(person.rear_appearance())}});
  }
  const runtime::Time stamp = wire::from_message(message.header().stamp());
  const auto* odometry = odom_.fresh();
  const auto pose = odometry != nullptr ? wire::to_planar(odometry->pose().pose())
                                        : Result<geometry::Pose2>(Error{"no odometry"});
  publish(pose ? core_.update({.time = runtime::seconds(stamp.time_since_epoch()),
                               .odom_T_base = *pose,
                               .service = service(),
                               .people = people_,
                               .looks_ahead = message.kinect_looks(),
                               .looks_behind = message.rear_looks()})
               : core_.lose(),
          stamp);
  report();
}

void VisitorTrackerComponent::publish(const Estimate& estimate, runtime::Time stamp) {
  namespace seen = usher_msgs::msg::Visitor_Constants;
  usher_msgs::msg::Visitor message;
  const bool there = estimate.presence == Presence::kSeen;
  message.header(wire::header(stamp, frames::kBaseFootprint));
  message.presence(there                                    ? seen::PRESENCE_SEEN
                   : estimate.presence == Presence::kNobody ? seen::PRESENCE_NOBODY
                                                            : seen::PRESENCE_UNKNOWN);
  message.person(estimate.person);
  message.x(estimate.place.x());
  message.y(estimate.place.y());
  message.speed(static_cast<float>(estimate.speed));
  visitor_.publish(message);
}

void VisitorTrackerComponent::report() {
  const bool people = input_.fresh() != nullptr;
  const bool located = odom_.fresh() != nullptr;
  host_.health().set(people && located ? HealthState::kOk : HealthState::kDegraded,
                     !people    ? "nobody says who is around"
                     : !located ? "no odometry"
                                : "");
}

}  // namespace usher::visitor_tracker
