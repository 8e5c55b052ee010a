/// Random changes to mission files, and the resulting flight, computed without the product's code.
#pragma once

#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/mavlink_files.h"
#include "tests/flight/clearance/cgal_oracle.h"

namespace skycap::flight {

/// Georeference of the mission frame and the pad.
struct Ground {
  /// Geodetic position of the frame's origin.
  double latitude_deg = 0.0, longitude_deg = 0.0, height = 0.0;
  double undulation = 0.0;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();

  /// Returns the local position at `up` above the pad, with the radii of the ellipsoid at the
  /// origin. The error is a few millimetres within 200 m.
  Eigen::Vector3d position(double latitude, double longitude, double up) const;

  /// Returns the box [degrees north, degrees east, metres above the pad] around the origin.
  Eigen::AlignedBox3d around(double half_width, double max_height) const;
};

/// Applies one random change to one random item: command, frame, parameter, altitude, order, a
/// jump, or a position in `site` (see Ground::around()). The numbers remain valid for the file's
/// positions.
void corrupt(MavlinkMission& file, std::mt19937_64& random, const Eigen::AlignedBox3d& site);

/// Returns the WPML text with one of its numbers changed.
std::string corrupted(std::string wpml, std::mt19937_64& random);

/// Returns the positions that an autopilot flies to: the pad, the items in order with jumps, and
/// the landing position.
std::vector<Eigen::Vector3d> make_flight(const std::vector<MissionItem>& items,
                                         const Ground& ground);

/// Returns the positions of the waypoints in a WPML file, read without an XML parser, with the pad
/// before and after.
std::vector<Eigen::Vector3d> make_flight(const std::string& wayline, const Ground& ground);

/// Returns true if the straight lines between the positions keep the clearance, minus the rounding
/// of files.
bool keeps_clear(const CgalOracle& oracle, const std::vector<Eigen::Vector3d>& positions,
                 double clearance);

}  // namespace skycap::flight
