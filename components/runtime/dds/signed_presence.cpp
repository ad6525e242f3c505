#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

bool SignedPresence::hears(const Prefix& from, Duration now) {
  const std::lock_guard lock(mutex_);
  auto found = peers_.find(from);
  if (found == peers_.end()) {
    if (peers_.size() >= kMostPeers) {
      std::erase_if(peers_, [&](const auto& peer) {
        return now - peer.second.last > kMeeting + kForgetting;
      });
      if (peers_.size() >= kMostPeers) return true;
    }
    found = peers_.emplace(from, Peer{.since = now}).first;
  }
  Peer& peer = found->second;
  // Fast DDS has forgotten who was silent for so long.
  if (now - peer.last > kForgetting && !peer.ignored) peer = {.since = now};
  peer.last = now;
  if (peer.ignored) {
    if (now - peer.since < kForgetting) return false;
    peer = {.since = now, .last = now};
  } else if (now - peer.since > (peer.met ? kSilence : kMeeting)) {
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

}  // namespace usher::runtime
