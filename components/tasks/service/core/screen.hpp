#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace usher::service {

/// What a button means, and so its color. The numbers of these enumerations are those on the wire.
enum class OptionKind : std::uint8_t {
  kOption = 0,  ///< one of several, blue
  kYes = 1,     ///< positive, green
  kNo = 2,      ///< negative, red
};

enum class Panel : std::uint8_t { kPrimary = 0, kSecondary = 1, kService = 2 };

struct Option {
  std::string id;     ///< unique on the screen; what an answer names
  std::string label;  ///< what the button and the visitor say
  OptionKind kind = OptionKind::kOption;
  Panel panel = Panel::kPrimary;
  bool takes_text = false;  ///< a line to type into
  bool operator==(const Option&) const = default;
};

enum class Content : std::uint8_t { kButtons = 0, kMap = 1, kJourney = 2, kSearch = 3 };
enum class Tone : std::uint8_t { kNone = 0, kMoving = 1, kPlease = 2, kCall = 3 };
enum class Human : std::uint8_t { kUnknown = 0, kNo = 1, kYes = 2 };
/// Whether the visitor keeps up.
enum class Follower : std::uint8_t {
  kUnknown = 0,  ///< nobody looks
  kFollowing = 1,
  kLagging = 2,  ///< the robot drives slower
  kAwaited = 3,  ///< the robot stands
  kCalled = 4,   ///< and calls
};
enum class AnswerResult : std::uint8_t { kNone = 0, kDone = 1, kLate = 2, kNotOffered = 3 };
enum class Input : std::uint8_t { kUnknown = 0, kTouch = 1, kVoice = 2 };

inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// What the visitor sees and hears. The id changes whenever the question changes, so that an answer
/// that comes late hits nothing else; everything else may change under the same id.
struct Screen {
  std::uint64_t id = 0;
  std::string state;     ///< of the dialogue
  std::string language;  ///< ISO 639-1
  Content content = Content::kButtons;
  std::string title;
  std::string text;
  std::string status;
  std::string spoken;           ///< sentences that are in title or text, too
  std::uint64_t spoken_id = 0;  ///< grows: say it (again)
  Tone tone = Tone::kNone;      ///< before it is said
  bool listens = false;         ///< an answer is waited for
  std::vector<Option> options;
  std::string place;            ///< name of the location that the screen is about
  double progress = -1.0;       ///< {0..1} of the way; negative: none
  double eta = kNothing;        ///< [s] left; NaN: unknown
  double remaining = kNothing;  ///< [m] left; NaN: unknown
  double time_left = kNothing;  ///< [s] until the question is given up; NaN: not soon
  Follower follower = Follower::kUnknown;
};

/// What the visitor chose, by touch or voice.
struct Answer {
  std::uint64_t screen_id = 0;
  std::string option_id;
  std::string text;  ///< what was typed, for an option that takes text
  Input input = Input::kUnknown;
  std::string client;    ///< who answers
  std::uint64_t id = 0;  ///< grows for each client; 0: never repeated
};

}  // namespace usher::service
