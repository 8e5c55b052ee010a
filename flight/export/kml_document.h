/// Common start and text output of KML documents.
#pragma once

#include <string>

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace skycap::flight {

inline constexpr const char* kml_namespace = "http://www.opengis.net/kml/2.2";

/// Creates the root element of a document. `prefix` is the attribute of the extension namespace,
/// such as "xmlns:gx".
pugi::xml_node begin_kml(pugi::xml_document& document, const char* prefix,
                         const std::string& extensions);

std::string xml_text(const pugi::xml_document& document);

}  // namespace skycap::flight
