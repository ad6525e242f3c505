#include "simulation/visitor/shell/attendees.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "wire/conversions.hpp"

namespace usher::visitor {

namespace {
using std::chrono::milliseconds;
constexpr auto kStep = milliseconds(200);
constexpr auto kTruthAge = milliseconds(500);
constexpr auto kDialogueAge = milliseconds(3000);
constexpr double kThrough = 0.4;  // [m] from the walls somebody has come through the door
constexpr double kBefore = 0.8;   // [rad] beside the robot's heading its screen can be read
namespace input = usher_msgs::msg::DialogueAnswer_Constants;
}  // namespace

AttendeesComponent::AttendeesComponent(runtime::Host& host)
    : host_(host), answers_(host, topics::kDialogueAnswer) {
  auto& p = host.parameters();
  const double reading = p.number("reading_time", "s", {0, 60}, 2.0,
                                  "How long an invitation is read before it is answered.");
  reach_ = p.number("reach", "m", {0.5, 5}, 2.0, "From there the robot's screen can be read.");
  speed_ = p.number("speed", "m/s", {0.1, 2}, 1.2, "How fast they walk.");
  const double stray = p.number("stray_time", "s", {0, 600}, 12.0, "How long who strays follows.");
  const auto invite = [&](const char* name, const char* text, Manner manner) {
    std::istringstream list(p.text(name, "", text));
    for (std::string one; list >> one;) people_.push_back({one, Attendee(manner, reading, stray)});
  };
  invite("come", "Names of people in the world who come along.", Manner::kComes);
  invite("decline", "Names of those who do not.", Manner::kDeclines);
  invite("silent", "Names of those who do not answer.", Manner::kSilent);
  invite("stray", "Names of those who stay behind on the way, the first time.", Manner::kStrays);
  rooms_ = wire::read_meeting_rooms(host);
  const auto place = [](const char* name) {
    return runtime::RecordField{name, runtime::ParameterKind::kNumber, "m", {-1e4, 1e4}, "In map."};
  };
  for (const auto& seat :
       p.records("site.seats",
                 {{"room", runtime::ParameterKind::kText, "-", {}, "Its location."},
                  place("x"),
                  place("y")},
                 "Where people go in meeting rooms, the first ones first.")) {
    seats_[seat.text("room")].emplace_back(seat.number("x"), seat.number("y"));
  }
  screen_ = host.input(topics::kDialogueScreen, {},
                       [this](const auto& screen, const auto&) { take(screen); });
  truth_ = host.input(topics::kSimGroundTruth, {.max_age = kTruthAge, .on_loss = "nobody answers"});
  meeting_ = host.input(topics::kMeetingStatus,
                        {.max_age = kDialogueAge, .on_loss = "nobody answers or follows"});
  walk_ = host.output(topics::kSimPersonGoal);
  timer_ = host.timer("step", kStep, [this](auto) { step(); });
  host.health().set(runtime::HealthState::kOk);
}

void AttendeesComponent::take(const usher_msgs::msg::DialogueScreen& screen) {
  answers_.answered(screen.answer_id(), screen.answer_client());
  shown_.id = screen.id();
  shown_.state = screen.state();
  room_ = screen.place();
}

/// The nearest one before the robot.
const AttendeesComponent::Somebody* AttendeesComponent::asked() const {
  const auto* truth = truth_.fresh();
  if (truth == nullptr) return nullptr;
  const auto robot = wire::to_planar(truth->pose());
  if (!robot) return nullptr;
  const Somebody* nearest = nullptr;
  double least = reach_;
  for (const auto& person : truth->people()) {
    const geometry::Point2 at = inverse(*robot) * geometry::Point2(person.x(), person.y());
    if (!(at.norm() < least) || std::abs(std::atan2(at.y(), at.x())) > kBefore) continue;
    for (const Somebody& somebody : people_) {
      if (somebody.name != person.name()) continue;
      nearest = &somebody;
      least = at.norm();
    }
  }
  return nearest;
}

/// Who is looked at from within the room does not wait at its door.
bool AttendeesComponent::is_called_in(const Somebody& somebody) const {
  const auto* truth = truth_.fresh();
  const auto room = std::find_if(rooms_.begin(), rooms_.end(),
                                 [&](const auto& each) { return each.name == room_; });
  if (truth == nullptr || room == rooms_.end() || shown_.state != "look_back") return false;
  const auto inside = [&](double x, double y) {
    const geometry::Point2 at(x, y);
    return (at.array() > room->low.array() + kThrough).all() &&
           (at.array() < room->high.array() - kThrough).all();
  };
  const auto person = std::find_if(truth->people().begin(), truth->people().end(),
                                   [&](const auto& each) { return each.name() == somebody.name; });
  return inside(truth->pose().position().x(), truth->pose().position().y()) &&
         person != truth->people().end() && !inside(person->x(), person->y());
}

void AttendeesComponent::choose_seat(Somebody& somebody) {
  const auto& seats = seats_[room_];
  if (seats.empty()) return;
  // By the place in the list, which is the same on all robots of a fleet.
  const auto which = static_cast<std::size_t>(&somebody - people_.data());
  somebody.seat = seats[which % seats.size()];
  somebody.has_seat = true;
}

void AttendeesComponent::step() {
  const double now = runtime::seconds(host_.now().time_since_epoch());
  // Nobody follows a robot that fell silent.
  const bool silent = meeting_.fresh() == nullptr;
  const Screen shown = silent ? Screen{} : shown_;
  const Somebody* before = silent ? nullptr : asked();
  for (Somebody& somebody : people_) {
    somebody.mind.see(shown, &somebody == before && !is_called_in(somebody), now);
    const std::uint64_t question = somebody.mind.screen_id();
    if (const auto choice = somebody.mind.answer(now)) {
      usher_msgs::msg::DialogueAnswer message;
      message.id(answers_.next_id());
      message.screen_id(question);
      message.option_id(*choice);
      message.input(input::INPUT_TOUCH);
      answers_.ask(std::move(message));
    }
    const Attendee::Walk walk = somebody.mind.walk();
    if (walk == Attendee::Walk::kToSeat && !somebody.has_seat) choose_seat(somebody);
    // Told once: somebody who stands may be guided by another robot of the fleet.
    if (walk == Attendee::Walk::kStand && !somebody.moved) continue;
    somebody.moved = walk != Attendee::Walk::kStand;
    usher_sim_msgs::msg::PersonGoal goal;
    goal.name(somebody.name);
    const bool stands =
        walk == Attendee::Walk::kStand || (walk == Attendee::Walk::kToSeat && !somebody.has_seat);
    goal.speed(stands ? 0.0 : speed_);
    goal.x(somebody.seat.x());
    goal.y(somebody.seat.y());
    goal.follow(walk == Attendee::Walk::kFollow);
    walk_.publish(goal);
  }
}

}  // namespace usher::visitor
