#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/result/result.hpp"
#include "tasks/guide/core/follow_check.hpp"

namespace usher::guide {

/// How a visit ended. The numbers are those on the wire.
enum class Outcome : std::uint8_t {
  kOpen = 0,
  kLeft = 1,     ///< went away or let a question run out
  kEnded = 2,    ///< said goodbye without a journey
  kArrived = 3,  ///< was guided at least once
  kGivenUp = 4,  ///< a journey ended before the place, and no other one reached it
};

/// One visit, from the greeting to the goodbye.
struct Visit {
  std::uint64_t id = 0;
  Outcome outcome = Outcome::kOpen;
  std::string place;                                      ///< the last one that was asked for
  bool greeted = false;                                   ///< the robot spoke first
  std::uint32_t touches = 0, utterances = 0, others = 0;  ///< accepted answers by input
  std::uint32_t ignored = 0;               ///< answers that came late or named nothing
  std::uint32_t started = 0, arrived = 0;  ///< journeys
  std::uint32_t waits = 0;                 ///< for the visitor
  Time duration{};
  Time travel_time{};  ///< of all journeys
  double eta_error =
      kNothing;  ///< of the last arrival: its time over the ETA at departure, minus 1
  double largest_gap = kNothing;  ///< [m] behind a robot that did not wait
  /// Of the statements of the questionnaire, as far as it got: 0 skipped or not asked, 1 strongly
  /// disagrees .. 5 strongly agrees.
  std::vector<std::uint8_t> ratings;

  bool engaged() const { return touches + utterances + others > 0; }
};

/// Over all visits: how many came how far.
struct Funnel {
  std::uint64_t greeted = 0, engaged = 0, started = 0, arrived = 0, given_up = 0;
};

/// What a guide must not forget when it is restarted.
struct Memory {
  std::string state;     ///< of the dialogue, as on the screen; empty: nothing to resume
  std::string language;  ///< tag
  std::string place;     ///< name
  std::uint64_t goal_id = 0;
  bool stopped = false;  ///< this guide has asked the robot to stop
  bool stays = false;    ///< it looks for nobody until the next visit
  Visit visit;
  Funnel funnel;
  std::vector<std::string> recent;  ///< places that were reached, newest first
};

/// One line for each field. Times are left out: they start anew.
std::string to_text(const Memory& memory);

/// The inverse. Refuses anything else with the line and what was expected there.
Result<Memory> memory_from_text(std::string_view text);

}  // namespace usher::guide
