/// Target and surroundings of a photo mission, and the space for photos, from prior data only.
#pragma once

#include <functional>
#include <memory>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/clearance/measured_space.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/config/mission_setup.h"
#include "missions/config/photo_rules.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::photo {

/// Airspace of a photo mission. Thread-safe for queries.
class PhotoAirspace {
 public:
  /// Keeps a reference to `setup`, whose document must have a photo camera. Throws
  /// Error{bad_config} if the targets have no surface or are outside site.geofence.
  PhotoAirspace(const config::MissionSetup& setup, unsigned threads);
  PhotoAirspace(const PhotoAirspace&) = delete;
  PhotoAirspace& operator=(const PhotoAirspace&) = delete;

  /// Returns the surface of all targets, in the mission frame.
  const geometry::Mesh& targets() const { return targets_; }

  /// Returns true if a photo may be taken at a position. The position must be at least the
  /// stand-off from all prior surfaces. With a vehicle, it must also be at least the clearance from
  /// all space that is not free.
  bool is_free(const Eigen::Vector3d& position) const;

  /// Returns the space assumed as measured, because a photo mission measures none. With
  /// flight.free_space: assumed, all space is free. Otherwise all space outside the unknown boxes
  /// is free. Prior data and rules apply in addition.
  const flight::MeasuredSpace& measured() const { return measured_; }

 private:
  const config::MissionSetup& setup_;
  geometry::Mesh targets_;
  geometry::MeshDistance walls_;
  flight::MeasuredSpace measured_;
  flight::KnownSpace rules_;
  flight::JointSpace space_;
};

/// Returns the target and its surroundings. `airspace` must outlive the result.
survey::photo::PhotoSite photo_site(const config::MissionSetup& setup,
                                    const PhotoAirspace& airspace);

}  // namespace skycap::missions::photo
