#include "missions/frame_recorder.h"

#include <cstdio>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "flight/export/text.h"
#include "flight/export/trajectory_file.h"
#include "missions/json_text.h"
#include "sim/depth_image.h"

namespace skycap::missions {
namespace {

nlohmann::ordered_json camera_json(const geometry::Camera& camera, double unit) {
  return {
      {"width_px", camera.width()},
      {"height_px", camera.height()},
      {"focal_length_px", {camera.focal_length_px().x(), camera.focal_length_px().y()}},
      {"principal_point_px", {camera.principal_point_px().x(), camera.principal_point_px().y()}},
      {"depth_unit_m", unit}};
}

std::string file_name(std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "depth_%06zu.png", frame);
  return name;
}

}  // namespace

FrameResult record_frames(const sim::Scene& scene, const sim::DepthCamera& camera,
                          std::span<const Frame> frames, OutputFolder& folder,
                          const FrameOptions& options) {
  FrameResult result;
  geometry::Scan scan;
  std::vector<flight::TimedPose> truth, believed;
  std::string list = "# timestamp filename\n";
  for (const Frame& frame : frames) {
    if (options.stop.stop_requested()) break;
    scan = camera.scan(scene, frame.world_from_camera, result.frames, options.threads,
                       std::move(scan));
    const std::string name = file_name(result.frames);
    sim::write_depth_png(sim::depth_image(scan, camera.camera(), options.depth_unit),
                         folder.stage(name));
    list += flight::fixed(frame.time, 6) + " " + name + "\n";
    truth.push_back({frame.time, frame.world_from_camera});
    believed.push_back({frame.time, frame.believed_from_camera});
    ++result.frames;
    result.points += scan.points.size();
    if (options.report) options.report(result.frames, result.points);
  }
  folder.write("depth.txt", list);
  folder.write("groundtruth.txt", flight::write_tum(truth));
  folder.write("believed.txt", flight::write_tum(believed));
  folder.write("camera.json", json_text(camera_json(camera.camera(), options.depth_unit)));
  return result;
}

}  // namespace skycap::missions
