#include "support/counted_new.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace usher::test {
namespace {

std::atomic<std::uint64_t> allocations{0};

}  // namespace

std::uint64_t allocation_count() { return allocations; }

}  // namespace usher::test

void* operator new(std::size_t size) {
  ++usher::test::allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++usher::test::allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
