#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/segway_rmp/core/device.hpp"
#include "drivers/segway_rmp/core/protocol.hpp"

namespace usher::segway_rmp {

/// The base's side of the USB line: reads command frames, speaks feedback frames, for tests and for
/// simulations with the real driver. It knows the protocol only; how a Segway moves is another's
/// business.
class EmulatedBase {
 public:
  enum class Wish : std::uint8_t {
    kDrive,     ///< at `twist`
    kShutdown,  ///< motors off
    kBalance,   ///< balance again; also sent by a driver that has just connected
  };
  struct Order {
    Wish wish = Wish::kDrive;
    geometry::Twist2 twist;  ///< rounded to the counts of the protocol
  };

  explicit EmulatedBase(const Calibration& calibration) : calibration_(calibration) {}

  /// Bytes of the driver; calls `on_order(const Order&)` for each whole frame. Every frame orders a
  /// velocity; one that sets the balance mode orders that too.
  template <class OnOrder>
  void received(std::span<const std::uint8_t> bytes, OnOrder&& on_order) {
    for (const std::uint8_t byte : bytes) {
      if (!take(byte)) continue;
      if (const auto wish = wish_of_frame(); wish != Wish::kDrive) on_order(Order{wish, {}});
      if (wish_of_frame() != Wish::kShutdown) on_order(Order{Wish::kDrive, twist_of_frame()});
    }
  }

  /// One control cycle as the base reports it, on both channels: valid until the next call.
  std::span<const std::uint8_t> feedback(const SegwayFeedback& state);

  std::uint64_t skipped_bytes() const { return skipped_bytes_; }

 private:
  static constexpr std::size_t kFrames = 7;

  bool take(std::uint8_t byte);
  std::uint16_t word(std::size_t at) const;
  Wish wish_of_frame() const;
  geometry::Twist2 twist_of_frame() const;

  Calibration calibration_;
  PacketBytes frame_{};
  std::size_t filled_ = 0;
  std::uint64_t skipped_bytes_ = 0;
  std::array<std::uint8_t, 2 * kFrames * kPacketSize> output_{};
};

}  // namespace usher::segway_rmp
