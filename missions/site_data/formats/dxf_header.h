/// Reader of the linear unit in the header of DXF drawings, which GDAL ignores.
#pragma once

#include <filesystem>
#include <string_view>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Sets the unit from the text's $INSUNITS (AutoCAD DXF reference, HEADER). Adds notes about the
/// unit and about entities with a thickness, which is not supported. Throws Error{bad_file} for an
/// unknown unit unless `has_unit` is set, which means that the source defines the unit.
void apply_dxf_unit(const std::filesystem::path& file, std::string_view text, bool has_unit,
                    FileContents& contents);

}  // namespace skycap::missions::site_data
