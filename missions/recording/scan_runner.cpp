#include "missions/recording/scan_runner.h"

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

namespace skycap::missions::recording {
namespace {

/// Some thousand shots, ready to be appended to each file.
struct Piece {
  std::vector<CloudChunk> chunks;  // one for each file
  std::uint64_t end_firing = 0;
  std::uint64_t points = 0;
  bool is_ready = false;
};

/// Pieces are measured by any thread and appended in order: by whichever thread has just measured
/// one, if no other is at it. The ring of pieces bounds how far measuring may run ahead.
class ScanRun {
 public:
  ScanRun(const sim::Scene& scene, const sim::Lidar& lidar, const sim::LidarFlight& flight,
          std::span<CloudFile> files, const ScanOptions& options)
      : scene_(scene), lidar_(lidar), flight_(flight), files_(files), options_(options) {
    // So few that the returns and their bytes stay in a core's own cache.
    constexpr std::uint64_t shots_in_piece = 1 << 12, block = 32;
    firings_in_piece_ =
        std::max<std::uint64_t>(1, shots_in_piece / (lidar.config().channels.size() * block)) *
        block;
    progress_.all_firings = lidar.firings(flight.flown);
    pieces_ = (progress_.all_firings + firings_in_piece_ - 1) / firings_in_piece_;
    ring_.resize(8UL * geometry::thread_count(options.threads));
    for (Piece& piece : ring_) piece.chunks.resize(files.size());
    go_on_from(options.begun);
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
    return {progress_, progress_.firings == progress_.all_firings};
  }

 private:
  void go_on_from(const ScanProgress& begun) {
    const bool is_whole = begun.firings % firings_in_piece_ == 0;
    if (begun.firings > progress_.all_firings ||
        (!is_whole && begun.firings != progress_.all_firings)) {
      throw Error(ErrorKind::bad_file, "no scan of this flight was interrupted after " +
                                           std::to_string(begun.firings) + " firings");
    }
    progress_.firings = begun.firings;
    progress_.points = begun.points;
    measured_ = appended_ = (begun.firings + firings_in_piece_ - 1) / firings_in_piece_;
  }

  void work() {
    sim::LidarReturns returns;
    for (auto number = next_number(); number < pieces_; number = next_number()) {
      Piece& piece = ring_[number % ring_.size()];
      const std::uint64_t first = number * firings_in_piece_;
      piece.end_firing = std::min(first + firings_in_piece_, progress_.all_firings);
      returns =
          lidar_.measure(scene_, flight_, {first, piece.end_firing - first}, std::move(returns));
      piece.points = returns.size();
      for (std::size_t i = 0; i < files_.size(); ++i) files_[i].encode(returns, piece.chunks[i]);
      append_from(piece);
    }
  }

  // The piece to measure next; `pieces_` when there is none left or the scan is to stop.
  std::uint64_t next_number() {
    std::unique_lock lock(mutex_);
    has_room_.wait(lock, [&] { return is_over_ || measured_ < appended_ + ring_.size(); });
    if (options_.stop.stop_requested()) is_over_ = true;
    return is_over_ || measured_ >= pieces_ ? pieces_ : measured_++;
  }

  // Appends what is ready, beginning with the piece whose turn it is.
  void append_from(Piece& measured) {
    std::unique_lock lock(mutex_);
    measured.is_ready = true;
    if (is_appending_) return;
    is_appending_ = true;
    while (ring_[appended_ % ring_.size()].is_ready) {
      Piece& piece = ring_[appended_ % ring_.size()];
      lock.unlock();
      for (std::size_t i = 0; i < files_.size(); ++i) files_[i].append(piece.chunks[i]);
      progress_.firings = piece.end_firing;
      progress_.points += piece.points;
      if (options_.report) options_.report(progress_);
      write_down();
      lock.lock();
      piece.is_ready = false;
      ++appended_;
      has_room_.notify_all();
    }
    is_appending_ = false;
  }

  // Only the thread that appends comes here.
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
    has_room_.notify_all();
  }

  const sim::Scene& scene_;
  const sim::Lidar& lidar_;
  const sim::LidarFlight& flight_;
  std::span<CloudFile> files_;
  const ScanOptions& options_;
  std::uint64_t firings_in_piece_ = 0, pieces_ = 0;

  std::mutex mutex_;
  std::condition_variable has_room_;
  std::vector<Piece> ring_;  // piece i is at i % size
  std::uint64_t measured_ = 0, appended_ = 0;
  bool is_appending_ = false, is_over_ = false;
  ScanProgress progress_;  // of the thread that appends
  std::chrono::steady_clock::time_point written_down_ = std::chrono::steady_clock::now();
};

}  // namespace

ScanResult run_scan(const sim::Scene& scene, const sim::Lidar& lidar,
                    const sim::LidarFlight& flight, std::span<CloudFile> files,
                    const ScanOptions& options) {
  return ScanRun(scene, lidar, flight, files, options).run();
}

}  // namespace skycap::missions::recording
