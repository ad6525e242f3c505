#include "control/manual_control/shell/component.hpp"

#include <algorithm>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::manual_control {

namespace {

using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;

constexpr auto kPeriod = milliseconds(50);
/// Nobody expects a button to act later than this.
constexpr auto kLongestWait = milliseconds(2000);

std::uint8_t command_for(Wish wish) {
  switch (wish) {
    case Wish::kMovementOn:
      return command::COMMAND_MOVEMENT_ON;
    case Wish::kMovementOff:
      return command::COMMAND_STOP;
    case Wish::kManualOn:
      return command::COMMAND_MANUAL_ON;
    case Wish::kManualOff:
      return command::COMMAND_MANUAL_OFF;
    case Wish::kNone:
      break;
  }
  return command::COMMAND_NONE;
}

}  // namespace

Parameters ManualControlComponent::read_parameters(runtime::Parameters& parameters) {
  Parameters p;
  const auto index = [&](std::size_t& value, const char* name, double most, const char* text) {
    value = static_cast<std::size_t>(
        parameters.integer(name, "-", {0, most}, static_cast<std::int64_t>(value), text));
  };
  index(p.mapping.forward_axis, "forward_axis", 63, "Stick that drives; forward is positive.");
  index(p.mapping.turn_axis, "turn_axis", 63, "Stick that turns; left is positive.");
  index(p.mapping.dead_man, "dead_man_button", 127, "The robot drives only while it is held.");
  index(p.mapping.movement_on, "movement_on_button", 127, "Ends the operator's stop.");
  index(p.mapping.movement_off, "movement_off_button", 127, "Standard stop.");
  index(p.mapping.manual_on, "manual_on_button", 127, "The operator takes over.");
  index(p.mapping.manual_off, "manual_off_button", 127, "The operator gives back.");
  p.linear = parameters.number("linear", "m/s", {0.1, 1.4}, p.linear, "At full deflection.");
  p.angular = parameters.number("angular", "rad/s", {0.1, 1.5}, p.angular, "At full deflection.");
  p.dead_zone = parameters.number("dead_zone", "-", {0, 0.5}, p.dead_zone,
                                  "Share of a stick's way that counts as rest.");
  return p;
}

ManualControlComponent::ManualControlComponent(runtime::Host& host)
    : host_(host),
      core_(read_parameters(host.parameters())),
      rejected_(host.health().counter("joy: rejected")),
      requests_(host, topics::kSupervisorRequest) {
  joy_ = host.input(
      topics::kJoy,
      {.max_age = milliseconds(250),
       .on_loss = "takes the dead-man button as released",
       .optional = true,
       .late_too = true},
      [this](const auto& joy, const auto& info) { take(joy, info); }, [this] { drive(); });
  supervisor_ = host.input(
      topics::kSupervisorStatus, {.optional = true}, [this](const auto& status, const auto&) {
        if (requests_.answered(status.last_request(), status.last_request_client()))
          asks_to_stop_ = false;
      });
  command_ = host.output(topics::kCmdVelManual);
  timer_ = host.timer("drive", kPeriod, [this](auto) {
    drive();
    const bool too_late = !asks_to_stop_ && host_.now() - asked_at_ > kLongestWait;
    if (requests_.waits() && too_late) requests_.give_up();
  });
  host.health().set(runtime::HealthState::kOk);
}

/// Of its participant; empty where discovery does not know it yet.
const std::string& ManualControlComponent::name_of(const runtime::Guid& writer) {
  if (heard_.guid != writer || heard_.participant.empty()) {
    const auto all = joy_.writers();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.guid == writer; });
    heard_ = found == all.end() ? runtime::WriterInfo{} : *found;
  }
  return heard_.participant;
}

void ManualControlComponent::take(const sensor_msgs::msg::Joy& joy,
                                  const runtime::SampleInfo& info) {
  const std::string& writer = name_of(info.writer);
  // What its buttons mean is not known before discovery tells whose they are: a moment later.
  if (writer.empty()) return;
  const bool held = core_.held();
  const bool late = joy_.fresh() == nullptr;
  const Wish wish =
      core_.take({info.writer, joy.axes(), joy.buttons(), late, writer == kKeyboard}, now());
  rejected_ = core_.rejected();
  if (wish != Wish::kNone) ask(wish);
  if (held || core_.held()) drive();
}

void ManualControlComponent::ask(Wish wish) {
  const bool movement = wish == Wish::kMovementOff || wish == Wish::kMovementOn;
  if (asks_to_stop_ && !movement) return;
  requests_.give_up();  // the last button that was pressed is what is meant
  asks_to_stop_ = wish == Wish::kMovementOff;
  usher_msgs::msg::SupervisorRequest request;
  request.id(requests_.next_id());
  request.command(command_for(wish));
  requests_.ask(request);
  asked_at_ = host_.now();
}

void ManualControlComponent::drive() {
  auto twist = core_.command(now());
  // While it is its turn it is never silent: movement_control hears nobody beside it then.
  const auto* status = supervisor_.latest();
  if (!twist && status != nullptr &&
      status->state() == usher_msgs::msg::SupervisorStatus_Constants::STATE_MANUAL)
    twist = geometry::Twist2{};
  if (!twist) return;
  auto message = wire::to_message(host_.now(), *twist);
  message.header().frame_id(frames::kBaseFootprint);
  command_.publish(message);
}

}  // namespace usher::manual_control
