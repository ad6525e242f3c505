#pragma once

#include <memory>

#include "interaction/speech/shell/equipment.hpp"

namespace usher::speech {

/// PocketSphinx with Debian's English models. The phrases become a JSGF grammar; beside it a loop
/// over all sounds of the language decodes the same frames, and the difference of both says whether
/// one of the phrases was said at all. Words that the dictionary has not are left out; phrases with
/// such words cannot be understood.
std::unique_ptr<Recognizer> make_pocketsphinx(const std::string& models);

/// Where Debian's package puts the models.
inline constexpr const char* kSphinxModels = "/usr/share/pocketsphinx/model/en-us";

}  // namespace usher::speech
