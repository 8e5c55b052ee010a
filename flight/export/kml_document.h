/// How KML files begin, and their texts.
#pragma once

#include <string>

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace skycap::flight {

inline constexpr const char* kml_namespace = "http://www.opengis.net/kml/2.2";

/// Begins a document: its root element, with a namespace of extensions under the attribute
/// `prefix`, such as "xmlns:gx".
pugi::xml_node begin_kml(pugi::xml_document& document, const char* prefix,
                         const std::string& extensions);

std::string xml_text(const pugi::xml_document& document);

}  // namespace skycap::flight
