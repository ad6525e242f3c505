#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

void SignedPresence::call_us(const Prefix& own) {
  const std::lock_guard lock(mutex_);
  own_ = own;
}

Duration SignedPresence::patience(const Prefix& with, const Peer& peer) const {
  if (peer.met) return kSilence;
  // PKI-DH: the lower key asks.
  return own_ < with ? kAsking : kMeeting;
}

bool SignedPresence::hears(const Prefix& from, Duration now) {
  const std::lock_guard lock(mutex_);
  auto found = peers_.find(from);
  if (found == peers_.end()) {
    if (peers_.size() >= kMostPeers) {
      std::erase_if(peers_, [&](const auto& peer) { return now - peer.second.last > kAsking; });
      if (peers_.size() >= kMostPeers) return true;
    }
    found = peers_.emplace(from, Peer{.since = now}).first;
  }
  Peer& peer = found->second;
  peer.last = now;
  if (peer.ignored) {
    if (now - peer.since < kForgetting) return false;
    peer = {.since = now, .last = now};
  } else if (now - peer.since > patience(from, peer)) {
    peer.since = now;
    peer.ignored = true;
    return false;
  }
  return true;
}

void SignedPresence::met(const Prefix& who, Duration now) {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(who);
  if (found == peers_.end() || found->second.ignored) return;
  found->second.since = now;
  found->second.met = true;
}

void SignedPresence::gone(const Prefix& who) {
  const std::lock_guard lock(mutex_);
  peers_.erase(who);
}

bool SignedPresence::is_meeting(const Prefix& who) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(who);
  return found != peers_.end() && !found->second.met && !found->second.ignored;
}

}  // namespace usher::runtime
