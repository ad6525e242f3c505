#pragma once

#include <map>
#include <string>

#include "runtime/api/host.hpp"

namespace usher::phrases {

/// By place, then by language: what people call it there.
using PlaceTitles = std::map<std::string, std::map<std::string, std::string>>;

/// The site's titles of places in other languages than that of its `locations` (`site.titles`). One
/// of no place among the `locations`, or a second one in a language, is a fault.
PlaceTitles read_place_titles(runtime::Host& host);

}  // namespace usher::phrases
