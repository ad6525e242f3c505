#include "navigation/navigator/core/locations.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

#include "foundation/text/edits.hpp"

namespace usher::navigator {
namespace {

constexpr std::size_t kMostSuggestions = 5;
constexpr std::size_t kLongestName =
    100;  // of what is compared; the rest of a longer one does not matter

/// What people mix up is left out: case, blanks and underscores.
std::string simplified(std::string_view name) {
  std::string result;
  for (const char c : name.substr(0, kLongestName))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Result<Locations> Locations::create(std::vector<Location> locations) {
  if (locations.size() > kMost)
    return Error{"at most " + std::to_string(kMost) + " locations, got " +
                 std::to_string(locations.size())};
  std::set<std::string> names;
  for (std::size_t i = 0; i < locations.size(); ++i) {
    const Location& location = locations[i];
    if (location.name.empty()) return Error{"location " + std::to_string(i + 1) + " has no name"};
    if (!location.pose.finite())
      return Error{"location " + location.name + " must have a finite pose"};
    if (!names.insert(location.name).second)
      return Error{"location " + location.name + " is there twice"};
  }
  Locations result;
  result.locations_ = std::move(locations);
  return result;
}

Result<Location> Locations::find(std::string_view name) const {
  const auto found = std::ranges::find(locations_, name, &Location::name);
  if (found != locations_.end()) return *found;

  const std::string wanted = simplified(name);
  struct Candidate {
    std::size_t distance;
    std::string name;
    bool operator<(const Candidate& other) const {
      return std::tie(distance, name) < std::tie(other.distance, other.name);
    }
  };
  std::vector<Candidate> close;
  close.reserve(locations_.size());
  for (const Location& location : locations_) {
    const std::string known = simplified(location.name);
    const bool part = !wanted.empty() && (known.find(wanted) != std::string::npos ||
                                          wanted.find(known) != std::string::npos);
    const std::size_t distance = edits(wanted, known);
    if (part || distance <= std::max<std::size_t>(1, known.size() / 3))
      close.push_back({distance, location.name});
  }
  std::sort(close.begin(), close.end());
  std::vector<std::string> names;
  names.reserve(locations_.size());
  for (const Candidate& candidate : close) names.push_back(candidate.name);
  const bool similar = !names.empty();
  if (!similar)
    for (const Location& location : locations_) names.push_back(location.name);
  const std::size_t count = names.size();
  if (count > kMostSuggestions) names.resize(kMostSuggestions);

  std::string text = "unknown location \"" + std::string(name.substr(0, kLongestName)) + "\"";
  if (similar) return Error{text + ", did you mean " + joined(names) + "?"};
  if (names.empty()) return Error{text + ", no locations are known"};
  return Error{text + ", known are " + joined(names) + (count > names.size() ? ", ..." : "")};
}

}  // namespace usher::navigator
