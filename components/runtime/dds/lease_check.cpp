#include "runtime/dds/lease_check.hpp"

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <fastrtps/config.h>

#include <chrono>
#include <mutex>

static_assert(FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9,
              "look whether this version of Fast DDS still needs its lease check replaced");

namespace eprosima::fastrtps::rtps {

void PDP::check_remote_participant_liveliness(ParticipantProxyData* participant) {
  GUID_t silent;
  {
    const std::lock_guard<std::recursive_mutex> lock(*mp_mutex);
    if (!participant->should_check_lease_duration || participant->m_guid == GUID_t::unknown())
      return;  // it has left
    const std::chrono::nanoseconds lease(participant->m_leaseDuration.to_ns());
    const std::chrono::duration<double, std::milli> rest =
        lease - (std::chrono::steady_clock::now() - participant->last_received_message_tm());
    if (rest.count() >= 0.0) {
      participant->lease_duration_event->update_interval_millisec(rest.count());
      participant->lease_duration_event->restart_timer();
      return;
    }
    silent = participant->m_guid;
  }
  remove_remote_participant(silent, ParticipantDiscoveryInfo::DROPPED_PARTICIPANT);
}

}  // namespace eprosima::fastrtps::rtps

namespace usher::runtime {

void use_lease_check() {}

}  // namespace usher::runtime
