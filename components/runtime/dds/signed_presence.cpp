#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

bool SignedPresence::hears(const Prefix& from, bool is_signed, Duration now) {
  const std::lock_guard lock(mutex_);
  auto found = peers_.find(from);
  if (found == peers_.end()) {
    if (peers_.size() >= kMostPeers) {
      std::erase_if(peers_, [&](const auto& peer) {
        return now - peer.second.last > kAuthentication + kForgetting;
      });
      if (peers_.size() >= kMostPeers) return true;
    }
    found = peers_.emplace(from, Peer{.since = now}).first;
  }
  Peer& peer = found->second;
  peer.last = now;
  if (peer.ignored) {
    if (now - peer.since < kForgetting) return false;
    peer = {.since = now, .last = now};
  } else if (now - peer.since > (peer.signed_once ? kSilence : kAuthentication)) {
    peer.since = now;
    peer.ignored = true;
    return false;
  }
  if (is_signed) {
    peer.since = now;
    peer.signed_once = true;
  }
  return true;
}

}  // namespace usher::runtime
