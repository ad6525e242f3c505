#include "operations/manifest/places.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "operations/manifest/tree.hpp"

namespace usher::operations {

namespace {

std::string word(const Tree& record, const std::string& field) {
  const Tree* found = record.find(field);
  return found != nullptr ? found->scalar : std::string();
}

std::string unknown(const std::string& place, const std::string& known) {
  return "'titles' must be of places among the locations (" + known + "), got '" + place + "'";
}

std::string repeated(const std::string& place, const std::string& language) {
  return "'titles' gives '" + place + "' two titles in '" + language + "'";
}

}  // namespace

void judge_titles(Deployment& deployment) {
  if (deployment.manifest.site_file.empty()) return;
  const auto site = read_tree(deployment.manifest.site_file);
  if (!site || site->kind != Tree::Kind::kMap) return;  // found before
  const Tree* titles = site->find("titles");
  if (titles == nullptr) return;
  std::set<std::string> known;
  std::string names;
  if (const Tree* locations = site->find("locations")) {
    for (const Tree& location : locations->items) {
      const std::string name = word(location, "name");
      if (known.insert(name).second) names += (names.empty() ? "" : ", ") + name;
    }
  }
  std::set<std::pair<std::string, std::string>> given;
  for (const Tree& title : titles->items) {
    const std::string place = word(title, "place"), language = word(title, "language");
    const auto found = [&](std::string text) {
      deployment.findings.push_back({Verdict::kWrongValue, std::move(text), title.origin});
    };
    if (!known.contains(place)) {
      found(unknown(place, names));
    } else if (!given.emplace(place, language).second) {
      found(repeated(place, language));
    }
  }
}

}  // namespace usher::operations
