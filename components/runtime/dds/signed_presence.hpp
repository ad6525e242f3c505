#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>

#include "runtime/api/time.hpp"

namespace usher::runtime {

/// What every participant with keys writes and reads, so that each knows whom it has met; all
/// permissions name it.
inline constexpr const char* kAliveTopic = "usher/alive";

/// Whom a participant with keys goes on hearing. Announcements are in the clear and tell no more
/// than that somebody may be there; whom we have met, authenticated and with all the endpoints that
/// discovery exchanges before those of `kAliveTopic`, writes us a sample of `kAliveTopic` every
/// `kAliveEvery`. Whoever announces itself without such samples is ignored until Fast DDS has
/// forgotten it, then heard anew. Without that, two participants that lost one another in one
/// direction only (a cut line, a machine that stood still for a second) would wait forever for an
/// authentication that one of them takes for done; and two whose exchange of endpoints got stuck
/// repeat its heartbeats forever, signed and all. Any thread.
class SignedPresence {
 public:
  using Prefix = std::array<std::uint8_t, 12>;  ///< of a participant's GUID

  /// How often a participant writes a sample to everybody whom it has met.
  static constexpr Duration kAliveEvery = std::chrono::milliseconds(500);
  /// Without a sample after the first announcement: an authentication or a discovery is stuck.
  static constexpr Duration kMeeting = std::chrono::seconds(15);
  /// Without a sample after the last: it has forgotten us.
  static constexpr Duration kSilence = std::chrono::seconds(4);
  /// Longer than the lease of a participant.
  static constexpr Duration kForgetting = std::chrono::milliseconds(1500);

  /// Whether a message of a participant shall be heard.
  bool hears(const Prefix& from, Duration now);
  /// A sample of `kAliveTopic` arrived.
  void met(const Prefix& who, Duration now);

 private:
  struct Peer {
    Duration since;   ///< of the last sample, or of the first message
    Duration last{};  ///< of any message
    bool met = false;
    bool ignored = false;
  };
  /// More than a robot has; beyond them everybody is heard.
  static constexpr std::size_t kMostPeers = 256;

  std::mutex mutex_;
  std::map<Prefix, Peer> peers_;
};

}  // namespace usher::runtime
