#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/sensor_board/core/device.hpp"
#include "drivers/sensor_board/core/protocol.hpp"
#include "drivers/sensor_board/core/sonar_faults.hpp"
#include "drivers/serial_frame/core/dialogue.hpp"

namespace usher::sensor_board {

/// The dialogue with the sensor board: sets the tilt and sends it again after a restart of the
/// board, and turns what it says into readings.
class Link {
 public:
  struct Parameters {
    double tilt_limit = 0.3490658503988659;  ///< [rad] 20 deg to either side
    /// Switches of each whisker as bits of the mask: two to a whisker.
    std::uint8_t front_left = 0x03;
    std::uint8_t front_right = 0x0C;
    std::uint8_t back_left = 0x30;
    std::uint8_t back_right = 0xC0;
  };

  Link();
  explicit Link(const Parameters& parameters);

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_reading(const Reading&)` for each new reading. A change of the
  /// whiskers gives one at once, with the ranges of before.
  template <class OnReading>
  void received(std::span<const std::uint8_t> bytes, Time now, OnReading&& on_reading) {
    dialogue_.received(bytes, [&](std::span<const std::uint8_t> content) {
      if (take(content, now)) on_reading(static_cast<const Reading&>(reading_));
    });
  }

  /// Where the tilt servo shall go, [rad] up is positive; clipped to the limit, ignored when not
  /// finite. Sent when it changes and after the board restarted.
  void set_tilt(double tilt);

  /// Time passed; call it at 20 Hz or more.
  void tick(Time now);

  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }

  /// Readings come as they should. When not, whiskers and ranges are unknown.
  bool healthy(Time now) const { return dialogue_.healthy(now); }
  /// Why it is not well; empty when it is.
  std::string reason(Time now) const;

  const serial_frame::Dialogue& dialogue() const { return dialogue_; }

 private:
  bool take(std::span<const std::uint8_t> content, Time now);
  void take(const Sensors& sensors, Time now);
  Whiskers corners(std::uint8_t mask) const;

  Parameters parameters_;
  serial_frame::Dialogue dialogue_;
  std::optional<std::int16_t> tilt_;  ///< [0.1 deg] wanted
  bool tilt_due_ = false;
  std::uint64_t told_after_ = 0;  ///< hellos: the board knows the tilt since then
  Reading reading_;
  SonarFaults faults_;
};

}  // namespace usher::sensor_board
