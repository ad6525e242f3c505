#include "tasks/guide/core/places.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace usher::guide {

namespace {

/// Base letters of U+00C0..U+017F, a dot where there is none.
constexpr std::string_view kBase =
    "aaaaaaaceeeeiiiidnooooo.ouuuuy.saaaaaaaceeeeiiiidnooooo.ouuuuy.y"
    "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllll"
    "lllnnnnnnnnnoooooooorrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";
static_assert(kBase.size() == 0x180 - 0xC0);

constexpr std::size_t kLongest = 32;  ///< letters of a query or word that are compared

/// Least edits (insert, delete, replace) that turn `query` into the beginning of `word`.
std::size_t edits_to_prefix(std::string_view query, std::string_view word) {
  query = query.substr(0, kLongest);
  word = word.substr(0, kLongest);
  std::array<std::size_t, kLongest + 1> row{};
  for (std::size_t j = 0; j <= word.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= query.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= word.size(); ++j) {
      const std::size_t replaced = diagonal + (query[i - 1] == word[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return *std::min_element(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(word.size()) + 1);
}

constexpr int kNoMatch = 100;

/// 0 begins with it, 1 contains it, 2.. almost begins with it.
int rank(std::string_view query, std::string_view words) {
  if (words.starts_with(query)) return 0;
  int best = words.find(query) != std::string_view::npos ? 1 : kNoMatch;
  const std::size_t allowed = query.size() >= 6 ? 2 : query.size() >= 3 ? 1 : 0;
  for (std::size_t from = 0; from < words.size();) {
    const std::size_t to = std::min(words.find_first_of(" _-", from), words.size());
    const std::string_view word = words.substr(from, to - from);
    if (!word.empty() && word.starts_with(query)) return 0;
    const std::size_t edits =
        allowed > 0 && !word.empty() ? edits_to_prefix(query, word) : kNoMatch;
    if (edits <= allowed) best = std::min(best, 1 + static_cast<int>(edits));
    from = to + 1;
  }
  return best;
}

}  // namespace

std::string folded(std::string_view utf8) {
  std::string out;
  out.reserve(utf8.size());
  for (std::size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = static_cast<unsigned char>(utf8[i]);
    if (byte >= 'A' && byte <= 'Z') {
      out += static_cast<char>(byte - 'A' + 'a');
    } else if (byte >= 0xC3 && byte <= 0xC5 && i + 1 < utf8.size()) {
      const auto next = static_cast<unsigned char>(utf8[i + 1]);
      const std::size_t code = (byte & 0x1FU) * 64U + (next & 0x3FU);
      const char base = kBase[code - 0xC0];
      if (base != '.') {
        out += base;
        ++i;
      } else {
        out += utf8[i];
      }
    } else {
      out += utf8[i];
    }
  }
  return out;
}

std::vector<const Location*> search(const std::vector<Location>& locations, std::string_view query,
                                    const std::string& language, std::size_t most) {
  std::string wanted = folded(query);
  while (!wanted.empty() && wanted.back() == ' ') wanted.pop_back();
  std::vector<std::pair<int, const Location*>> hits;
  for (const Location& location : locations) {
    const int best = std::min(rank(wanted, folded(location.label(language))),
                              rank(wanted, folded(location.name)));
    if (best < kNoMatch) hits.emplace_back(best, &location);
  }
  std::stable_sort(hits.begin(), hits.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (hits.size() > most) hits.resize(most);
  std::vector<const Location*> found;
  for (const auto& hit : hits) found.push_back(hit.second);
  return found;
}

const Location* nearest(const std::vector<Location>& locations, const geometry::Point2& point) {
  const Location* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Location& location : locations) {
    const double distance = (location.at - point).squaredNorm();
    if (distance < least) {
      least = distance;
      best = &location;
    }
  }
  return best;
}

const Location* find(const std::vector<Location>& locations, std::string_view name) {
  const auto found = std::find_if(locations.begin(), locations.end(),
                                  [&](const Location& location) { return location.name == name; });
  return found == locations.end() ? nullptr : &*found;
}

}  // namespace usher::guide
