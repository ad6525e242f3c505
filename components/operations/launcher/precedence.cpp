#include "operations/launcher/precedence.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <cerrno>

namespace usher::operations {

namespace {

/// Ten times the share of an ordinary program. Not real time, which is for short work on one core:
/// where the robot's processes keep two busy, as twenty that authenticate each other do, the others
/// of its own would starve.
constexpr int kNice = -10;

bool take_priority(int priority) {
  const sched_param wanted{.sched_priority = priority};
  return sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
}

/// The last of the processors that the caller may use; false where it is the only one.
bool keep_to_one_processor() {
  cpu_set_t permitted;
  if (sched_getaffinity(0, sizeof(permitted), &permitted) != 0 || CPU_COUNT(&permitted) < 2)
    return false;
  int last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(last, &permitted)) --last;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(last, &one);
  return sched_setaffinity(0, sizeof(one), &one) == 0;
}

}  // namespace

bool may_go_first() {
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  return errno == 0 && setpriority(PRIO_PROCESS, 0, kNice) == 0 &&
         setpriority(PRIO_PROCESS, 0, nice) == 0;
}

void go_first() { setpriority(PRIO_PROCESS, 0, kNice); }

bool may_run_in_real_time() {
  bool may = false;
  std::thread([&] { may = run_in_real_time(); }).join();
  return may;
}

bool run_in_real_time() { return keep_to_one_processor() && take_priority(kRealTime); }

void go_before_all() {
  setpriority(PRIO_PROCESS, 0, kNice - 1);  // where real time is not permitted
  if (!take_priority(kRealTime + 1)) take_priority(kRealTime);
}

}  // namespace usher::operations
