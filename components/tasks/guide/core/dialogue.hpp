#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace usher::guide {

/// The states of fig. 7.1 of the thesis; location options, paused, follow me and feedback are ours.
enum class State : std::uint8_t {
  kInitialise,       ///< the robot is not ready
  kInactive,         ///< nobody is served; the robot looks for people
  kIntroduction,     ///< a visitor came near
  kLocationAsk,      ///< see our location?
  kLocationOptions,  ///< which place is looked for?
  kLocationShow,     ///< the map
  kGuideAsk,         ///< shall I guide you?
  kGuideOptions,     ///< where to?
  kGuideStart,       ///< ready to go?
  kGuideActive,
  kGuidePaused,  ///< the visitor asked to stop
  kGuideError,   ///< another try?
  kGuideSuccess,
  kFollowMe,  ///< the robot goes behind the visitor
  kEndAsk,    ///< anything else?
  kFeedback,  ///< the statements of the questionnaire, one by one
  kEnd,       ///< goodbye
};

enum class Cause : std::uint8_t {
  kReady,     ///< the robot can serve
  kNotReady,  ///< it cannot
  kVisitor,   ///< somebody came
  kYes,       ///< a positive answer: yes, start, continue, done
  kNo,        ///< a negative one: no, cancel, stop
  kChoice,    ///< an option was chosen
  kDelay,     ///< it was shown long enough
  kTimeout,   ///< no answer
  kLeft,      ///< the visitor went away
  kArrived,   ///< the navigator reached the place
  kFailure,   ///< the navigator or the robot failed
};

struct Edge {
  State from;
  State to;
  Cause cause;
};

/// Every edge there is; to take another one is a programming error.
inline constexpr std::array kEdges{
    Edge{State::kInitialise, State::kInactive, Cause::kReady},
    Edge{State::kInactive, State::kInitialise, Cause::kNotReady},
    Edge{State::kInactive, State::kIntroduction, Cause::kVisitor},
    Edge{State::kInactive, State::kIntroduction, Cause::kChoice},
    Edge{State::kIntroduction, State::kIntroduction, Cause::kChoice},
    Edge{State::kIntroduction, State::kLocationAsk, Cause::kDelay},
    Edge{State::kIntroduction, State::kEnd, Cause::kLeft},
    Edge{State::kLocationAsk, State::kLocationShow, Cause::kYes},
    Edge{State::kLocationAsk, State::kGuideAsk, Cause::kNo},
    Edge{State::kLocationAsk, State::kGuideOptions, Cause::kChoice},
    Edge{State::kLocationAsk, State::kIntroduction, Cause::kChoice},
    Edge{State::kLocationAsk, State::kEnd, Cause::kTimeout},
    Edge{State::kLocationAsk, State::kEnd, Cause::kLeft},
    Edge{State::kLocationShow, State::kGuideAsk, Cause::kYes},
    Edge{State::kLocationShow, State::kLocationOptions, Cause::kChoice},
    Edge{State::kLocationShow, State::kGuideStart, Cause::kChoice},
    Edge{State::kLocationShow, State::kEnd, Cause::kTimeout},
    Edge{State::kLocationShow, State::kEnd, Cause::kLeft},
    Edge{State::kLocationOptions, State::kLocationOptions, Cause::kChoice},
    Edge{State::kLocationOptions, State::kLocationShow, Cause::kChoice},
    Edge{State::kLocationOptions, State::kGuideAsk, Cause::kNo},
    Edge{State::kLocationOptions, State::kEnd, Cause::kTimeout},
    Edge{State::kLocationOptions, State::kEnd, Cause::kLeft},
    Edge{State::kGuideAsk, State::kGuideOptions, Cause::kYes},
    Edge{State::kGuideAsk, State::kEndAsk, Cause::kNo},
    Edge{State::kGuideAsk, State::kLocationOptions, Cause::kChoice},
    Edge{State::kGuideAsk, State::kFollowMe, Cause::kChoice},
    Edge{State::kGuideAsk, State::kIntroduction, Cause::kChoice},
    Edge{State::kGuideAsk, State::kEnd, Cause::kTimeout},
    Edge{State::kGuideAsk, State::kEnd, Cause::kLeft},
    Edge{State::kGuideOptions, State::kGuideOptions, Cause::kChoice},
    Edge{State::kGuideOptions, State::kGuideStart, Cause::kChoice},
    Edge{State::kGuideOptions, State::kEndAsk, Cause::kNo},
    Edge{State::kGuideOptions, State::kEnd, Cause::kTimeout},
    Edge{State::kGuideOptions, State::kEnd, Cause::kLeft},
    Edge{State::kGuideStart, State::kGuideActive, Cause::kYes},
    Edge{State::kGuideStart, State::kEndAsk, Cause::kNo},
    Edge{State::kGuideStart, State::kGuideError, Cause::kFailure},
    Edge{State::kGuideStart, State::kEnd, Cause::kTimeout},
    Edge{State::kGuideStart, State::kEnd, Cause::kLeft},
    Edge{State::kGuideActive, State::kGuidePaused, Cause::kNo},
    Edge{State::kGuideActive, State::kEndAsk, Cause::kNo},
    Edge{State::kGuideActive, State::kGuideSuccess, Cause::kArrived},
    Edge{State::kGuideActive, State::kGuideError, Cause::kFailure},
    Edge{State::kGuideActive, State::kEnd, Cause::kLeft},
    Edge{State::kGuidePaused, State::kGuideActive, Cause::kYes},
    Edge{State::kGuidePaused, State::kEndAsk, Cause::kNo},
    Edge{State::kGuidePaused, State::kGuideSuccess, Cause::kArrived},
    Edge{State::kGuidePaused, State::kGuideError, Cause::kFailure},
    Edge{State::kGuidePaused, State::kEnd, Cause::kTimeout},
    Edge{State::kGuideError, State::kGuideOptions, Cause::kYes},
    Edge{State::kGuideError, State::kGuideAsk, Cause::kYes},
    Edge{State::kGuideError, State::kEndAsk, Cause::kNo},
    Edge{State::kGuideError, State::kEnd, Cause::kTimeout},
    Edge{State::kGuideError, State::kEnd, Cause::kLeft},
    Edge{State::kGuideSuccess, State::kEndAsk, Cause::kDelay},
    Edge{State::kFollowMe, State::kEndAsk, Cause::kYes},
    Edge{State::kFollowMe, State::kEndAsk, Cause::kNo},
    Edge{State::kFollowMe, State::kEndAsk, Cause::kTimeout},
    Edge{State::kFollowMe, State::kGuideError, Cause::kFailure},
    Edge{State::kFollowMe, State::kEnd, Cause::kLeft},
    Edge{State::kEndAsk, State::kLocationAsk, Cause::kYes},
    Edge{State::kEndAsk, State::kEnd, Cause::kNo},
    Edge{State::kEndAsk, State::kFeedback, Cause::kNo},
    Edge{State::kEndAsk, State::kEnd, Cause::kTimeout},
    Edge{State::kEndAsk, State::kEnd, Cause::kLeft},
    Edge{State::kFeedback, State::kFeedback, Cause::kChoice},
    Edge{State::kFeedback, State::kEnd, Cause::kYes},
    Edge{State::kFeedback, State::kEnd, Cause::kNo},
    Edge{State::kFeedback, State::kEnd, Cause::kTimeout},
    Edge{State::kFeedback, State::kEnd, Cause::kLeft},
    Edge{State::kEnd, State::kLocationAsk, Cause::kChoice},
    Edge{State::kEnd, State::kInactive, Cause::kDelay},
};

std::string_view text(State state);
std::string_view text(Cause cause);
/// The state of that name, if any.
std::optional<State> state_of(std::string_view text);

}  // namespace usher::guide
