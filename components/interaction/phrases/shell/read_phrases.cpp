#include "interaction/phrases/shell/read_phrases.hpp"

#include <filesystem>
#include <utility>

namespace usher::phrases {

PhraseBook read_phrases(runtime::Host& host, const std::string& section,
                        std::span<const std::string_view> keys) {
  auto& parameters = host.parameters();
  const std::filesystem::path file = parameters.file(
      "texts", "", "A file of config/dialogue; those of the other languages lie beside it.");
  const auto tags = tags_of(parameters.text(
      "languages", "en mi de fr", "Languages of the dialogue, the first is the default."));
  if (file.empty()) return PhraseBook::of_keys(keys);
  auto book = PhraseBook::load(file.parent_path(), tags, section, keys);
  if (!book) host.fault("texts: " + book.error());
  return std::move(book).value();
}

}  // namespace usher::phrases
