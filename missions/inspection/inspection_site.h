/// Structure of an inspection and the space around it, from prior data only.
#pragma once

#include <memory>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"
#include "missions/config/mission_setup.h"
#include "survey/inspection/inspection_planner.h"

namespace skycap::missions::inspection {

/// Space of an inspection: all space outside of the clearance from prior data, the structure, the
/// ground, no-fly volumes and the geofence. Thread-safe for queries.
class InspectionSpace {
 public:
  /// Reads the structure. The document of `setup` must be an inspection. Throws Error{bad_file} for
  /// a cloud that cannot be read, and Error{bad_config} if the targets have no surface.
  explicit InspectionSpace(const config::MissionSetup& setup);

  /// Returns the site for the planner. This object must outlive it.
  survey::inspection::InspectionSite site() const;

  /// Options of the flight, with the structure as an obstacle.
  const flight::FlightOptions& flight() const { return flight_; }
  const flight::FreeSpace& space() const { return *space_; }

 private:
  void add_cloud(const config::MissionSetup& setup, const std::filesystem::path& file);
  void add_targets(const config::MissionSetup& setup);

  flight::FlightOptions flight_;
  survey::ViewLimits limits_;
  std::vector<Eigen::Vector3f> points_, normals_;
  std::unique_ptr<const flight::KnownSpace> space_;
};

}  // namespace skycap::missions::inspection
