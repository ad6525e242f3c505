#include "operations/manifest/suggestion.hpp"

#include <algorithm>
#include <numeric>

namespace usher::operations {

namespace {

constexpr std::size_t kMostErrors = 2;
constexpr std::size_t kShortest = 4;

/// Levenshtein's distance.
std::size_t errors_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  if (name.size() < kShortest) return {};
  std::string best;
  std::size_t least = kMostErrors + 1;
  for (const std::string& candidate : known) {
    const std::size_t errors = errors_between(name, candidate);
    if (errors >= least) continue;
    least = errors;
    best = candidate;
  }
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

}  // namespace usher::operations
