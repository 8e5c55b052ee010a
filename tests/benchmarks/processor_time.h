/// Processor time: the machine may be busy with other things.
#pragma once

#include <ctime>

/// Of CLOCK_THREAD_CPUTIME_ID, this thread, or CLOCK_PROCESS_CPUTIME_ID, all of its program [s].
inline double seconds_on(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
