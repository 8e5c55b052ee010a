/// Readers of maps and terrain based on GDAL, and of scenes based on Assimp. The libraries are
/// loaded on demand.
#pragma once

#include <filesystem>
#include <string>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Reads the polygons of a map: GeoJSON, GPKG, Shapefile, KML, OSM (.osm, .pbf), DXF, FlatGeobuf.
/// Two-dimensional polygons are outlines, and building heights are taken from their attributes.
/// Points and lines are skipped with a note, except closed lines of DXF. Throws Error{bad_file},
/// and Error{bad_config} if the layer does not exist.
FileContents read_map(const std::filesystem::path& file, const std::string& layer);

/// Reads the first band of a height raster: GeoTIFF, ASCII grid, XYZ, JPEG 2000. Throws
/// Error{bad_file}.
FileContents read_raster(const std::filesystem::path& file);

/// Reads a scene: glTF, GLB, Collada, FBX, IFC, 3DS. Nodes become objects with y up, as in Assimp's
/// output. Throws Error{bad_file}.
FileContents read_scene(const std::filesystem::path& file);

}  // namespace skycap::missions::site_data
