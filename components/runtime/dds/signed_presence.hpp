#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>

#include "runtime/api/time.hpp"

namespace usher::runtime {

/// What every participant with keys writes, so that it signs something; all permissions name it.
inline constexpr const char* kAliveTopic = "usher/alive";

/// Whom a participant with keys goes on hearing. Announcements are in the clear and tell no more
/// than that somebody may be there; who takes part signs something every `kAliveEvery`. Whoever
/// announces itself and signs nothing is ignored until Fast DDS has forgotten it, then heard anew.
/// Without that, of two participants that had lost one another in one direction only (a cut line, a
/// machine that stood still for a second), one would wait forever for an authentication that the
/// other takes for done. Any thread.
class SignedPresence {
 public:
  using Prefix = std::array<std::uint8_t, 12>;  ///< of a participant's GUID

  /// How often a participant signs something for everybody.
  static constexpr Duration kAliveEvery = std::chrono::milliseconds(500);
  /// Without a signed message after the first announcement: an authentication that got stuck.
  static constexpr Duration kAuthentication = std::chrono::seconds(15);
  /// Without a signed message after the last: it has forgotten us.
  static constexpr Duration kSilence = std::chrono::seconds(4);
  /// Longer than the lease of a participant.
  static constexpr Duration kForgetting = std::chrono::milliseconds(1500);

  /// Whether a message of a participant shall be heard; `is_signed` by its structure.
  bool hears(const Prefix& from, bool is_signed, Duration now);

 private:
  struct Peer {
    Duration since;   ///< of the last sign of life that counts
    Duration last{};  ///< of any message
    bool signed_once = false;
    bool ignored = false;
  };
  /// More than a robot has; beyond them everybody is heard.
  static constexpr std::size_t kMostPeers = 256;

  std::mutex mutex_;
  std::map<Prefix, Peer> peers_;
};

}  // namespace usher::runtime
