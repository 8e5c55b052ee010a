#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "missions/site_data/reference_system.h"

namespace skycap::missions::site_data {
namespace {

struct Name {
  std::string_view authority, epsg;
};

/// Names of the German surveys (AdV, "Kurzbezeichnungen der Koordinatenreferenzsysteme").
constexpr std::array<Name, 14> horizontal_names = {{
    {"ETRS89_UTM31", "25831"},
    {"ETRS89_UTM32", "25832"},
    {"ETRS89_UTM33", "25833"},
    {"ETRS89_Lat-Lon", "4258"},
    {"DE_DHDN_3GK2", "31466"},
    {"DE_DHDN_3GK3", "31467"},
    {"DE_DHDN_3GK4", "31468"},
    {"DE_DHDN_3GK5", "31469"},
    {"DE_42-83_3GK3", "2397"},
    {"DE_42-83_3GK4", "2398"},
    {"DE_42-83_3GK5", "2399"},
    {"DE_RD-83_3GK4", "3398"},
    {"DE_RD-83_3GK5", "3399"},
    {"WGS84_Lat-Lon", "4326"},
}};
constexpr std::array<Name, 4> vertical_names = {{
    {"DE_DHHN2016_NH", "7837"},
    {"DE_DHHN92_NH", "5783"},
    {"DE_DHHN12_NOH", "7699"},
    {"DE_DHHN85_NOH", "5784"},
}};

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

template <typename Names>
std::string_view authority_code(const Names& names, std::string_view authority) {
  for (const Name& name : names) {
    if (name.authority == authority) return name.epsg;
  }
  return {};
}

/// Parts of a German survey's name: a horizontal system, heights, and a geoid model, which PROJ
/// selects automatically. They are separated by asterisks and optional spaces.
struct AdvName {
  std::string_view horizontal, vertical;  ///< EPSG numbers; empty if unknown.
  bool names_heights = false;
};

AdvName adv_name(std::string_view names) {
  AdvName result;
  const std::size_t star = names.find('*');
  result.horizontal = authority_code(horizontal_names, trimmed(names.substr(0, star)));
  result.names_heights = star != std::string_view::npos;
  if (!result.names_heights) return result;
  const std::string_view rest = names.substr(star + 1);
  result.vertical = authority_code(vertical_names, trimmed(rest.substr(0, rest.find('*'))));
  return result;
}

}  // namespace

std::string proj_name(const std::string& crs) {
  // Names of the map projections of Switzerland in its city models. PROJ knows the geographic
  // systems by them.
  if (crs == "CH1903") return "EPSG:21781";
  if (crs == "CH1903+") return "EPSG:2056";
  constexpr std::string_view adv = "urn:adv:crs:";
  if (!crs.starts_with(adv)) return crs;
  const AdvName name = adv_name(std::string_view(crs).substr(adv.size()));
  if (name.horizontal.empty() || (name.names_heights && name.vertical.empty())) return crs;
  std::string known = "EPSG:" + std::string(name.horizontal);
  if (name.names_heights) known += "+" + std::string(name.vertical);
  return known;
}

std::string name_by_numbers(const std::string& crs) {
  std::string upper;
  for (const char c : crs) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string name;
  int systems = 0;
  for (std::size_t at = upper.find("EPSG"); at != std::string::npos; at = upper.find("EPSG", at)) {
    // Examples: "EPSG::25832", "EPSG:6.9:25832", "EPSG/0/25832", "epsg.xml#25832".
    const std::size_t end = std::min(upper.find_first_of(", +", at), upper.size());
    std::size_t last = end;
    while (last > at && std::isdigit(static_cast<unsigned char>(upper[last - 1])) != 0) --last;
    if (end - last >= 4) {
      name += (systems++ == 0 ? "EPSG:" : "+") + upper.substr(last, end - last);
    }
    at = end;
  }
  return systems <= 2 ? name : std::string();
}

std::string likely_name(const std::string& crs) {
  constexpr std::string_view adv = "urn:adv:crs:";
  const std::string by_numbers = name_by_numbers(crs);
  if (!by_numbers.empty() || !crs.starts_with(adv)) return by_numbers;
  const AdvName name = adv_name(std::string_view(crs).substr(adv.size()));
  return name.horizontal.empty() ? std::string() : "EPSG:" + std::string(name.horizontal);
}

}  // namespace skycap::missions::site_data
