/// Georeference of meshes from photogrammetry programs, which store it in a file of its own because
/// single precision holds no map coordinates.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace skycap::missions::site_data {

struct PhotogrammetryOffset {
  std::filesystem::path file;                        ///< File that contains the offset.
  std::string crs;                                   ///< Such as "EPSG:32632"; empty if unknown.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< To be added to the coordinates [m].
};

/// Returns the offset of a mesh, or nullopt without such a file.
///
/// OpenDroneMap: odm_texturing/NAME_geo.obj with odm_georeferencing/coords.txt, also in the folder
/// of the mesh. Its first line is "WGS84 UTM 32N" or "EPSG:32632", its second line the easting and
/// northing that were subtracted (ODM, opendm/types.py). Pix4D: NAME.obj with NAME_offset.xyz or
/// PROJECT_offset.xyz, if the folder contains only one, with x, y and z.
///
/// Metashape (export option), DJI Terra and iTwin Capture: metadata.xml in the folder of the mesh
/// or up to two folders above it. The root element is ModelMetadata, with the elements SRS and
/// SRSOrigin. A system other than EPSG:code, such as "ENU:latitude,longitude", is unknown.
///
/// Throws Error{bad_file} with the name and line of an invalid file.
std::optional<PhotogrammetryOffset> find_photogrammetry_offset(const std::filesystem::path& mesh);

}  // namespace skycap::missions::site_data
