#include "missions/scan_runner.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/parallel.h"

namespace skycap::missions {

ScanResult run_scan(const sim::Scene& scene, const sim::Lidar& lidar,
                    const sim::LidarFlight& flight, LasWriter& file, const ScanOptions& options) {
  // A piece has some ten thousand shots; a round is enough pieces for the threads to share evenly.
  constexpr std::uint64_t shots_in_piece = 1 << 15, block = 32;
  const std::uint64_t channels = lidar.config().channels.size();
  const std::uint64_t firings_in_piece =
      std::max<std::uint64_t>(1, shots_in_piece / (channels * block)) * block;
  const std::size_t pieces_in_round = 16 * geometry::thread_count(options.threads);

  ScanResult result;
  ScanProgress& progress = result.progress;
  progress.all_firings = lidar.firings(flight.flown);
  std::vector<LasChunk> written, measured;
  std::uint64_t next = 0;
  while (next < progress.all_firings && !options.stop.stop_requested()) {
    const std::uint64_t rest = progress.all_firings - next;
    measured.assign(
        std::min<std::uint64_t>(pieces_in_round, (rest + firings_in_piece - 1) / firings_in_piece),
        {});
    // While this round is measured, one thread writes the last one.
    geometry::parallel_for(measured.size() + 1, options.threads, [&](std::size_t i) {
      if (i == 0) {
        for (const LasChunk& chunk : written) file.append(chunk);
        return;
      }
      const std::uint64_t first = next + (i - 1) * firings_in_piece;
      const std::uint64_t count = std::min(firings_in_piece, progress.all_firings - first);
      thread_local sim::LidarReturns returns;
      returns = lidar.measure(scene, flight, {first, count}, std::move(returns));
      measured[i - 1] = file.encode(returns);
    });
    next = std::min(next + measured.size() * firings_in_piece, progress.all_firings);
    written.swap(measured);
    progress.firings = next;
    progress.points = file.points();
    if (options.report) options.report(progress);
  }
  for (const LasChunk& chunk : written) file.append(chunk);
  progress.points = file.points();
  result.is_complete = next == progress.all_firings;
  return result;
}

}  // namespace skycap::missions
