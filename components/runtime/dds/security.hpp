#pragma once

// Private to this folder: includes Fast DDS.

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "foundation/result/result.hpp"
#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

/// Gives the participant the identity that lies in a folder: certificate.pem, key.pem and
/// permissions.smime there, ca.pem and governance.smime in the folder above (`usher keys` makes
/// them). Fails when a file cannot be read or others may read the key.
Status apply_identity(const std::string& folder, eprosima::fastdds::dds::DomainParticipantQos& qos);

struct GuardOptions {
  bool only_signed = false;
  /// With `only_signed`: whom it does not hear is ignored; null: nobody.
  std::shared_ptr<SignedPresence> presence;
  /// Announcements go out by multicast, which this host hears too: those that Fast DDS also sends
  /// to each participant of this host alone stay unsent (20 of the 21 datagrams of an announcement
  /// on a robot of 20 participants, 5 times a second from each).
  bool announces_by_multicast = false;
  /// Gets the address that a malformed or unsigned message came from, on the thread that received
  /// it.
  std::function<void(const std::string& address)> refused;
  /// Nothing is sent before this is set. Fast DDS announces a participant before it listens: the
  /// answers of others, the first step of their authentication among them, would be lost and come
  /// again a second later.
  std::shared_ptr<const std::atomic<bool>> open;
};

/// A transport that passes on from `below` no malformed message and, with `only_signed`, nothing
/// that classify() calls unsigned and no farewell (the lease ends who has left).
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> guarded_transport(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below,
    GuardOptions options);

}  // namespace usher::runtime
