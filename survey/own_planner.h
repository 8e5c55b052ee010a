/// Interface for planners of users in shared libraries. The header has no dependency on a compiled
/// library of Skycap: a planner is compiled with its include folder only.
/// docs/howto/write-a-planner.md has examples.
///
/// The library must be built with a compiler whose C++ interface is compatible with that of the
/// program, and with the headers of the same minor version.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"

namespace skycap::survey {

/// Version of this interface. It changes with every incompatible change.
inline constexpr int own_planner_interface = 1;

/// Survey for which a planner is created.
struct OwnPlannerTask {
  std::uint64_t seed = 1;  ///< all random decisions of the planner must depend on it only
  geometry::CameraConfig camera;
  double spacing = 0.0;        ///< minimum distance of the points of the cloud [m]
  double view_distance = 1.0;  ///< recommended distance of views from the surface [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< region of interest, world frame [m]
};

/// Planner of a user. It receives scans only, never the true scene. Exceptions derived from
/// std::exception end the survey with their message.
class OwnPlanner {
 public:
  virtual ~OwnPlanner() = default;

  /// Processes a scan and returns the next view, or nullopt if the survey is complete. `cloud`
  /// contains all stored points including those of the scan. Directions need not have unit length.
  virtual std::optional<geometry::View> next_view(const geometry::ScanSpan& scan,
                                                  const geometry::PointCloud& cloud) = 0;

  /// Returns another view instead of the last one, which violates a limit of the mission or is
  /// unreachable, or nullopt if there are no more. May be called repeatedly.
  virtual std::optional<geometry::View> next_alternative_view() { return std::nullopt; }
};

}  // namespace skycap::survey

/// Makes a class the planner of a library. It must have a constructor with the parameter `const
/// skycap::survey::OwnPlannerTask&`. Use it once per library, outside of namespaces.
#define SKYCAP_OWN_PLANNER(Type)                                                         \
  extern "C" __attribute__((visibility("default"))) int skycap_own_planner_interface() { \
    return skycap::survey::own_planner_interface;                                        \
  }                                                                                      \
  extern "C" __attribute__((visibility("default"))) void* skycap_make_own_planner(       \
      const void* task) {                                                                \
    return static_cast<skycap::survey::OwnPlanner*>(                                     \
        new Type(*static_cast<const skycap::survey::OwnPlannerTask*>(task)));            \
  }
