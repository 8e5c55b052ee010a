/// The header of a DXF drawing, which GDAL passes over: what its lengths are in.
#pragma once

#include <filesystem>
#include <string_view>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Sets the unit that the text's $INSUNITS names (AutoCAD's DXF reference, HEADER), and notes what
/// was taken, and entities with a thickness, which is not read. Throws Error{bad_file} for a unit
/// that is not known, if `has_unit` does not say that the source names one.
void take_dxf_unit(const std::filesystem::path& file, std::string_view text, bool has_unit,
                   FileContents& contents);

}  // namespace skycap::missions::site_data
