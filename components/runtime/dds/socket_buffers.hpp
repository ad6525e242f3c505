#pragma once

#include <cstdint>

namespace usher::runtime {

/// Warns on standard error, once per process, when a UDP socket of this process in the port range
/// of the DDS domain got a smaller receive buffer than `wanted` bytes, and names the setting to
/// change: the kernel caps it silently, and then images and maps are lost.
void warn_of_small_socket_buffers(std::uint32_t domain, std::uint32_t wanted);

}  // namespace usher::runtime
