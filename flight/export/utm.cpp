#include "flight/export/utm.h"

#include <cmath>

#include <GeographicLib/UTMUPS.hpp>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double series_reach = 1000.0;  // Range of the series around the origin [m].

int compute_utm_zone(const Site& site) {
  site.validate();
  const int zone =
      GeographicLib::UTMUPS::StandardZone(site.origin.latitude_deg, site.origin.longitude_deg);
  if (zone > 0) return zone;
  throw Error(ErrorKind::bad_config,
              "the site's latitude is " + std::to_string(site.origin.latitude_deg) +
                  "; UTM is defined from 80 degrees south to 84 degrees north");
}

std::string authority(int code) { return "AUTHORITY[\"EPSG\",\"" + std::to_string(code) + "\"]"; }

}  // namespace

UtmProjection::UtmProjection(const Site& site)
    : is_above_geoid_(site.geoid_undulation.has_value()),
      undulation_(site.geoid_undulation.value_or(0.0)),
      zone_(compute_utm_zone(site)),
      is_north_(site.origin.latitude_deg >= 0.0),
      frame_(site.origin) {
  constexpr double step = 500.0;
  const auto at = [&](const Vector3d& geodetic) { return to_map_exactly(step * geodetic); };
  at_origin_ = at(Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d unit = Vector3d::Unit(axis);
    const Vector3d after = at(unit), before = at(-unit);
    slopes_.col(axis) = (after - before) / (2.0 * step);
    curvature_.col(axis) = (after - 2.0 * at_origin_ + before) / (step * step);
    const Vector3d first = Vector3d::Unit((axis + 1) % 3), second = Vector3d::Unit((axis + 2) % 3);
    curvature_.col(3 + axis) =
        (at(first + second) - at(first - second) - at(second - first) + at(-first - second)) /
        (4.0 * step * step);
  }
}

Vector3d UtmProjection::to_map_exactly(const Vector3d& local) const {
  const GeodeticPoint point = frame_.to_geodetic(local);
  int zone = 0;
  bool is_north = true;
  double easting = 0.0, northing = 0.0;
  GeographicLib::UTMUPS::Forward(point.latitude_deg, point.longitude_deg, zone, is_north, easting,
                                 northing, zone_);
  // The zone's hemisphere is that of the origin, even beyond the equator.
  constexpr double southern_false_northing = 1e7;
  if (is_north && !is_north_) northing += southern_false_northing;
  if (!is_north && is_north_) northing -= southern_false_northing;
  return {easting, northing, point.height - undulation_};
}

Vector3d UtmProjection::to_map(const Vector3d& local) const {
  if (local.squaredNorm() > series_reach * series_reach) return to_map_exactly(local);
  const double x = local.x(), y = local.y(), z = local.z();
  Eigen::Matrix<double, 6, 1> squares;
  squares << 0.5 * x * x, 0.5 * y * y, 0.5 * z * z, y * z, x * z, x * y;
  return at_origin_ + slopes_ * local + curvature_ * squares;
}

// Written as a constant so that exports do not require PROJ. Tests compare it with PROJ's output
// for the code.
std::string UtmProjection::wkt() const {
  const std::string metre = "UNIT[\"metre\",1," + authority(9001) + "]";
  const std::string name = "WGS 84 / UTM zone " + std::to_string(zone_) + (is_north_ ? "N" : "S");
  const std::string projected =
      "PROJCS[\"" + name + "\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137," +
      "298.257223563," + authority(7030) + "]," + authority(6326) + "],PRIMEM[\"Greenwich\",0," +
      authority(8901) + "],UNIT[\"degree\",0.0174532925199433," + authority(9122) + "]," +
      authority(4326) + "],PROJECTION[\"Transverse_Mercator\"]," +
      "PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\"," +
      std::to_string(6 * zone_ - 183) + "],PARAMETER[\"scale_factor\",0.9996]," +
      "PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\"," +
      (is_north_ ? "0" : "10000000") + "]," + metre + ",AXIS[\"Easting\",EAST]," +
      "AXIS[\"Northing\",NORTH]," + authority(epsg()) + "]";
  // Datum type 2005 denotes a geoid. 2002 denotes the ellipsoid, which has no EPSG code.
  const std::string vertical =
      is_above_geoid_
          ? "VERT_CS[\"EGM96 height\",VERT_DATUM[\"EGM96 geoid\",2005," + authority(5171) + "]," +
                metre + ",AXIS[\"Gravity-related height\",UP]," + authority(5773) + "]"
          : "VERT_CS[\"ellipsoid height\",VERT_DATUM[\"Ellipsoid\",2002]," + metre +
                ",AXIS[\"Up\",UP]]";
  return "COMPD_CS[\"" + name + (is_above_geoid_ ? " + EGM96 height" : " + ellipsoid height") +
         "\"," + projected + "," + vertical + "]";
}

}  // namespace skycap::flight
