#include "interaction/phrases/core/phrase_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>

namespace usher::phrases {

namespace {

struct Phrase {
  std::string text;
  std::string origin;
};

struct Page {
  Language language;
  std::map<std::string, Phrase> phrases;
  std::string origin;  ///< of the section
};

std::string origin(const std::string& path, const YAML::Mark& mark) {
  return path + ":" + std::to_string(std::max(mark.line, 0) + 1);
}

/// A text that is not empty.
std::optional<Phrase> scalar(const YAML::Node& node, const std::string& key,
                             const std::string& where, const std::string& path,
                             std::vector<Misprint>& misprints) {
  const std::string at = node ? origin(path, node.Mark()) : where;
  if (node && node.IsScalar() && !node.Scalar().empty()) return Phrase{node.Scalar(), at};
  misprints.push_back({at, "'" + key + "' must be a text that is not empty"});
  return std::nullopt;
}

std::optional<Page> read_page(const std::string& path, const std::string& section,
                              std::vector<Misprint>& misprints) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    misprints.push_back({origin(path, error.mark), error.msg});
    return std::nullopt;
  }
  const std::string top = path + ":1";
  if (!root.IsMap() || !root["language"] || !root["language"].IsMap()) {
    misprints.push_back({top, "expected 'language: {tag: ..., name: ...}'"});
    return std::nullopt;
  }
  const auto language = root["language"];
  const std::string at = origin(path, language.Mark());
  const auto tag = scalar(language["tag"], "tag", at, path, misprints);
  const auto name = scalar(language["name"], "name", at, path, misprints);
  const auto phrases = root[section];
  if (!phrases || !phrases.IsMap()) {
    misprints.push_back({top, "expected a mapping '" + section + "'"});
    return std::nullopt;
  }
  if (!tag || !name) return std::nullopt;
  Page page{{tag->text, name->text}, {}, origin(path, phrases.Mark())};
  for (const auto& entry : phrases) {
    const std::string key = entry.first.Scalar();
    const auto text = scalar(entry.second, key, page.origin, path, misprints);
    if (!page.phrases.emplace(key, text.value_or(Phrase{})).second)
      misprints.push_back({origin(path, entry.first.Mark()), "'" + key + "' is there twice"});
  }
  return page;
}

}  // namespace

std::vector<std::string> placeholders(std::string_view text) {
  std::vector<std::string> found;
  for (auto open = text.find('{'); open != std::string_view::npos;
       open = text.find('{', open + 1)) {
    const auto close = text.find('}', open);
    if (close == std::string_view::npos) break;
    found.emplace_back(text.substr(open + 1, close - open - 1));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::string filled(std::string text,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> values) {
  for (const auto& [name, value] : values) {
    const std::string mark = "{" + std::string(name) + "}";
    for (auto at = text.find(mark); at != std::string::npos;
         at = text.find(mark, at + value.size()))
      text.replace(at, mark.size(), value);
  }
  return text;
}

std::vector<Misprint> PhraseBook::read(const std::string& folder,
                                       const std::vector<std::string>& tags,
                                       const std::string& section,
                                       std::span<const std::string_view> keys) {
  std::vector<Misprint> misprints;
  if (tags.empty()) misprints.push_back({folder, "at least one language is needed"});
  for (const std::string& tag : tags) {
    if (std::any_of(languages_.begin(), languages_.end(),
                    [&](const Language& language) { return language.tag == tag; })) {
      misprints.push_back({folder, "language '" + tag + "' is asked for twice"});
      continue;
    }
    const std::string path = std::filesystem::path(folder) / (tag + ".yaml");
    auto page = read_page(path, section, misprints);
    if (!page) continue;
    if (page->language.tag != tag)
      misprints.push_back(
          {path + ":1", "expected tag '" + tag + "', got '" + page->language.tag + "'"});
    std::vector<std::string> phrases;
    for (const auto key : keys) {
      auto entry = page->phrases.extract(std::string(key));
      if (entry.empty()) {
        misprints.push_back(
            {page->origin, "'" + section + "." + std::string(key) + "' is missing"});
      } else if (!phrases_.empty() && !entry.mapped().text.empty()) {
        const auto& first = phrases_.front()[phrases.size()];
        if (placeholders(first) != placeholders(entry.mapped().text))
          misprints.push_back({entry.mapped().origin,
                               "'" + std::string(key) + "' must have the placeholders of \"" +
                                   first + "\", got \"" + entry.mapped().text + "\""});
      }
      phrases.push_back(entry.empty() ? "" : std::move(entry.mapped().text));
    }
    const std::string prefix = "nobody says '" + section + ".";
    for (const auto& [key, phrase] : page->phrases)
      misprints.push_back({phrase.origin, prefix + key + "'"});
    languages_.push_back(page->language);
    phrases_.push_back(std::move(phrases));
  }
  return misprints;
}

Result<PhraseBook> PhraseBook::load(const std::string& folder, const std::vector<std::string>& tags,
                                    const std::string& section,
                                    std::span<const std::string_view> keys) {
  PhraseBook book;
  const auto misprints = book.read(folder, tags, section, keys);
  if (!misprints.empty()) return Error{misprints.front().origin + ": " + misprints.front().text};
  return book;
}

std::vector<Misprint> PhraseBook::misprints(const std::string& folder,
                                            const std::vector<std::string>& tags,
                                            const std::string& section,
                                            std::span<const std::string_view> keys) {
  return PhraseBook().read(folder, tags, section, keys);
}

PhraseBook PhraseBook::of_keys(std::span<const std::string_view> keys) {
  PhraseBook book;
  book.languages_.push_back({"en", "English"});
  book.phrases_.emplace_back(keys.begin(), keys.end());
  return book;
}

std::size_t PhraseBook::find(std::string_view tag) const {
  const auto found = std::find_if(languages_.begin(), languages_.end(),
                                  [&](const Language& language) { return language.tag == tag; });
  return found == languages_.end() ? 0 : static_cast<std::size_t>(found - languages_.begin());
}

std::vector<std::string> tags_of(const std::string& list) {
  std::istringstream words(list);
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace usher::phrases
