#include "missions/photo/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "flight/export/text.h"
#include "geometry/io/output_folder.h"

namespace skycap::missions::photo {
namespace {

using flight::fixed;
using geometry::PhotoCameraConfig;
using survey::photo::PhotoPlan;

constexpr int decimals = 9;

/// Returns the indices of the photos in the order of their image names, which is COLMAP's order.
std::vector<std::uint32_t> by_name(const PhotoPlan& plan) {
  std::vector<std::uint32_t> order(plan.photos.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return plan.photos[i].name; });
  return order;
}

}  // namespace

std::string colmap_camera_model(const PhotoCameraConfig& camera) {
  if (!camera.distortion) return "PINHOLE";
  return camera.distortion->k3 == 0.0 ? "OPENCV" : "FULL_OPENCV";
}

std::string colmap_camera_parameters(const PhotoCameraConfig& camera) {
  const std::string focal = fixed(geometry::PhotoCamera(camera).focal_length_px(), decimals);
  std::string text = focal + "," + focal + "," + fixed(0.5 * camera.width, 1) + "," +
                     fixed(0.5 * camera.height, 1);
  if (!camera.distortion) return text;
  const geometry::BrownDistortion& intrinsics = *camera.distortion;
  for (const double value : {intrinsics.k1, intrinsics.k2, intrinsics.p1, intrinsics.p2}) {
    text += "," + fixed(value, decimals);
  }
  if (intrinsics.k3 != 0.0)
    text += "," + fixed(intrinsics.k3, decimals) + ",0,0,0";  // k3, then k4 to k6
  return text;
}

std::string colmap_cameras(const PhotoCameraConfig& camera) {
  std::string parameters = colmap_camera_parameters(camera);
  std::ranges::replace(parameters, ',', ' ');
  return "# Camera list with one line of data per camera:\n"
         "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 " +
         colmap_camera_model(camera) + " " + std::to_string(camera.width) + " " +
         std::to_string(camera.height) + " " + parameters + "\n";
}

std::string colmap_images(const PhotoPlan& plan, const std::string& extension) {
  std::string text =
      "# Image list with two lines of data per image:\n"
      "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
      "#   POINTS2D[] as (X, Y, POINT3D_ID)\n";
  int id = 0;
  for (const std::uint32_t i : by_name(plan)) {
    const Eigen::Isometry3d camera_from_world =
        geometry::camera_pose(plan.photos[i].view).inverse();
    Eigen::Quaterniond turn(camera_from_world.linear());
    turn.normalize();
    if (turn.w() < 0.0) turn.coeffs() *= -1.0;
    text += std::to_string(++id);
    for (const double value : {turn.w(), turn.x(), turn.y(), turn.z()}) {
      text += " " + fixed(value, 12);
    }
    for (const double value : camera_from_world.translation()) text += " " + fixed(value, decimals);
    text += " 1 " + image_name(plan.photos[i], extension) + "\n\n";
  }
  return text;
}

std::string colmap_pairs(const PhotoPlan& plan, std::span<const survey::photo::PhotoPair> pairs,
                         const std::string& extension) {
  std::string text;
  for (const survey::photo::PhotoPair& pair : pairs) {
    text += image_name(plan.photos.at(pair.first), extension) + " " +
            image_name(plan.photos.at(pair.second), extension) + "\n";
  }
  return text;
}

std::string colmap_priors(const PhotoPlan& plan, const PoseSigmas& sigmas,
                          const std::string& extension) {
  std::string text = "# IMAGE_NAME X Y Z SIGMA_X SIGMA_Y SIGMA_Z\n";
  const std::string sigma = " " + fixed(sigmas.position, 3);
  for (const std::uint32_t i : by_name(plan)) {
    text += image_name(plan.photos[i], extension);
    for (const double value : plan.photos[i].view.position) text += " " + fixed(value, 4);
    text += sigma + sigma + sigma + "\n";
  }
  return text;
}

std::string colmap_script(const PhotoPlan& plan, const PoseSigmas& sigmas) {
  // Three standard deviations per axis.
  const std::string max_error = fixed(3.0 * std::sqrt(3.0) * sigmas.position, 3);
  const std::vector<std::string> lines{
      "#!/bin/sh",
      "# Reconstructs the photos of the plan with COLMAP 3.8 or later.",
      "#",
      "#   sh reconstruct.sh IMAGES [known | unknown]",
      "#",
      "# IMAGES: folder of the photos, named as in images.txt.",
      "# known (default): COLMAP uses the poses of images.txt. Use it for simulated photos,",
      "# or replace the poses in images.txt with the measured poses first.",
      "# unknown: COLMAP estimates the poses, and aligns the model with priors.txt.",
      "# Features are extracted by one thread, because several threads change the image IDs.",
      "set -eu",
      "images=$1",
      "poses=${2:-known}",
      "here=$(cd \"$(dirname \"$0\")\" && pwd)",
      "database=$here/database.db",
      "rm -f \"$database\"",
      "colmap feature_extractor --database_path \"$database\" --image_path \"$images\" \\",
      "  --ImageReader.single_camera 1 \\",
      "  --ImageReader.camera_model " + colmap_camera_model(plan.camera) + " \\",
      "  --ImageReader.camera_params " + colmap_camera_parameters(plan.camera) + " \\",
      "  --SiftExtraction.use_gpu 0 --SiftExtraction.num_threads 1",
      "colmap matches_importer --database_path \"$database\" --match_type pairs \\",
      "  --match_list_path \"$here/pairs.txt\" --SiftMatching.use_gpu 0",
      "mkdir -p \"$here/sparse\"",
      "if [ \"$poses\" = known ]; then",
      "  colmap point_triangulator --database_path \"$database\" --image_path \"$images\" \\",
      "    --input_path \"$here\" --output_path \"$here/sparse\"",
      "else",
      "  colmap mapper --database_path \"$database\" --image_path \"$images\" \\",
      "    --output_path \"$here/sparse\" \\",
      "    --Mapper.ba_refine_focal_length 0 --Mapper.ba_refine_extra_params 0",
      "  mkdir -p \"$here/aligned\"",
      "  colmap model_aligner --input_path \"$here/sparse/0\" --output_path \"$here/aligned\" \\",
      "    --ref_images_path \"$here/priors.txt\" --ref_is_gps 0 \\",
      "    --robust_alignment_max_error " + max_error,
      "fi"};
  std::string script;
  for (const std::string& line : lines) script += line + "\n";
  return script;
}

void write_colmap(const PhotoPlan& plan, std::span<const survey::photo::PhotoPair> pairs,
                  const PoseSigmas& sigmas, const std::filesystem::path& folder,
                  const std::string& extension) {
  geometry::OutputFolder output(folder);
  output.write("cameras.txt", colmap_cameras(plan.camera));
  output.write("images.txt", colmap_images(plan, extension));
  output.write("points3D.txt", "# No points, because the photos have not been taken yet.\n");
  output.write("pairs.txt", colmap_pairs(plan, pairs, extension));
  output.write("priors.txt", colmap_priors(plan, sigmas, extension));
  output.write("reconstruct.sh", colmap_script(plan, sigmas));
  output.commit();
}

}  // namespace skycap::missions::photo
