// Whatever arrives on a UDP port: classify() reads it without leaving its bounds.
#include <cstddef>
#include <cstdint>

#include "runtime/dds/rtps_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static_cast<void>(usher::runtime::classify({data, size}));
  return 0;
}
