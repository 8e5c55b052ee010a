/// Planned photos for COLMAP: a model of known poses, the pairs to match, and the commands.
///
/// COLMAP stores camera_from_world as a quaternion (w first) and a translation; camera x right, y
/// down, z forward; the centre of the top-left pixel is at (0.5, 0.5). The world is the mission
/// frame [m]. Source: COLMAP documentation, "Output Format", "Camera Models" and FAQ "Reconstruct
/// sparse/dense model from known camera poses".
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "geometry/angle.h"
#include "missions/photos/photo_table.h"
#include "survey/photo/photo_plan.h"
#include "survey/photo/view_graph.h"

namespace skycap::missions::photos {

/// Pairs worth matching share at least this fraction of the smaller photo's samples, at a mean
/// parallax of at most this [rad]; others are seldom verified, and take most of the time.
inline constexpr double min_shared_to_match = 0.2;
inline constexpr double max_parallax_to_match = 42.0 * geometry::radians_per_degree;

/// One camera, id 1: PINHOLE, with distortion OPENCV, with k3 FULL_OPENCV.
std::string colmap_cameras(const geometry::PhotoCameraConfig& camera);

/// The parameters of that camera as feature_extractor takes them.
std::string colmap_camera_model(const geometry::PhotoCameraConfig& camera);
std::string colmap_camera_parameters(const geometry::PhotoCameraConfig& camera);

/// All photos, without points. Ids count from 1 in the order of the image names, as in a database
/// that feature_extractor makes: point_triangulator matches by id.
std::string colmap_images(const survey::photo::PhotoPlan& plan,
                          const std::string& extension = ".jpg");

/// Names of the two images of each pair that is worth matching, one pair a line.
std::string colmap_pairs(const survey::photo::PhotoPlan& plan,
                         std::span<const survey::photo::PhotoPair> pairs,
                         const std::string& extension = ".jpg");

/// Image name, x, y, z, and their standard deviations, for model_aligner (which reads the first
/// four columns) and pose_prior_mapper.
std::string colmap_priors(const survey::photo::PhotoPlan& plan, const PoseSigmas& sigmas,
                          const std::string& extension = ".jpg");

/// A shell script that reconstructs the images of a folder with this model: with known poses, or
/// without them and aligned afterwards.
std::string colmap_script(const survey::photo::PhotoPlan& plan, const PoseSigmas& sigmas);

/// Writes cameras.txt, images.txt, points3D.txt, pairs.txt, priors.txt and reconstruct.sh to the
/// folder, all or none. Throws Error{bad_file}.
void write_colmap(const survey::photo::PhotoPlan& plan,
                  std::span<const survey::photo::PhotoPair> pairs, const PoseSigmas& sigmas,
                  const std::filesystem::path& folder, const std::string& extension = ".jpg");

}  // namespace skycap::missions::photos
