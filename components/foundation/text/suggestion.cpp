#include "foundation/text/suggestion.hpp"

#include "foundation/text/edits.hpp"

namespace usher {

std::string suggestion(const std::string& typed, std::span<const std::string> known) {
  std::size_t least = typed.size() / 3 + 2;
  const std::string* best = nullptr;
  for (const std::string& name : known) {
    const std::size_t wrong = edits(typed, name);
    if (wrong >= least) continue;
    least = wrong;
    best = &name;
  }
  return best == nullptr ? "" : "; did you mean " + *best + "?";
}

}  // namespace usher
