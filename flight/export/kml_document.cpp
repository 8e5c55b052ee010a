#include "flight/export/kml_document.h"

#include <sstream>

#include <pugixml.hpp>

namespace skycap::flight {

pugi::xml_node begin_kml(pugi::xml_document& document, const char* prefix,
                         const std::string& extensions) {
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node kml = document.append_child("kml");
  kml.append_attribute("xmlns") = kml_namespace;
  kml.append_attribute(prefix) = extensions.c_str();
  return kml;
}

std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream out;
  // Without this, text would be lost silently if memory is insufficient.
  out.exceptions(std::ios::badbit);
  document.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
  return out.str();
}

}  // namespace skycap::flight
