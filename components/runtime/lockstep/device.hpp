#pragma once

#include <cstdint>
#include <span>

#include "runtime/api/ports.hpp"
#include "runtime/api/time.hpp"

namespace usher::runtime {

/// The device at the other end of a component's stream in virtual time, as a test scripts it.
class LockstepDevice {
 public:
  virtual ~LockstepDevice() = default;
  /// The line was opened.
  virtual void opened() {}
  /// The component wrote; what the device answers arrives 1 ms later.
  virtual Bytes answer(std::span<const std::uint8_t> bytes) = 0;
  /// What it says by itself; asked every 10 ms while the line is open.
  virtual Bytes speak(Time now) = 0;
  /// What the component leaves its guard to say; there is none here to say it.
  virtual void last_will(std::span<const std::uint8_t> /*message*/, Duration /*lasts*/) {}

  /// False: the line is closed, and opened again a second after this is true again.
  bool plugged = true;
};

}  // namespace usher::runtime
