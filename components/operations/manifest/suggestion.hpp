#pragma once

#include <string>
#include <vector>

namespace usher::operations {

/// "; did you mean 'amcl'?" where one of the known names is at most two typing errors (a letter
/// too many, too few, another one) away from a name of at least four letters; else empty.
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

}  // namespace usher::operations
