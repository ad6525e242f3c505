#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace usher::speech {

/// A button as the dialogue offers it.
struct Option {
  std::string id;
  std::string label;
  bool takes_text = false;  ///< a line to type into: nothing to say
  bool operator==(const Option&) const = default;
};

/// One way to say an option.
struct Phrase {
  std::string option_id;
  std::string label;  ///< of the option, to ask back with
  std::string words;  ///< lower case words between single spaces, as a dictionary has them
  bool operator==(const Phrase&) const = default;
};

inline constexpr std::string_view kYes = "yes";
inline constexpr std::string_view kNo = "no";
inline constexpr std::string_view kStop = "stop";
inline constexpr std::size_t kMostPhrases = 96;

/// The words of a text: lower case, numbers in words ("Room 3.14" -> "room three point one four",
/// "42" -> "forty two", four digits in pairs), "&" as and, "-" and other signs as gaps; letters
/// with accents lose them; what no English text has is left out. Empty when nothing remains.
std::string spoken_words(std::string_view text);

/// What may be said to these buttons in English: their texts, a few other words for yes and no,
/// English names for languages, and always "stop" (option kStop). Each word sequence is there once,
/// the first button wins. At most kMostPhrases.
std::vector<Phrase> phrases_for(std::span<const Option> options);

/// The same for a question back: yes, no, and the buttons that are on the screen.
std::vector<Phrase> phrases_for_question(std::span<const Option> options);

/// A JSGF grammar whose one public rule is one of the phrases.
std::string jsgf(std::span<const Phrase> phrases);

}  // namespace usher::speech
