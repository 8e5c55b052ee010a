/// Conversion between local frame and geodetic coordinates, and the three height references.
///
/// The local frame is east-north-up around an origin on WGS84. The model stores ellipsoid heights.
/// Height AMSL is the ellipsoid height minus the geoid undulation. Height above take-off is the
/// difference of two ellipsoid heights.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace skycap::flight {

struct GeodeticPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height = 0.0;  ///< Height above the WGS84 ellipsoid [m].
};

/// Georeference of the local frame.
struct Site {
  GeodeticPoint origin;
  /// Height of the geoid (EGM96 or EGM2008) above the ellipsoid at the site [m]. If it is unknown,
  /// formats with heights AMSL cannot be written.
  std::optional<double> geoid_undulation;

  /// Throws Error{bad_config} naming the first value outside its interval.
  void validate() const;

  /// Returns the undulation. If it is unknown, throws Error{bad_config} with `who`, the name of the
  /// requesting format.
  double undulation_for(const std::string& who) const;
};

/// East-north-up frame at an origin. Exact on the ellipsoid, without a flat-Earth approximation.
class LocalFrame {
 public:
  explicit LocalFrame(const GeodeticPoint& origin);
  ~LocalFrame();
  LocalFrame(LocalFrame&&) noexcept;
  LocalFrame& operator=(LocalFrame&&) noexcept;

  GeodeticPoint to_geodetic(const Eigen::Vector3d& local) const;
  Eigen::Vector3d to_local(const GeodeticPoint& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::flight
