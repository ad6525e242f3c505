#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace usher::guide {

/// What a button means, and so its color. The numbers are those on the wire.
enum class OptionKind : std::uint8_t {
  kOption = 0,  ///< one of several, blue
  kYes = 1,     ///< positive, green
  kNo = 2,      ///< negative, red
};

struct Option {
  std::string id;     ///< unique on the screen; what an answer names
  std::string label;  ///< what the button and the visitor say
  OptionKind kind = OptionKind::kOption;
  bool operator==(const Option&) const = default;
};

/// What the visitor sees and hears. The id changes whenever the question changes, so that an answer
/// that comes late hits nothing else; progress and time left change under the same id.
struct Screen {
  std::uint64_t id = 0;
  std::string state;  ///< of the dialogue, as in fig. 7.1 of the thesis
  std::string title;
  std::string text;
  std::vector<Option> options;
  double progress = -1.0;                                 ///< {0..1} of the way; negative: none
  double eta = std::numeric_limits<double>::quiet_NaN();  ///< [s] left; NaN: unknown
};

/// What the visitor chose, by touch or voice.
struct Answer {
  std::uint64_t screen_id = 0;
  std::string option_id;
};

}  // namespace usher::guide
