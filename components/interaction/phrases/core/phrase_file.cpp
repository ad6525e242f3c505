#include "interaction/phrases/core/phrase_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>

namespace usher::phrases {

namespace {

struct Page {
  Language language;
  std::map<std::string, std::string> phrases;
};

Result<std::string> scalar(const YAML::Node& node, const std::string& key,
                           const std::string& path) {
  const auto value = node[key];
  if (!value || !value.IsScalar() || value.Scalar().empty())
    return Error{path + ": '" + key + "' must be a text that is not empty"};
  return value.Scalar();
}

Result<Page> read_page(const std::string& path, const std::string& section) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    return Error{path + ": " + error.what()};
  }
  if (!root.IsMap() || !root["language"] || !root["language"].IsMap())
    return Error{path + ": expected 'language: {tag: ..., name: ...}'"};
  const auto tag = scalar(root["language"], "tag", path);
  const auto name = scalar(root["language"], "name", path);
  if (!tag) return Error{tag.error()};
  if (!name) return Error{name.error()};
  Page page{{*tag, *name}, {}};
  const auto phrases = root[section];
  if (!phrases || !phrases.IsMap()) return Error{path + ": expected a mapping '" + section + "'"};
  for (const auto& entry : phrases) {
    const std::string key = entry.first.Scalar();
    const auto text = scalar(phrases, key, path);
    if (!text) return Error{text.error()};
    if (!page.phrases.emplace(key, *text).second)
      return Error{path + ": '" + key + "' is there twice"};
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

Result<PhraseBook> PhraseBook::load(const std::string& folder, const std::vector<std::string>& tags,
                                    const std::string& section,
                                    std::span<const std::string_view> keys) {
  if (tags.empty()) return Error{folder + ": at least one language is needed"};
  PhraseBook book;
  for (const std::string& tag : tags) {
    const std::string path = folder + "/" + tag + ".yaml";
    auto page = read_page(path, section);
    if (!page) return Error{page.error()};
    if (page->language.tag != tag)
      return Error{path + ": expected tag '" + tag + "', got '" + page->language.tag + "'"};
    std::vector<std::string> phrases;
    for (const auto key : keys) {
      const auto entry = page->phrases.extract(std::string(key));
      if (entry.empty())
        return Error{path + ": '" + section + "." + std::string(key) + "' is missing"};
      if (!book.phrases_.empty()) {
        const auto& first = book.phrases_.front()[phrases.size()];
        if (placeholders(first) != placeholders(entry.mapped()))
          return Error{path + ": '" + std::string(key) + "' must have the placeholders of \"" +
                       first + "\", got \"" + entry.mapped() + "\""};
      }
      phrases.push_back(entry.mapped());
    }
    if (!page->phrases.empty())
      return Error{path + ": nobody says '" + section + "." + page->phrases.begin()->first + "'"};
    if (book.find(tag) < book.languages_.size() && book.languages_[book.find(tag)].tag == tag)
      return Error{folder + ": language '" + tag + "' is asked for twice"};
    book.languages_.push_back(page->language);
    book.phrases_.push_back(std::move(phrases));
  }
  return book;
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

}  // namespace usher::phrases
