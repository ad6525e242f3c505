#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/p3dx/core/device.hpp"
#include "drivers/p3dx/core/information.hpp"
#include "drivers/p3dx/core/packet.hpp"

namespace usher::p3dx {

/// Turns information packets into the way of the robot: unwraps positions, sorts sonar readings.
class Tracker {
 public:
  struct Parameters {
    double track = 0.357;         ///< [m] {> 0} effective: half wheel difference x 0.0056 rad/mm
    double full_battery = 12.8;   ///< [V]
    double empty_battery = 11.0;  ///< [V]
    double longest_step = 0.5;    ///< [m] between two packets; more is a reset of the origin
  };
  explicit Tracker(const Parameters& parameters) : parameters_(parameters) {}
  void reset() { last_.reset(); }
  Feedback take(const Information& information, Time now);

 private:
  void move(const Information& information);
  Parameters parameters_;
  std::optional<Information> last_;
  geometry::Pose2 pose_;
};

/// The dialogue with the base's controller over its serial line (ARCOS): three handshakes, open,
/// motors on, sonars on; then velocities, at least one packet a second, or the controller's
/// watchdog stops the wheels. There are no acknowledgements: what must hold is seen in the base's
/// reports and asked again.
///
///   closed -> SYNC0 -> SYNC1 -> SYNC2 -> running (waits for the first report, then drives)
class Link {
 public:
  struct Parameters {
    Tracker::Parameters tracker;
    int acceleration = 600;                          ///< [mm/s^2]
    int turn_acceleration = 140;                     ///< [deg/s^2]
    int max_velocity = 1200;                         ///< [mm/s]
    int max_turn_rate = 300;                         ///< [deg/s]
    Time patience = std::chrono::milliseconds(500);  ///< for an answer to a handshake
    Time repeat =
        std::chrono::milliseconds(40);    ///< of velocities; a packet takes 10 ms at 9600 baud
    Time lost = std::chrono::seconds(1);  ///< without a report
  };

  explicit Link(const Parameters& parameters);

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_feedback(const Feedback&)` for each report.
  template <class OnFeedback>
  void received(std::span<const std::uint8_t> bytes, Time now, OnFeedback&& on_feedback) {
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> packet) {
      if (const auto feedback = take(packet, now)) on_feedback(*feedback);
    });
  }

  /// A velocity, as a guard sends it for a driver that is gone.
  static std::vector<std::uint8_t> velocity(const geometry::Twist2& twist);

  /// What to send now, valid until the next call; call it at 25 Hz or more. Zero velocity goes out
  /// before the motors are switched on: the controller would resume what it was told last.
  std::span<const std::uint8_t> cycle(const geometry::Twist2& wanted, Time now);

  /// Stops at once and stays stopped until reset(), also when the line is opened anew; so do its
  /// stop button and a stall that took the motors off. Once it stands it is told to switch its
  /// motors off: before, they brake.
  void emergency_stop() { stay_stopped("emergency stop"); }
  void stay_stopped(std::string why) { stopped_by_ = std::move(why); }
  void reset();
  /// What stopped it until reset(); empty: nothing.
  const std::string& stopped_by() const { return stopped_by_; }

  /// The next cycle says nothing that a later one would not say again: only the newest counts.
  bool velocity_only() const { return state_ == State::kRunning && output_.empty(); }

  Mode mode(Time now) const;
  /// Why it does not drive; empty when all is well.
  const std::string& reason() const { return reason_; }
  const Decoder& decoder() const { return decoder_; }

 private:
  bool stopped() const { return !stopped_by_.empty(); }

  enum class State : std::uint8_t { kClosed, kSync0, kSync1, kSync2, kRunning };

  std::optional<Feedback> take(std::span<const std::uint8_t> packet, Time now);
  void handshake(std::span<const std::uint8_t> packet, Time now);
  void send(const Frame& frame);
  void send_sync(Time now);
  void send_setup();
  void send_velocity(const geometry::Twist2& wanted, Time now);

  Parameters parameters_;
  Decoder decoder_;
  Tracker tracker_;
  State state_ = State::kClosed;
  Time asked_{};    ///< the last handshake
  Time told_{};     ///< the last velocity
  Time enabled_{};  ///< when the motors were last asked on
  std::optional<Time> reported_;
  Mode reported_mode_ = Mode::kStandby;
  bool motors_on_ = false, rolls_ = false;  ///< as it reported last
  bool released_ = false;                   ///< reset, not yet told to the base
  Time forgives_until_{};                   ///< it reports an old stall until its motors are on
  std::string stopped_by_;                  ///< until reset(); empty: nothing
  std::string reason_ = "not connected";
  std::vector<std::uint8_t> output_, sent_;
};

}  // namespace usher::p3dx
