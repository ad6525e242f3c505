#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::guide {

/// Where the guide can go.
struct Location {
  std::string name;                                ///< what the navigator knows
  std::string title;                               ///< what people know; empty: the name
  geometry::Point2 at{0, 0};                       ///< [m] in map
  std::map<std::string, std::string> titles = {};  ///< by language, instead of `title`
  bool operator==(const Location&) const = default;
  const std::string& label(const std::string& language) const {
    if (const auto own = titles.find(language); own != titles.end()) return own->second;
    return title.empty() ? name : title;
  }
};

/// Lower case without accents ("Café" -> "cafe"), as far as Latin letters go; other bytes stay.
std::string folded(std::string_view utf8);

/// The locations whose title in a language, or whose name, is like `query`, best first, at most
/// `most`: words that begin with it, then words that contain it, then words that begin almost like
/// it (one typing error from three letters on, two from six). Equal ones keep their order. All for
/// an empty query.
std::vector<const Location*> search(const std::vector<Location>& locations, std::string_view query,
                                    const std::string& language, std::size_t most);

/// The location nearest to a point; null when there is none.
const Location* nearest(const std::vector<Location>& locations, const geometry::Point2& point);

const Location* find(const std::vector<Location>& locations, std::string_view name);

}  // namespace usher::guide
