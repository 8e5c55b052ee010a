#include "missions/scan/scan_runner.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "geometry/parallel.h"

namespace skycap::missions::scan {
namespace {

/// Returns the number of firings per portion, small enough for the returns and their bytes to stay
/// in the cache of a core.
std::uint64_t firings_in_portion(const sim::Lidar& lidar) {
  constexpr std::uint64_t pulses = 1 << 12, block = 32;
  return std::max<std::uint64_t>(1, pulses / (lidar.config().channels.size() * block)) * block;
}

/// Some thousand pulses, encoded for each file.
struct Portion {
  std::vector<CloudChunk> chunks;  // One chunk per file.
  std::uint64_t end_firing = 0;
  std::uint64_t points = 0;
  bool is_ready = false;
};

/// Portions are measured on any thread and appended in order. The thread that has just measured a
/// portion appends all ready portions unless another thread does so. The size of the ring limits
/// how far measuring can run ahead.
class ScanRun {
 public:
  ScanRun(const sim::Scene& scene, const sim::Lidar& lidar, const sim::LidarFlight& flight,
          std::span<CloudFile> files, const ScanOptions& options)
      : scene_(scene),
        lidar_(lidar),
        flight_(flight),
        files_(files),
        options_(options),
        firings_in_portion_(firings_in_portion(lidar)) {
    const sim::FiringRange range = find_firings(options.shard, lidar, flight.ground_truth);
    end_firing_ = range.first + range.count;
    progress_.all_firings = lidar.firings(flight.ground_truth);
    portions_ = (end_firing_ + firings_in_portion_ - 1) / firings_in_portion_;
    ring_.resize(8UL * geometry::thread_count(options.threads));
    for (Portion& portion : ring_) portion.chunks.resize(files.size());
    go_on_from(options.begun.firings == 0 ? ScanProgress{range.first, 0, 0} : options.begun,
               range.first);
  }

  ScanResult run() {
    const unsigned threads = geometry::thread_count(options_.threads);
    geometry::parallel_for(threads, threads, [&](std::size_t) {
      try {
        work();
      } catch (...) {
        abandon();
        throw;
      }
    });
    return {progress_, progress_.firings == end_firing_};
  }

 private:
  void go_on_from(const ScanProgress& begun, std::uint64_t first_firing) {
    const bool is_whole = begun.firings % firings_in_portion_ == 0;
    if (begun.firings < first_firing || begun.firings > end_firing_ ||
        (!is_whole && begun.firings != end_firing_)) {
      throw Error(ErrorKind::bad_file,
                  "the checkpoint does not belong to this flight: it ends after " +
                      std::to_string(begun.firings) + " firings");
    }
    progress_.firings = begun.firings;
    progress_.points = begun.points;
    measured_ = appended_ = (begun.firings + firings_in_portion_ - 1) / firings_in_portion_;
  }

  void work() {
    sim::LidarReturns returns;
    for (auto number = next_number(); number < portions_; number = next_number()) {
      Portion& portion = ring_[number % ring_.size()];
      const std::uint64_t first = number * firings_in_portion_;
      portion.end_firing = std::min(first + firings_in_portion_, progress_.all_firings);
      returns =
          lidar_.measure(scene_, flight_, {first, portion.end_firing - first}, std::move(returns));
      portion.points = returns.size();
      for (std::size_t i = 0; i < files_.size(); ++i) files_[i].encode(returns, portion.chunks[i]);
      append_from(portion);
    }
  }

  // Returns the next portion to measure, or `portions_` when all are measured or a stop is
  // requested.
  std::uint64_t next_number() {
    std::unique_lock lock(mutex_);
    space_available_.wait(lock, [&] { return is_over_ || measured_ < appended_ + ring_.size(); });
    if (options_.stop.stop_requested()) is_over_ = true;
    return is_over_ || measured_ >= portions_ ? portions_ : measured_++;
  }

  // Appends all consecutive ready portions.
  void append_from(Portion& measured) {
    std::unique_lock lock(mutex_);
    measured.is_ready = true;
    if (is_appending_) return;
    is_appending_ = true;
    while (ring_[appended_ % ring_.size()].is_ready) {
      Portion& portion = ring_[appended_ % ring_.size()];
      lock.unlock();
      for (std::size_t i = 0; i < files_.size(); ++i) files_[i].append(portion.chunks[i]);
      progress_.firings = portion.end_firing;
      progress_.points += portion.points;
      if (options_.report) options_.report(progress_);
      write_down();
      lock.lock();
      portion.is_ready = false;
      ++appended_;
      space_available_.notify_all();
    }
    is_appending_ = false;
  }

  // Called only by the appending thread.
  void write_down() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> since = now - written_down_;
    if (!options_.checkpoint || since.count() < options_.checkpoint_period) return;
    options_.checkpoint(progress_);
    written_down_ = std::chrono::steady_clock::now();
  }

  void abandon() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    space_available_.notify_all();
  }

  const sim::Scene& scene_;
  const sim::Lidar& lidar_;
  const sim::LidarFlight& flight_;
  std::span<CloudFile> files_;
  const ScanOptions& options_;
  std::uint64_t firings_in_portion_;
  std::uint64_t end_firing_ = 0, portions_ = 0;

  std::mutex mutex_;
  std::condition_variable space_available_;
  std::vector<Portion> ring_;  // Portion i is at index i % size.
  std::uint64_t measured_ = 0, appended_ = 0;
  bool is_appending_ = false, is_over_ = false;
  ScanProgress progress_;  // Used only by the appending thread.
  std::chrono::steady_clock::time_point written_down_ = std::chrono::steady_clock::now();
};

}  // namespace

sim::FiringRange find_firings(const FlightShard& shard, const sim::Lidar& lidar,
                              const sim::Trajectory& ground_truth) {
  const std::uint64_t all = lidar.firings(ground_truth), portion = firings_in_portion(lidar);
  const std::uint64_t portions = (all + portion - 1) / portion;
  const auto compute_begin = [&](std::uint64_t number) {
    return std::min(all, portions * number / shard.count * portion);
  };
  const std::uint64_t first = compute_begin(shard.number);
  return {first, compute_begin(shard.number + 1) - first};
}

ScanResult run_scan(const sim::Scene& scene, const sim::Lidar& lidar,
                    const sim::LidarFlight& flight, std::span<CloudFile> files,
                    const ScanOptions& options) {
  return ScanRun(scene, lidar, flight, files, options).run();
}

}  // namespace skycap::missions::scan
