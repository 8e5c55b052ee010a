/// CPU time, which depends less on the load of the machine than wall-clock time.
#pragma once

#include <ctime>

/// Returns the CPU time [s] of this thread (CLOCK_THREAD_CPUTIME_ID) or of the whole process
/// (CLOCK_PROCESS_CPUTIME_ID).
inline double seconds_on(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
