/// Interpretation of the attributes of map objects, for the sources of the module.
#pragma once

#include <map>
#include <string>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Adds OSM's additional tags in GDAL's notation: "key"=>"value","key"=>"value", with \ before
/// quotes.
void add_tags(const std::string& text, std::map<std::string, std::string>& attributes);

/// Returns the number at the start of an attribute, or 0 without one.
double numeric_tag(const FileObject& object, const char* key);

/// Returns true if the attribute exists and is not "no".
bool has_tag(const FileObject& object, const char* key);

/// Returns true if one of the attributes may be a height.
bool may_state_height(const FileObject& object);

/// Returns true if an OpenStreetMap area represents a physical structure.
bool is_structure(const FileObject& object);

/// Returns true for power lines and cableways.
bool is_cable(const FileObject& object);

}  // namespace skycap::missions::site_data
