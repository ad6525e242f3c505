#include "tasks/service/shell/messages.hpp"

#include "wire/conversions.hpp"

namespace usher::service {

namespace {
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace state = usher_msgs::msg::SupervisorStatus_Constants;
}  // namespace

Supervisor supervisor_from(std::uint8_t value) {
  switch (value) {
    case state::STATE_INITIALISE:
      return Supervisor::kNotReady;
    case state::STATE_INACTIVE:
      return Supervisor::kInactive;
    case state::STATE_INTERACTION:
      return Supervisor::kAvailable;
    case state::STATE_NAVIGATION_START:
    case state::STATE_NAVIGATION_ACTIVE:
    case state::STATE_NAVIGATION_END:
      return Supervisor::kNavigation;
    case state::STATE_MANUAL:
      return Supervisor::kManual;
    case state::STATE_FAULT:
      return Supervisor::kFault;
    default:
      return Supervisor::kUnknown;
  }
}

std::uint8_t command_for(RequestKind kind) {
  switch (kind) {
    case RequestKind::kNavigationStart:
      return command::COMMAND_NAVIGATION_START;
    case RequestKind::kNavigationGo:
      return command::COMMAND_NAVIGATION_GO;
    case RequestKind::kNavigationEnd:
      return command::COMMAND_NAVIGATION_END;
    case RequestKind::kStop:
      return command::COMMAND_STOP;
    case RequestKind::kMovementOn:
      return command::COMMAND_MOVEMENT_ON;
  }
  return command::COMMAND_NONE;
}

usher_msgs::msg::DialogueScreen to_message(const Screen& screen, runtime::Time now) {
  usher_msgs::msg::DialogueScreen message;
  message.header(wire::header(now, ""));
  message.id(screen.id);
  message.state(screen.state);
  message.language(screen.language);
  message.content(static_cast<std::uint8_t>(screen.content));
  message.title(screen.title);
  message.text(screen.text);
  message.status(screen.status);
  message.spoken(screen.spoken);
  message.spoken_id(screen.spoken_id);
  message.tone(static_cast<std::uint8_t>(screen.tone));
  message.listens(screen.listens);
  for (const auto& option : screen.options) {
    auto& entry = message.options().emplace_back();
    entry.id(option.id);
    entry.label(option.label);
    entry.kind(static_cast<std::uint8_t>(option.kind));
    entry.panel(static_cast<std::uint8_t>(option.panel));
    entry.takes_text(option.takes_text);
  }
  message.place(screen.place);
  message.progress(static_cast<float>(screen.progress));
  message.eta(static_cast<float>(screen.eta));
  message.remaining(static_cast<float>(screen.remaining));
  message.time_left(static_cast<float>(screen.time_left));
  message.follower(static_cast<std::uint8_t>(screen.follower));
  return message;
}

}  // namespace usher::service
