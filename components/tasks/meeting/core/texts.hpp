#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace usher::meeting {

/// What the assistant says and shows; a key of the section `meeting` in
/// config/dialogue/<language>.yaml.
enum class Text : std::size_t {
  kNotReady,
  kReady,
  kLooksForRoom,
  kLooksRound,
  kLooksForPeople,
  kOneMoment,
  kComing,
  kInvitation,
  kWouldYou,
  kFollowMe,
  kWithMe,
  kComeIn,
  kWhereAreYou,
  kThankYou,
  kThere,
  kCount,
  kAllThere,
  kEnded,
  kListening,
  kYes,
  kNo,
  kLeave,
  kStopped,
};

inline constexpr std::array<std::string_view, 23> kTextKeys{
    "not_ready",  "ready",     "looks_for_room", "looks_round", "looks_for_people",
    "one_moment", "coming",    "invitation",     "would_you",   "follow_me",
    "with_me",    "come_in",   "where_are_you",  "thank_you",   "there",
    "count",      "all_there", "ended",          "listening",   "yes",
    "no",         "leave",     "stopped"};
static_assert(static_cast<std::size_t>(Text::kStopped) + 1 == kTextKeys.size());

}  // namespace usher::meeting
