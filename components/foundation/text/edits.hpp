#pragma once

#include <cstddef>
#include <string_view>

namespace usher {

/// Levenshtein's distance: the number of letters to insert, delete or change.
std::size_t edits(std::string_view a, std::string_view b);

}  // namespace usher
