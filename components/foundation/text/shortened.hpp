#pragma once

#include <cstddef>
#include <string>

namespace usher {

/// The first `most` bytes of a UTF-8 text, or fewer: cut at a letter's beginning.
std::string shortened(std::string text, std::size_t most);

}  // namespace usher
