#pragma once

#include <string>

#include "foundation/result/result.hpp"

namespace usher {

/// A text file, compressed by gzip or not, of up to 1 GiB of text. The error says what is wrong
/// with the file.
Result<std::string> read_compressed_text(const std::string& path);

}  // namespace usher
