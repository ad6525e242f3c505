#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "idl/topics.hpp"

namespace usher::operations {

/// A request for a meeting, until the meeting assistant has answered it. Not thread-safe.
class MeetingCall {
 public:
  /// @param persons to be brought, 1 to 100
  /// @param time_limit [s] up to 3600; 0 = the assistant's own
  MeetingCall(std::uint32_t persons, double time_limit);
  /// The request, when it is time to send it: 5 Hz until there is an answer.
  std::optional<usher_msgs::msg::MeetingRequest> due();
  void take(const usher_msgs::msg::MeetingStatus& status);
  /// The newest status is that of this call's mission.
  bool taken() const { return taken_; }
  /// Why it was refused; empty = it was not.
  const std::string& refusal() const { return refusal_; }
  std::uint64_t id() const { return request_.id(); }

 private:
  usher_msgs::msg::MeetingRequest request_;
  std::chrono::steady_clock::time_point sent_{};
  bool taken_ = false;
  std::string refusal_;
};

/// "looks for people, 1 of 2 there": what the assistant does, in a few words.
std::string meeting_progress(const usher_msgs::msg::MeetingStatus& status);

}  // namespace usher::operations
