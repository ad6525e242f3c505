#pragma once

namespace usher::runtime {

/// Takes the place of the function with which Fast DDS 2.9 asks whether a participant has been
/// silent for longer than its lease (`PDP::check_remote_participant_liveliness`, from the library's
/// timer thread). The library's own asserts that the participant is still known, and that is not so
/// where it leaves while the timer thread waits for the lock: on a busy machine the one who was
/// told goodbye aborts, the base driver for example. A definition in the program goes before the
/// library's (ELF); calling this brings it in. Does nothing else.
void use_lease_check();

}  // namespace usher::runtime
