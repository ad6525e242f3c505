#include "tasks/guide/core/dialogue.hpp"

#include <algorithm>

namespace usher::guide {

namespace {

constexpr std::array<std::string_view, 17> kStates{
    "initialise",    "inactive",    "introduction",  "location_ask", "location_options",
    "location_show", "guide_ask",   "guide_options", "guide_start",  "guide_active",
    "guide_paused",  "guide_error", "guide_success", "follow_me",    "end_ask",
    "feedback",      "end"};
static_assert(kStates.size() == static_cast<std::size_t>(State::kEnd) + 1);

constexpr std::array<std::string_view, 11> kCauses{"ready", "not ready", "visitor", "yes",
                                                   "no",    "choice",    "delay",   "timeout",
                                                   "left",  "arrived",   "failure"};
static_assert(kCauses.size() == static_cast<std::size_t>(Cause::kFailure) + 1);

}  // namespace

std::string_view text(State state) { return kStates[static_cast<std::size_t>(state)]; }
std::string_view text(Cause cause) { return kCauses[static_cast<std::size_t>(cause)]; }

std::optional<State> state_of(std::string_view text) {
  const auto found = std::find(kStates.begin(), kStates.end(), text);
  if (found == kStates.end()) return std::nullopt;
  return static_cast<State>(found - kStates.begin());
}

}  // namespace usher::guide
