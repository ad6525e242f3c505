#include "interaction/phrases/shell/place_titles.hpp"

#include <algorithm>

#include "wire/site_locations.hpp"

namespace usher::phrases {

namespace {

std::string unknown(const std::string& place, const std::vector<wire::SiteLocation>& locations) {
  std::string names;
  for (const auto& location : locations) {
    if (!names.empty()) names += ", ";
    names += location.name;
  }
  return "site.titles must be of places among site.locations (" + names + "), got '" + place + "'";
}

std::string repeated(const std::string& place, const std::string& language) {
  return "site.titles: '" + place + "' has two titles in '" + language + "'";
}

}  // namespace

PlaceTitles read_place_titles(runtime::Host& host) {
  using runtime::ParameterKind;
  const auto records = host.parameters().records(
      "site.titles",
      {{"place", ParameterKind::kText, "-", {}, "Name of a location."},
       {"language", ParameterKind::kText, "-", {}, "ISO 639-1."},
       {"title", ParameterKind::kText, "-", {}, "For people who chose that language."}},
      "Titles of places in single languages; else the location's own counts.");
  const auto locations = wire::read_locations(host.parameters());
  PlaceTitles titles;
  for (const auto& record : records) {
    const auto& place = record.text("place");
    const bool known = std::ranges::any_of(
        locations, [&](const auto& location) { return location.name == place; });
    if (!known) host.fault(unknown(place, locations));
    const auto& language = record.text("language");
    if (!titles[place].emplace(language, record.text("title")).second)
      host.fault(repeated(place, language));
  }
  return titles;
}

}  // namespace usher::phrases
