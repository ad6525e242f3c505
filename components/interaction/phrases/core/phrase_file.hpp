#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::phrases {

struct Language {
  std::string tag;   ///< ISO 639-1, "de"
  std::string name;  ///< in the language itself, "Deutsch"
};

/// Something wrong with a file of phrases.
struct Misprint {
  std::string origin;  ///< file:line
  std::string text;
};

/// The same phrases in several languages. A phrase is named by its place in the list of keys.
class PhraseBook {
 public:
  /// Reads FOLDER/<tag>.yaml for each tag: `language: {tag, name}` and, below `section`, a phrase
  /// for each key and no others. A phrase has the same placeholders ("{place}") in each language.
  /// The first language is the default. At least one tag; the error is the first
  /// of misprints().
  static Result<PhraseBook> load(const std::string& folder, const std::vector<std::string>& tags,
                                 const std::string& section,
                                 std::span<const std::string_view> keys);

  /// All that load() would refuse; empty when it would not.
  static std::vector<Misprint> misprints(const std::string& folder,
                                         const std::vector<std::string>& tags,
                                         const std::string& section,
                                         std::span<const std::string_view> keys);

  /// One language, "en", that says the keys themselves: for a component without a folder of texts.
  static PhraseBook of_keys(std::span<const std::string_view> keys);

  const std::vector<Language>& languages() const { return languages_; }
  /// Place of a language in languages(); 0, the default, for one that is not known.
  std::size_t find(std::string_view tag) const;
  const std::string& phrase(std::size_t language, std::size_t key) const {
    return phrases_.at(language).at(key);
  }

 private:
  std::vector<Misprint> read(const std::string& folder, const std::vector<std::string>& tags,
                             const std::string& section, std::span<const std::string_view> keys);

  std::vector<Language> languages_;
  std::vector<std::vector<std::string>> phrases_;
};

/// `text` with "{name}" replaced by its value, wherever it is.
std::string filled(std::string text,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> values);

/// The words of a list of languages, "en de".
std::vector<std::string> tags_of(const std::string& list);

/// The words in braces, sorted, each once.
std::vector<std::string> placeholders(std::string_view text);

}  // namespace usher::phrases
