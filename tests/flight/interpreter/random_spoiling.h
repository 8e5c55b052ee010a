/// Random changes to mission files, and where a vehicle goes that flies what is left: computed
/// without the product's code.
#pragma once

#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/mavlink_files.h"
#include "tests/flight/clearance/cgal_oracle.h"

namespace skycap::flight {

/// Where a mission's frame and its pad are on the Earth.
struct Ground {
  double latitude_deg = 0.0, longitude_deg = 0.0, height = 0.0;  ///< of the frame's origin
  double undulation = 0.0;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();

  /// A place that is `up` above the pad, by the ellipsoid's radii at the origin: good to some
  /// millimetres within 200 m.
  Eigen::Vector3d position(double latitude, double longitude, double up) const;

  /// Degrees north and east, and metres above the pad, of all within so far of the origin.
  Eigen::AlignedBox3d around(double half_width, double max_height) const;
};

/// One random change to one random item: another command, frame, parameter, height, order, a jump,
/// a place in `site`, which is as Ground::around() says. Numbers stay those of the places in the
/// file.
void corrupt(MavlinkMission& file, std::mt19937_64& random, const Eigen::AlignedBox3d& site);

/// The text of a WPML file with one of its numbers changed.
std::string corrupted(std::string wpml, std::mt19937_64& random);

/// The places that an autopilot flies to: the pad, those of the items in order, jumps followed, and
/// where it lands.
std::vector<Eigen::Vector3d> make_flight(const std::vector<MissionItem>& items,
                                         const Ground& ground);

/// The places of a WPML file's waypoints, read without an XML parser, between the pad's.
std::vector<Eigen::Vector3d> make_flight(const std::string& wayline, const Ground& ground);

/// Whether straight lines between the places keep the clearance, less the rounding of files.
bool keeps_clear(const CgalOracle& oracle, const std::vector<Eigen::Vector3d>& positions,
                 double clearance);

}  // namespace skycap::flight
