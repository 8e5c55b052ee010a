#include <array>
#include <string_view>

#include "missions/site_data/reference_system.h"

namespace skycap::missions::site_data {
namespace {

struct Name {
  std::string_view authority, epsg;
};

/// Of the German surveys (AdV, "Kurzbezeichnungen der Koordinatenreferenzsysteme").
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

template <typename Names>
std::string_view number_of(const Names& names, std::string_view authority) {
  for (const Name& name : names) {
    if (name.authority == authority) return name.epsg;
  }
  return {};
}

}  // namespace

std::string proj_name(const std::string& crs) {
  constexpr std::string_view adv = "urn:adv:crs:";
  if (!crs.starts_with(adv)) return crs;
  const std::string_view names = std::string_view(crs).substr(adv.size());
  const std::size_t star = names.find('*');
  const std::string_view horizontal = number_of(horizontal_names, names.substr(0, star));
  if (horizontal.empty()) return crs;
  if (star == std::string_view::npos) return "EPSG:" + std::string(horizontal);
  const std::string_view vertical = number_of(vertical_names, names.substr(star + 1));
  if (vertical.empty()) return crs;
  return "EPSG:" + std::string(horizontal) + "+" + std::string(vertical);
}

}  // namespace skycap::missions::site_data
