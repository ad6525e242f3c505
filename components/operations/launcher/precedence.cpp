#include "operations/launcher/precedence.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <cerrno>

namespace usher::operations {

namespace {

/// Low among real-time priorities: the kernel's own threads and the sound server come first. The
/// kernel keeps 5 % for the rest of the machine, so that a component in an endless loop can be
/// found and killed.
constexpr int kPriority = 10;
constexpr int kNice = -10;

bool set_real_time(int priority = kPriority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return sched_setscheduler(0, SCHED_RR, &parameters) == 0;
}

}  // namespace

Precedence permitted_precedence() {
  const int policy = sched_getscheduler(0);
  sched_param parameters{};
  if (policy >= 0 && sched_getparam(0, &parameters) == 0 && set_real_time()) {
    sched_setscheduler(0, policy, &parameters);
    return Precedence::kRealTime;
  }
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  if (errno == 0 && setpriority(PRIO_PROCESS, 0, kNice) == 0 &&
      setpriority(PRIO_PROCESS, 0, nice) == 0)
    return Precedence::kNice;
  return Precedence::kNone;
}

void take(Precedence precedence) {
  if (precedence == Precedence::kRealTime) set_real_time();
  if (precedence == Precedence::kNice) setpriority(PRIO_PROCESS, 0, kNice);
}

void take_before(Precedence precedence) {
  if (precedence == Precedence::kRealTime) set_real_time(kPriority + 1);
  if (precedence == Precedence::kNice) setpriority(PRIO_PROCESS, 0, kNice - 1);
}

}  // namespace usher::operations
