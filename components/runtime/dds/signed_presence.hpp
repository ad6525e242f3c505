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
/// authentication that one of them takes for done: Fast DDS 2.9.1 repeats its old answer to a new
/// request. And two whose exchange of endpoints got stuck repeat its heartbeats forever, signed and
/// all. Any thread.
class SignedPresence {
 public:
  using Prefix = std::array<std::uint8_t, 12>;  ///< of a participant's GUID

  /// How often a participant writes a sample to everybody whom it has met.
  static constexpr Duration kAliveEvery = std::chrono::milliseconds(500);
  /// Without anything signed after the first announcement: the authentication is stuck. Who answers
  /// one gives up first and more often, as its answer to an older request is what the other cannot
  /// use; were both to do so with one period, each could spoil the other's next try forever.
  static constexpr Duration kAnswering = std::chrono::seconds(30);
  static constexpr Duration kAsking = std::chrono::seconds(75);
  /// Without a sample after the first signed message: the exchange of endpoints is stuck.
  static constexpr Duration kMeeting = std::chrono::seconds(60);
  /// Without anything signed after something was: it has begun anew, and we take it for known. On a
  /// starting robot messages wait in a socket for ten seconds and more.
  static constexpr Duration kMute = std::chrono::seconds(15);
  /// Without a sample after the last: it has forgotten us.
  static constexpr Duration kSilence = std::chrono::seconds(4);
  /// Who is ignored and was not known to Fast DDS, which would tell when it forgets it.
  static constexpr Duration kForgetting = std::chrono::milliseconds(2500);
  /// Silence of somebody who is not met yet, before it counts as gone.
  static constexpr Duration kShyness = std::chrono::seconds(5);

  /// Before anybody is heard: who we are.
  void call_us(const Prefix& own);
  /// Whether a message of a participant shall be heard.
  bool hears(const Prefix& from, bool is_signed, Duration now);
  /// A sample of `kAliveTopic` arrived.
  void met(const Prefix& who, Duration now);
  /// Fast DDS has forgotten it.
  void gone(const Prefix& who);
  /// Whether it is heard and not met yet.
  bool is_meeting(const Prefix& who) const;

 private:
  struct Peer {
    enum class State { kAnnounced, kAuthenticated, kMet, kIgnored } state = State::kAnnounced;
    Duration since;         ///< in this state; kMet: since the last sample
    Duration heard{};       ///< when it was, last
    Duration has_signed{};  ///< the last message that was signed
  };
  bool is_stuck(const Prefix& prefix, const Peer& peer, Duration now) const;

  /// More than a robot has; beyond them everybody is heard.
  static constexpr std::size_t kMostPeers = 256;

  mutable std::mutex mutex_;
  Prefix own_{};
  std::map<Prefix, Peer> peers_;
};

}  // namespace usher::runtime
