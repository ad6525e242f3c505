#pragma once

#include <span>
#include <string>
#include <string_view>

#include "interaction/phrases/core/phrase_file.hpp"
#include "runtime/api/host.hpp"

namespace usher::phrases {

/// A component's section of the dialogue's texts in all its languages, by the parameters `texts`
/// and `languages`; without a file the keys themselves, in English. A file that does not fit is a
/// fault.
PhraseBook read_phrases(runtime::Host& host, const std::string& section,
                        std::span<const std::string_view> keys);

}  // namespace usher::phrases
