#include "operations/command_line/meeting_client.hpp"

#include <array>
#include <cmath>

#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"

namespace usher::operations {

namespace {

constexpr auto kRepeat = std::chrono::milliseconds(200);
constexpr std::array<const char*, 15> kDoes{"waits for the robot",
                                            "waits for a request",
                                            "drives to a meeting room",
                                            "looks round in the room",
                                            "looks at a face in the room",
                                            "looks for people",
                                            "looks at a face",
                                            "drives to somebody whom it saw on the way",
                                            "drives to a person",
                                            "invites",
                                            "brings a person to the room",
                                            "looks back whether the person follows",
                                            "has brought a person",
                                            "has brought everybody",
                                            "has ended"};

}  // namespace

MeetingCall::MeetingCall(std::uint32_t persons, double time_limit) {
  request_.id(fresh_id());
  request_.client(kOperatorName);
  request_.persons(persons);
  request_.time_limit(static_cast<float>(time_limit));
}

std::optional<usher_msgs::msg::MeetingRequest> MeetingCall::due() {
  const auto now = std::chrono::steady_clock::now();
  if (taken_ || !refusal_.empty() || now - sent_ < kRepeat) return std::nullopt;
  sent_ = now;
  return request_;
}

void MeetingCall::take(const usher_msgs::msg::MeetingStatus& status) {
  const auto& mission = status.mission();
  taken_ = mission.id() == request_.id() && mission.client() == request_.client();
  const bool answered =
      status.last_request() == request_.id() && status.last_client() == request_.client();
  if (answered && !taken_) refusal_ = status.reason().empty() ? "refused" : status.reason();
}

std::string meeting_progress(const usher_msgs::msg::MeetingStatus& status) {
  const auto& mission = status.mission();
  std::string line = status.state() < kDoes.size() ? kDoes[status.state()] : "?";
  if (!mission.room().empty()) line += ", meeting in " + mission.room();
  line += ", " + std::to_string(mission.brought()) + " of " + std::to_string(mission.wanted()) +
          " there";
  if (std::isfinite(status.time_left())) line += format(", %.0f s left", status.time_left());
  // Why somebody else's request was refused is not this mission's reason.
  const bool refusal = status.last_request() != mission.id();
  if (!status.reason().empty() && !refusal) line += ": " + status.reason();
  return line;
}

}  // namespace usher::operations
