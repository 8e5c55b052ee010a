/// Between the local frame and the Earth, and the three heights that are so often confused.
///
/// The local frame is east-north-up about an origin on WGS84; the model stores ellipsoid heights.
/// Height above mean sea level is the ellipsoid height less the geoid undulation; height above
/// take-off is the difference of two ellipsoid heights.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace skycap::flight {

struct GeodeticPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height = 0.0;  ///< above the WGS84 ellipsoid [m]
};

/// Where the local frame is on the Earth.
struct Site {
  GeodeticPoint origin;
  /// Height of the geoid (EGM96 or EGM2008) above the ellipsoid at the site [m]; unknown if absent,
  /// then nothing can be written that needs heights above mean sea level.
  std::optional<double> geoid_undulation;

  /// Throws Error{bad_config} naming the first value that is out of its interval.
  void validate() const;

  /// The undulation. Throws Error{bad_config} saying that `who` needs it.
  double undulation_for(const std::string& who) const;
};

/// East-north-up about an origin: exact on the ellipsoid, not a flat-Earth approximation.
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
