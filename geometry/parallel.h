/// Loops over all cores whose results do not depend on how many there are.
///
/// Threads are made anew for each loop: 18 microseconds with two, where TBB takes 2, of some 200
/// milliseconds that a view is planned for. They are the standard library's because the thread
/// sanitizer knows what those order; every loop of TBB, which Debian builds without it, it takes
/// for a race.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace skycap::geometry {

/// The number of threads that a request for `threads` means: zero asks for all processors.
unsigned thread_count(unsigned threads);

/// Calls `work(i)` for each i in [0, count), from up to `threads` threads, in no fixed order. Each
/// call must write only to its own slots. The first exception that a call throws is thrown on.
void parallel_for(std::size_t count, unsigned threads,
                  const std::function<void(std::size_t)>& work);

/// The same for work that takes less time than a call: a thousand neighbours at a time.
template <typename Work>
void parallel_for_each(std::size_t count, unsigned threads, const Work& work) {
  constexpr std::size_t block = 1024;
  parallel_for((count + block - 1) / block, threads, [&](std::size_t number) {
    const std::size_t end = std::min(count, (number + 1) * block);
    for (std::size_t i = number * block; i < end; ++i) work(i);
  });
}

}  // namespace skycap::geometry
