#pragma once

#include <memory>
#include <thread>
#include <utility>

namespace usher::operations {

/// Priority of what runs in real time. The kernel's own threads have 50.
constexpr int kRealTime = 10;

/// Whether this process may give its children a larger share of the processor than other programs
/// have, so that what must answer in time does. Tries it on the caller and takes it back.
bool may_go_first();
/// Gives it to the calling thread and all that it starts; for a child between fork and exec.
void go_first();

/// Whether children may run in real time: tried in a thread of its own.
bool may_run_in_real_time();
/// The calling thread, and all that it starts, has a processor whenever it wants it, before the
/// drive chain: but that one only, so that whatever goes wrong in it leaves the others to the drive
/// chain. False where there is one processor, or no right to it. What a child's worker computes
/// beside is taken out of it (runtime/dds/worker.hpp). For a child between fork and exec.
bool run_in_real_time();

/// For the calling thread and all that it starts: before all of those, as far as it is permitted.
void go_before_all();

/// What `make` returns, made in a thread that goes before all, and so whatever threads it starts;
/// for who measures the robot, whose clock would else wait for what it measures.
template <class Make>
auto made_before_all(Make make) {
  std::unique_ptr<decltype(make())> made;
  std::thread([&] {
    go_before_all();
    made = std::make_unique<decltype(make())>(make());
  }).join();
  return std::move(*made);
}

}  // namespace usher::operations
