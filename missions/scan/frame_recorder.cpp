#include "missions/scan/frame_recorder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/text.h"
#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "geometry/points/depth_image.h"
#include "geometry/points/point_cloud.h"
#include "missions/scan/preview.h"
#include "missions/scan/rawlog_module.h"
#include "missions/scan/scan_route.h"
#include "missions/support/json_text.h"
#include "missions/support/module.h"

namespace skycap::missions::scan {
namespace {

using Clock = std::chrono::steady_clock;

nlohmann::ordered_json camera_json(const geometry::Camera& camera, double unit) {
  return {
      {"width_px", camera.width()},
      {"height_px", camera.height()},
      {"focal_length_px", {camera.focal_length_px().x(), camera.focal_length_px().y()}},
      {"principal_point_px", {camera.principal_point_px().x(), camera.principal_point_px().y()}},
      {"depth_unit_m", unit}};
}

std::string file_name(std::size_t frame) { return fmt::format("depth_{:06}.png", frame); }

/// Rawlog of images that is written during the recording.
class FrameRawlog {
 public:
  /// Continues a file that had the size `grown` [bytes].
  FrameRawlog(const std::filesystem::path& path, std::uint64_t grown,
              const geometry::Camera& camera, double unit)
      : path_(path),
        camera_(camera),
        unit_(unit),
        encode_(support::module_function<EncodeDepthFrame>("libskycap_rawlog.so",
                                                           encode_depth_frame_name)),
        bytes_written_(grown) {
    if (grown > 0) geometry::cut_file(path, grown);
    file_.open(path, grown > 0 ? std::ios::binary | std::ios::in | std::ios::out | std::ios::ate
                               : std::ios::binary | std::ios::out);
    require_written();
  }

  void append(const Frame& frame, const geometry::DepthImage& image) {
    const Eigen::Isometry3d world_from_sensor =
        frame.estimated_from_camera * body_from_camera().inverse();
    encode_({frame.time, world_from_sensor, image, camera_.focal_length_px(),
             camera_.principal_point_px(), unit_, camera_.config().max_range},
            bytes_);
    file_.write(reinterpret_cast<const char*>(bytes_.data()),
                static_cast<std::streamsize>(bytes_.size()));
    require_written();
    bytes_written_ += bytes_.size();
  }

  /// Flushes the file to disk and returns its size [bytes].
  std::uint64_t sync() {
    file_.flush();
    require_written();
    geometry::sync_to_disk(path_);
    return bytes_written_;
  }

 private:
  void require_written() const {
    if (!file_.is_open() || !file_) {
      throw Error(ErrorKind::bad_file, path_.string() + ": cannot be written");
    }
  }

  std::filesystem::path path_;
  const geometry::Camera& camera_;
  double unit_;
  EncodeDepthFrame* encode_;
  std::fstream file_;
  std::uint64_t bytes_written_;
  std::vector<std::uint8_t> bytes_;
};

/// Adds the selected points of an image at their estimated positions.
void add_preview(const geometry::Scan& scan, const Frame& frame, std::uint32_t number, double share,
                 geometry::PointCloud& preview) {
  const Eigen::Isometry3d estimated_from_true =
      frame.estimated_from_camera * frame.world_from_camera.inverse();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!is_previewed(number, i, share)) continue;
    const Eigen::Vector3d point = estimated_from_true * scan.points[i].cast<double>();
    preview.positions.emplace_back(point.cast<float>());
    preview.views.push_back(number);
  }
}

/// Recording of the images in order.
class FrameRecording {
 public:
  FrameRecording(const sim::Scene& scene, const sim::DepthCamera& camera,
                 std::span<const Frame> frames, ScanJournal& journal, const FrameOptions& options)
      : scene_(scene), camera_(camera), frames_(frames), journal_(journal), options_(options) {
    const double pixels = static_cast<double>(frames.size()) * camera.camera().width() *
                          static_cast<double>(camera.camera().height());
    preview_share_ = preview_share(pixels);
    std::uint64_t rawlog_bytes = 0;
    if (options.begun.is_object()) rawlog_bytes = go_on();
    if (options.has_rawlog) {
      rawlog_.emplace(journal.path_to_change(rawlog_name), rawlog_bytes, camera.camera(),
                      options.depth_unit);
    }
  }

  FrameResult run() {
    auto written_down = Clock::now();
    while (result_.frames < frames_.size() && !options_.stop.stop_requested()) {
      capture(frames_[result_.frames]);
      if (result_.frames - synced_ == max_unsynced) sync_images();
      if (options_.report) options_.report(result_.frames, result_.points);
      const auto now = Clock::now();
      if (std::chrono::duration<double>(now - written_down).count() < options_.checkpoint_period) {
        continue;
      }
      write_down();
      written_down = Clock::now();
    }
    write_down();
    return result_;
  }

  void stage(geometry::OutputFolder& folder) const {
    std::vector<flight::TimedPose> truth, estimated;
    std::string list = "# timestamp filename\n";
    for (std::size_t i = 0; i < result_.frames; ++i) {
      const Frame& frame = frames_[i];
      journal_.stage_on_disk(file_name(i), folder);
      list += flight::fixed(frame.time, 6) + " " + file_name(i) + "\n";
      truth.push_back({frame.time, frame.world_from_camera});
      estimated.push_back({frame.time, frame.estimated_from_camera});
    }
    if (rawlog_ && result_.frames > 0) journal_.stage(rawlog_name, folder);
    journal_.stage(preview_name, folder);
    folder.write("depth.txt", list);
    folder.write("groundtruth.txt", flight::write_tum(truth));
    folder.write("estimated.txt", flight::write_tum(estimated));
    folder.write("camera.json",
                 support::json_text(camera_json(camera_.camera(), options_.depth_unit)));
  }

 private:
  static constexpr const char* rawlog_name = "frames.rawlog";
  // Flushing takes some milliseconds per image, which would delay the end of an interrupted scan.
  static constexpr std::size_t max_unsynced = 16;

  /// Restores the state of a checkpoint. Returns the size of the rawlog [bytes].
  std::uint64_t go_on() {
    try {
      result_ = {options_.begun.at("images").get<std::size_t>(),
                 options_.begun.at("points").get<std::size_t>(),
                 options_.begun.at("simulation_s").get<double>()};
      earlier_ = result_.time;
      synced_ = result_.frames;
      const auto previewed = options_.begun.at("preview_points").get<std::size_t>();
      if (previewed > 0) read_preview(previewed);
      if (result_.frames > frames_.size() || preview_.size() != previewed) {
        throw Error(ErrorKind::bad_file,
                    journal_.file().string() + ": is truncated; start again without --resume");
      }
      return options_.begun.at("rawlog_bytes").get<std::uint64_t>();
    } catch (const nlohmann::json::exception& failure) {
      throw Error(ErrorKind::bad_file, journal_.file().string() + ": " + failure.what());
    }
  }

  /// The file may contain further points that were written after the last checkpoint.
  void read_preview(std::size_t count) {
    geometry::AttributedCloud read = geometry::read_cloud(journal_.path(preview_name));
    count = std::min({count, read.positions.size(), read.views.size()});
    read.positions.resize(count);
    read.views.resize(count);
    preview_ = {std::move(read.positions), std::move(read.views)};
  }

  void capture(const Frame& frame) {
    scan_ = camera_.scan(scene_, frame.world_from_camera, result_.frames, options_.threads,
                         std::move(scan_));
    const geometry::DepthImage image =
        geometry::depth_image(scan_, camera_.camera(), options_.depth_unit);
    geometry::write_depth_png(image, journal_.path(file_name(result_.frames)));
    if (rawlog_) rawlog_->append(frame, image);
    add_preview(scan_, frame, static_cast<std::uint32_t>(result_.frames), preview_share_, preview_);
    ++result_.frames;
    result_.points += scan_.points.size();
  }

  void sync_images() {
    for (; synced_ < result_.frames; ++synced_) {
      geometry::sync_to_disk(journal_.path(file_name(synced_)));
    }
  }

  void write_down() {
    sync_images();
    geometry::write_cloud(
        journal_.path(preview_name),
        {.positions = preview_.positions, .normals = {}, .views = preview_.views, .colours = {}});
    result_.time = earlier_ + std::chrono::duration<double>(Clock::now() - start_).count();
    journal_.checkpoint({{"images", result_.frames},
                         {"points", result_.points},
                         {"simulation_s", result_.time},
                         {"preview_points", preview_.size()},
                         {"rawlog_bytes", rawlog_ ? rawlog_->sync() : 0}});
  }

  const sim::Scene& scene_;
  const sim::DepthCamera& camera_;
  std::span<const Frame> frames_;
  ScanJournal& journal_;
  const FrameOptions& options_;
  double preview_share_ = 1.0;
  FrameResult result_;
  std::size_t synced_ = 0;  ///< Number of images flushed to disk.
  Clock::time_point start_ = Clock::now();
  double earlier_ = 0.0;  ///< Computation time of previous runs [s].
  geometry::Scan scan_;
  geometry::PointCloud preview_;
  std::optional<FrameRawlog> rawlog_;
};

}  // namespace

FrameResult record_frames(const sim::Scene& scene, const sim::DepthCamera& camera,
                          std::span<const Frame> frames, ScanJournal& journal,
                          geometry::OutputFolder& folder, const FrameOptions& options) {
  FrameRecording recording(scene, camera, frames, journal, options);
  const FrameResult result = recording.run();
  recording.stage(folder);
  return result;
}

}  // namespace skycap::missions::scan
