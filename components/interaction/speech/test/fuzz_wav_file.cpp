// libFuzzer target: a WAV file is outside bytes.
#include <cstdlib>

#include "interaction/speech/core/wav_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace usher::speech;
  const auto sound = parse_wav({data, size});
  if (!sound) return 0;
  if (sound->rate < kLowestRate || sound->rate > kHighestRate) std::abort();
  if (2 * sound->samples.size() > size) std::abort();
  const auto again = parse_wav(write_wav(*sound));
  if (!again || again->samples != sound->samples || again->rate != sound->rate) std::abort();
  return 0;
}
