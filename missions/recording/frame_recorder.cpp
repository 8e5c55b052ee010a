#include "missions/recording/frame_recorder.h"

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
#include "geometry/points/point_cloud.h"
#include "missions/file/json_text.h"
#include "missions/plugins/module.h"
#include "missions/recording/preview.h"
#include "missions/recording/rawlog_module.h"
#include "missions/recording/scan_route.h"
#include "sim/sensors/depth_image.h"

namespace skycap::missions::recording {
namespace {

nlohmann::ordered_json camera_json(const geometry::Camera& camera, double unit) {
  return {
      {"width_px", camera.width()},
      {"height_px", camera.height()},
      {"focal_length_px", {camera.focal_length_px().x(), camera.focal_length_px().y()}},
      {"principal_point_px", {camera.principal_point_px().x(), camera.principal_point_px().y()}},
      {"depth_unit_m", unit}};
}

std::string file_name(std::size_t frame) { return fmt::format("depth_{:06}.png", frame); }

/// Images appended to a file as they are taken.
class FrameRawlog {
 public:
  FrameRawlog(const std::filesystem::path& path, const geometry::Camera& camera, double unit)
      : path_(path),
        camera_(camera),
        unit_(unit),
        encode_(plugins::module_function<EncodeDepthFrame>("libskycap_rawlog.so",
                                                           encode_depth_frame_name)),
        file_(path, std::ios::binary) {
    require_written();
  }

  void append(const Frame& frame, const sim::DepthImage& image) {
    const Eigen::Isometry3d world_from_sensor =
        frame.believed_from_camera * body_from_camera().inverse();
    encode_({frame.time, world_from_sensor, image, camera_.focal_length_px(),
             camera_.principal_point_px(), unit_, camera_.config().max_range},
            bytes_);
    file_.write(reinterpret_cast<const char*>(bytes_.data()),
                static_cast<std::streamsize>(bytes_.size()));
    require_written();
  }

  void finish() {
    file_.close();
    require_written();
  }

 private:
  void require_written() const {
    if (!file_) throw Error(ErrorKind::bad_file, path_.string() + ": cannot be written");
  }

  std::filesystem::path path_;
  const geometry::Camera& camera_;
  double unit_;
  EncodeDepthFrame* encode_;
  std::ofstream file_;
  std::vector<std::uint8_t> bytes_;
};

/// Adds the chosen points of an image, where its camera believes that they are.
void add_preview(const geometry::Scan& scan, const Frame& frame, std::uint32_t number, double share,
                 geometry::PointCloud& preview) {
  const Eigen::Isometry3d believed_from_real =
      frame.believed_from_camera * frame.world_from_camera.inverse();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!is_previewed(number, i, share)) continue;
    const Eigen::Vector3d point = believed_from_real * scan.points[i].cast<double>();
    preview.positions.emplace_back(point.cast<float>());
    preview.views.push_back(number);
  }
}

}  // namespace

FrameResult record_frames(const sim::Scene& scene, const sim::DepthCamera& camera,
                          std::span<const Frame> frames, geometry::OutputFolder& folder,
                          const FrameOptions& options) {
  FrameResult result;
  geometry::Scan scan;
  std::vector<flight::TimedPose> truth, believed;
  std::string list = "# timestamp filename\n";
  std::optional<FrameRawlog> rawlog;
  if (options.has_rawlog) {
    rawlog.emplace(folder.stage("frames.rawlog"), camera.camera(), options.depth_unit);
  }
  const double pixels = static_cast<double>(frames.size()) * camera.camera().width() *
                        static_cast<double>(camera.camera().height());
  geometry::PointCloud preview;
  for (const Frame& frame : frames) {
    if (options.stop.stop_requested()) break;
    scan = camera.scan(scene, frame.world_from_camera, result.frames, options.threads,
                       std::move(scan));
    const std::string name = file_name(result.frames);
    const sim::DepthImage image = sim::depth_image(scan, camera.camera(), options.depth_unit);
    sim::write_depth_png(image, folder.stage(name));
    if (rawlog) rawlog->append(frame, image);
    list += flight::fixed(frame.time, 6) + " " + name + "\n";
    truth.push_back({frame.time, frame.world_from_camera});
    believed.push_back({frame.time, frame.believed_from_camera});
    add_preview(scan, frame, static_cast<std::uint32_t>(result.frames), preview_share(pixels),
                preview);
    ++result.frames;
    result.points += scan.points.size();
    if (options.report) options.report(result.frames, result.points);
  }
  if (rawlog) rawlog->finish();
  geometry::write_cloud(
      folder.stage(preview_name),
      {.positions = preview.positions, .normals = {}, .views = preview.views, .colours = {}});
  folder.write("depth.txt", list);
  folder.write("groundtruth.txt", flight::write_tum(truth));
  folder.write("believed.txt", flight::write_tum(believed));
  folder.write("camera.json", file::json_text(camera_json(camera.camera(), options.depth_unit)));
  return result;
}

}  // namespace skycap::missions::recording
