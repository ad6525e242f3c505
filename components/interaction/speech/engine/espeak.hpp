#pragma once

#include <memory>

#include "interaction/speech/shell/equipment.hpp"

namespace usher::speech {

/// espeak-ng, which gives samples and opens no device of its own. One for a process: the library is
/// a single global. The error says what is missing.
Result<std::unique_ptr<Synthesizer>> make_espeak();

}  // namespace usher::speech
