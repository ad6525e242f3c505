#include "operations/launcher/precedence.hpp"

#include <sys/resource.h>

#include <cerrno>

namespace usher::operations {

namespace {

/// Ten times the share of an ordinary program. Not real time: where the robot's processes keep two
/// cores busy, as twenty that authenticate each other do, the others of its own would starve.
constexpr int kNice = -10;

}  // namespace

bool may_go_first() {
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  return errno == 0 && setpriority(PRIO_PROCESS, 0, kNice) == 0 &&
         setpriority(PRIO_PROCESS, 0, nice) == 0;
}

void go_first() { setpriority(PRIO_PROCESS, 0, kNice); }

void go_before_all() { setpriority(PRIO_PROCESS, 0, kNice - 1); }

}  // namespace usher::operations
