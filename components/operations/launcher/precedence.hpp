#pragma once

namespace usher::operations {

/// How the processes that must answer in time go before all others of their machine.
enum class Precedence {
  kRealTime,  ///< SCHED_RR: whatever else computes, they run first
  kNice,      ///< a larger share of the processor
  kNone,      ///< this user may do neither
};

/// What this process may give its children. Tries it on the caller and takes it back.
Precedence permitted_precedence();

/// Gives it to the calling thread and all that it starts; for a child between fork and exec.
void take(Precedence precedence);
/// The same before those: for who measures them, whose clock would else wait for them.
void take_before(Precedence precedence);

}  // namespace usher::operations
