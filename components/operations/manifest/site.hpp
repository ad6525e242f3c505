#pragma once

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Judges what the site says by what the manifest's components do with it: what they need is there
/// (their contracts have defaults, with which they could do nothing), the map can be read, the
/// start and every location lie on it, a meeting room has an inside and a location of its name, a
/// title is of a location and the only one in its language.
void judge_site(const Contracts& contracts, Deployment& deployment);

}  // namespace usher::operations
