#pragma once

#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// Reads the dialogue's texts as guide, meeting, tablet and speech will (`texts`, `languages`), and
/// judges whether those who show and say the dialogue know each language that it is led in.
void judge_dialogue(const Contracts& contracts, Deployment& deployment);

}  // namespace usher::operations
