/// What a survey leaves uncovered, in connected pieces: where, how much, why, and who sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "geometry/surfaces/mesh.h"
#include "survey/skycap/skycap_planner.h"

namespace skycap::missions::package {

/// Uncovered pieces of surface that hang together and are missing for the same reason.
struct Hole {
  survey::skycap::MissingReason reason = survey::skycap::MissingReason::none;
  double area = 0.0;  ///< missing: of each piece the share that is not expected to be covered [m^2]
  std::size_t pieces = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of the pieces by missing area
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit; zero if the pieces face all ways
  double radius = 0.0;                               ///< of its farthest piece from the centre
  std::size_t nearest_view = 0;                      ///< to the centre; of no views: 0
  double view_distance = 0.0;                        ///< from that view [m]; of no views: 0
};

/// All that is missing. The areas of holes, smaller ones and rest sum to what is missing of the
/// surface: its area times one less its coverage.
struct MissingSurface {
  double area = 0.0;          ///< of the whole surface [m^2]
  double link = 0.0;          ///< pieces of usual size this near together are of one hole [m]
  std::vector<Hole> holes;    ///< of at least `least_hole`, largest first
  double least_hole = 0.0;    ///< four pieces of usual size [m^2]
  std::size_t smaller = 0;    ///< how many there are besides
  double smaller_area = 0.0;  ///< missing in them [m^2]
  double rest = 0.0;          ///< what even well covered surface is expected to lack [m^2]
};

MissingSurface missing_surface(std::span<const survey::skycap::BelievedPatch> patches,
                               std::span<const geometry::View> views);

/// The surface as the simulator knows it, for planners that believe nothing: a piece for each
/// sample, covered or not. A sample that no admissible view sees is out of reach; `is_visible` is
/// empty where nobody has asked.
std::vector<survey::skycap::BelievedPatch> true_patches(const geometry::SurfaceSamples& samples,
                                                        double area,
                                                        std::span<const std::uint8_t> is_covered,
                                                        std::span<const std::uint8_t> is_visible);

/// The word for it in files: covered, seen_too_thinly, never_seen, unreachable.
const char* name_of(survey::skycap::MissingReason reason);

}  // namespace skycap::missions::package
