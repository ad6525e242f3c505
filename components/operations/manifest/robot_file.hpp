#pragma once

#include <string>
#include <utility>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::operations {

/// Key and value as YAML: {"mount_z", "0.6712 m"}.
using FileValues = std::vector<std::pair<std::string, std::string>>;

/// The text of a robot's or site's file with these values in a section of its top level
/// (`kinect:`). Comments, all other keys and their order stay; a key that is not there is added at
/// the section's end, a section that is not there at the file's. Fails where the section is not a
/// block of lines or the result would not say these values; `where` stands for the file in errors.
Result<std::string> with_values(const std::string& text, const std::string& where,
                                const std::string& section, const FileValues& values);

/// The same in the file itself, which is either replaced as a whole or stays as it was.
Status set_values(const std::string& path, const std::string& section, const FileValues& values);

}  // namespace usher::operations
