#include "sensing/depth_pipeline/core/kernels.hpp"

#include "sensing/depth_pipeline/core/kernels_loop.hpp"

namespace usher::depth_pipeline::kernels {

namespace {

/// One value at a time; a mask is all ones or zero.
struct Scalar {
  using V = std::uint16_t;
  static constexpr int kSize = 1;
  static V of(int value) { return static_cast<V>(value); }
  static V mask(bool yes) { return yes ? V{0xffff} : V{0}; }
  static V load(const V* p) { return *p; }
  static void store(V* p, V v) { *p = v; }
  static V all(V v) { return v; }
  static V lower(V a, V b) { return a < b ? a : b; }
  static V higher(V a, V b) { return a > b ? a : b; }
  static V either(V a, V b) { return of(a | b); }
  static V both(V a, V b) { return of(a & b); }
  static V without(V a, V b) { return of(a & ~b); }
  static V flip(V a) { return of(~a); }
  static V equal(V a, V b) { return mask(a == b); }
  static V at_most(V a, V b) { return mask(a <= b); }
  static V choose(V yes, V a, V b) { return yes != 0 ? a : b; }
  static bool any(V a) { return a != 0; }
  static V add(V a, V b) { return of(a + b); }
  static V subtract(V a, V b) { return of(a - b); }
  static V subtract_to_zero(V a, V b) { return a > b ? of(a - b) : V{0}; }
  static V times_four(V a) { return of(a << 2); }
  static V high_product(V a, V b) {
    return static_cast<V>((static_cast<std::uint32_t>(a) * b) >> 16);
  }
};

}  // namespace

void process_portable(const Frame& frame) { process<Scalar>(frame); }

}  // namespace usher::depth_pipeline::kernels
