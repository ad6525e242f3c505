#pragma once

#include <memory>

#include "runtime/dds/signed_presence.hpp"

namespace usher::runtime {

/// Takes the place of the function with which Fast DDS 2.9 asks whether a participant has been
/// silent for longer than its lease (`PDP::check_remote_participant_liveliness`, from the library's
/// timer thread), for two reasons. The library's own asserts that the participant is still known,
/// and that is not so where it leaves while the timer thread waits for the lock: on a busy machine
/// the one who was told goodbye aborts, the base driver for example. And it gives those who are
/// still authenticating one another no longer than those who have met: of 20 participants with keys
/// that start at once on two cores, the ones without priority read their announcements later than a
/// lease, forget who has not forgotten them, and begin authentications that the other side takes
/// for done. A definition in the program goes before the library's (ELF); making one of these
/// brings it in.
class LeaseCheck {
 public:
  /// Whom `presence` is meeting may be silent for `SignedPresence::kShyness`, as long as this
  /// lives, seen from the participant `own`.
  LeaseCheck(const SignedPresence::Prefix& own, std::shared_ptr<SignedPresence> presence);
  ~LeaseCheck();
  LeaseCheck(const LeaseCheck&) = delete;
  LeaseCheck& operator=(const LeaseCheck&) = delete;

  /// How long `other`, whose lease this is, may be silent before `own` takes it for gone. Any
  /// thread.
  static Duration allowed_silence(const SignedPresence::Prefix& own,
                                  const SignedPresence::Prefix& other, Duration lease);

 private:
  SignedPresence::Prefix own_;
};

}  // namespace usher::runtime
