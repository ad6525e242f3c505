#pragma once

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Reads the titles that the site gives its places in single languages: each must be of one of its
/// locations, and a place has one title in a language.
void judge_titles(Deployment& deployment);

}  // namespace usher::operations
