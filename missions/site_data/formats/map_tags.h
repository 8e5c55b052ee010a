/// What the attributes of a map's objects say that they are, for the sources of its module.
#pragma once

#include <map>
#include <string>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Adds OSM's further tags, as GDAL writes them: "key"=>"value","key"=>"value", with \ before
/// quotes.
void add_tags(const std::string& text, std::map<std::string, std::string>& attributes);

/// The number that an attribute begins with; 0 if there is none.
double number_of(const FileObject& object, const char* key);

/// Whether an attribute is there and says other than "no".
bool has_tag(const FileObject& object, const char* key);

/// Whether one of its attributes may be a height.
bool may_state_height(const FileObject& object);

/// Whether an area of OpenStreetMap stands for something that is in the way.
bool is_structure(const FileObject& object);

/// Whether it is a line of electricity or of a cableway.
bool is_cable(const FileObject& object);

}  // namespace skycap::missions::site_data
