#pragma once

#include <span>
#include <string>

namespace usher {

/// "; did you mean max_beams?" where a known name is near enough to what somebody typed, about
/// every third letter wrong; else empty.
std::string suggestion(const std::string& typed, std::span<const std::string> known);

}  // namespace usher
