#pragma once

namespace usher::operations {

/// Whether this process may give its children a larger share of the processor than other programs
/// have, so that what must answer in time does. Tries it on the caller and takes it back.
bool may_go_first();

/// Gives it to the calling thread and all that it starts; for a child between fork and exec.
void go_first();
/// The same before those: for who measures them, whose clock would else wait for them.
void go_before_all();

}  // namespace usher::operations
