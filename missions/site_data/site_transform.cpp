#include "missions/site_data/site_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;

std::string decimal(double value, int digits) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string position_text(double latitude_deg, double longitude_deg) {
  return "latitude " + decimal(latitude_deg, 6) + ", longitude " + decimal(longitude_deg, 6);
}

/// Returns the rotation from y up, as in modelling software, to z up. The front side then faces
/// south.
Eigen::Matrix3d upright(const Source& source, const FileContents& contents) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (source.is_y_up.value_or(contents.is_y_up.value_or(false))) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

/// Returns true if the coordinates may be longitude and latitude. All must be within the limits of
/// degrees, and the file must be a map or a raster with cells smaller than a centimetre.
bool may_be_degrees(const FileContents& contents) {
  const auto is_geodetic = [](const Vector3d& pose) {
    return std::abs(pose.x()) <= 180.0 && std::abs(pose.y()) <= 90.0;
  };
  constexpr double smallest_cell = 0.01;  // In metres or degrees.
  if (!contents.nodes.empty()) {
    return contents.right.norm() < smallest_cell &&
           std::ranges::all_of(contents.nodes, is_geodetic);
  }
  return contents.is_map && !contents.corners.empty() &&
         std::ranges::all_of(contents.corners, is_geodetic);
}

flight::GeodeticPoint geodetic_point(const Vector3d& pose) {
  return {pose.y(), pose.x(), pose.z()};
}

}  // namespace

SiteTransform::SiteTransform(const Source& source, const FileContents& contents,
                             const SiteFrame& site, bool needs_heights)
    : file_(source.file), needs_heights_(needs_heights), origin_(site.origin) {
  if (source.pose || (contents.crs.empty() && source.crs.empty())) {
    if (!source.pose && !contents.is_local_frame && may_be_degrees(contents)) {
      const Vector3d& some =
          contents.nodes.empty() ? contents.corners.front() : contents.nodes.front();
      throw Error(ErrorKind::bad_config,
                  file_.string() + ": missing coordinate reference system; the coordinates (" +
                      decimal(some.x(), 4) + ", " + decimal(some.y(), 4) +
                      ") may be degrees; set crs: EPSG:4326, or set place if they are in metres");
    }
    prepare_pose(source, contents);
    if (!source.pose && !contents.is_local_frame) {
      notes_.push_back("missing coordinate reference system; the mission frame is assumed");
    }
  } else {
    prepare_crs(source, contents, site);
  }
}

/// Throws if the unit of the file's heights is unknown and the source does not define it.
void SiteTransform::require_unit(const Source& source, const FileContents& contents) const {
  if (contents.unknown_unit.empty() || source.unit) return;
  throw Error(ErrorKind::bad_config, file_.string() + ": has heights in an unknown unit: '" +
                                         one_line(contents.unknown_unit.substr(0, 40)) +
                                         "'; set unit to the length of one unit in metres");
}

void SiteTransform::prepare_pose(const Source& source, const FileContents& contents) {
  require_unit(source, contents);
  if (!source.crs.empty()) {
    throw Error(ErrorKind::bad_config,
                file_.string() + ": place conflicts with crs; remove one of them");
  }
  if (source.vertical) {
    throw Error(ErrorKind::bad_config, file_.string() +
                                           ": vertical requires a coordinate reference system; "
                                           "without one, heights are z in the mission frame");
  }
  const SourcePose pose = source.pose.value_or(SourcePose{});
  const double unit = source.unit.value_or(contents.unit.value_or(1.0));
  const Eigen::AngleAxisd heading(-pose.heading, Vector3d::UnitZ());
  // The conversion to Affine3d is required because a transform times a plain matrix would treat its
  // columns as points.
  const double up = source.unit ? unit : contents.height_unit.value_or(unit);
  const Eigen::Affine3d upright_metres(
      Eigen::Matrix3d(Vector3d(unit, unit, up).asDiagonal() * upright(source, contents)));
  base_transform_ = Eigen::Translation3d(pose.position) * heading *
                    Eigen::Translation3d(source.offset) * upright_metres;
  metres_per_unit_ = Vector3d(unit, unit, up);
  name_ = "the mission frame";
}

void SiteTransform::prepare_crs(const Source& source, const FileContents& contents,
                                const SiteFrame& site) {
  if (source.crs.empty() && !contents.other_crs.empty()) {
    throw Error(ErrorKind::bad_config,
                file_.string() + ": contains two coordinate reference systems, " +
                    one_line(contents.crs) + " and " + one_line(contents.other_crs) +
                    "; set crs to the one that applies to the whole file");
  }
  ReferenceRequest request;
  request.crs = source.crs.empty() ? contents.crs : source.crs;
  request.is_latitude_first = source.crs.empty() && contents.is_latitude_first;
  request.vertical = source.vertical;
  request.vertical_if_silent = contents.vertical;
  request.needs_heights = needs_heights_;
  request.near = site.origin;
  if (!needs_heights_) request.takeoff_height = 0.0;  // Heights are not used.
  if (site.origin && site.takeoff_z) {
    const flight::LocalFrame frame(*site.origin);
    request.takeoff_height = frame.to_geodetic({0.0, 0.0, *site.takeoff_z}).height;
  }
  try {
    geodetic_ = geodetic_transform(request);
  } catch (const Error& error) {
    throw Error(error.kind(), file_.string() + ": " + one_line(error.what()));
  }
  name_ = geodetic_->name;
  notes_ = geodetic_->notes;
  prepare_units(source, contents);
}

void SiteTransform::prepare_units(const Source& source, const FileContents& contents) {
  if (!geodetic_->has_own_heights) require_unit(source, contents);
  if (contents.unit && !contents.is_scene && *contents.unit != 1.0) {
    notes_.push_back("its linear unit is not applied, because crs defines the unit");
  }
  if (source.unit && geodetic_->has_own_heights && !contents.is_scene) {
    throw Error(ErrorKind::bad_config, file_.string() + ": unit conflicts with " + name_ +
                                           ", which defines the unit of heights");
  }
  const double across = geodetic_->horizontal_unit;
  const std::optional<double> scene_unit = source.unit ? source.unit : contents.unit;
  const double all = contents.is_scene ? scene_unit.value_or(1.0) : 1.0;
  double up = 1.0;
  if (!geodetic_->has_own_heights && !contents.is_scene) {
    up = source.unit.value_or(contents.height_unit.value_or(across));
  } else if (!geodetic_->has_own_heights && !scene_unit) {
    up = across;
  }
  if (needs_heights_ && across != 1.0 && !source.unit && up == across) {
    notes_.push_back("heights are read in units of " + decimal(across, 6) +
                     " m, like the map coordinates; set unit to change this");
  }
  base_transform_ =
      Eigen::Translation3d(source.offset) *
      Eigen::Matrix3d(Vector3d(1.0, 1.0, up).asDiagonal() * upright(source, contents) * all);
  metres_per_unit_ = Vector3d(across, across, up * geodetic_->height_unit) * all;
  if (geodetic_->is_geographic) {
    constexpr double metres_per_degree = 111'320.0;
    const double latitude = origin_ ? origin_->latitude_deg * geometry::radians_per_degree : 0.0;
    metres_per_unit_.x() = metres_per_degree * std::cos(latitude);
    metres_per_unit_.y() = metres_per_degree;
  }
}

void SiteTransform::to_geodetic(std::span<Vector3d> coordinates) const {
  for (Vector3d& coordinate : coordinates) coordinate = base_transform_ * coordinate;
  geodetic_->apply(coordinates);
}

void SiteTransform::to_site(std::span<Vector3d> coordinates) const {
  if (!geodetic_) {
    for (Vector3d& coordinate : coordinates) {
      const Vector3d pose = base_transform_ * coordinate;
      if (!(pose.norm() <= farthest_from_site)) reject(coordinate, pose);
      coordinate = pose;
    }
    return;
  }
  if (!origin_) {
    throw Error(ErrorKind::bad_config, file_.string() + ": is in " + name_ +
                                           "; set site.latitude_deg and site.longitude_deg");
  }
  const flight::LocalFrame frame(*origin_);
  constexpr std::size_t at_once = 1 << 16;
  std::vector<Vector3d> batch;
  for (std::size_t first = 0; first < coordinates.size(); first += at_once) {
    const auto some = coordinates.subspan(first, std::min(at_once, coordinates.size() - first));
    batch.assign(some.begin(), some.end());
    to_geodetic(batch);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (!needs_heights_) batch[i].z() = origin_->height;
      const Vector3d pose =
          batch[i].allFinite() ? frame.to_local(geodetic_point(batch[i])) : batch[i];
      if (!(pose.norm() <= farthest_from_site)) reject(some[i], batch[i]);
      some[i] = pose;
    }
  }
}

void SiteTransform::reject(const Vector3d& coordinate, const Vector3d& pose) const {
  const std::string what = file_.string() + ": has " + decimal(coordinate.x(), 3) + " " +
                           decimal(coordinate.y(), 3) + " " + decimal(coordinate.z(), 3);
  if (!geodetic_) {
    throw Error(ErrorKind::bad_config,
                what + ", more than 50 km from the site; check unit, offset and place");
  }
  std::string message = what + " in " + name_;
  if (pose.allFinite()) {
    message += ", which is at " + position_text(pose.y(), pose.x()) +
               ", more than 50 km from the site at " +
               position_text(origin_->latitude_deg, origin_->longitude_deg);
  } else {
    message += ", which is not a position on the Earth; the site is at " +
               position_text(origin_->latitude_deg, origin_->longitude_deg);
  }
  std::array<Vector3d, 1> swapped = {Vector3d(coordinate.y(), coordinate.x(), coordinate.z())};
  to_geodetic(swapped);
  const bool is_swapped =
      swapped[0].allFinite() &&
      flight::LocalFrame(*origin_).to_local(geodetic_point(swapped[0])).norm() <=
          farthest_from_site;
  throw Error(ErrorKind::bad_config,
              message + (is_swapped ? "; the axes may be swapped: east must come first"
                                    : "; check crs and the position of the site"));
}

}  // namespace skycap::missions::site_data
