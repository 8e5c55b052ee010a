/// Planned photos for COLMAP: model with known poses, image pairs to match, and commands.
///
/// COLMAP stores camera_from_world as a quaternion (w first) and a translation. The camera frame is
/// x right, y down, z forward. The centre of the top-left pixel is at (0.5, 0.5). The world is the
/// mission frame [m]. Source: COLMAP documentation, "Output Format", "Camera Models" and FAQ
/// "Reconstruct sparse/dense model from known camera poses".
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "missions/photo/photo_table.h"
#include "survey/photo/photo_plan.h"
#include "survey/photo/view_graph.h"

namespace skycap::missions::photo {

/// Returns cameras.txt with one camera, id 1. The model is PINHOLE without distortion, OPENCV with
/// distortion, and FULL_OPENCV if k3 is not zero.
std::string colmap_cameras(const geometry::PhotoCameraConfig& camera);

/// Returns the model or the parameters of the camera in the form required by feature_extractor.
std::string colmap_camera_model(const geometry::PhotoCameraConfig& camera);
std::string colmap_camera_parameters(const geometry::PhotoCameraConfig& camera);

/// Returns images.txt with all photos, without points. Ids count from 1 in the order of the image
/// names, as in a database created by feature_extractor. This is necessary because
/// point_triangulator matches images by id.
std::string colmap_images(const survey::photo::PhotoPlan& plan,
                          const std::string& extension = ".jpg");

/// Returns pairs.txt: the names of both images of each pair to match, one pair per line.
std::string colmap_pairs(const survey::photo::PhotoPlan& plan,
                         std::span<const survey::photo::PhotoPair> pairs,
                         const std::string& extension = ".jpg");

/// Returns priors.txt: image name, x, y, z and their standard deviations, for pose_prior_mapper and
/// model_aligner. model_aligner reads only the first four columns.
std::string colmap_priors(const survey::photo::PhotoPlan& plan, const PoseSigmas& sigmas,
                          const std::string& extension = ".jpg");

/// Returns a shell script that reconstructs the images of a folder with this model. It uses the
/// known poses, or estimates the poses and aligns the model afterwards.
std::string colmap_script(const survey::photo::PhotoPlan& plan, const PoseSigmas& sigmas);

/// Writes cameras.txt, images.txt, points3D.txt, pairs.txt, priors.txt and reconstruct.sh to the
/// folder, either all or none. Throws Error{bad_file}.
void write_colmap(const survey::photo::PhotoPlan& plan,
                  std::span<const survey::photo::PhotoPair> pairs, const PoseSigmas& sigmas,
                  const std::filesystem::path& folder, const std::string& extension = ".jpg");

}  // namespace skycap::missions::photo
