#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

void SignedPresence::call_us(const Prefix& own) {
  const std::lock_guard lock(mutex_);
  own_ = own;
}

bool SignedPresence::is_stuck(const Prefix& prefix, const Peer& peer, Duration now) const {
  const Duration in_state = now - peer.since;
  switch (peer.state) {
    case Peer::State::kAnnounced:  // PKI-DH: the lower key asks
      return in_state > (own_ < prefix ? kAsking : kAnswering);
    case Peer::State::kAuthenticated:
      return in_state > kMeeting || now - peer.has_signed > kMute;
    case Peer::State::kMet:
      return in_state > kSilence;
    case Peer::State::kIgnored:
      break;
  }
  return false;
}

bool SignedPresence::hears(const Prefix& from, bool is_signed, Duration now) {
  const std::lock_guard lock(mutex_);
  auto found = peers_.find(from);
  if (found == peers_.end()) {
    if (peers_.size() >= kMostPeers) {
      std::erase_if(peers_, [&](const auto& peer) { return now - peer.second.heard > kAsking; });
      if (peers_.size() >= kMostPeers) return true;
    }
    found = peers_.emplace(from, Peer{.since = now}).first;
  }
  Peer& peer = found->second;
  if (peer.state == Peer::State::kIgnored) {
    if (now - peer.since < kForgetting) return false;
    peer = {.since = now};
  } else if (is_stuck(from, peer, now)) {
    peer = {.state = Peer::State::kIgnored, .since = now, .heard = now};
    return false;
  }
  peer.heard = now;
  if (!is_signed) return true;
  peer.has_signed = now;
  if (peer.state == Peer::State::kAnnounced) {
    peer.state = Peer::State::kAuthenticated;
    peer.since = now;
  }
  return true;
}

void SignedPresence::met(const Prefix& who, Duration now) {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(who);
  if (found == peers_.end() || found->second.state == Peer::State::kIgnored) return;
  found->second.since = now;
  found->second.state = Peer::State::kMet;
}

void SignedPresence::gone(const Prefix& who) {
  const std::lock_guard lock(mutex_);
  peers_.erase(who);
}

bool SignedPresence::is_meeting(const Prefix& who) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(who);
  if (found == peers_.end()) return false;
  const Peer::State state = found->second.state;
  return state == Peer::State::kAnnounced || state == Peer::State::kAuthenticated;
}

}  // namespace usher::runtime
