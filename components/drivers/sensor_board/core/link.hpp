#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/sensor_board/core/device.hpp"
#include "drivers/sensor_board/core/median_filter.hpp"
#include "drivers/sensor_board/core/protocol.hpp"

namespace usher::sensor_board {

/// The dialogue with the sensor board: says hello, keeps its watchdog content, sets the tilt and
/// sends it again after a restart of the board, and turns what it says into readings.
class Link {
 public:
  struct Parameters {
    std::size_t median_window = 3;           ///< {1..15} of each ultrasonic sensor
    double tilt_limit = 0.3490658503988659;  ///< [rad] 20 deg to either side
    Time boot = std::chrono::seconds(2);     ///< opening the line restarts the board
    Time heartbeat = std::chrono::milliseconds(100);
    Time silence = std::chrono::milliseconds(300);  ///< then nothing is known any more
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
    if (!open_) return;
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> content) {
      if (take(content, now)) on_reading(static_cast<const Reading&>(reading_));
    });
  }

  /// Where the camera shall look, [rad] up is positive; clipped to the limit, ignored when not
  /// finite. Sent when it changes and after the board restarted.
  void set_tilt(double tilt);

  /// Time passed; call it at 20 Hz or more.
  void tick(Time now);

  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output();

  /// Readings come as they should. When not, whiskers and ranges are unknown.
  bool healthy(Time now) const;
  /// Why it is not well; empty when it is.
  std::string reason(Time now) const;

  std::uint64_t lost_messages() const { return lost_messages_; }  ///< by the sequence
  std::uint64_t rejected() const { return rejected_; }            ///< whole frames without sense
  std::uint64_t damaged() const { return decoder_.damaged(); }

 private:
  bool take(std::span<const std::uint8_t> content, Time now);
  void take(const Hello& hello);
  void take(const Sensors& sensors, Time now);
  Whiskers corners(std::uint8_t mask) const;
  void send(const Frame& frame);

  Parameters parameters_;
  FrameDecoder decoder_;
  std::array<MedianFilter, kSonars> filters_;
  bool open_ = false;
  bool greeted_ = false;  ///< the board said hello since the line was opened
  Time opened_at_{};
  std::optional<Time> hello_sent_;
  std::optional<Time> heartbeat_sent_;
  std::optional<Time> heard_at_;  ///< the last Sensors
  std::optional<std::uint8_t> last_sequence_;
  std::uint8_t sequence_ = 0;  ///< of what is sent
  std::int16_t tilt_ = 0;      ///< [0.1 deg] wanted
  bool tilt_wanted_ = false;
  bool tilt_due_ = false;
  std::uint8_t status_ = 0;
  std::string refusal_;  ///< why the board is not usable at all
  Reading reading_;
  std::vector<std::uint8_t> output_;
  std::uint64_t lost_messages_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::sensor_board
