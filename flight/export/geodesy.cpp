#include "flight/export/geodesy.h"

#include <cmath>

#include <GeographicLib/LocalCartesian.hpp>

#include "geometry/error.h"

namespace skycap::flight {

void Site::validate() const {
  const auto require = [](double value, double limit, const char* field) {
    if (std::abs(value) <= limit) return;  // False for NaN.
    throw Error(ErrorKind::bad_config, "the site's " + std::string(field) + " is " +
                                           std::to_string(value) + "; it must be from " +
                                           std::to_string(-limit) + " to " + std::to_string(limit));
  };
  require(origin.latitude_deg, 90.0, "latitude");
  require(origin.longitude_deg, 180.0, "longitude");
  require(origin.height, 10000.0, "ellipsoid height");
  if (geoid_undulation) require(*geoid_undulation, 120.0, "geoid undulation");
}

double Site::undulation_for(const std::string& who) const {
  if (geoid_undulation) return *geoid_undulation;
  throw Error(ErrorKind::bad_config,
              who +
                  " requires heights above mean sea level, but the geoid undulation of the site is "
                  "unknown; set site.geoid_undulation");
}

struct LocalFrame::Impl {
  GeographicLib::LocalCartesian frame;
};

LocalFrame::LocalFrame(const GeodeticPoint& origin)
    : impl_(new Impl{{origin.latitude_deg, origin.longitude_deg, origin.height}}) {}
LocalFrame::~LocalFrame() = default;
LocalFrame::LocalFrame(LocalFrame&&) noexcept = default;
LocalFrame& LocalFrame::operator=(LocalFrame&&) noexcept = default;

GeodeticPoint LocalFrame::to_geodetic(const Eigen::Vector3d& local) const {
  GeodeticPoint point;
  impl_->frame.Reverse(local.x(), local.y(), local.z(), point.latitude_deg, point.longitude_deg,
                       point.height);
  return point;
}

Eigen::Vector3d LocalFrame::to_local(const GeodeticPoint& point) const {
  Eigen::Vector3d local;
  impl_->frame.Forward(point.latitude_deg, point.longitude_deg, point.height, local.x(), local.y(),
                       local.z());
  return local;
}

}  // namespace skycap::flight
