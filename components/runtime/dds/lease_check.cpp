#include "runtime/dds/lease_check.hpp"

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <fastrtps/config.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>

#include "runtime/dds/discovery.hpp"
#include "runtime/dds/participant.hpp"

static_assert(FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9,
              "look whether this version of Fast DDS still needs its lease check replaced");

namespace usher::runtime {
namespace {

/// What the participants of this process know of whom they meet.
struct Presences {
  std::mutex mutex;
  std::map<SignedPresence::Prefix, std::shared_ptr<SignedPresence>> of;
};

Presences& presences() {
  static Presences all;
  return all;
}

}  // namespace

LeaseCheck::LeaseCheck(const SignedPresence::Prefix& own, std::shared_ptr<SignedPresence> presence)
    : own_(own) {
  const std::lock_guard lock(presences().mutex);
  presences().of[own] = std::move(presence);
}

LeaseCheck::~LeaseCheck() {
  const std::lock_guard lock(presences().mutex);
  presences().of.erase(own_);
}

Duration LeaseCheck::allowed_silence(const SignedPresence::Prefix& own,
                                     const SignedPresence::Prefix& other, Duration lease) {
  const std::lock_guard lock(presences().mutex);
  const auto found = presences().of.find(own);
  const bool meeting = found != presences().of.end() && found->second->is_meeting(other);
  return meeting ? std::max(lease, SignedPresence::kShyness) : lease;
}

}  // namespace usher::runtime

namespace eprosima::fastrtps::rtps {

void PDP::check_remote_participant_liveliness(ParticipantProxyData* participant) {
  GUID_t silent;
  {
    const std::lock_guard<std::recursive_mutex> lock(*mp_mutex);
    if (!participant->should_check_lease_duration || participant->m_guid == GUID_t::unknown())
      return;  // it has left
    const auto prefix_of = [](const GUID_t& guid) {
      return usher::runtime::DiscoveryBook::prefix_of(usher::runtime::to_guid(guid));
    };
    const std::chrono::nanoseconds lease(participant->m_leaseDuration.to_ns());
    const auto allowed = usher::runtime::LeaseCheck::allowed_silence(
        prefix_of(getLocalParticipantProxyData()->m_guid), prefix_of(participant->m_guid), lease);
    const std::chrono::nanoseconds rest =
        allowed - (std::chrono::steady_clock::now() - participant->last_received_message_tm());
    if (rest.count() >= 0) {
      // No later than a lease: they may have met by then, or the other be ignored.
      const std::chrono::duration<double, std::milli> next = std::min(rest, lease);
      participant->lease_duration_event->update_interval_millisec(next.count());
      participant->lease_duration_event->restart_timer();
      return;
    }
    silent = participant->m_guid;
  }
  remove_remote_participant(silent, ParticipantDiscoveryInfo::DROPPED_PARTICIPANT);
}

}  // namespace eprosima::fastrtps::rtps
