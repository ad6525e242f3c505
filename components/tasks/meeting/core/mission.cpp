#include "tasks/meeting/core/mission.hpp"

namespace usher::meeting {

namespace {

constexpr std::array<std::string_view, kStates> kStateNames{
    "initialise", "idle",       "to_room", "scan_room", "check_room",
    "explore",    "check_face", "revisit", "approach",  "invite",
    "guide",      "look_back",  "arrived", "done",      "ended"};

constexpr std::array<std::string_view, kCauses> kCauseNames{
    "ready",     "not ready", "request", "arrived",   "no way", "face",     "lost",    "unseen",
    "confirmed", "near",      "scanned", "seen then", "yes",    "no",       "timeout", "more",
    "enough",    "limit",     "failure", "cancelled", "delay",  "elsewhere"};

}  // namespace

std::string_view text(State state) { return kStateNames[static_cast<std::size_t>(state)]; }
std::string_view text(Cause cause) { return kCauseNames[static_cast<std::size_t>(cause)]; }

}  // namespace usher::meeting
