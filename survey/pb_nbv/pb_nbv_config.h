/// Settings of PB-NBV (pb_nbv_planner.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "survey/view_limits.h"

namespace skycap::survey::pb_nbv {

/// Reading of the method where the released code differs from the published text.
enum class Reading { published, released };

/// Part of the sphere with candidates.
enum class Region {
  sphere,
  hemisphere,  ///< upper half
};

/// Settings in a mission file. Symbols are those of the paper.
struct PbNbvSettings {
  std::size_t views = 10;        ///< total number of views; the method has no stopping rule
  std::size_t candidates = 800;  ///< N
  std::size_t parallels = 24;    ///< alpha
  std::size_t sectors = 4;       ///< beta: sectors visited before the choice is free
  /// T_max: maximum number of ellipsoids per class; zero: random views (ablation).
  std::size_t max_ellipsoids = 10;
  double growth = 1.0;          ///< gamma: growth of the box around frontiers [voxels]
  std::optional<double> voxel;  ///< voxel size [m]; default: 0.06 of the first scan's longest edge
  std::optional<double> working_distance;  ///< d_c [m]; default: the view distance
  Region region = Region::sphere;
};

struct PbNbvConfig {
  PbNbvSettings settings;
  Reading reading = Reading::published;
  double view_distance = 1.0;                    ///< default of the working distance [m]
  double spacing = 0.00261711877;                ///< minimum distance of stored points [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are ignored
  ViewLimits limits;
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< threads for scores; zero: all processors; does not affect results

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;

  double working_distance() const { return settings.working_distance.value_or(view_distance); }
};

}  // namespace skycap::survey::pb_nbv
