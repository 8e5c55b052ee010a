/// Maps and terrain by GDAL, models of scenes by assimp: each is loaded when it is needed.
#pragma once

#include <filesystem>
#include <string>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Polygons of a map: GeoJSON, GPKG, Shapefile, KML, OSM (.osm, .pbf), DXF, FlatGeobuf. Outlines
/// are two-dimensional polygons; heights of buildings are those that their attributes state. Points
/// and lines are passed over, with a note, but for closed lines of DXF. Throws Error{bad_file}, and
/// Error{bad_config} if there is no such layer.
FileContents read_map(const std::filesystem::path& file, const std::string& layer);

/// The first band of a raster of heights: GeoTIFF, ASCII grid, XYZ, JPEG 2000. Throws
/// Error{bad_file}.
FileContents read_raster(const std::filesystem::path& file);

/// A scene: glTF, GLB, Collada, FBX, IFC, 3DS. Its nodes are objects, with y up as assimp hands
/// all of them on. Throws Error{bad_file}.
FileContents read_scene(const std::filesystem::path& file);

}  // namespace skycap::missions::site_data
