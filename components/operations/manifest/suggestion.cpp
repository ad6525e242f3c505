#include "operations/manifest/suggestion.hpp"

#include "foundation/text/edits.hpp"

namespace usher::operations {

namespace {

constexpr std::size_t kMostErrors = 2;
constexpr std::size_t kShortest = 4;

}  // namespace

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  if (name.size() < kShortest) return {};
  std::string best;
  std::size_t least = kMostErrors + 1;
  for (const std::string& candidate : known) {
    const std::size_t errors = edits(name, candidate);
    if (errors >= least) continue;
    least = errors;
    best = candidate;
  }
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

}  // namespace usher::operations
