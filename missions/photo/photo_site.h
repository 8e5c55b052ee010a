/// The target of a photo mission with its surroundings, and the space that photos may be taken in:
/// all from prior data.
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

/// The airspace of a photo mission. Safe to query from several threads.
class PhotoAirspace {
 public:
  /// Keeps a reference to `setup`, whose document has a photo camera.
  PhotoAirspace(const config::MissionSetup& setup, unsigned threads);
  PhotoAirspace(const PhotoAirspace&) = delete;
  PhotoAirspace& operator=(const PhotoAirspace&) = delete;

  /// Whether a photo may be taken there: at the stand-off from all prior surfaces, and with a
  /// vehicle at the clearance from all that is not free.
  bool is_free(const Eigen::Vector3d& position) const;

  /// Space as a photo mission knows it, which measures none: with flight.free_space: assumed, free
  /// everywhere; else outside of the unknown boxes. Prior data and rules apply in addition.
  const flight::MeasuredSpace& measured() const { return measured_; }

 private:
  const config::MissionSetup& setup_;
  geometry::MeshDistance walls_;
  flight::MeasuredSpace measured_;
  flight::KnownSpace rules_;
  flight::JointSpace space_;
};

/// The target and its surroundings. `airspace` must outlive it. Throws Error{bad_config} if the
/// targets have no surface.
survey::photo::PhotoSite photo_site(const config::MissionSetup& setup,
                                    const PhotoAirspace& airspace);

}  // namespace skycap::missions::photo
